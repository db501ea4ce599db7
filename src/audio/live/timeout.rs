//! Waiting for a sound system that may never answer.

use std::sync::atomic::{AtomicBool, Ordering::Acquire, Ordering::Release};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::LiveError;

/// Maximum time to wait for a sound system.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(5);

/// Interval at which a waiting thread checks whether to give up.
const GLANCE: Duration = Duration::from_millis(20);

/// Whether a request is in progress. Only one request runs at a time, so that a sound system that
/// hangs holds one thread and one connection, however many requests follow.
static IS_PENDING: AtomicBool = AtomicBool::new(false);

/// Ends the request when its thread ends, even by a panic.
struct PendingRequest;

impl PendingRequest {
    /// `None` while another request is in progress.
    fn begin() -> Option<Self> {
        (!IS_PENDING.swap(true, Acquire)).then(|| Self)
    }
}

impl Drop for PendingRequest {
    fn drop(&mut self) {
        IS_PENDING.store(false, Release);
    }
}

/// Runs `work`, which calls the sound system, on a separate thread and waits for it up to a limit,
/// or until `is_off`.
///
/// A later answer is dropped on that thread; until then no other request starts.
pub(super) fn within<T: Send + 'static>(
    limit: Duration,
    is_off: impl Fn() -> bool,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, LiveError> {
    let start = Instant::now();
    let is_enough = || is_off() || start.elapsed() > limit;
    let no_answer = LiveError::NoAnswer {
        seconds: limit.as_secs(),
    };
    let request = loop {
        match PendingRequest::begin() {
            Some(request) => break request,
            None if is_enough() => return Err(no_answer),
            None => thread::sleep(GLANCE),
        }
    };
    let (sender, receiver) = mpsc::channel();
    spawn("echomarch-open", move || {
        let answer = work();
        drop(request);
        // The receiver may be gone: the answer is then dropped.
        let _ = sender.send(answer);
    })?;
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Disconnected) => return Err(LiveError::BrokenDown),
            Err(RecvTimeoutError::Timeout) if is_enough() => return Err(no_answer),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Drops a value on a separate thread, since that may take long.
pub(super) fn drop_elsewhere<T: Send + 'static>(value: T) {
    // If the thread cannot start, the value is dropped with the closure, here.
    let _ = spawn("echomarch-close", move || drop(value));
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<(), LiveError> {
    let spawned = thread::Builder::new().name(name.to_owned()).spawn(work);
    spawned.map_err(|source| LiveError::Thread { source })?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a hanging sound system from repeated requests, each from another thread; and a
    /// panic from being reported as a time-out. It is one test because all requests share one lock.
    #[test]
    fn one_request_at_a_time_and_a_panic_is_told() {
        let (answer, hangs) = mpsc::channel::<()>();
        let brief = Duration::from_millis(50);
        let first = within(brief, || false, move || hangs.recv().is_ok());
        assert!(matches!(first, Err(LiveError::NoAnswer { .. })));
        let second = within(
            brief,
            || false,
            || unreachable!("the first is still under way"),
        );
        assert!(matches!(second, Err(LiveError::NoAnswer { .. })));
        answer.send(()).unwrap();
        assert_eq!(within(ANSWER_LIMIT, || false, || 3).unwrap(), 3);
        let panicked: Result<(), _> = within(ANSWER_LIMIT, || false, || panic!("on purpose"));
        assert!(matches!(panicked, Err(LiveError::BrokenDown)));
        assert_eq!(within(ANSWER_LIMIT, || false, || 4).unwrap(), 4);
    }
}
