//! Contexts without a window on systems where EGL lists no devices: on Mesa's platform without surfaces, or on the
//! default display. ANGLE and older drivers list no devices.

use std::ffi::{CStr, c_void};
use std::{fmt, ptr};

use glutin_egl_sys::egl;
use glutin_egl_sys::egl::types::{EGLConfig, EGLContext, EGLDisplay, EGLSurface, EGLint};

use super::{Functions, functions};
use crate::gl::backend::Backend;
use crate::gl::{Api, GpuError};

// Constant of EGL_MESA_platform_surfaceless.
const PLATFORM_SURFACELESS_MESA: u32 = 0x31DD;

/// Side in pixels of the unused surface for contexts that must have one.
const SIDE: EGLint = 1;

/// A display that is opened without a device and without a connection to a window system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gl) enum Platform {
    /// Mesa's platform of `EGL_MESA_platform_surfaceless`.
    Surfaceless,
    /// EGL's default display.
    Default,
}

impl fmt::Display for Platform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Platform::Surfaceless => "the surfaceless platform",
            Platform::Default => "the default display",
        })
    }
}

/// EGL's error for a failed call.
struct Refusal(String);

/// An open display. It is never closed: other code in this process may have opened the same one.
struct Opened {
    functions: &'static Functions,
    display: EGLDisplay,
    /// EGL's version: major and minor.
    version: (EGLint, EGLint),
    extensions: String,
}

impl Platform {
    /// All platforms, in the order in which they are tried.
    pub const ALL: [Platform; 2] = [Platform::Surfaceless, Platform::Default];

    /// Checks whether the display can be opened.
    ///
    /// # Errors
    /// EGL's error.
    pub fn check(self) -> Result<(), String> {
        let functions = functions().map_err(|error| error.to_string())?;
        self.open(functions).map(drop).map_err(|Refusal(why)| why)
    }

    fn open(self, functions: &'static Functions) -> Result<Opened, Refusal> {
        let egl = &functions.egl;
        let none = ptr::null_mut();
        // SAFETY: the call passes no native display that would have to be valid.
        let display = unsafe {
            match self {
                Platform::Surfaceless => {
                    let known = extensions(functions, egl::NO_DISPLAY);
                    if !has(&known, "EGL_MESA_platform_surfaceless")
                        || !egl.GetPlatformDisplayEXT.is_loaded()
                    {
                        return Err(Refusal(format!("{self} is not offered")));
                    }
                    egl.GetPlatformDisplayEXT(PLATFORM_SURFACELESS_MESA, none, ptr::null())
                }
                Platform::Default => egl.GetDisplay(ptr::null()),
            }
        };
        if display.is_null() {
            return Err(refusal(functions, &format!("{self}: eglGetDisplay")));
        }
        let mut version = (0, 0);
        // SAFETY: the display is EGL's own, and the pointers are valid for the two numbers.
        if unsafe { egl.Initialize(display, &raw mut version.0, &raw mut version.1) } == egl::FALSE
        {
            return Err(refusal(functions, &format!("{self}: eglInitialize")));
        }
        let extensions = extensions(functions, display);
        Ok(Opened {
            functions,
            display,
            version,
            extensions,
        })
    }
}

/// A context on such a display.
pub(in crate::gl) struct Plain {
    functions: &'static Functions,
    api: egl::types::EGLenum,
    display: EGLDisplay,
    context: EGLContext,
    /// Null if the contexts need no surface to be current.
    surface: EGLSurface,
}

impl Plain {
    /// Makes a context, which is not yet current.
    ///
    /// # Errors
    /// [`GpuError::NoContext`] with EGL's error, and the errors of the library.
    pub fn on(platform: Platform, api: Api) -> Result<Plain, GpuError> {
        let functions = functions()?;
        let made = platform.open(functions).and_then(|open| open.context(api));
        made.map_err(|Refusal(reason)| GpuError::no_context(api, reason))
    }
}

impl Opened {
    fn context(&self, api: Api) -> Result<Plain, Refusal> {
        let egl = &self.functions.egl;
        let name = match api {
            Api::Gles => egl::OPENGL_ES_API,
            Api::Gl | Api::OsMesa => egl::OPENGL_API,
        };
        // SAFETY: the name is one of EGL's.
        if unsafe { egl.BindAPI(name) } == egl::FALSE {
            return Err(refusal(self.functions, "eglBindAPI"));
        }
        let is_surfaceless = has(&self.extensions, "EGL_KHR_surfaceless_context");
        let config = self.config(api, is_surfaceless)?;
        let context = self.new_context(api, config)?;
        let mut made = Plain {
            functions: self.functions,
            api: name,
            display: self.display,
            context,
            surface: egl::NO_SURFACE,
        };
        if !is_surfaceless {
            let size = [egl::WIDTH as EGLint, SIDE, egl::HEIGHT as EGLint, SIDE];
            let attributes = ended(&size);
            // SAFETY: display and configuration are EGL's own, and the list has an end marker.
            made.surface =
                unsafe { egl.CreatePbufferSurface(self.display, config, attributes.as_ptr()) };
            if made.surface.is_null() {
                return Err(refusal(self.functions, "eglCreatePbufferSurface"));
            }
        }
        Ok(made)
    }

