//! The report as Markdown.

use super::report::{Cell, LocaliseReport, Plateau, SceneReport};
use super::statistics::ErrorFigures;
use crate::experiment::{THESIS_TABLES, WAVE_COUNTS};
use std::fmt::Write;

/// The whole report: what people read, and what the program prints.
pub fn markdown(report: &LocaliseReport) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(report, &mut text);
    text
}

fn write_all(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "# Localisation by an observer\n")?;
    writeln!(
        out,
        "{}, panning law {}, {} seeds for each setting and facing, {:.0} s. Angles in degrees, \
         positive to the\nright. Intervals: percentile bootstrap of the median, {:.0} %, {} \
         drawings. An angle of up to {}° is in the centre.\n",
        report.renderer,
        report.law,
        report.seeds,
        report.seconds,
        100.0 * report.confidence,
        report.resamples,
        report.centre_deg
    )?;
    write_open(report, out)?;
    for scene in &report.scenes {
        write_scene(scene, out)?;
    }
    write_plateaus(report, out)?;
    write_unheard(report, out)?;
    write_limits_of_levels(report, out)
}

fn write_open(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## In the open\n")?;
    writeln!(
        out,
        "The source stands around the listener of open-field; 1 iteration hears the straight \
         way alone, more\nalso the ground, from below.\n"
    )?;
    header(
        out,
        &[
            "profile",
            "waves",
            "it.",
            "metres",
            "m",
            "azimuths",
            "median error",
            "interval",
            "outward bias",
            "spread",
            "worst azimuth",
        ],
    )?;
    for open in &report.open {
        let worst = open.azimuths.iter().max_by(|a, b| {
            let of = |at: &super::OpenAzimuth| at.error.median_abs_deg;
            of(a).total_cmp(&of(b))
        });
        let worst = worst.map(|at| format!("{:.2} at {}", at.error.median_abs_deg, at.azimuth_deg));
        let error = &open.all;
        writeln!(
            out,
            "| {} | {} | {} | {} | {:.4} | {} | {:.2} | {} | {:+.2} | {:.2} | {} |",
            open.profile,
            open.waves,
            open.iterations,
            open.distance_m,
            open.mean_side,
            open.azimuths.len(),
            error.median_abs_deg,
            interval(error),
            error.outward_bias_deg,
            error.spread_deg,
            worst.unwrap_or_default(),
        )?;
    }
    writeln!(out)
}

fn write_scene(scene: &SceneReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## {}\n", scene.scene)?;
    writeln!(
        out,
        "Source {:.2} m away, listener {:.2} m in radius, m = {:.4}. The best that levels can \
         do, by facing:\n",
        scene.distance_m, scene.radius_m, scene.mean_side
    )?;
    header(
        out,
        &["source at", "lateral", "it.", "pan", "±", "heard", "answer"],
    )?;
    for facing in &scene.facings {
        for limit in &facing.limits {
            writeln!(
                out,
                "| {:+.1} | {:+.1} | {} | {:+.4} | {:.4} | {:.4} % | {:+.1} |",
                facing.azimuth_deg,
                facing.lateral_deg,
                limit.iterations,
                limit.pan,
                limit.uncertainty,
                100.0 * limit.heard,
                limit.lateral_deg
            )?;
        }
    }
    writeln!(out, "\nThe first sound, all facings:\n")?;
    header(
        out,
        &[
            "profile",
            "waves",
            "it.",
            "hits",
            "unheard",
            "error from source",
            "interval",
            "outward bias",
            "spread",
            "error from limit",
            "interval",
            "bias",
            "left said L/C/R",
            "centre",
            "right",
        ],
    )?;
    for cell in first_sound(scene) {
        write_cell(cell, out)?;
    }
    writeln!(out)
}

fn write_cell(cell: &Cell, out: &mut String) -> std::fmt::Result {
    let said = cell
        .confusion
        .map(|row| row.map(|n| n.to_string()).join("/"));
    writeln!(
        out,
        "| {} | {} | {} | {:.1} | {:.0} % | {:.1} | {} | {:+.1} | {:.1} | {:.1} | {} | {:+.1} | \
         {} |",
        cell.profile,
        cell.waves,
        cell.iterations,
        cell.hits,
        100.0 * cell.unheard,
        cell.source.median_abs_deg,
        interval(&cell.source),
        cell.source.outward_bias_deg,
        cell.source.spread_deg,
        cell.limit.median_abs_deg,
        interval(&cell.limit),
        cell.limit.bias_deg,
        said.join(" | "),
    )
}

