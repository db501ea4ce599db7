//! The report as Markdown.

use super::report::{Cell, LocaliseReport, Plateau, SceneReport};
use super::statistics::ErrorFigures;
use crate::experiment::{THESIS_TABLES, WAVE_COUNTS};
use crate::trace::Profile;
use std::fmt::Write;

/// The plateaus that are shown: along waves with these iterations, the thesis' own …
const PLATEAU_ITERATIONS: [u32; 2] = [4, 8];
/// … and along iterations with so many waves.
const PLATEAU_WAVES: u32 = 65_536;

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
        "From: the smallest count from which on the median error is within the interval of the \
         largest count's, or\nbelow it; a count at which half of the trials hear nothing does \
         not qualify. Best: the count with the smallest\nmedian error. The first sound; along \
         waves with the thesis' iterations, along iterations with {PLATEAU_WAVES} waves,\nthe \
         rest in the JSON file.\n"
    )?;
    header(
        out,
        &[
            "scene",
            "error from",
            "along",
            "with",
            "profile",
            "from",
            "best",
            "of",
            "error there",
            "interval",
        ],
    )?;
    let first = report.scenes.first().and_then(|scene| scene.cells.first());
    let first = first.map(|cell| cell.sound.as_str());
    let shown = |plateau: &&Plateau| {
        let is_shown = match plateau.along {
            "waves" => PLATEAU_ITERATIONS.contains(&plateau.fixed),
            _ => plateau.fixed == PLATEAU_WAVES,
        };
        is_shown && Some(plateau.sound.as_str()) == first
    };
    let mut shown: Vec<&Plateau> = report.plateaus.iter().filter(shown).collect();
    let place = |of: &Plateau| {
        report
            .scenes
            .iter()
            .position(|scene| scene.scene == of.scene)
    };
    // The profiles side by side.
    shown.sort_by_key(|of| (place(of), of.against, of.along, of.fixed));
    for plateau in shown {
        write_plateau(plateau, out)?;
    }
    writeln!(out)
}

fn write_plateau(plateau: &Plateau, out: &mut String) -> std::fmt::Result {
    let other = match plateau.along {
        "waves" => "iterations",
        _ => "waves",
    };
    let told = |count: Option<u32>| count.map_or_else(|| "none".to_owned(), |n| n.to_string());
    writeln!(
        out,
        "| {} | {} | {} | {} {other} | {} | {} | {} | {} | {:.1} | {} |",
        plateau.scene,
        plateau.against,
        plateau.along,
        plateau.fixed,
        plateau.profile,
        told(plateau.count),
        told(plateau.best),
        plateau.largest,
        plateau.error.median_abs_deg,
        interval(&plateau.error),
    )
}

/// Trials in which nothing arrives: the answer is then the middle, whatever the truth.
fn write_unheard(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## What is heard at all\n")?;
    writeln!(
        out,
        "Waves that arrive, mean of the trials, and the share of trials in which none does: the \
         sound then stays in\nthe middle, wherever the source is. Printed: figures 11.1 to 11.4 of the thesis.\n"
    )?;
    header(
        out,
        &[
            "scene", "it.", "waves", "printed", "thesis", "march", "hybrid",
        ],
    )?;
    for table in &THESIS_TABLES {
        let Some(scene) = report
            .scenes
            .iter()
            .find(|scene| scene.scene == table.scene)
        else {
            continue;
        };
        for (waves, row) in WAVE_COUNTS.into_iter().zip(&table.rows) {
            let heard = Profile::ALL.map(|profile| {
                let is = |cell: &&Cell| {
                    (cell.waves, cell.iterations) == (waves, table.iterations)
                        && cell.profile == profile.to_string()
                };
                let cell = first_sound(scene).find(is);
                cell.map(|cell| format!("{:.1}{}", cell.hits, none_in(cell.unheard)))
            });
            let [hybrid, march, thesis] = heard.map(Option::unwrap_or_default);
            if [&hybrid, &march, &thesis]
                .iter()
                .all(|text| text.is_empty())
            {
                continue;
            }
            let (name, iterations) = (table.scene, table.iterations);
            let printed = row.listener_hits;
            writeln!(
                out,
                "| {name} | {iterations} | {waves} | {printed} | {thesis} | {march} | {hybrid} |"
            )?;
        }
    }
    writeln!(out)
}

fn none_in(unheard: f64) -> String {
    match unheard {
        0.0 => String::new(),
        share => format!(" (none in {:.0} %)", 100.0 * share),
    }
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
