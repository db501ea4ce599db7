//! `echomarch figures`: the thesis' performance experiment.

use super::numbers::count;
use super::options::{Common, check_range};
use super::print;
use super::report::Experiment;
use crate::experiment::WAVE_COUNTS;
use crate::experiment::figures::{
    self, FigureRow, FigureTable, FiguresOptions, FiguresReport, plot_svg, write_csv,
};
use crate::trace::{Profile, Settings};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch figures                          all four tables, up to 1048576 waves
  echomarch figures --max-waves 65536 --runs 3 -o out
  echomarch figures --profiles thesis        the thesis' algorithm alone
  echomarch figures --json > figures.json";

/// Arguments of `figures`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Leave out rows of more waves
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1_048_576,
        value_name = "N", value_parser = count::<u32>)]
    max_waves: u32,
    /// Timed frames of each row; times are their medians
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 5,
        value_name = "N", value_parser = count::<u32>)]
    runs: u32,
    /// Profiles to set side by side, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "thesis,march,hybrid"
    )]
    profiles: Vec<Profile>,
    /// Chooses the random directions
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        value_name = "N", value_parser = count::<u32>)]
    seed: u32,
    /// Write figures.csv, figures.json and figures.svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let least = f64::from(WAVE_COUNTS[0]);
    let most = f64::from(u32::MAX);
    check_range("--max-waves", f64::from(arguments.max_waves), least, most)?;
    check_range("--runs", f64::from(arguments.runs), 1.0, 1000.0)?;
    let profiles = arguments.profiles.iter();
    let options = FiguresOptions {
        profiles: profiles
            .map(|&p| Settings::new(p).with_seed(arguments.seed))
            .collect(),
        max_waves: arguments.max_waves,
        runs: arguments.runs,
    };
    let experiment = Experiment {
        name: "figures",
        unit: "rows",
        print: print_tables,
        write_csv,
        plot_svg,
    };
    experiment.run(common, arguments.output.as_deref(), |tracer, progress| {
        figures::run(tracer, &options, progress)
    })
}

fn print_tables(report: &FiguresReport) -> anyhow::Result<()> {
    print::prose(&format!(
        "{} (times: {}, median of {}; seed {})",
        report.renderer, report.clock, report.runs, report.seed
    ))?;
    for table in &report.tables {
        print::prose(&format!(
            "\nFigure {}: {} scene, {} iterations",
            table.figure, table.scene, table.iterations
        ))?;
        print::prose(&as_table(table).to_string())?;
    }
    print::prose(
        "\nms: median time of a frame; init, march, pan, read: of its parts, read is the copy to the\n\
         processor. hits: waves that reached the listener. se: their difference from the thesis in\n\
         standard errors, √(ours + thesis). zero: share of all iterations that end at distance 0.\n\
         step limit: marches that reached it.",
    )
}

fn as_table(table: &FigureTable) -> print::Wide {
    let mut printed = print::table(
        2,
        &[
            "waves",
            "profile",
            "ms",
            "init",
            "march",
            "pan",
            "read",
            "thesis ms (mobile, desktop)",
            "hits",
            "thesis hits",
            "se",
            "dead",
            "travelling",
            "zero",
            "step limit",
        ],
    );
    for row in &table.rows {
        printed.add_row(cells(row));
    }
    printed
}

fn cells(row: &FigureRow) -> [String; 15] {
    let time = &row.milliseconds;
    [
        row.waves.to_string(),
        row.profile.clone(),
        format!("{:.2}", time.total),
        format!("{:.2}", time.initialise),
        format!("{:.2}", time.march),
        format!("{:.2}", time.pan),
        format!("{:.2}", time.read_back),
        format!("{}, {}", row.thesis.mobile_ms, row.thesis.desktop_ms),
        row.counts.listener_hits.to_string(),
        row.thesis.listener_hits.to_string(),
        format!("{:+.1}", row.standard_errors()),
        row.counts.dead.to_string(),
        row.counts.travelling.to_string(),
        format!("{:.1} %", 100.0 * row.zero_length_share),
        row.counts.step_limit_reached.to_string(),
    ]
}
