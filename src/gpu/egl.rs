//! Contexts without a surface through EGL, on a device chosen by number.

use std::ffi::{CStr, c_void};

use glutin::api::egl::config::Config;
use glutin::api::egl::context::NotCurrentContext;
use glutin::api::egl::context::PossiblyCurrentContext;
use glutin::api::egl::device::Device;
use glutin::api::egl::display::Display;
use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Robustness, Version};
use glutin::error::ErrorKind;
use glutin::prelude::*;

use super::backend::Backend;
use super::{Api, GpuError, current};

/// A context of EGL that draws into no surface.
pub(super) struct Egl {
    // Before the display: the context goes first.
    context: PossiblyCurrentContext,
    display: Display,
}

impl Egl {
    /// Makes a context on a device; it is not current yet.
    ///
    /// # Errors
    /// [`GpuError::NoContext`] with what EGL answered.
    pub(super) fn on_device(device: &Device, api: Api) -> Result<Egl, GpuError> {
        create(device, api).map_err(|error| GpuError::NoContext {
            api,
            reason: error.to_string(),
        })
    }
}

/// The devices that EGL lists, in its order; at least one.
///
/// # Errors
/// [`GpuError::NoEglLibrary`], [`GpuError::NoEglDevice`].
pub(super) fn devices() -> Result<Vec<Device>, GpuError> {
    let devices: Vec<Device> = match Device::query_devices() {
        Ok(devices) => devices.collect(),
        Err(error) if matches!(error.error_kind(), ErrorKind::NotFound) => {
            return Err(GpuError::NoEglLibrary);
        }
        Err(error) => {
            return Err(GpuError::NoEglDevice {
                reason: error.to_string(),
            });
        }
    };
    if devices.is_empty() {
        return Err(GpuError::NoEglDevice {
            reason: "the list is empty".into(),
        });
    }
    Ok(devices)
}

fn create(device: &Device, api: Api) -> Result<Egl, glutin::error::Error> {
    let (config_api, context_api) = match api {
        Api::Gles => (ConfigApi::GLES3, ContextApi::Gles(Some(Version::new(3, 0)))),
        Api::Gl | Api::OsMesa => (
            ConfigApi::OPENGL,
            ContextApi::OpenGl(Some(Version::new(3, 3))),
        ),
    };
    let template = ConfigTemplateBuilder::new()
        .with_surface_type(ConfigSurfaceTypes::empty())
        .with_api(config_api)
        .with_alpha_size(0)
        .with_depth_size(0)
        .with_stencil_size(0)
        .build();
    let attributes = ContextAttributesBuilder::new()
        .with_profile(GlProfile::Core)
        .with_context_api(context_api);
    // SAFETY: no native display handle is given that would have to be valid.
    let display = unsafe { Display::with_device(device, None) }?;
    // SAFETY: the template names no native window or pixmap.
    let mut configs = unsafe { display.find_configs(template) }?;
    let config = configs.next().ok_or(ErrorKind::BadConfig)?;
    drop(configs);
    let context = new_context(&display, &config, attributes)?.treat_as_possibly_current();
    current::knows_egl(&display);
    Ok(Egl { context, display })
}

/// A context that is told when the graphics card was reset, where the driver offers that: otherwise a lost context
/// looks like one that is slow.
///
/// # Errors
/// What EGL answered to a context without.
pub(super) fn new_context(
    display: &Display,
    config: &Config,
    attributes: ContextAttributesBuilder,
) -> Result<NotCurrentContext, glutin::error::Error> {
    let told = attributes
        .clone()
        .with_robustness(Robustness::RobustLoseContextOnReset);
    // SAFETY: the attributes name no window and share no other context.
    unsafe { display.create_context(config, &told.build(None)) }.or_else(|_| {
        // SAFETY: as above.
        unsafe { display.create_context(config, &attributes.build(None)) }
    })
}

impl Backend for Egl {
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
