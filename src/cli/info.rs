//! `echomarch info`: what there is to render with.

use super::options::Common;
use super::print;
use crate::gpu::{Api, Context, ContextOptions, GpuError, list_gpus};
use crate::trace::MAX_WAVES;
use clap::Args;
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
        Ok(list) => (
            list.iter().map(|g| gpu_report(api, g.index)).collect(),
            None,
        ),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    ApiReport {
        api: api.to_string(),
        error,
        gpus,
    }
}

fn gpu_report(api: Api, gpu: usize) -> GpuReport {
    match renderer_report(api, gpu) {
        Ok(renderer) => GpuReport {
            gpu,
            error: None,
            renderer: Some(renderer),
        },
        Err(error) => GpuReport {
            gpu,
            error: Some(error.to_string()),
            renderer: None,
        },
    }
}

fn renderer_report(api: Api, gpu: usize) -> Result<RendererReport, GpuError> {
    let context = Context::headless(&ContextOptions {
        api,
        gpu: Some(gpu),
    })?;
    let limits = context.limits();
    let side = u64::from(limits.max_texture_size);
    Ok(RendererReport {
        renderer: context.renderer().to_owned(),
        version: context.version().to_owned(),
        shading_language: context.shading_language().to_owned(),
        software: context.is_software(),
        max_texture_size: limits.max_texture_size,
        max_waves: (side * side).min(u64::from(MAX_WAVES)),
        max_fragment_uniform_vectors: limits.max_fragment_uniform_vectors,
    })
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
        renderer.version, renderer.shading_language
    ))?;
    print::line(&format!(
        "    textures up to {} a side, {} waves, {} uniform vectors",
        renderer.max_texture_size, renderer.max_waves, renderer.max_fragment_uniform_vectors
    ))
}
