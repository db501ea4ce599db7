//! EGL contexts that echomarch did not make.

use std::ffi::c_void;

use super::library::{Functions, loaded};

// Values from EGL/egl.h.
const EGL_DRAW: i32 = 0x3059;
const EGL_READ: i32 = 0x305A;

/// A current EGL context that echomarch did not make.
pub(in crate::gpu) struct Foreign {
    functions: &'static Functions,
    api: u32,
    display: *const c_void,
    draw: *const c_void,
    read: *const c_void,
    context: *const c_void,
}

impl Foreign {
    /// The EGL context that is current on this thread, if any; `None` if no EGL context has been made yet.
    pub fn of_system() -> Option<Foreign> {
        let functions = loaded()?;
        let egl = &functions.egl;
        // SAFETY: only a query.
        unsafe {
            let context = egl.GetCurrentContext();
            if context.is_null() {
                return None;
            }
            Some(Foreign {
                functions,
                api: egl.QueryAPI(),
                display: egl.GetCurrentDisplay(),
                draw: egl.GetCurrentSurface(EGL_DRAW),
                read: egl.GetCurrentSurface(EGL_READ),
                context,
            })
        }
    }

    /// Makes no context current on this thread.
    pub fn release(&self) {
        let none = std::ptr::null();
        // SAFETY: the display is the current one; null surfaces and no context mean that none is current.
        unsafe {
            self.functions
                .egl
                .MakeCurrent(self.display, none, none, none)
        };
    }

    /// Makes it current again. If its owner has destroyed it in the meantime, EGL refuses and no context is current.
    pub fn make_current(&self) {
        let egl = &self.functions.egl;
        // SAFETY: EGL checks the handles against its own.
        unsafe {
            egl.BindAPI(self.api);
            egl.MakeCurrent(self.display, self.draw, self.read, self.context);
        }
    }
}
