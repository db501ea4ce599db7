//! EGL: its library, contexts without a window (on a device chosen by index, or on a display without a device if EGL
//! lists none), and contexts made by others.

use std::ffi::{CStr, CString, c_void};
use std::ptr;
use std::rc::Rc;
use std::sync::OnceLock;

use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::ConfigSurfaceTypes;
use glutin::error::ErrorKind;
use glutin::prelude::*;
use glutin_egl_sys::egl::Egl;
use libloading::Library;

use super::backend::{Backend, GlutinContext, attributes, new_context, template};
use super::{Api, GpuError};
use plain::{Plain, Platform};

mod plain;

/// A device or display to make a context on.
#[derive(Debug)]
pub(super) enum Place {
    /// A device in EGL's list.
    Device(Device),
    /// A display without a device.
    Platform(Platform),
}

/// Returns the devices and displays on which a context can be made, at least one: the devices that EGL lists, in its
/// order; if EGL lists none (ANGLE, older drivers), the displays without a device that can be opened.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`], [`GpuError::NoEglDevice`].
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    prepare()?;
    let mut reasons = Vec::new();
    match Device::query_devices() {
        Ok(devices) => {
            let places: Vec<Place> = devices.map(Place::Device).collect();
            if !places.is_empty() {
                return Ok(places);
            }
            reasons.push("the list is empty".to_owned());
        }
        Err(error) => reasons.push(error.to_string()),
    }
    let mut places = Vec::new();
    for platform in Platform::ALL {
        match platform.check() {
            Ok(()) => places.push(Place::Platform(platform)),
            Err(reason) => reasons.push(reason),
        }
    }
    match places.is_empty() {
        true => Err(GpuError::NoEglDevice {
            reason: reasons.join("; "),
        }),
        false => Ok(places),
    }
}

/// Checks that there is a complete library before glutin loads it: glutin ends the program if functions are missing.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`].
pub(super) fn prepare() -> Result<(), GpuError> {
    functions().map(|_| ())
}

/// Makes a context, which is not yet current.
///
/// # Errors
/// [`GpuError::NoContext`] with EGL's error.
pub(super) fn open(place: &Place, api: Api) -> Result<Rc<dyn Backend>, GpuError> {
    match place {
        Place::Device(device) => match create(device, api) {
            Ok(egl) => Ok(Rc::new(egl)),
            Err(error) => Err(GpuError::no_context(api, error)),
        },
        Place::Platform(platform) => Ok(Rc::new(Plain::on(*platform, api)?)),
    }
}

/// Creates a context on a device, without a surface.
fn create(device: &Device, api: Api) -> Result<impl Backend + use<>, glutin::error::Error> {
    // SAFETY: the call passes no native display handle that would have to be valid.
    let display = unsafe { Display::with_device(device, None) }?;
    let template = template(api, ConfigSurfaceTypes::empty());
    // SAFETY: the template names no native window or pixmap.
    let mut configs = unsafe { display.find_configs(template.build()) }?;
    let config = configs.next().ok_or(ErrorKind::BadConfig)?;
    drop(configs);
    Ok(GlutinContext {
        context: new_context(&display, &config, attributes(api))?.treat_as_possibly_current(),
        make_current: PossiblyCurrentContext::make_current_surfaceless,
        display,
    })
}

/// File names tried for the library. Glutin, which opens displays, also takes the first one found.
const NAMES: [&str; 2] = ["libEGL.so.1", "libEGL.so"];

/// Functions that a libEGL must have, including those that glutin calls: calling a missing function ends the program.
const NEEDED: [&CStr; 23] = [
    c"eglBindAPI",
    c"eglChooseConfig",
    c"eglCreateContext",
    c"eglCreatePbufferSurface",
    c"eglCreateWindowSurface",
    c"eglDestroyContext",
    c"eglDestroySurface",
    c"eglGetConfigAttrib",
    c"eglGetConfigs",
    c"eglGetCurrentContext",
    c"eglGetCurrentDisplay",
    c"eglGetCurrentSurface",
    c"eglGetDisplay",
    c"eglGetError",
    c"eglGetProcAddress",
    c"eglInitialize",
    c"eglMakeCurrent",
    c"eglQueryAPI",
    c"eglQueryString",
    c"eglQuerySurface",
    c"eglSwapBuffers",
    c"eglSwapInterval",
    c"eglTerminate",
];

