//! `echomarch cost`: what each surface and each option costs, and what could be left out.

use super::numbers::count;
use super::options::{Common, TraceOptions, Values, check_ending, check_range};
use super::print;
use crate::experiment::cost::{
    self, Change, CostOptions, CostReport, Feature, OptionRow, Size, SurfaceRow, Timing, Verdict,
    write_csv,
};
use crate::output::{check_file, write_whole};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch cost corner                      every surface and option of a built-in scene
  echomarch cost my.ron --waves 262144 --runs 25 -o cost.csv
  echomarch cost obstacles --profile march --json";

const LEGEND: &str = "\
saves: median time that the change saves (negative: costs), run by run, ± half the distance between
the quartiles; ~ where the clock makes as much of no difference. met: waves that meet it. heard:
change of the share of waves heard; pan; level: at the ear at which it changes more; each the mean,
and in brackets the root mean square of a single frame. A change is noise where another seed
changes as much in all three. Everything is changed alone: two things that can each be left out may
be heard together.";

/// Arguments of `cost`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Built-in scene or scene file
    scene: String,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    options: TraceOptions,
    /// Pairs of frames for each row, a seed each; times are medians
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
    let scene = common.scene_with(&arguments.scene, &arguments.values)?;
    if let Some(path) = &arguments.output {
        check_file(path)?;
    }
    let options = CostOptions {
        runs: arguments.runs,
    };
    let mut tracer = common.tracer()?;
    let bar = print::progress(common.quiet, 0, "rows");
    let report = cost::measure(
        &mut tracer,
        &scene,
        &settings,
        &options,
        &mut |done, total| {
            bar.set_length(total);
            bar.set_position(done);
        },
    )?;
    bar.finish_and_clear();
    if let Some(path) = &arguments.output {
        write_whole(path, |out| write_csv(&report, out))?;
    }
    if common.json {
        return print::json(&report);
    }
    print_report(&report)?;
    match &arguments.output {
        Some(path) => print::line(&format!("\nwritten: {}", path.display())),
        None => Ok(()),
    }
}

fn print_report(report: &CostReport) -> anyhow::Result<()> {
    print::prose(&format!(
        "{}: {} waves, {} iterations, profile {}, {} directions, seeds from {}\n\
         {} (times: {}, median of {} pairs)",
        report.scene,
        report.waves,
        report.iterations,
        report.profile,
        report.directions,
        report.seed,
        report.renderer,
        report.clock,
        report.runs
    ))?;
    print_noise(report)?;
    let what = match report.by_kind {
        true => "Surfaces, by kind, left out all of a kind",
        false => "Surfaces, left out one at a time",
    };
    let followed = report.followed;
    print::prose(&format!(
        "\n## {what}\n\n{}\n",
        surfaces_table(&report.surfaces)
    ))?;
    print::prose(&format!("met: of {followed} waves"))?;
    if report.surfaces.iter().any(|row| row.leaves_cells) {
        print::prose("*: without it the others no longer lie in cells, and are unrolled")?;
    }
    print::prose(&format!(
        "\n## Options, changed one at a time\n\n{}",
        options_table(&report.options)
    ))?;
    print_shader(report)?;
    print::prose(&format!("\n{LEGEND}\n"))?;
    for sentence in &report.advice {
        print::prose(sentence)?;
    }
    Ok(())
}

fn print_noise(report: &CostReport) -> anyhow::Result<()> {
    let noise = &report.noise;
    let level = noise.level_db.map_or_else(
        || "without bound, for an ear hears nothing by some seed".to_owned(),
        |level| format!("{level:.2} dB"),
    );
    print::prose(&format!(
        "with everything: frame {:.2} ms, march {:.2} ms; against itself {}\n\
         {:.1} waves heard; another seed changes that by {:.2} %, the pan by {:.4}, the level by {level}",
        report.control_total.base_ms,
        report.control.base_ms,
        saves(&report.control),
        noise.heard,
        noise.heard_percent,
        noise.pan
    ))
}

