//! `echomarch info`: the available renderers.

use super::options::Common;
use super::print;
use clap::Args;
use echomarch::gl::{Api, GpuInfo, Renderer, list_gpus};
use echomarch::tracer::Settings;
use serde::Serialize;

const EXAMPLES: &str = "\
Examples:
  echomarch info                             every API and GPU, and their limits
  echomarch info --json > renderers.json";

/// Arguments of `info`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {}

#[derive(Serialize)]
struct Report {
    version: &'static str,
    apis: Vec<ApiReport>,
}

#[derive(Serialize)]
struct ApiReport {
    api: String,
    error: Option<String>,
    gpus: Vec<GpuReport>,
}

#[derive(Serialize)]
struct GpuReport {
    gpu: usize,
    error: Option<String>,
    #[serde(flatten)]
    renderer: Option<RendererReport>,
}

#[derive(Serialize)]
struct RendererReport {
    renderer: String,
    version: String,
    shading_language: String,
    software: bool,
    max_texture_size: u32,
    max_waves: u64,
    max_fragment_uniform_vectors: u32,
}

/// Runs the subcommand.
pub fn run(_: &Arguments, common: &Common) -> anyhow::Result<()> {
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        apis: Api::ALL.map(api_report).into(),
    };
    if common.json {
        return print::json(&report);
    }
    print_text(&report)
}

fn api_report(api: Api) -> ApiReport {
    let (gpus, error) = match list_gpus(api) {
        Ok(list) => (list.iter().map(gpu_report).collect(), None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    ApiReport {
        api: api.to_string(),
        error,
        gpus,
    }
}

fn gpu_report(gpu: &GpuInfo) -> GpuReport {
    let (renderer, error) = match &gpu.outcome {
        Ok(renderer) => (Some(renderer_report(renderer)), None),
        Err(error) => (None, Some(error.to_string())),
    };
    GpuReport {
        gpu: gpu.index,
        error,
        renderer,
    }
}

fn renderer_report(renderer: &Renderer) -> RendererReport {
    let side = u64::from(renderer.limits.max_texture_size);
    RendererReport {
        renderer: renderer.name.clone(),
        version: renderer.version.clone(),
        shading_language: renderer.shading_language.clone(),
        software: renderer.is_software,
        max_texture_size: renderer.limits.max_texture_size,
        max_waves: (side * side).min(u64::from(Settings::MAX_WAVES)),
        max_fragment_uniform_vectors: renderer.limits.max_fragment_uniform_vectors,
    }
}

fn print_text(report: &Report) -> anyhow::Result<()> {
    print::line(&format!("echomarch {}", report.version))?;
    for api in &report.apis {
        print::line(&format!("\n--gl {}", api.api))?;
        if let Some(error) = &api.error {
            print::line(&format!("  not usable: {error}"))?;
        }
        for gpu in &api.gpus {
            print_gpu(gpu)?;
        }
    }
    Ok(())
}

fn print_gpu(gpu: &GpuReport) -> anyhow::Result<()> {
    if let Some(error) = &gpu.error {
        print::line(&format!("  --gpu {}: not usable: {error}", gpu.gpu))?;
    }
    let Some(renderer) = &gpu.renderer else {
        return Ok(());
    };
    let kind = if renderer.software {
        "software"
    } else {
        "hardware"
    };
    print::line(&format!(
        "  --gpu {}: {} ({kind})",
        gpu.gpu, renderer.renderer
    ))?;
    print::line(&format!(
        "    version {}, GLSL {}",
        renderer.version,
        // OpenGL ES puts its name before the version number.
        renderer
            .shading_language
            .trim_start_matches("OpenGL ES GLSL ")
    ))?;
    print::line(&format!(
        "    textures up to {} a side, {} waves, {} uniform vectors",
        renderer.max_texture_size, renderer.max_waves, renderer.max_fragment_uniform_vectors
    ))
}
