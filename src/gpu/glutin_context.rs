//! Contexts made by the library glutin, on any of its platforms.

use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Robustness, Version};
use glutin::prelude::*;
use std::ffi::{CStr, c_void};

use super::Api;
use super::backend::Backend;

/// Requirements of a configuration for such surfaces: passes draw into textures, so the surface needs neither alpha,
/// depth nor stencil.
pub(super) fn template(api: Api, surfaces: ConfigSurfaceTypes) -> ConfigTemplateBuilder {
    ConfigTemplateBuilder::new()
        .with_surface_type(surfaces)
        .with_api(match api {
            Api::Gles => ConfigApi::GLES3,
            Api::Gl | Api::OsMesa => ConfigApi::OPENGL,
        })
        .with_alpha_size(0)
        .with_depth_size(0)
        .with_stencil_size(0)
}

/// The lowest supported version: OpenGL 3.3 core, or OpenGL ES 3.0.
pub(super) fn attributes(api: Api) -> ContextAttributesBuilder {
    ContextAttributesBuilder::new()
        .with_profile(GlProfile::Core)
        .with_context_api(match api {
            Api::Gles => ContextApi::Gles(Some(Version::new(3, 0))),
            Api::Gl | Api::OsMesa => ContextApi::OpenGl(Some(Version::new(3, 3))),
        })
}

/// Creates a context with reset notification if the driver offers it: otherwise a lost context looks like a slow one.
///
/// # Errors
/// The library's answer to the request for a context without it.
pub(super) fn new_context<D: GlDisplay>(
    display: &D,
    config: &D::Config,
    attributes: ContextAttributesBuilder,
) -> Result<D::NotCurrentContext, glutin::error::Error> {
    let told = attributes
        .clone()
        .with_robustness(Robustness::RobustLoseContextOnReset);
    // SAFETY: the attributes name no window and share no other context.
    unsafe { display.create_context(config, &told.build(None)) }.or_else(|_| {
        // SAFETY: as above.
        unsafe { display.create_context(config, &attributes.build(None)) }
    })
}

/// A context made by glutin, and the way to make it current: without a surface, or with its own.
pub(super) struct GlutinContext<C, D, M> {
    // Field order matters: the context is dropped first, then its surface, then the display.
    pub context: C,
    pub make_current: M,
    pub display: D,
}

impl<C, D, M> Backend for GlutinContext<C, D, M>
where
    C: PossiblyCurrentGlContext,
    D: GlDisplay,
    M: Fn(&C) -> Result<(), glutin::error::Error>,
{
    fn make_current(&self) -> Result<(), String> {
        (self.make_current)(&self.context).map_err(|error| error.to_string())
    }

    fn is_current(&self) -> bool {
        self.context.is_current()
    }

    fn release(&self) {
        // After a failure a context stays current, which the next make_current replaces.
        let _ = self.context.make_not_current_in_place();
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        self.display.get_proc_address(name)
    }
}
