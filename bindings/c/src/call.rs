//! Statuses, and the one place where panics end.

use echomarch::Error;
use echomarch::simulator::SimulatorError;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of a call. `echomarch_simulator_error` has the text of the last one that is not ECHOMARCH_STATUS_OK.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EchomarchStatus {
    /// Done.
    Ok = 0,
    /// A handle or a place for a result is NULL.
    Null = 1,
    /// A number is out of its range or not a number, or a text is not one of the scene format.
    BadInput = 2,
    /// There is no such source or surface: it was removed, or never added.
    NoObject = 3,
    /// There is no OpenGL that the simulator can use, or the system starts no thread.
    NoRenderer = 4,
    /// The source has no update: before its first round, and if it is removed or disabled.
    NotYet = 5,
    /// A fault in the library. The handle can be freed; its other results are not reliable.
    Fault = 6,
}

/// The reason why a call changes nothing.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error("{0} is NULL")]
    Null(&'static str),
    #[error("{0} is not a text in UTF-8")]
    NotUtf8(&'static str),
    #[error("the text must have exactly one {what}, not {count}")]
    NotOne { what: &'static str, count: usize },
    #[error("the source has no update: before its first round, and if it is removed or disabled")]
    NotYet,
    #[error("a fault in the library: the call ended in a panic")]
    Fault,
    #[error("{0}")]
    Library(#[from] Error),
}

impl From<SimulatorError> for Failure {
    fn from(error: SimulatorError) -> Failure {
        Failure::Library(error.into())
    }
}

impl Failure {
    pub fn status(&self) -> EchomarchStatus {
        match self {
            Failure::Null(_) => EchomarchStatus::Null,
            Failure::NotUtf8(_) | Failure::NotOne { .. } => EchomarchStatus::BadInput,
            Failure::NotYet => EchomarchStatus::NotYet,
            Failure::Fault => EchomarchStatus::Fault,
            Failure::Library(Error::Gpu(_)) => EchomarchStatus::NoRenderer,
            Failure::Library(Error::Simulator(error)) => match error {
                SimulatorError::NoSource(_) | SimulatorError::NoSurface(_) => {
                    EchomarchStatus::NoObject
                }
                SimulatorError::NoThread { .. } => EchomarchStatus::NoRenderer,
                _ => EchomarchStatus::BadInput,
            },
            Failure::Library(_) => EchomarchStatus::BadInput,
        }
    }
}

/// Runs the body of a call. Every function of the interface goes through here, so that no panic reaches C.
///
/// A body may leave a handle half changed by a panic. That is safe, and the caller learns of the fault.
pub fn guard<T>(body: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or(Err(Failure::Fault))
}

/// The status of a result without a value.
pub fn status_of(result: &Result<(), Failure>) -> EchomarchStatus {
    result
        .as_ref()
        .map_or_else(Failure::status, |()| EchomarchStatus::Ok)
}

/// A text of the caller.
///
/// # Safety
/// `text` is null, or a text that ends with 0 and is not changed during the call.
pub unsafe fn text_of<'a>(text: *const c_char, what: &'static str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::Null(what));
    }
    // SAFETY: it is not null, and the caller ends it with 0.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Failure::NotUtf8(what))
}

/// The meaning of a status in English, for example of `echomarch_mix_process`, which leaves no text of its own. Never
/// NULL; the text is never freed.
#[unsafe(no_mangle)]
pub extern "C" fn echomarch_status_text(status: i32) -> *const c_char {
    let text = match status {
        0 => c"done",
        1 => c"a handle or a place for a result is NULL",
        2 => c"a number is out of its range, or a text is not one of the scene format",
        3 => c"there is no such source or surface",
        4 => c"there is no OpenGL that the simulator can use",
        5 => c"the source has no update yet",
        6 => c"a fault in the library",
        _ => c"not a status of echomarch",
    };
    text.as_ptr()
}
