//! Contexts by the library glutin, whichever way to OpenGL it takes.

use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Robustness, Version};
use glutin::prelude::*;

use super::Api;

/// What is asked of a configuration for such surfaces: passes draw into textures, so that the surface needs neither
/// alpha, depth nor stencil.
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

/// The least version that this crate works with: OpenGL 3.3 core, or OpenGL ES 3.0.
pub(super) fn attributes(api: Api) -> ContextAttributesBuilder {
    ContextAttributesBuilder::new()
        .with_profile(GlProfile::Core)
        .with_context_api(match api {
            Api::Gles => ContextApi::Gles(Some(Version::new(3, 0))),
            Api::Gl | Api::OsMesa => ContextApi::OpenGl(Some(Version::new(3, 3))),
        })
}

/// A context that is told when the graphics card was reset, where the driver offers that: otherwise a lost context
/// looks like one that is slow.
///
/// # Errors
/// What the library answered to a context without.
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
