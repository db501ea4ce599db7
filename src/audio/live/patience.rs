//! Waiting for a sound system that may never answer.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::LiveError;

/// How long a sound system is waited for.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(5);

/// How often a waiting thread looks whether it shall give up.
const GLANCE: Duration = Duration::from_millis(20);

/// Runs `work` on a thread of its own and waits for it up to a limit, or until `is_off`.
///
/// If it answers later, the answer is dropped on that thread.
pub(super) fn within<T: Send + 'static>(
    limit: Duration,
    is_off: impl Fn() -> bool,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, LiveError> {
    let (sender, receiver) = mpsc::channel();
    spawn("echomarch-open", move || {
        // Nobody listens any more: the answer goes.
        let _ = sender.send(work());
    })?;
    let start = Instant::now();
    let no_answer = LiveError::NoAnswer {
        seconds: limit.as_secs(),
    };
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Disconnected) => return Err(no_answer),
            Err(RecvTimeoutError::Timeout) if is_off() || start.elapsed() > limit => {
                return Err(no_answer);
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Drops a value on a thread of its own, which may take as long as it likes.
pub(super) fn drop_elsewhere<T: Send + 'static>(value: T) {
    // Without a thread it is dropped with the closure, here.
    let _ = spawn("echomarch-close", move || drop(value));
}

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<(), LiveError> {
    let spawned = thread::Builder::new().name(name.to_owned()).spawn(work);
    spawned.map_err(|source| LiveError::Thread { source })?;
    Ok(())
}
