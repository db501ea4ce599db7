//! The connection to the X server, which breaks if the server stops or the network fails.
//!
//! By default, Xlib then ends the process (`XIOError`), and winit panics where it expects a reply. This module lets
//! Xlib continue with the broken connection (`XSetIOErrorExitHandler`, from libX11 1.7 on). With an older libX11 the
//! process still ends with exit code 1. A panic caused by a broken connection ends only the event loop.

use libloading::Library;
use std::any::Any;
use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind, set_hook, take_hook};
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use winit::event_loop::{EventLoop, OwnedDisplayHandle};
use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};

/// Whether Xlib has reported a broken connection. Xlib has one error handler per process.
static IS_BROKEN: AtomicBool = AtomicBool::new(false);

type XDisplay = *mut c_void;
type IoErrorHandler = unsafe extern "C" fn(XDisplay) -> c_int;
type IoErrorExitHandler = unsafe extern "C" fn(XDisplay, *mut c_void);

type SetIoErrorHandler = unsafe extern "C" fn(Option<IoErrorHandler>) -> Option<IoErrorHandler>;
type SetIoErrorExitHandler = unsafe extern "C" fn(XDisplay, IoErrorExitHandler, *mut c_void);
type GetXcbConnection = unsafe extern "C" fn(XDisplay) -> *mut c_void;
type ConnectionHasError = unsafe extern "C" fn(*mut c_void) -> c_int;

/// A connection handle that stays valid after the server has gone. The fields are dropped in declaration order: the
/// handle that keeps the connection open is dropped last.
#[derive(Clone)]
pub struct Connection(Arc<Inner>);

struct Inner {
    xcb: *mut c_void,
    has_error: ConnectionHasError,
    _library: Library,
    _open: OwnedDisplayHandle,
}

// SAFETY: xcb_connection_has_error may be called from any thread (xcb.h). The pointer has no other use, and this struct
// keeps the connection open.
unsafe impl Send for Inner {}
// SAFETY: as above.
unsafe impl Sync for Inner {}

/// Records the error instead of printing it.
extern "C" fn take_down(_: XDisplay) -> c_int {
    IS_BROKEN.store(true, Ordering::Release);
    0
}

/// Returns control to Xlib instead of ending the process.
extern "C" fn go_on(_: XDisplay, _: *mut c_void) {}

impl Connection {
    /// Returns the event loop's connection. Returns `None` if it is not an Xlib connection, or if a library lacks a
    /// required function; the process then ends with the server.
    pub fn of(events: &EventLoop<()>) -> Option<Connection> {
        let open = events.owned_display_handle();
        let RawDisplayHandle::Xlib(handle) = open.display_handle().ok()?.as_raw() else {
            return None;
        };
        let display = handle.display?.as_ptr();
        // SAFETY: winit has already loaded these libraries, so loading them again runs no code. The symbols have the
        // types declared in Xlib.h, Xlib-xcb.h and xcb.h. The display is open, and the handlers are static functions.
        // libX11 and libX11-xcb stay loaded while winit holds its own handles, which it keeps with the connection.
        unsafe {
            let x11 = Library::new("libX11.so.6").ok()?;
            let between = Library::new("libX11-xcb.so.1").ok()?;
            let library = Library::new("libxcb.so.1").ok()?;
            let set_exit = *x11
                .get::<SetIoErrorExitHandler>(b"XSetIOErrorExitHandler\0")
                .ok()?;
            let set = *x11.get::<SetIoErrorHandler>(b"XSetIOErrorHandler\0").ok()?;
            let xcb = *between
                .get::<GetXcbConnection>(b"XGetXCBConnection\0")
                .ok()?;
            let has_error = *library
                .get::<ConnectionHasError>(b"xcb_connection_has_error\0")
                .ok()?;
            set(Some(take_down));
            set_exit(display, go_on, ptr::null_mut());
            Some(Connection(Arc::new(Inner {
                xcb: xcb(display),
                has_error,
                _library: library,
                _open: open,
            })))
        }
    }

    /// Whether the server is known to be gone.
    pub fn is_gone(&self) -> bool {
        // SAFETY: this struct keeps the connection open, and keeps the library loaded that contains the function.
        let has_error = unsafe { (self.0.has_error)(self.0.xcb) } != 0;
        has_error || IS_BROKEN.load(Ordering::Acquire)
    }

    /// Calls `run` and returns its result; `None` if it panicked because the server is gone. Any other panic is passed
    /// on.
    pub fn outlive<T>(&self, run: impl FnOnce() -> T) -> Option<T> {
        let usual = Arc::new(take_hook());
        let (connection, at_panic) = (self.clone(), usual.clone());
        set_hook(Box::new(move |panic| {
            if !connection.is_gone() {
                at_panic(panic);
            }
        }));
        let ran = catch_unwind(AssertUnwindSafe(run));
        // Restores the previous hook.
        drop(take_hook());
        if let Ok(usual) = Arc::try_unwrap(usual) {
            set_hook(usual);
        }
        ran.map_or_else(|panic| self.only_if_gone(panic), Some)
    }

    fn only_if_gone<T>(&self, panic: Box<dyn Any + Send>) -> Option<T> {
        if self.is_gone() {
            return None;
        }
        resume_unwind(panic)
    }
}
