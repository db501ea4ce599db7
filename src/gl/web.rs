//! A WebGL 2 context made by a page in a browser.
//!
//! WebGL 2 is OpenGL ES 3.0 without some calls: buffers cannot be mapped, fences cannot be waited for, and reading
//! texels is the only way to wait for the drawing ([`platform`](crate::platform)).
//!
//! A browser's contexts are always current, so the functions of `current` do nothing here.

use super::backend::Backend;
use super::{Api, Context, GpuError};
use std::ffi::{CStr, c_void};
use std::ptr;
use std::rc::Rc;
use web_sys::WebGl2RenderingContext;

/// The extension that reports the device's name.
const RENDERER_INFO: &str = "WEBGL_debug_renderer_info";

/// The parameter for the device's name, from the extension's specification.
const UNMASKED_RENDERER_WEBGL: u32 = 0x9246;

/// A context of the browser, which is always current.
struct Page(WebGl2RenderingContext);

impl Context {
    /// Wraps a context that the page made: `canvas.getContext("webgl2", { antialias: false })`. Works with a canvas in
    /// the page and with one off the screen (`OffscreenCanvas`, in a worker).
    ///
    /// # Errors
    /// [`GpuError::MissingExtension`] if the browser has no `EXT_color_buffer_float`; [`GpuError::NoContext`].
    pub fn from_webgl2(context: WebGl2RenderingContext) -> Result<Context, GpuError> {
        let page = Rc::new(Page(context.clone()));
        Context::from_backend_with(page, Api::Gles, |_| {
            // glow enables all extensions that it knows, including the one for float targets.
            Ok(glow::Context::from_webgl2_context(context))
        })
    }
}

impl Backend for Page {
    fn make_current(&self) -> Result<(), String> {
        Ok(())
    }

    fn is_current(&self) -> bool {
        true
    }

    fn release(&self) {}

    fn is_lost(&self) -> bool {
        self.0.is_context_lost()
    }

    fn renderer_parameter(&self, gl: &glow::Context) -> u32 {
        use glow::HasContext;
        match gl.supported_extensions().contains(RENDERER_INFO) {
            true => UNMASKED_RENDERER_WEBGL,
            false => glow::RENDERER,
        }
    }

    fn proc_address(&self, _name: &CStr) -> *const c_void {
        ptr::null()
    }
}

/// Makes the context current.
///
/// # Errors
/// The backend's error.
pub(super) fn make(context: &Rc<dyn Backend>) -> Result<(), String> {
    context.make_current()
}

/// Does nothing: there is nothing to release.
pub(super) fn release() {}

/// A guard without effect, because there is nothing to restore.
#[must_use]
pub(crate) struct Entered;

/// Makes the context current.
///
/// # Errors
/// The errors of [`make`].
pub(super) fn enter(context: &Rc<dyn Backend>) -> Result<Entered, String> {
    make(context).map(|()| Entered)
}
