//! The devices that contexts can be made on.

use std::fmt;

use super::native;
use super::{Api, Context, ContextOptions, GpuError, Limits};

/// One device, and the result of making a context on it.
#[derive(Debug)]
#[non_exhaustive]
pub struct GpuInfo {
    /// The number to ask for in [`ContextOptions::gpu`], from 0.
    pub index: usize,
    /// How the driver names itself, or why there is no context.
    pub outcome: Result<Renderer, GpuError>,
}

/// How a driver names itself.
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
    /// Whether the processor draws.
    pub is_software: bool,
    /// What the driver allows.
    pub(crate) limits: Limits,
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

/// The devices of an API, each tried by making a context on it and dropping it again. No context is current
/// afterwards.
///
/// # Errors
/// Only where there is no list: no library or no device. A device that gives no context is in the list with its
/// reason.
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