/// The functions of the library, which stays loaded: unloading a driver may crash the program.
struct Functions {
    egl: Egl,
    _library: Library,
}

// SAFETY: addresses of functions, which do not change and may be called from any thread.
unsafe impl Send for Functions {}
// SAFETY: as above.
unsafe impl Sync for Functions {}

/// Reason why loading the functions failed.
#[derive(Clone, Debug)]
enum Failure {
    NotThere,
    Strange(String),
}

static FUNCTIONS: OnceLock<Result<Functions, Failure>> = OnceLock::new();

/// Returns the functions, loaded on first use.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`].
fn functions() -> Result<&'static Functions, GpuError> {
    match FUNCTIONS.get_or_init(load) {
        Ok(functions) => Ok(functions),
        Err(Failure::NotThere) => Err(GpuError::NoEglLibrary),
        Err(Failure::Strange(reason)) => Err(GpuError::StrangeEglLibrary {
            reason: reason.clone(),
        }),
    }
}

/// Returns the functions if they have been loaded.
fn loaded() -> Option<&'static Functions> {
    FUNCTIONS.get()?.as_ref().ok()
}

fn load() -> Result<Functions, Failure> {
    let found = NAMES.into_iter().find_map(|name| {
        // SAFETY: the initialisers of an EGL library may run at any time, on any thread.
        let library = unsafe { Library::new(name) };
        library.ok().map(|library| (name, library))
    });
    let (name, library) = found.ok_or(Failure::NotThere)?;
    for function in NEEDED {
        if symbol(&library, function).is_null() {
            let function = function.to_string_lossy();
            let reason = format!("the first {name} that is found has no {function}");
            return Err(Failure::Strange(reason));
        }
    }
    // SAFETY: the function has this type in every library that provides it.
    let address: unsafe extern "system" fn(*const i8) -> *const c_void =
        unsafe { std::mem::transmute(symbol(&library, c"eglGetProcAddress")) };
    let egl = Egl::load_with(|name| {
        let Ok(name) = CString::new(name) else {
            return ptr::null();
        };
        match symbol(&library, &name) {
            // SAFETY: the name ends in zero.
            none if none.is_null() => unsafe { address(name.as_ptr().cast()) },
            found => found,
        }
    });
    Ok(Functions {
        egl,
        _library: library,
    })
}

/// The address of a symbol in the library, or null if the library lacks it.
fn symbol(library: &Library, name: &CStr) -> *const c_void {
    // SAFETY: only the address is taken.
    match unsafe { library.get::<*const c_void>(name.to_bytes_with_nul()) } {
        Ok(symbol) => *symbol,
        Err(_) => ptr::null(),
    }
}

// Values from EGL/egl.h.
const EGL_DRAW: i32 = 0x3059;
const EGL_READ: i32 = 0x305A;

/// A current EGL context that echomarch did not make.
pub(super) struct Foreign {
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

    /// Leaves this thread without a current context.
    pub fn release(&self) {
        let none = std::ptr::null();
        // SAFETY: the display is the current one; null surfaces and no context release the current context.
        unsafe {
            self.functions
                .egl
                .MakeCurrent(self.display, none, none, none)
        };
    }

    /// Makes the context current again. If its owner has destroyed it in the meantime, EGL refuses and no context is
    /// current.
    pub fn make_current(&self) {
        let egl = &self.functions.egl;
        // SAFETY: EGL rejects handles that it does not know.
        unsafe {
            egl.BindAPI(self.api);
            egl.MakeCurrent(self.display, self.draw, self.read, self.context);
        }
    }
}
