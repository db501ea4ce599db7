//! `echomarch cost`: the cost of each surface and option, and the surfaces that could be removed.

use super::numbers::count;
use super::options::{Common, TraceOptions, check_ending, check_range};
use super::print;
use super::report::{print_report, with_progress};
use super::scene::SceneArguments;
use clap::Args;
use echomarch::internals::file_output::{check_file, write_whole};
use echomarch_lab::experiment::cost::{self, CostOptions};
use echomarch_lab::of_first_pair;
use echomarch_lab::report::Report;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch cost corner                      every surface and option of a built-in scene
  echomarch cost my.ron --waves 262144 --runs 25 -o cost.csv
  echomarch cost obstacles --profile march --json";

/// Arguments of `cost`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    options: TraceOptions,
    /// Number of pairs of frames per row, each with its own seed; reported times are medians
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 9,
        value_name = "N", value_parser = count::<u32>)]
    runs: u32,
    /// Write the rows as CSV
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_range("--runs", f64::from(arguments.runs), 1.0, 1000.0)?;
    let settings = arguments.options.settings()?;
    if let Some(path) = &arguments.output {
        check_ending(path, "csv")?;
    }
    let scene = of_first_pair(common.scene_with_values(&arguments.scene)?);
    if let Some(path) = &arguments.output {
        check_file(path)?;
    }
    let options = CostOptions {
        runs: arguments.runs,
    };
    let mut tracer = common.tracer()?;
    let report = with_progress(common, "rows", |progress| {
        cost::measure(&mut tracer, &scene, &settings, &options, progress)
    })?;
    if let Some(path) = &arguments.output {
        write_whole(path, |out| report.table().write_csv(out))?;
    }
    print_report(common, &report)?;
    match &arguments.output {
        Some(path) if !common.json => print::line(&format!("\nwritten: {}", path.display())),
        _ => Ok(()),
    }
}
