//! EGL's functions, loaded from a complete library.

use std::ffi::{CStr, CString, c_void};
use std::ptr;
use std::sync::OnceLock;

use glutin_egl_sys::egl::Egl;
use libloading::Library;

use crate::gpu::GpuError;

/// Names under which the library is looked for. Glutin, which opens displays, also takes the first one found.
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

/// The functions, which stay loaded: drivers do not survive being unloaded.
pub struct Functions {
    pub egl: Egl,
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

/// The functions, loaded when first requested.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::StrangeEglLibrary`].
pub fn functions() -> Result<&'static Functions, GpuError> {
    match FUNCTIONS.get_or_init(load) {
        Ok(functions) => Ok(functions),
        Err(Failure::NotThere) => Err(GpuError::NoEglLibrary),
        Err(Failure::Strange(reason)) => Err(GpuError::StrangeEglLibrary {
            reason: reason.clone(),
        }),
    }
}

/// The functions, if they have been loaded.
pub fn loaded() -> Option<&'static Functions> {
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
    // SAFETY: the function has this type in every library that has it.
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

/// The address of a symbol of the library, or null if it has none.
fn symbol(library: &Library, name: &CStr) -> *const c_void {
    // SAFETY: only the address is taken.
    match unsafe { library.get::<*const c_void>(name.to_bytes_with_nul()) } {
        Ok(symbol) => *symbol,
        Err(_) => ptr::null(),
    }
}
