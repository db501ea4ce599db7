//! Handles the signals that end the program: SIGINT from the terminal, SIGTERM from another program, and SIGHUP when
//! the terminal closes.
//!
//! The program removes its temporary files and exits with 128 plus the signal number, as shells do. The window closes
//! normally.

use echomarch::internals::file_output::remove_parts;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering::SeqCst};
use std::time::Duration;

/// Maximum time in which the window must close after a signal.
const MOST_TO_END: Duration = Duration::from_secs(5);

/// Whether the running command polls [`asked`] and then ends.
static IS_GENTLE: AtomicBool = AtomicBool::new(false);

/// The number of the received signal; 0 if there was none.
static ASKED: AtomicI32 = AtomicI32::new(0);

/// Installs the signal handlers described in the module documentation. A hang-up signal that was already ignored
/// (`nohup`) stays ignored.
///
/// # Errors
/// System errors, for example if another thread cannot be started.
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

/// Handles a signal. At the first signal, a running command that polls [`asked`] is asked to end. Otherwise, and at the
/// second signal, the process exits at once.
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
    // Exits without running destructors, because other threads may hold locks.
    signal_hook::low_level::exit(exit_code(signal));
}

fn exit_code(signal: i32) -> i32 {
    128 + signal
}

/// From this call on, a signal only requests the end of the program. The running command must poll [`asked`].
#[cfg(feature = "demo")]
pub fn ask_from_now_on() {
    IS_GENTLE.store(true, SeqCst);
}

/// Whether a signal requested the end.
#[cfg(feature = "demo")]
pub fn is_asked() -> bool {
    asked().is_some()
}

/// The exit code for the signal that requested the end; `None` without a signal.
pub fn asked() -> Option<u8> {
    match ASKED.load(SeqCst) {
        0 => None,
        signal => u8::try_from(exit_code(signal)).ok(),
    }
}

fn is_ignored(signal: i32) -> bool {
    // SAFETY: an all-zero `sigaction` is valid (no handler, empty mask). Without a new action, `sigaction` only writes
    // the current action to the given address.
    unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let asked = libc::sigaction(signal, std::ptr::null(), &raw mut present);
        asked == 0 && present.sa_sigaction == libc::SIG_IGN
    }
}