    fn config(&self, api: Api, is_surfaceless: bool) -> Result<EGLConfig, Refusal> {
        let drawn_by = match api {
            Api::Gles => egl::OPENGL_ES3_BIT,
            Api::Gl | Api::OsMesa => egl::OPENGL_BIT,
        };
        let surfaces = match is_surfaceless {
            true => 0,
            false => egl::PBUFFER_BIT,
        };
        let attributes = ended(&[
            egl::RENDERABLE_TYPE as EGLint,
            drawn_by as EGLint,
            egl::SURFACE_TYPE as EGLint,
            surfaces as EGLint,
        ]);
        let (mut config, mut found) = (ptr::null(), 0);
        // SAFETY: the display is open, the list has an end marker, and there is room for one configuration.
        let chosen = unsafe {
            let list = attributes.as_ptr();
            let egl = &self.functions.egl;
            egl.ChooseConfig(self.display, list, &raw mut config, 1, &raw mut found)
        };
        match (chosen, found) {
            (egl::FALSE, _) => Err(refusal(self.functions, "eglChooseConfig")),
            (_, 0) => Err(Refusal(format!("EGL has no configuration for {api}"))),
            _ => Ok(config),
        }
    }

    /// Creates a context, with reset notification if available. Without reset notification a lost context cannot be
    /// distinguished from a slow one.
    fn new_context(&self, api: Api, config: EGLConfig) -> Result<EGLContext, Refusal> {
        let (minor, profile) = match api {
            Api::Gles => (0, &[][..]),
            Api::Gl | Api::OsMesa => {
                let core = egl::CONTEXT_OPENGL_CORE_PROFILE_BIT as EGLint;
                (3, &[egl::CONTEXT_OPENGL_PROFILE_MASK as EGLint, core][..])
            }
        };
        let version = [
            egl::CONTEXT_MAJOR_VERSION as EGLint,
            3,
            egl::CONTEXT_MINOR_VERSION as EGLint,
            minor,
        ];
        let plain = [&version, profile].concat();
        let told = self.reset_attribute().map(|name| {
            let told = [name as EGLint, egl::LOSE_CONTEXT_ON_RESET as EGLint];
            [&plain, &told[..]].concat()
        });
        for attributes in told.iter().chain([&plain]) {
            let attributes = ended(attributes);
            let none = egl::NO_CONTEXT;
            // SAFETY: display and configuration are EGL's own, the list has an end marker, and no context is shared.
            let context = unsafe {
                let egl = &self.functions.egl;
                egl.CreateContext(self.display, config, none, attributes.as_ptr())
            };
            if !context.is_null() {
                return Ok(context);
            }
        }
        Err(refusal(self.functions, "eglCreateContext"))
    }

    /// The attribute that requests reset notification.
    fn reset_attribute(&self) -> Option<u32> {
        if has(&self.extensions, "EGL_EXT_create_context_robustness") {
            return Some(egl::CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT);
        }
        (self.version >= (1, 5)).then_some(egl::CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY)
    }
}

impl Backend for Plain {
    fn make_current(&self) -> Result<(), String> {
        let egl = &self.functions.egl;
        // SAFETY: display, surface and context exist.
        let made = unsafe {
            egl.BindAPI(self.api);
            egl.MakeCurrent(self.display, self.surface, self.surface, self.context)
        };
        match made {
            egl::FALSE => Err(refusal(self.functions, "eglMakeCurrent").0),
            _ => Ok(()),
        }
    }

    fn is_current(&self) -> bool {
        // SAFETY: only a query; the answer is compared and never dereferenced.
        unsafe { self.functions.egl.GetCurrentContext() == self.context }
    }

    fn release(&self) {
        let (display, none) = (self.display, egl::NO_SURFACE);
        // SAFETY: null surfaces and no context release the current context. If this fails, the context stays current
        // until the next call replaces it.
        unsafe {
            self.functions
                .egl
                .MakeCurrent(display, none, none, egl::NO_CONTEXT)
        };
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        // SAFETY: the name ends in zero.
        unsafe { self.functions.egl.GetProcAddress(name.as_ptr()).cast() }
    }
}

impl Drop for Plain {
    fn drop(&mut self) {
        let egl = &self.functions.egl;
        // SAFETY: both are EGL's own and not used again.
        unsafe {
            if !self.surface.is_null() {
                egl.DestroySurface(self.display, self.surface);
            }
            egl.DestroyContext(self.display, self.context);
        }
    }
}

/// The list with EGL's end marker.
fn ended(attributes: &[EGLint]) -> Vec<EGLint> {
    [attributes, &[egl::NONE as EGLint]].concat()
}

/// The extensions of a display, or of EGL itself, separated by spaces.
fn extensions(functions: &Functions, display: EGLDisplay) -> String {
    // SAFETY: the answer is null or a string that stays valid.
    unsafe {
        let names = functions
            .egl
            .QueryString(display, egl::EXTENSIONS as EGLint);
        match names.is_null() {
            true => String::new(),
            false => CStr::from_ptr(names).to_string_lossy().into_owned(),
        }
    }
}

fn has(extensions: &str, name: &str) -> bool {
    extensions
        .split_ascii_whitespace()
        .any(|known| known == name)
}

fn refusal(functions: &Functions, call: &str) -> Refusal {
    // SAFETY: only a query.
    let code = unsafe { functions.egl.GetError() };
    Refusal(format!("{call} failed with EGL error {code:#x}"))
}
