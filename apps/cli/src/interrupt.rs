//! Signals that end the program: from the terminal (SIGINT), by another program (SIGTERM), or
//! because the terminal is closed (SIGHUP).
//!
//! The temporary files are removed, and the exit code is 128 and the signal's number, as a
//! shell reports it. The window ends as if it had been closed.

use echomarch::internals::file_output::remove_parts;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering::SeqCst};
use std::time::Duration;

/// Maximum time that the window may take to end after a signal.
const MOST_TO_END: Duration = Duration::from_secs(5);

/// Whether the running command polls [`asked`] and then ends.
static IS_GENTLE: AtomicBool = AtomicBool::new(false);

/// The signal received; 0 for none.
static ASKED: AtomicI32 = AtomicI32::new(0);

/// Handles signals from now on as described in the module header. A hang-up that was ignored before
/// (`nohup`) stays ignored.
///
/// # Errors
/// Errors of the system, which may be unable to start another thread.
pub fn install() -> io::Result<()> {
    let mut answered = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP) {
        answered.push(SIGHUP);
    }
    let mut signals = Signals::new(answered)?;
    std::thread::Builder::new()
        .name("echomarch-signals".to_owned())
        .spawn(move || {
            for signal in signals.forever() {
                answer(signal);
            }
        })?;
    Ok(())
}

/// The first signal requests the end if the running command polls for it. Otherwise, and at the
/// second signal, the process exits.
fn answer(signal: i32) {
    let is_first = ASKED.swap(signal, SeqCst) == 0;
    if !(is_first && IS_GENTLE.load(SeqCst)) {
        end(signal);
    }
    let watch = std::thread::Builder::new().spawn(move || {
        std::thread::sleep(MOST_TO_END);
        end(signal);
    });
    if watch.is_err() {
        end(signal);
    }
}

fn end(signal: i32) {
    remove_parts();
    // Exits at once: other threads may be in the middle of anything.
    signal_hook::low_level::exit(exit_code(signal));
}

fn exit_code(signal: i32) -> i32 {
    128 + signal
}

/// From now on a signal only requests the end; the running command must poll [`asked`].
#[cfg(feature = "demo")]
pub fn ask_from_now_on() {
    IS_GENTLE.store(true, SeqCst);
}

/// Whether a signal requested the end.
#[cfg(feature = "demo")]
pub fn is_asked() -> bool {
    asked().is_some()
}

/// The exit code of the signal that requested the end, if one did.
pub fn asked() -> Option<u8> {
    match ASKED.load(SeqCst) {
        0 => None,
        signal => u8::try_from(exit_code(signal)).ok(),
    }
}

fn is_ignored(signal: i32) -> bool {
    // SAFETY: all zero bytes are a valid `sigaction` (no handler, an empty mask), and without a new
    // action `sigaction` only writes the present one to the given place.
    unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let asked = libc::sigaction(signal, std::ptr::null(), &raw mut present);
        asked == 0 && present.sa_sigaction == libc::SIG_IGN
    }
}
