//! The ways to reach OpenGL, the devices that contexts can be made on, and which of them draw with the processor.

use std::fmt;
use std::str::FromStr;

#[cfg(not(target_arch = "wasm32"))]
use super::{Context, ContextOptions, GpuError, Limits, native};

/// A way to reach OpenGL: which library makes the context, and which language the shaders are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Api {
    /// OpenGL 3.3 core through EGL.
    #[default]
    Gl,
    /// OpenGL ES 3.0 with `EXT_color_buffer_float` through EGL.
    Gles,
    /// OpenGL 3.3 core through Mesa's off-screen library, on the processor; needs no EGL, device or display.
    OsMesa,
}

impl Api {
    /// All APIs, in order of preference.
    pub const ALL: [Api; 3] = [Api::Gl, Api::Gles, Api::OsMesa];
}

impl fmt::Display for Api {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Api::Gl => "gl",
            Api::Gles => "gles",
            Api::OsMesa => "osmesa",
        })
    }
}

impl FromStr for Api {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Api::ALL
            .into_iter()
            .find(|api| api.to_string() == name)
            .ok_or_else(|| format!("there is no GL API \"{name}\": use gl, gles or osmesa"))
    }
}

#[cfg(not(target_arch = "wasm32"))]
/// One device, and the result of making a context on it.
#[derive(Debug)]
#[non_exhaustive]
pub struct GpuInfo {
    /// The index for [`ContextOptions::gpu`], from 0.
    pub index: usize,
    /// The driver's description, or the reason why making a context failed.
    pub outcome: Result<Renderer, GpuError>,
}

#[cfg(not(target_arch = "wasm32"))]
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
    /// Whether the processor draws.
    pub is_software: bool,
    /// The driver's limits.
    pub limits: Limits,
}

#[cfg(not(target_arch = "wasm32"))]
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

#[cfg(not(target_arch = "wasm32"))]
/// Lists the devices of an API, each tested by making a context on it and dropping it again. No context is current
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

#[cfg(not(target_arch = "wasm32"))]
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

/// Parts of the names of renderers that draw with the processor, in lower case.
const SOFTWARE_RENDERERS: [&str; 12] = [
    // Mesa's; also as "zink (llvmpipe ...)" and "virgl (LLVMPIPE ...)".
    "llvmpipe",
    "lavapipe",
    "softpipe",
    "swrast",
    "software rasterizer",
    "openswr",
    "swr (",
    // ANGLE and Vulkan in browsers.
    "swiftshader",
    "apple software renderer",
    // WARP, through ANGLE or as Mesa's "D3D12 (Microsoft Basic Render Driver)".
    "microsoft basic render driver",
    "warp",
    // Windows without a driver: OpenGL 1.1.
    "gdi generic",
];

/// Whether a renderer of that name draws with the processor.
pub(super) fn is_software(renderer: &str) -> bool {
    let renderer = renderer.to_lowercase();
    SOFTWARE_RENDERERS
        .iter()
        .any(|name| renderer.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the API names: the command line accepts the names that are printed.
    #[test]
    fn names_read_back() {
        for api in Api::ALL {
            assert_eq!(api.to_string().parse(), Ok(api));
        }
        assert!("vulkan".parse::<Api>().unwrap_err().contains("osmesa"));
    }

    /// Protects recognising a software renderer by its name, which decides on wall clock or timer query, goldens or
    /// tolerances.
    #[test]
    fn software_renderers_are_known_by_name() {
        for software in [
            "llvmpipe (LLVM 15.0.6, 256 bits)",
            "zink (llvmpipe (LLVM 15.0.6, 256 bits))",
            "zink Vulkan 1.3(llvmpipe (LLVM 19.1.7, 256 bits) (MESA_LLVMPIPE))",
            "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))",
            "softpipe",
            "SWR (LLVM 10.0, AVX2)",
            "Software Rasterizer",
            "Google SwiftShader",
            "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)",
            "ANGLE (Microsoft, Microsoft Basic Render Driver Direct3D11 vs_5_0 ps_5_0)",
            "D3D12 (Microsoft Basic Render Driver)",
            "Apple Software Renderer",
            "GDI Generic",
        ] {
            assert!(is_software(software), "{software}");
        }
        for hardware in [
            "NVIDIA H200/PCIe/SSE2",
            "Mesa Intel(R) UHD Graphics 620 (KBL GT2)",
            "AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6, DRM 3.49)",
            "zink Vulkan 1.3(NVIDIA GeForce RTX 4090 (NVIDIA_PROPRIETARY))",
            "virgl (AMD Radeon RX 6800 (radeonsi, navi21))",
            "Apple M2 Pro",
            "ANGLE (Intel, Intel(R) UHD Graphics 620 Direct3D11 vs_5_0 ps_5_0, D3D11)",
        ] {
            assert!(!is_software(hardware), "{hardware}");
        }
    }
}
