//! The interface of the libraries that make contexts.

use std::ffi::{CStr, c_void};

/// One GL context, as the library that made it sees it: EGL or OSMesa without a window, or a window's own.
///
/// Dropping it destroys the context; `current` sees to it that no context at all is current then.
pub(super) trait Backend {
    /// Makes the context current on this thread. No other may be current: Mesa's libraries share one slot for the
    /// current context, and each believes what it last put there itself.
    ///
    /// # Errors
    /// What the library answered.
    fn make_current(&self) -> Result<(), String>;

    /// Whether the library reports that calls on this thread go to this context: others may have made theirs current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn is_current(&self) -> bool;

    /// Makes no context current on this thread. The context is the current one.
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

    /// Address of a GL function, null where the library has none of that name.
    fn proc_address(&self, name: &CStr) -> *const c_void;

    /// Whose context it is, and who makes it current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn owner(&self) -> Owner {
        Owner::Echomarch
    }
}

/// Whose a context is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// Made here, and free to stay current.
    Echomarch,
    /// Made by the caller, whose functions make it current and not current.
    Caller,
    /// Made by the caller, who keeps it current: echomarch does not change that.
    KeptCurrentByCaller,
}
