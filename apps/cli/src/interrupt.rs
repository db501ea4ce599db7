//! Signals that end the program: from the terminal (SIGINT), by another program (SIGTERM), or
//! because the terminal is closed (SIGHUP).
//!
//! The program removes its temporary files, and exits with 128 plus the number of the signal, as
//! shells do. The window ends as if it had been closed.

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

/// Installs the handlers described in the module header. A hang-up signal that was ignored before
/// (`nohup`) stays ignored.
///
/// # Errors
/// Errors of the system, which may fail to start another thread.
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

/// At the first signal the running command is told to end if it polls for that. Otherwise, and at
/// the second signal, the process exits at once.
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
    // Exits without cleaning up: other threads may hold locks.
    signal_hook::low_level::exit(exit_code(signal));
}

fn exit_code(signal: i32) -> i32 {
    128 + signal
}

/// From now on a signal only requests the end. The running command must poll [`asked`].
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
    // action `sigaction` only writes the current action to the given address.
    unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let asked = libc::sigaction(signal, std::ptr::null(), &raw mut present);
        asked == 0 && present.sa_sigaction == libc::SIG_IGN
    }
}
