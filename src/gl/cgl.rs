//! Contexts without a window on macOS, through CGL.

use std::ffi::c_void;
use std::ptr;
use std::rc::Rc;

use glutin::api::cgl::context::PossiblyCurrentContext;
use glutin::api::cgl::display::Display;
use glutin::config::ConfigSurfaceTypes;
use glutin::error::ErrorKind;
use glutin::prelude::*;
use raw_window_handle::{AppKitDisplayHandle, RawDisplayHandle};

#[cfg(feature = "window")]
pub(super) use super::backend::prepare;
use super::backend::{Backend, GlutinContext, attributes, new_context, template};
pub(super) use super::backend::{Place, places};
use super::{Api, GpuError};

/// Makes a context, which is not yet current.
///
/// # Errors
/// [`GpuError::NoContext`] with the error of macOS, which has no OpenGL ES.
pub(super) fn open(_: &Place, api: Api) -> Result<Rc<dyn Backend>, GpuError> {
    if api == Api::Gles {
        return Err(GpuError::no_context(api, "macOS has no OpenGL ES"));
    }
    match create() {
        Ok(context) => Ok(Rc::new(context)),
        Err(error) => Err(GpuError::no_context(api, error)),
    }
}

/// Creates a context without a surface.
fn create() -> Result<impl Backend + use<>, glutin::error::Error> {
    // SAFETY: the call passes no native display handle that would have to be valid.
    let display = unsafe { Display::new(RawDisplayHandle::AppKit(AppKitDisplayHandle::new())) }?;
    let template = template(Api::Gl, ConfigSurfaceTypes::empty()).build();
    // SAFETY: the template names no native window or pixmap.
    let config = unsafe { display.find_configs(template) }?.next();
    let config = config.ok_or(ErrorKind::BadConfig)?;
    Ok(GlutinContext {
        context: new_context(&display, &config, attributes(Api::Gl))?.treat_as_possibly_current(),
        make_current: PossiblyCurrentContext::make_current_surfaceless,
        display,
    })
}

#[link(name = "OpenGL", kind = "framework")]
unsafe extern "C" {
    fn CGLGetCurrentContext() -> *mut c_void;
    fn CGLSetCurrentContext(context: *mut c_void) -> i32;
    fn CGLRetainContext(context: *mut c_void) -> *mut c_void;
    fn CGLReleaseContext(context: *mut c_void);
}

/// A current CGL context that echomarch did not make.
pub(super) struct Foreign(*mut c_void);

impl Foreign {
    /// The CGL context that is current on this thread, if any.
    pub fn of_system() -> Option<Foreign> {
        // SAFETY: only a query.
        let context = unsafe { CGLGetCurrentContext() };
        // SAFETY: the context is the current one, and released when this is dropped.
        (!context.is_null()).then(|| Foreign(unsafe { CGLRetainContext(context) }))
    }

    /// Leaves this thread without a current context.
    pub fn release(&self) {
        // SAFETY: null means none.
        unsafe { CGLSetCurrentContext(ptr::null_mut()) };
    }

    /// Makes the context current again.
    pub fn make_current(&self) {
        // SAFETY: the context was retained.
        unsafe { CGLSetCurrentContext(self.0) };
    }
}

impl Drop for Foreign {
    fn drop(&mut self) {
        // SAFETY: the context was retained once.
        unsafe { CGLReleaseContext(self.0) };
    }
}