fn surfaces_table(rows: &[SurfaceRow]) -> print::Wide {
    let mut printed = print::table(
        1,
        &[
            "without", "met", "march ms", "saves", "of march", "lines", "heard", "pan", "level", "",
        ],
    );
    for row in rows {
        let star = if row.leaves_cells { " *" } else { "" };
        let march = row.march.as_ref();
        let [heard, pan, level] = change_cells(row.change.as_ref());
        printed.add_row([
            format!("{}{star}", row.name),
            format!("{:.1} %", row.met_percent),
            march.map_or(String::new(), |march| format!("{:.2}", march.changed_ms)),
            march.map_or(String::new(), saves),
            march.map_or(String::new(), percent),
            row.lines.map_or(String::new(), |lines| lines.to_string()),
            heard,
            pan,
            level,
            verdict(row.verdict).to_owned(),
        ]);
    }
    printed
}

fn options_table(rows: &[OptionRow]) -> print::Wide {
    let mut printed = print::table(
        2,
        &[
            "with", "against", "frame ms", "saves", "of frame", "of march", "heard", "pan",
            "level", "",
        ],
    );
    for row in rows {
        let [heard, pan, level] = change_cells(row.change.as_ref());
        let said = match (row.change, row.within_noise) {
            (None, _) => "nothing heard",
            (Some(_), true) => "within noise",
            (Some(_), false) => "heard",
        };
        printed.add_row([
            row.name.clone(),
            row.against.clone(),
            format!("{:.2}", row.total.changed_ms),
            saves(&row.total),
            percent(&row.total),
            percent(&row.march),
            heard,
            pan,
            level,
            said.to_owned(),
        ]);
    }
    printed
}

fn print_shader(report: &CostReport) -> anyhow::Result<()> {
    let shader = &report.shader;
    let tell = |feature: &Feature| match (feature.in_scene, feature.called_by.is_empty()) {
        (true, _) => feature.name.clone(),
        (false, false) => format!("{} (for {})", feature.name, feature.called_by.join(", ")),
        (false, true) => format!("{} (not in the scene!)", feature.name),
    };
    let features: Vec<String> = shader.features.iter().map(tell).collect();
    print::prose(&format!(
        "\n## The shader of the march\n\n{} lines in {} functions; a scene of one plane has {} in {}\n\
         shapes and operators in it: {}",
        shader.lines,
        shader.functions,
        shader.least_lines,
        shader.least_functions,
        features.join(", ")
    ))?;
    let verdict = match shader.strangers().is_empty() {
        true => "none that the scene does not use".to_owned(),
        false => format!("not used by the scene: {}", shader.strangers().join(", ")),
    };
    let unused = match shader.unused_functions.is_empty() {
        true => "every function is called".to_owned(),
        false => format!(
            "never called, for the compiler to drop: {}",
            shader.unused_functions.join(", ")
        ),
    };
    print::prose(&format!("{verdict}; {unused}"))
}

fn saves(timing: &Timing) -> String {
    let noise = if timing.beyond_noise { "" } else { "~ " };
    format!(
        "{noise}{:+.2} ± {:.2} ms",
        timing.saved_ms, timing.spread_ms
    )
}

fn percent(timing: &Timing) -> String {
    let noise = if timing.beyond_noise { "" } else { "~ " };
    format!("{noise}{:+.1} %", timing.saved_percent)
}

/// Change of heard waves, pan and level.
fn change_cells(change: Option<&Change>) -> [String; 3] {
    let Some(change) = change else {
        return Default::default();
    };
    let size = |size: Size, digits: usize, unit: &str| {
        let (mean, rms) = (size.mean, size.rms);
        format!("{mean:+.digits$}{unit} ({rms:.digits$})")
    };
    let level = change.level_db.map(|level| size(level, 2, " dB"));
    [
        size(change.heard_percent, 1, " %"),
        size(change.pan, 4, ""),
        level.unwrap_or_else(|| "an ear falls silent".to_owned()),
    ]
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::CanBeLeftOut => "can be left out",
        Verdict::IsHeard => "heard",
        Verdict::LeavesNothing => "leaves no surface",
        Verdict::NothingHeard => "nothing heard",
    }
}
