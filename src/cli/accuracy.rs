//! `echomarch accuracy`: speed against error, and the project's own targets.

use super::numbers::{count, real};
use super::options::{Common, check_range};
use super::print;
use super::report::Experiment;
use crate::experiment::accuracy::{
    self, AccuracyOptions, AccuracyReport, COMPARED_ITERATIONS, DEFAULT_SCENES, Quantiles, ROOMS,
    Recommendation, Row, SceneReport, SurfaceCounts, plot_svg, write_csv,
};
use crate::scene::{BUILTIN_NAMES, Scene};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  echomarch accuracy                         four scenes, and the targets: some 4 minutes
  echomarch accuracy -o out                  the same; CSV, JSON and the plot in out/
  echomarch accuracy corner --error 0.01     one scene: about a minute
  echomarch accuracy my.ron --error 0.005    a scene of yours, without the targets
  echomarch accuracy --full -o out           every setting in every built-in scene: hours";

const LEGEND: &str = "\
ms: median time of a frame. M/s: millions of waves × iterations a second. eval: evaluations a wave
and iteration, of the distance and, in hybrid and march, of all fields that are marched; where
surfaces lie in cells, of those in the cell. status, sequence: share of the waves compared that end
otherwise than the exact ones, or meet other surfaces. end: metres from the exact wave's end
(median, 99 %, largest); within: the same, 99 % and largest, of waves within the horizon of chaos.
Hits: heard, less those of the exact waves, by order of reflection, without waves that thesis hears
after they died. limit bias: the mean less the limit of many waves; twin bias: against the exact
panning of the same waves, with its standard error; spread: over the seeds; rms: root of the mean
square error from the limit, MSE = (mean − limit)² + spread²; efficiency: 1 / (MSE × seconds).";

/// Arguments of `accuracy`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Built-in scenes or scene files [default: corner obstacles cave glasshouse; with --full all]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Every combination of settings, not one change at a time: takes hours
    #[arg(long)]
    full: bool,
    /// The panning error that the recommended setting has to stay below
    #[arg(long, default_value_t = 0.02, value_name = "RMS", value_parser = real::<f64>)]
    error: f64,
    /// Frames of each setting, a seed each
    #[arg(long, default_value_t = 16, value_name = "N", value_parser = count::<u32>)]
    seeds: u32,
    /// Write accuracy.csv, accuracy.json and accuracy.svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    check_range("--error", arguments.error, 1e-9, 2.0)?;
    check_range("--seeds", f64::from(arguments.seeds), 16.0, 1000.0)?;
    let options = options(arguments, common)?;
    let experiment = Experiment {
        name: "accuracy",
        unit: "steps",
        print: print_report,
        write_csv,
        plot_svg,
    };
    experiment.run(common, arguments.output.as_deref(), |tracer, progress| {
        accuracy::run(tracer, &options, progress)
    })
}

/// The built-in scenes that the exact reference knows: it has nothing but samples of a
/// user's GLSL.
fn with_a_truth() -> Vec<&'static str> {
    let known =
        |name: &&str| Scene::builtin(name).is_ok_and(|scene| scene.user_fields().next().is_none());
    BUILTIN_NAMES.into_iter().filter(known).collect()
}

fn options(arguments: &Arguments, common: &Common) -> anyhow::Result<AccuracyOptions> {
    let names: Vec<&str> = match (arguments.scenes.is_empty(), arguments.full) {
        (false, _) => arguments.scenes.iter().map(String::as_str).collect(),
        (true, true) => with_a_truth(),
        (true, false) => DEFAULT_SCENES.to_vec(),
    };
    let scenes: Result<Vec<_>, _> = names.iter().map(|name| common.scene(name)).collect();
    let options = match arguments.full {
        true => AccuracyOptions::full(scenes?),
        false => AccuracyOptions::quick(scenes?),
    };
    Ok(AccuracyOptions {
        seeds: arguments.seeds,
        stated_error: arguments.error,
        targets: ROOMS.iter().all(|room| names.contains(room)),
        ..options
    })
}

