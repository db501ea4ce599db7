//! The interface of the libraries that make contexts.

use std::ffi::{CStr, c_void};

/// One GL context as seen by the library that made it: EGL or OSMesa without a window, or a window's own library.
///
/// Dropping it destroys the context; `current` ensures that no context is current at that time.
pub(super) trait Backend {
    /// Makes the context current on this thread. No other context may be current: Mesa's libraries share one slot for
    /// the current context, and each assumes that the slot still holds what it last stored there.
    ///
    /// # Errors
    /// The library's answer.
    fn make_current(&self) -> Result<(), String>;

    /// Whether the library reports this context as current on this thread: other code may have made another one
    /// current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn is_current(&self) -> bool;

    /// Makes no context current on this thread. This context is the current one.
    fn release(&self);

    /// Whether the library itself reports that the context is lost: a browser does, and its calls then do nothing and
    /// report no error.
    fn is_lost(&self) -> bool {
        false
    }

    /// The parameter that holds the driver's name for the device.
    fn renderer_parameter(&self, _gl: &glow::Context) -> u32 {
        glow::RENDERER
    }

    /// Address of a GL function, or null if the library has no function of that name.
    fn proc_address(&self, name: &CStr) -> *const c_void;

    /// The owner: whether echomarch or the caller made the context, and who makes it current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn owner(&self) -> Owner {
        Owner::Echomarch
    }
}

/// Owner of a context.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// Made by echomarch; may stay current.
    Echomarch,
    /// Made by the caller, whose functions make it current and not current.
    Caller,
    /// Made by the caller, who keeps it current: echomarch does not change that.
    KeptCurrentByCaller,
}
