//! Turns off the messages of JACK's client library.
//!
//! ALSA has a plugin that plays to JACK. When the devices of ALSA are listed that plugin looks
//! for a server, and without one the library writes an error to the standard error stream, some
//! six lines a time. It offers two functions to send its messages elsewhere.

use std::ffi::c_char;
use std::sync::Once;

/// What takes a message.
type Told = extern "C" fn(*const c_char);

extern "C" fn forget(_: *const c_char) {}

/// Sends the messages of JACK's client library nowhere, where that library is installed. Errors
/// still come back from ALSA.
pub(super) fn hush() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // SAFETY: the library is the one that ALSA's plugin would load, by the same name; what it
        // runs when it is loaded it would run there as well.
        let Ok(library) = (unsafe { libloading::Library::new("libjack.so.0") }) else {
            return;
        };
        for name in [
            b"jack_set_error_function\0" as &[u8],
            b"jack_set_info_function\0",
        ] {
            // SAFETY: both are `void (void (*)(const char *))` since JACK 0.118, and what they are
            // given may be called on any thread at any time: it does nothing.
            unsafe {
                if let Ok(set) = library.get::<unsafe extern "C" fn(Told)>(name) {
                    set(forget);
                }
            }
        }
        // It holds on to `forget`, and other libraries to it.
        std::mem::forget(library);
    });
}