/// Rows of the first sound: the others' are the same but for rounding.
pub(super) fn first_sound(scene: &SceneReport) -> impl Iterator<Item = &Cell> {
    let first = scene.cells.first().map(|cell| cell.sound.as_str());
    scene
        .cells
        .iter()
        .filter(move |cell| Some(cell.sound.as_str()) == first)
}

fn write_plateaus(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## Where more stops helping\n")?;
    writeln!(
        out,
        "The smallest count from which on the median error is within the interval of the largest \
         count's,\nor below it. None: at the largest count half of the trials hear nothing. The \
         first sound.\n"
    )?;
    header(
        out,
        &[
            "scene",
            "profile",
            "error from",
            "along",
            "at",
            "from",
            "of",
            "error there",
            "interval",
        ],
    )?;
    let first = report.scenes.first().and_then(|scene| scene.cells.first());
    let first = first.map(|cell| cell.sound.as_str());
    let shown = |plateau: &&Plateau| Some(plateau.sound.as_str()) == first;
    for plateau in report.plateaus.iter().filter(shown) {
        let other = match plateau.along {
            "waves" => "iterations",
            _ => "waves",
        };
        let count = plateau.count.map(|count| count.to_string());
        writeln!(
            out,
            "| {} | {} | {} | {} | {} {other} | {} | {} | {:.1} | {} |",
            plateau.scene,
            plateau.profile,
            plateau.against,
            plateau.along,
            plateau.fixed,
            count.unwrap_or_else(|| "none".to_owned()),
            plateau.largest,
            plateau.error.median_abs_deg,
            interval(&plateau.error),
        )?;
    }
    writeln!(out)
}

/// Trials in which nothing arrives: the answer is then the middle, whatever the truth.
fn write_unheard(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## Where nothing is heard\n")?;
    writeln!(
        out,
        "Settings in which a trial in ten or more hears no wave; the sound then stays in the \
         middle. Thesis: the count\nof its figures 11.1 to 11.4.\n"
    )?;
    header(
        out,
        &[
            "scene",
            "profile",
            "waves",
            "it.",
            "hits",
            "thesis",
            "unheard",
            "error from source",
        ],
    )?;
    for scene in &report.scenes {
        for cell in first_sound(scene) {
            let thesis = thesis_hits(&scene.scene, cell);
            let thesis_alone = cell.profile == "thesis" && thesis.is_some();
            if cell.unheard < 0.1 && !(thesis_alone && cell.waves == 1 << 20) {
                continue;
            }
            writeln!(
                out,
                "| {} | {} | {} | {} | {:.1} | {} | {:.0} % | {:.1} |",
                scene.scene,
                cell.profile,
                cell.waves,
                cell.iterations,
                cell.hits,
                thesis.map(|hits| hits.to_string()).unwrap_or_default(),
                100.0 * cell.unheard,
                cell.source.median_abs_deg
            )?;
        }
    }
    writeln!(out)
}

/// What the thesis counted with these settings, if it did.
fn thesis_hits(scene: &str, cell: &Cell) -> Option<u64> {
    let table = THESIS_TABLES
        .iter()
        .find(|table| table.scene == scene && table.iterations == cell.iterations)?;
    let row = WAVE_COUNTS.iter().position(|&waves| waves == cell.waves)?;
    Some(table.rows[row].listener_hits)
}

fn write_limits_of_levels(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## What levels cannot tell\n")?;
    writeln!(
        out,
        "- Front from back, above from below: both have the same levels. Truth and answer are \
         lateral angles, folded to\n  the front.\n\
         - One sound from another: the answers differ by {:.1e}° at the most, since the gains \
         are the same at every frequency.\n\
         - A source in the middle from silence: when no wave arrives the sound goes on, in the \
         middle.\n\
         - Where a hidden source is: what arrives comes from the openings and walls. The error \
         of the limit from the source\n  is the panning's, not the tracing's.",
        report.largest_difference_of_sounds_deg
    )
}

fn interval(error: &ErrorFigures) -> String {
    format!("{:.1} … {:.1}", error.low_deg, error.high_deg)
}

fn header(out: &mut String, headings: &[&str]) -> std::fmt::Result {
    writeln!(out, "| {} |", headings.join(" | "))?;
    writeln!(out, "|{}", " --- |".repeat(headings.len()))
}