fn print_report(report: &AccuracyReport) -> anyhow::Result<()> {
    print::prose(&format!(
        "{} (times: {}, median of {}; {:.0} s in all)",
        report.renderer, report.clock, report.seeds, report.seconds
    ))?;
    for scene in &report.scenes {
        print::prose(&format!("\n## {}\n", scene.scene))?;
        print::prose(&surfaces(scene))?;
        print_limits(scene)?;
        print_chaos(scene)?;
        print::prose(&compared(scene))?;
        print::prose(&format!("\n{}\n", waves_table(scene)))?;
        print::prose(&format!("{}\n", panning_table(scene)))?;
        print_slopes(scene)?;
        print::prose(&recommendation(scene, report.stated_error))?;
    }
    print::prose(&format!("\n{LEGEND}"))?;
    print_targets(report)
}

/// How the surfaces of a scene are met.
fn surfaces(scene: &SceneReport) -> String {
    let SurfaceCounts {
        all,
        in_cells,
        marched,
    } = scene.surfaces;
    let many = if all == 1 { "surface" } else { "surfaces" };
    let mut told = format!("{all} {many}");
    if in_cells > 0 {
        told += &format!(", {in_cells} in cells");
    }
    if marched > 0 {
        told += &format!(", {marched} marched by hybrid too");
    }
    told
}

/// Of how many waves and seeds the exact ones were traced.
fn compared(scene: &SceneReport) -> String {
    let rows = || scene.rows.iter();
    let waves = rows().map(|row| row.waves.compared).max().unwrap_or(0);
    let seeds = rows().map(|row| row.panning.twin_seeds).max().unwrap_or(0);
    format!("compared one by one: {waves} waves a row at most; twin bias: of {seeds} seeds")
}

fn print_limits(scene: &SceneReport) -> anyhow::Result<()> {
    for limit in &scene.limits {
        print::prose(&format!(
            "{} iterations, exactly: pan {:+.5} ± {:.5}, {:.3} % of the waves heard ({} directions)",
            limit.iterations,
            limit.pan,
            limit.uncertainty,
            100.0 * limit.heard,
            limit.directions
        ))?;
    }
    Ok(())
}

fn print_chaos(scene: &SceneReport) -> anyhow::Result<()> {
    let chaos = &scene.chaos;
    let Some(growth) = chaos.growth else {
        return print::prose("chaos: none, no wave meets two curved surfaces");
    };
    let by_hit: Vec<String> = chaos
        .steps
        .iter()
        .map(|step| format!("{:.1e} ({} waves)", step.separation, step.pairs))
        .collect();
    print::prose(&format!(
        "chaos: separations in metres a radian at the 1st, 2nd … curved surface: {}",
        by_hit.join(", ")
    ))?;
    let horizon = chaos.horizon.unwrap_or(f64::INFINITY);
    let beyond = scene.rows.iter().map(|row| {
        let share = 100.0 * row.waves.beyond_horizon;
        (row.case.iterations, share)
    });
    let mut beyond: Vec<(u32, f64)> = beyond.collect();
    beyond.sort_by_key(|of| of.0);
    beyond.dedup_by_key(|of| of.0);
    let beyond: Vec<String> = beyond
        .iter()
        .map(|(iterations, share)| format!("{share:.3} % in {iterations}"))
        .collect();
    print::prose(&format!(
        "       × {growth:.1} a curved hit; f32 rounding is 1 cm after {horizon:.1} of them; \
         waves past that horizon: {} iterations",
        beyond.join(", ")
    ))
}

fn waves_table(scene: &SceneReport) -> print::Wide {
    let mut printed = print::table(
        3,
        &[
            "setting",
            "waves",
            "it.",
            "ms",
            "M/s",
            "eval",
            "status",
            "sequence",
            "end: median",
            "99 %",
            "largest",
            "within: 99 %",
            "largest",
            "NaN",
        ],
    );
    for row in &scene.rows {
        printed.add_row(waves_cells(row));
    }
    printed
}

fn waves_cells(row: &Row) -> [String; 14] {
    let (speed, waves) = (&row.speed, &row.waves);
    let Quantiles { median, p99, max } = waves.end;
    [
        row.label.clone(),
        row.case.waves.to_string(),
        row.case.iterations.to_string(),
        format!("{:.2}", speed.total_ms),
        format!("{:.1}", speed.million_per_second),
        format!("{:.1}", speed.evaluations_per_segment),
        format!("{:.3} %", 100.0 * waves.status_differs),
        format!("{:.3} %", 100.0 * waves.sequence_differs),
        format!("{median:.1e}"),
        format!("{p99:.1e}"),
        format!("{max:.1e}"),
        format!("{:.1e}", waves.end_within_horizon.p99),
        format!("{:.1e}", waves.end_within_horizon.max),
        waves.not_finite.to_string(),
    ]
}

