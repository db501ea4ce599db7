//! Contexts without a window on macOS: CGL needs none.

use std::ffi::{CStr, c_void};
use std::ptr;
use std::rc::Rc;

use glutin::api::cgl::context::PossiblyCurrentContext;
use glutin::api::cgl::display::Display;
use glutin::config::ConfigSurfaceTypes;
use glutin::error::ErrorKind;
use glutin::prelude::*;
use raw_window_handle::{AppKitDisplayHandle, RawDisplayHandle};

use super::backend::Backend;
use super::glutin_context::{attributes, new_context, template};
use super::{Api, GpuError};

/// Where a context can be made: macOS chooses the graphics card itself.
#[derive(Debug)]
pub(super) struct Place;

/// The one place.
///
/// # Errors
/// None.
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    Ok(vec![Place])
}

/// Sees that there is a library: CGL is there with macOS.
///
/// # Errors
/// None.
#[cfg(feature = "demo")]
pub(super) fn prepare() -> Result<(), GpuError> {
    Ok(())
}

/// Makes a context; it is not current yet.
///
/// # Errors
/// [`GpuError::NoContext`] with what macOS answered; of OpenGL ES it has none.
pub(super) fn open(_: &Place, api: Api) -> Result<Rc<dyn Backend>, GpuError> {
    let refused = |reason: String| GpuError::NoContext { api, reason };
    if api == Api::Gles {
        return Err(refused("macOS has no OpenGL ES".into()));
    }
    match Cgl::new() {
        Ok(cgl) => Ok(Rc::new(cgl)),
        Err(error) => Err(refused(error.to_string())),
    }
}

/// A context of CGL that draws into no surface.
struct Cgl {
    context: PossiblyCurrentContext,
    display: Display,
}

impl Cgl {
    fn new() -> Result<Cgl, glutin::error::Error> {
        // SAFETY: no native display handle is given that would have to be valid.
        let display =
            unsafe { Display::new(RawDisplayHandle::AppKit(AppKitDisplayHandle::new())) }?;
        let template = template(Api::Gl, ConfigSurfaceTypes::empty()).build();
        // SAFETY: the template names no native window or pixmap.
        let config = unsafe { display.find_configs(template) }?.next();
        let config = config.ok_or(ErrorKind::BadConfig)?;
        let context =
            new_context(&display, &config, attributes(Api::Gl))?.treat_as_possibly_current();
        Ok(Cgl { context, display })
    }
}

impl Backend for Cgl {
    fn make_current(&self) -> Result<(), String> {
        self.context
            .make_current_surfaceless()
            .map_err(|error| error.to_string())
    }

    fn is_current(&self) -> bool {
        self.context.is_current()
    }

    fn release(&self) {
        // A failure leaves a context current that the next make_current replaces.
        let _ = self.context.make_not_current_in_place();
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        self.display.get_proc_address(name)
    }
}

#[link(name = "OpenGL", kind = "framework")]
unsafe extern "C" {
    fn CGLGetCurrentContext() -> *mut c_void;
    fn CGLSetCurrentContext(context: *mut c_void) -> i32;
}

/// A context of CGL's that echomarch did not make, as it was current.
pub(super) struct Foreign(*mut c_void);

impl Foreign {
    /// What is current on this thread, if anything.
    pub fn of_system() -> Option<Foreign> {
        // SAFETY: asks only.
        let context = unsafe { CGLGetCurrentContext() };
        (!context.is_null()).then_some(Foreign(context))
    }

    /// Makes no context current on this thread.
    pub fn release(&self) {
        // SAFETY: null means none.
        unsafe { CGLSetCurrentContext(ptr::null_mut()) };
    }

    /// Makes it current again.
    pub fn make_current(&self) {
        // SAFETY: its owner keeps it while it is current, which it was when this call into echomarch began.
        unsafe { CGLSetCurrentContext(self.0) };
    }
}
