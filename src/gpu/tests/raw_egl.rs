//! EGL without the crate: contexts that a test program makes for itself.

use crate::gpu::SwitchContext;
use glow::HasContext;
use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Version};
use glutin::display::{AsRawDisplay, DisplayFeatures, RawDisplay};
use glutin::prelude::*;
use std::ffi::{CStr, CString, c_void};
use std::rc::Rc;

/// EGL by raw calls, as used by a program that does not know echomarch's contexts.
pub struct RawEgl {
    egl: &'static glutin::api::egl::Egl,
    display: Display,
    context: PossiblyCurrentContext,
}

/// The kind of context that a program has made for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Core,
    Compatibility,
    Es,
}

impl Kind {
    pub const ALL: [Kind; 3] = [Kind::Core, Kind::Compatibility, Kind::Es];

    fn apis(self) -> (ConfigApi, ContextApi, GlProfile) {
        let gl = ContextApi::OpenGl(Some(Version::new(3, 3)));
        match self {
            Kind::Core => (ConfigApi::OPENGL, gl, GlProfile::Core),
            Kind::Compatibility => (ConfigApi::OPENGL, gl, GlProfile::Compatibility),
            Kind::Es => {
                let es = ContextApi::Gles(Some(Version::new(3, 0)));
                (ConfigApi::GLES3, es, GlProfile::Core)
            }
        }
    }
}

impl RawEgl {
    /// Creates a context of the program's own on the first device that allows one; not current.
    pub fn new() -> RawEgl {
        RawEgl::of(Kind::Core)
    }

    /// The same for a given kind.
    pub fn of(kind: Kind) -> RawEgl {
        let (config_api, context_api, profile) = kind.apis();
        let made = Device::query_devices().unwrap().find_map(|device| {
            // SAFETY: the call uses neither a native display nor a window, and shares no context.
            unsafe {
                let display = Display::with_device(&device, None).ok()?;
                let template = ConfigTemplateBuilder::new()
                    .with_surface_type(ConfigSurfaceTypes::empty())
                    .with_api(config_api)
                    .build();
                let config = display.find_configs(template).ok()?.next()?;
                let attributes = ContextAttributesBuilder::new()
                    .with_profile(profile)
                    .with_context_api(context_api)
                    .build(None);
                let context = display.create_context(&config, &attributes).ok()?;
                let egl = display.egl();
                let context = context.treat_as_possibly_current();
                Some(RawEgl {
                    egl,
                    display,
                    context,
                })
            }
        });
        made.unwrap()
    }

    /// Makes it current.
    pub fn bind(&self) {
        self.context.make_current_surfaceless().unwrap();
    }

    /// Makes no context current.
    pub fn unbind(&self) {
        let RawDisplay::Egl(display) = self.display.raw_display();
        let none = std::ptr::null();
        // SAFETY: the display lives, and null means none.
        unsafe { self.egl.MakeCurrent(display, none, none, none) };
    }

    /// Whether EGL reports it as current.
    pub fn is_current(&self) -> bool {
        self.context.is_current()
    }

    /// Whether its display offers contexts with reset notification.
    pub fn offers_robustness(&self) -> bool {
        let features = self.display.supported_features();
        features.contains(DisplayFeatures::CONTEXT_ROBUSTNESS)
    }

    /// Sets the viewport of the context that is current: x, y, width and height.
    pub fn set_viewport(&self, [x, y, width, height]: [i32; 4]) {
        // SAFETY: the functions are those of the library of the context that is current.
        unsafe { self.gl().viewport(x, y, width, height) };
    }

    /// The viewport of the context that is current.
    pub fn viewport(&self) -> [i32; 4] {
        let mut found = [0; 4];
        // SAFETY: as above, and the slice has room for four numbers.
        unsafe {
            self.gl()
                .get_parameter_i32_slice(glow::VIEWPORT, &mut found)
        };
        found
    }

    /// The address of a function of the library.
    pub fn address(&self, name: &CStr) -> *const c_void {
        self.display.get_proc_address(name)
    }

    /// The GL functions, for use while the context is current.
    pub fn gl(&self) -> glow::Context {
        let address = |name: &str| self.address(&CString::new(name).unwrap());
        // SAFETY: a context is current, and the addresses are those of its library.
        unsafe { glow::Context::from_loader_function(address) }
    }
}

/// The program's functions, as it passes them to echomarch.
pub struct Switch(pub Rc<RawEgl>);

impl SwitchContext for Switch {
    fn make_current(&self) -> Result<(), String> {
        let made = self.0.context.make_current_surfaceless();
        made.map_err(|error| error.to_string())
    }

    fn is_current(&self) -> bool {
        self.0.is_current()
    }

    fn release(&self) {
        self.0.unbind();
    }
}