fn panning_table(scene: &SceneReport) -> print::Wide {
    let mut printed = print::table(
        3,
        &[
            "setting",
            "waves",
            "it.",
            "exact hits",
            "hits, less exact by order",
            "pan",
            "limit bias",
            "twin bias",
            "spread",
            "rms",
            "efficiency",
            "GPU sum off by",
        ],
    );
    for row in &scene.rows {
        printed.add_row(panning_cells(row));
    }
    printed
}

fn panning_cells(row: &Row) -> [String; 12] {
    let (panning, waves) = (&row.panning, &row.waves);
    let pairs = waves.hits.iter().zip(&waves.exact_hits);
    let off: Vec<String> = pairs
        .map(|(&hits, &exact)| (hits as i64).wrapping_sub(exact as i64))
        .map(|off| {
            if off == 0 {
                "0".to_owned()
            } else {
                format!("{off:+}")
            }
        })
        .collect();
    let sum_error = panning.sum_error.map(|error| format!("{error:.0e}"));
    [
        row.label.clone(),
        row.case.waves.to_string(),
        row.case.iterations.to_string(),
        waves.exact_hits.iter().sum::<u64>().to_string(),
        off.join(" "),
        format!("{:+.4}", panning.mean),
        format!("{:+.4}", panning.limit_bias),
        format!("{:+.4} ± {:.4}", panning.twin_bias, panning.twin_bias_error),
        format!("{:.4}", panning.spread),
        format!("{:.4}", panning.rms),
        format!("{:.0}", panning.efficiency),
        sum_error.unwrap_or_default(),
    ]
}

fn print_slopes(scene: &SceneReport) -> anyhow::Result<()> {
    for slope in &scene.slopes {
        let points: Vec<String> = slope
            .points
            .iter()
            .map(|point| format!("{}: {:.5}", point.waves, point.rms))
            .collect();
        let left_out = slope.points.iter().filter(|point| !point.fitted);
        let left_out: Vec<String> = left_out.map(|point| point.waves.to_string()).collect();
        let left_out = match left_out.is_empty() {
            true => String::new(),
            false => format!("; not fitted, next to none heard: {}", left_out.join(", ")),
        };
        let law = match (slope.slope, slope.standard_error) {
            (Some(power), Some(error)) => format!("∝ waves^({power:.2} ± {error:.2})"),
            (Some(power), None) => format!("∝ waves^{power:.2}"),
            (None, _) => "follows no law".to_owned(),
        };
        print::prose(&format!(
            "hybrid, {} directions: rms panning error {law} ({}{left_out})",
            slope.directions,
            points.join(", ")
        ))?;
    }
    Ok(())
}

fn recommendation(scene: &SceneReport, error: f64) -> String {
    let tell = |row: &Recommendation| {
        let (label, waves) = (&row.label, row.case.waves);
        format!(
            "{label}, {waves} waves: {:.2} ms, rms {:.4}",
            row.total_ms, row.rms
        )
    };
    let wanted = format!("a panning error of at most {error} at {COMPARED_ITERATIONS} iterations");
    match (&scene.recommendation, &scene.best) {
        (Some(fastest), _) => format!(
            "recommended: the fastest with {wanted} is {}",
            tell(fastest)
        ),
        (None, Some(best)) => format!("recommended: none has {wanted}; the best is {}", tell(best)),
        (None, None) => format!(
            "recommended: nothing; no setting hears anything at {COMPARED_ITERATIONS} iterations"
        ),
    }
}

fn print_targets(report: &AccuracyReport) -> anyhow::Result<()> {
    if report.targets.is_empty() {
        return Ok(());
    }
    let mut printed = print::table(1, &["target", "measured", "bound", ""]);
    for target in &report.targets {
        let relation = if target.at_least { "≥" } else { "≤" };
        let bound = target.bound.map(|bound| format!("{relation} {bound}"));
        let verdict = match target.met {
            Some(true) => "met",
            Some(false) => "not met",
            None => "for information",
        };
        printed.add_row([
            target.what.clone(),
            short(target.measured),
            bound.unwrap_or_default(),
            verdict.to_owned(),
        ]);
    }
    print::prose(&format!("\n## Against its targets\n\n{printed}"))
}

fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size >= 1e-3 => format!("{value:.3}"),
        _ => format!("{value:.1e}"),
    }
}
