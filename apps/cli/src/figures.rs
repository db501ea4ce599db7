//! `echomarch figures`: the thesis' performance experiment.

use super::numbers::count;
use super::options::{Common, ProfilesOption, check_range};
use super::report;
use clap::Args;
use echomarch::tracer::Settings;
use echomarch_lab::experiment::WAVE_COUNTS;
use echomarch_lab::experiment::figures::{self, FiguresOptions};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch figures                          all four tables, up to 1048576 waves
  echomarch figures --max-waves 65536 --runs 3 -o out
  echomarch figures --profiles thesis        only the thesis' algorithm
  echomarch figures --json > figures.json";

/// Arguments of `figures`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Omit rows with more waves than this
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1_048_576,
        value_name = "N", value_parser = count::<u32>)]
    max_waves: u32,
    /// Number of timed frames per row; the reported times are medians
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 5,
        value_name = "N", value_parser = count::<u32>)]
    runs: u32,
    #[command(flatten)]
    compared: ProfilesOption,
    /// Seed of the random directions
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        value_name = "N", value_parser = count::<u32>)]
    seed: u32,
    /// Write figures.csv, .json, .md and .svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let least = f64::from(WAVE_COUNTS[0]);
    let most = f64::from(u32::MAX);
    check_range("--max-waves", f64::from(arguments.max_waves), least, most)?;
    check_range("--runs", f64::from(arguments.runs), 1.0, 1000.0)?;
    let profiles = arguments.compared.profiles.iter();
    let options = FiguresOptions {
        profiles: profiles
            .map(|&p| Settings::new(p).with_seed(arguments.seed))
            .collect(),
        max_waves: arguments.max_waves,
        runs: arguments.runs,
    };
    report::run(
        common,
        arguments.output.as_deref(),
        "rows",
        |tracer, progress| figures::run(tracer, &options, progress),
    )
}
