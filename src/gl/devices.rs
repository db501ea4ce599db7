//! The devices on which contexts can be made.

use std::fmt;

use super::{Api, Context, ContextOptions, GpuError, Limits, native};

/// One device, and the result of making a context on it.
#[derive(Debug)]
#[non_exhaustive]
pub struct GpuInfo {
    /// The index for [`ContextOptions::gpu`], from 0.
    pub index: usize,
    /// The driver's description, or the reason why making a context failed.
    pub outcome: Result<Renderer, GpuError>,
}

/// A driver's description of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Renderer {
    /// GL_RENDERER.
    pub name: String,
    /// GL_VENDOR.
    pub vendor: String,
    /// GL_VERSION.
    pub version: String,
    /// GL_SHADING_LANGUAGE_VERSION.
    pub shading_language: String,
    /// Whether the renderer runs on the processor.
    pub is_software: bool,
    /// The driver's limits.
    pub limits: Limits,
}

impl fmt::Display for GpuInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.outcome {
            Ok(renderer) => {
                let software = if renderer.is_software {
                    ", software"
                } else {
                    ""
                };
                write!(
                    f,
                    "{}: {} ({}){software}",
                    self.index, renderer.name, renderer.version
                )
            }
            Err(error) => write!(f, "{}: {error}", self.index),
        }
    }
}

/// Lists the devices of an API, and tests each by making and dropping a context on it. No context is current
/// afterwards.
///
/// # Errors
/// Only if the library or all devices are missing. A device without a context is listed with the reason.
pub fn list_gpus(api: Api) -> Result<Vec<GpuInfo>, GpuError> {
    if api == Api::OsMesa {
        let outcome = Context::headless(&ContextOptions { api, gpu: None });
        return match outcome {
            Err(error @ GpuError::NoOsMesaLibrary { .. }) => Err(error),
            outcome => Ok(vec![GpuInfo {
                index: 0,
                outcome: outcome.map(|context| describe(&context)),
            }]),
        };
    }
    let tried = native::places()?
        .into_iter()
        .enumerate()
        .map(|(index, place)| {
            let context =
                native::open(&place, api).and_then(|backend| Context::from_backend(backend, api));
            GpuInfo {
                index,
                outcome: context.map(|context| describe(&context)),
            }
        });
    Ok(tried.collect())
}

fn describe(context: &Context) -> Renderer {
    Renderer {
        name: context.renderer().into(),
        vendor: context.vendor().into(),
        version: context.version().into(),
        shading_language: context.shading_language().into(),
        is_software: context.is_software(),
        limits: context.limits(),
    }
}
