//! Contexts of Mesa's off-screen library, which is loaded on first use.

use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::ptr;
use std::sync::OnceLock;

use libloading::Library;

use super::backend::Backend;
use super::{Api, GpuError};

/// File names tried for the library, newest first.
const LIBRARY_NAMES: [&str; 3] = ["libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"];

// Values from GL/osmesa.h.
const OSMESA_RGBA: c_int = 0x1908;
const OSMESA_FORMAT: c_int = 0x22;
const OSMESA_DEPTH_BITS: c_int = 0x30;
const OSMESA_STENCIL_BITS: c_int = 0x31;
const OSMESA_PROFILE: c_int = 0x33;
const OSMESA_CORE_PROFILE: c_int = 0x34;
const OSMESA_CONTEXT_MAJOR_VERSION: c_int = 0x36;
const OSMESA_CONTEXT_MINOR_VERSION: c_int = 0x37;

/// Side in pixels of the unused colour buffer that every context must have.
const SIDE: usize = 16;

type CreateContext = unsafe extern "C" fn(*const c_int, *mut c_void) -> *mut c_void;
type DestroyContext = unsafe extern "C" fn(*mut c_void);
type MakeCurrent = unsafe extern "C" fn(*mut c_void, *mut c_void, c_uint, c_int, c_int) -> u8;
type GetCurrentContext = unsafe extern "C" fn() -> *mut c_void;
type GetProcAddress = unsafe extern "C" fn(*const c_char) -> *const c_void;

/// The functions of the library, which stays loaded: unloading a driver may crash the program.
struct Functions {
    create_context: CreateContext,
    destroy_context: DestroyContext,
    make_current: MakeCurrent,
    get_current_context: GetCurrentContext,
    get_proc_address: GetProcAddress,
    _library: Library,
}

impl Functions {
    fn get() -> Result<&'static Functions, GpuError> {
        static FUNCTIONS: OnceLock<Result<Functions, String>> = OnceLock::new();
        FUNCTIONS
            .get_or_init(|| Functions::load().map_err(|error| error.to_string()))
            .as_ref()
            .map_err(|reason| GpuError::NoOsMesaLibrary {
                reason: reason.clone(),
            })
    }

    fn load() -> Result<Functions, libloading::Error> {
        let library = load_library()?;
        // SAFETY: the symbols have the types given in GL/osmesa.h, and the library is stored with them.
        unsafe {
            Ok(Functions {
                create_context: *library.get(b"OSMesaCreateContextAttribs\0")?,
                destroy_context: *library.get(b"OSMesaDestroyContext\0")?,
                make_current: *library.get(b"OSMesaMakeCurrent\0")?,
                get_current_context: *library.get(b"OSMesaGetCurrentContext\0")?,
                get_proc_address: *library.get(b"OSMesaGetProcAddress\0")?,
                _library: library,
            })
        }
    }
}

fn load_library() -> Result<Library, libloading::Error> {
    let [first, others @ ..] = LIBRARY_NAMES;
    // SAFETY: Mesa's initialisers may run at any time, on any thread.
    let mut library = unsafe { Library::new(first) };
    for name in others {
        if library.is_err() {
            // SAFETY: as above.
            library = unsafe { Library::new(name) };
        }
    }
    library
}

/// An OSMesa context.
pub(super) struct OsMesa {
    functions: &'static Functions,
    context: *mut c_void,
    // The library writes to the buffer when the context is flushed.
    colours: Box<UnsafeCell<[u8; 4 * SIDE * SIDE]>>,
}

impl OsMesa {
    /// Makes a context of OpenGL 3.3 core, which is not yet current.
    ///
    /// # Errors
    /// [`GpuError::NoOsMesaLibrary`], [`GpuError::NoContext`].
    pub(super) fn new() -> Result<OsMesa, GpuError> {
        let functions = Functions::get()?;
        #[rustfmt::skip]
        let attributes = [
            OSMESA_FORMAT, OSMESA_RGBA,
            OSMESA_DEPTH_BITS, 0,
            OSMESA_STENCIL_BITS, 0,
            OSMESA_PROFILE, OSMESA_CORE_PROFILE,
            OSMESA_CONTEXT_MAJOR_VERSION, 3,
            OSMESA_CONTEXT_MINOR_VERSION, 3,
            0, 0,
        ];
        // SAFETY: the list ends in zero, and no context is shared.
        let context = unsafe { (functions.create_context)(attributes.as_ptr(), ptr::null_mut()) };
        if context.is_null() {
            let reason = "OSMesa cannot create a context of OpenGL 3.3 core";
            return Err(GpuError::no_context(Api::OsMesa, reason));
        }
        Ok(OsMesa {
            functions,
            context,
            colours: Box::new(UnsafeCell::new([0; 4 * SIDE * SIDE])),
        })
    }
}

impl Backend for OsMesa {
    fn make_current(&self) -> Result<(), String> {
        // SAFETY: the context exists; the buffer has the given size and lives as long as the context.
        let made = unsafe {
            let side = SIDE as c_int;
            (self.functions.make_current)(
                self.context,
                self.colours.get().cast(),
                glow::UNSIGNED_BYTE,
                side,
                side,
            )
        };
        if made == 0 {
            Err("OSMesaMakeCurrent failed".into())
        } else {
            Ok(())
        }
    }

    fn is_current(&self) -> bool {
        // SAFETY: only a query; the answer is compared and never dereferenced.
        unsafe { (self.functions.get_current_context)() == self.context }
    }

    fn release(&self) {
        // SAFETY: null for both context and buffer means no context.
        unsafe {
            (self.functions.make_current)(
                ptr::null_mut(),
                ptr::null_mut(),
                glow::UNSIGNED_BYTE,
                0,
                0,
            )
        };
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        // SAFETY: the name ends in zero.
        unsafe { (self.functions.get_proc_address)(name.as_ptr()) }
    }
}

impl Drop for OsMesa {
    fn drop(&mut self) {
        // SAFETY: the context exists and is not used again.
        unsafe { (self.functions.destroy_context)(self.context) };
    }
}
