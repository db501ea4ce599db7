//! The trait of the libraries that make GL contexts, and its implementation for glutin.

use std::ffi::{CStr, c_void};

#[cfg(not(target_arch = "wasm32"))]
use glutin::config::{Api as ConfigApi, ConfigSurfaceTypes, ConfigTemplateBuilder};
#[cfg(not(target_arch = "wasm32"))]
use glutin::context::{ContextApi, ContextAttributesBuilder, GlProfile, Robustness, Version};
#[cfg(not(target_arch = "wasm32"))]
use glutin::prelude::*;

#[cfg(not(target_arch = "wasm32"))]
use super::Api;
#[cfg(any(windows, target_os = "macos"))]
use super::GpuError;

/// One GL context, with the functions of the library that made it: EGL, OSMesa, WGL, CGL or a browser.
///
/// Dropping it destroys the context. The module `current` ensures that the context is not current at that time.
pub(super) trait Backend {
    /// Makes the context current on this thread. No other context may be current: Mesa's libraries share one slot for
    /// the current context, and each library assumes that this slot still holds the value that the library stored last.
    ///
    /// # Errors
    /// The library's answer.
    fn make_current(&self) -> Result<(), String>;

    /// Whether the library reports this context as current on this thread; code outside echomarch may have made another
    /// context current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn is_current(&self) -> bool;

    /// Leaves this thread without a current context. Requires that this context is current.
    fn release(&self);

    /// Whether the library itself reports that the context is lost. Only a browser reports a loss in this way, because
    /// its GL calls then do nothing and report no error.
    fn is_lost(&self) -> bool {
        false
    }

    /// The GL parameter whose value is the driver's name for the device.
    fn renderer_parameter(&self, _gl: &glow::Context) -> u32 {
        glow::RENDERER
    }

    /// Address of a GL function, or null if the library lacks it.
    fn proc_address(&self, name: &CStr) -> *const c_void;

    /// The owner of the context: its maker, and whether the maker keeps it current.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code))]
    fn owner(&self) -> Owner {
        Owner::Echomarch
    }
}

/// Owner of a context.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// Made by echomarch; may stay current.
    Echomarch,
    /// Made by the caller, whose functions make it current and release it.
    Caller,
    /// Made by the caller, who keeps it current: echomarch does not change that.
    KeptCurrentByCaller,
}

#[cfg(not(target_arch = "wasm32"))]
/// The configuration for passes. They draw into textures, so the surface needs no alpha, depth or stencil.
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

#[cfg(not(target_arch = "wasm32"))]
/// Requests the lowest supported version: OpenGL 3.3 core, or OpenGL ES 3.0.
pub(super) fn attributes(api: Api) -> ContextAttributesBuilder {
    ContextAttributesBuilder::new()
        .with_profile(GlProfile::Core)
        .with_context_api(match api {
            Api::Gles => ContextApi::Gles(Some(Version::new(3, 0))),
            Api::Gl | Api::OsMesa => ContextApi::OpenGl(Some(Version::new(3, 3))),
        })
}

#[cfg(not(target_arch = "wasm32"))]
/// Creates a context, with reset notification if the driver offers it. Without reset notification a lost context cannot
/// be distinguished from a slow one.
///
/// # Errors
/// The library's error for a context without reset notification.
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

#[cfg(not(target_arch = "wasm32"))]
/// A context made by glutin, and the function that makes it current, with or without a surface.
pub(super) struct GlutinContext<C, D, M> {
    // Field order matters: the context is dropped first, then its surface, then the display.
    pub context: C,
    pub make_current: M,
    pub display: D,
}

#[cfg(not(target_arch = "wasm32"))]
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
        // If this fails, the context stays current until the next make_current replaces it.
        let _ = self.context.make_not_current_in_place();
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        self.display.get_proc_address(name)
    }
}

/// The only device on systems that choose the graphics card themselves.
#[cfg(any(windows, target_os = "macos"))]
#[derive(Debug)]
pub(super) struct Place;

#[cfg(any(windows, target_os = "macos"))]
/// Returns the only device.
///
/// # Errors
/// None.
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    Ok(vec![Place])
}

/// Does nothing: the library is part of the system.
///
/// # Errors
/// None.
#[cfg(all(feature = "window", any(windows, target_os = "macos")))]
pub(super) fn prepare() -> Result<(), GpuError> {
    Ok(())
}
