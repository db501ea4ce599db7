//! `echomarch accuracy`: compares speed with error, and checks the project's own targets.

use super::numbers::{count, real};
use super::options::{Common, check_range};
use super::report;
use clap::Args;
use echomarch::scene::Scene;
use echomarch_lab::experiment::accuracy::{self, AccuracyOptions, DEFAULT_SCENES, GYROID, ROOMS};
use echomarch_lab::of_first_pair;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch accuracy                         five scenes, and the targets: about 4 minutes
  echomarch accuracy -o out                  the same; CSV, JSON, Markdown and the plot in out/
  echomarch accuracy corner --error 0.01     one scene: about a minute
  echomarch accuracy gyroid                  a field in GLSL, built into this command
  echomarch accuracy my.ron --error 0.005    your own scene, without the targets
  echomarch accuracy --full -o out           every setting in every built-in scene: hours";

/// Arguments of `accuracy`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Scenes or scene files [default: corner obstacles cave gyroid glasshouse; with --full all]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Run every combination of settings instead of one change at a time; takes hours
    #[arg(long)]
    full: bool,
    /// Maximum panning error of the recommended setting
    #[arg(long, default_value_t = 0.02, value_name = "RMS", value_parser = real::<f64>)]
    error: f64,
    /// Number of frames per setting, each with its own seed, 16 to 1000
    #[arg(long, default_value_t = 16, value_name = "N", value_parser = count::<u32>)]
    seeds: u32,
    /// Write accuracy.csv, .json, .md and .svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_range("--error", arguments.error, 1e-9, 2.0)?;
    check_range("--seeds", f64::from(arguments.seeds), 16.0, 1000.0)?;
    let options = options(arguments, common)?;
    report::run(
        common,
        arguments.output.as_deref(),
        "steps",
        |tracer, progress| accuracy::run(tracer, &options, progress),
    )
}

/// The built-in scenes that the exact reference can trace exactly, and the gyroid. Scenes with users' GLSL are
/// excluded, because the reference knows their fields only from samples.
fn with_a_truth() -> Vec<&'static str> {
    let known =
        |name: &&str| Scene::builtin(name).is_ok_and(|scene| scene.user_fields().next().is_none());
    let built_in = Scene::BUILTIN_NAMES.into_iter().filter(known);
    built_in.chain([GYROID]).collect()
}

fn options(arguments: &Arguments, common: &Common) -> anyhow::Result<AccuracyOptions> {
    let names: Vec<&str> = match (arguments.scenes.is_empty(), arguments.full) {
        (false, _) => arguments.scenes.iter().map(String::as_str).collect(),
        (true, true) => with_a_truth(),
        (true, false) => DEFAULT_SCENES.to_vec(),
    };
    let scene = |name: &&str| match *name {
        GYROID => Ok(accuracy::gyroid()),
        name => common.scene(name).map(of_first_pair),
    };
    let scenes: Result<Vec<_>, _> = names.iter().map(scene).collect();
    let options = match arguments.full {
        true => AccuracyOptions::full(scenes?),
        false => AccuracyOptions::quick(scenes?),
    };
    Ok(AccuracyOptions {
        seeds: arguments.seeds,
        stated_error: arguments.error,
        targets: ROOMS.iter().all(|room| names.contains(room)),
        responses: ROOMS.iter().all(|room| names.contains(room)),
        ..options
    })
}
