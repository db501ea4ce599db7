//! Turns off the messages of JACK's client library.
//!
//! ALSA has a plugin that plays to JACK. When ALSA's devices are listed, the plugin looks for a
//! server, and without one the library writes an error of about six lines to the standard error
//! stream each time. The library offers two functions to redirect its messages.

use std::ffi::c_char;
use std::sync::Once;

/// A function that receives a message.
type Told = extern "C" fn(*const c_char);

extern "C" fn forget(_: *const c_char) {}

/// Discards the messages of JACK's client library, if that library is installed. ALSA still returns
/// errors.
pub(super) fn hush() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // SAFETY: this is the library that ALSA's plugin would load, by the same name; its
        // initialisers would run there as well.
        let Ok(library) = (unsafe { libloading::Library::new("libjack.so.0") }) else {
            return;
        };
        for name in [
            b"jack_set_error_function\0" as &[u8],
            b"jack_set_info_function\0",
        ] {
            // SAFETY: both are `void (void (*)(const char *))` since JACK 0.118, and the function
            // passed to them may be called on any thread at any time: it does nothing.
            unsafe {
                if let Ok(set) = library.get::<unsafe extern "C" fn(Told)>(name) {
                    set(forget);
                }
            }
        }
        // The library keeps a pointer to `forget`, and other libraries use the library.
        std::mem::forget(library);
    });
}
