//! The report as Markdown.

use super::report::{Cell, LocaliseReport, Plateau, SceneReport};
use super::shown::{first_sound, interval, none, number, shown_plateaus, signed, with_interval};
use super::statistics::{ErrorFigures, LEAST_DRAWN};
use super::{AUDIBLE_DEG, MOST_WORK};
use crate::experiment::{THESIS_TABLES, WAVE_COUNTS};
use crate::text::markdown as as_markdown;
use crate::trace::Profile;
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
         positive to the\nright; errors are medians of the absolute. Intervals: percentile \
         bootstrap, {} drawings, {}.\nAn angle of up to {}° is in the centre. Trials in which \
         nothing is heard are in no error.\n",
        report.renderer,
        report.law,
        report.seeds,
        report.seconds,
        report.resamples,
        intervals(report),
        report.centre_deg
    )?;
    write_left_out(report, out)?;
    write_open(report, out)?;
    write_alike(report, out)?;
    for scene in &report.scenes {
        write_scene(scene, out)?;
    }
    write_plateaus(report, out)?;
    write_unheard(report, out)?;
    write_limits_of_levels(report, out)
}

/// What the intervals are.
fn intervals(report: &LocaliseReport) -> String {
    match report.rough {
        true => format!("rough: fewer than {LEAST_DRAWN} seeds"),
        false => format!(
            "{:.0} % (~: rough, fewer than {LEAST_DRAWN} heard answers to a truth)",
            100.0 * report.confidence
        ),
    }
}

fn write_left_out(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    if report.left_out.is_empty() {
        return Ok(());
    }
    let told = |&(waves, iterations): &(u32, u32)| format!("{waves} × {iterations}");
    let told: Vec<String> = report.left_out.iter().map(told).collect();
    writeln!(
        out,
        "Left out, more than {MOST_WORK} waves × iterations: {}.\n",
        told.join(", ")
    )
}

fn write_open(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## In the open\n")?;
    writeln!(
        out,
        "The source stands around the listener of open-field; 1 iteration hears the straight \
         way alone, more\nalso the ground, from below, where there is one. The observer is told \
         how far the source is, which no person\nis; the blind one is not, and takes it for \
         far.\n"
    )?;
    header(
        out,
        &[
            "profile",
            "waves",
            "it.",
            "ground",
            "metres",
            "m",
            "azimuths",
            "error",
            "interval",
            "outward bias",
            "spread",
            "worst azimuth",
            "blind m",
            "blind error",
            "outward bias",
        ],
    )?;
    for open in &report.open {
        let median = |at: &super::OpenDirection| Some((at.error?.median_abs.deg, at.azimuth_deg));
        let worst = open.azimuths.iter().filter_map(median);
        let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0));
        let worst = worst.map(|(error, at)| format!("{error:.2} at {at}"));
        let (all, blind) = (open.all.as_ref(), open.blind.as_ref());
        writeln!(
            out,
            "| {} | {} | {} | {} | {} | {:.4} | {} | {} | {} | {} | {} | {} | {:.4} | {} | {} |",
            open.profile,
            open.waves,
            open.iterations,
            if open.ground { "yes" } else { "no" },
            open.distance_m,
            open.mean_side,
            open.azimuths.len(),
            all.map_or_else(none, |error| format!("{:.2}", error.median_abs.deg)),
            interval(all, |of| Some(of.median_abs), 2),
            with_interval(all, |of| of.outward_bias, 2),
            with_interval(all, |of| of.spread, 2),
            worst.unwrap_or_else(none),
            open.blind_mean_side,
            with_interval(blind, |of| Some(of.median_abs), 1),
            signed(blind, |of| of.outward_bias),
        )?;
    }
    writeln!(out)
}

/// Three sources that have the same levels, and what is answered to them.
fn write_alike(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    writeln!(
        out,
        "Ahead, behind and above: three sources 30° beside the median plane, and the mean \
         answers to them.\n"
    )?;
    header(
        out,
        &[
            "profile", "it.", "ground", "azimuth", "height", "lateral", "answer", "spread",
        ],
    )?;
    for open in &report.open {
        for at in &open.alike {
            writeln!(
                out,
                "| {} | {} | {} | {:+} | {:+} | {:+.1} | {} | {} |",
                open.profile,
                open.iterations,
                if open.ground { "yes" } else { "no" },
                at.azimuth_deg,
                at.elevation_deg,
                at.lateral_deg,
                at.answer_deg
                    .map_or_else(none, |answer| format!("{answer:+.1}")),
                number(at.error.as_ref(), |of| of.spread),
            )?;
        }
    }
    writeln!(out)
}

fn write_scene(scene: &SceneReport, out: &mut String) -> std::fmt::Result {
    writeln!(out, "## {}\n", as_markdown(&scene.scene))?;
    writeln!(
        out,
        "Source {:.2} m away, listener {:.2} m in radius, m = {:.4}. The converged panning of \
         `hybrid`, by facing:\n",
        scene.distance_m, scene.radius_m, scene.mean_side
    )?;
    header(
        out,
        &["source at", "lateral", "it.", "pan", "±", "heard", "answer"],
    )?;
    for facing in &scene.facings {
        for limit in &facing.limits {
            let is_heard = limit.heard > 0.0;
            let told = |text: String| if is_heard { text } else { none() };
            writeln!(
                out,
                "| {:+.1} | {:+.1} | {} | {} | {} | {:.4} % | {} |",
                facing.azimuth_deg,
                facing.lateral_deg,
                limit.iterations,
                told(format!("{:+.4}", limit.pan)),
                told(format!("{:.4}", limit.uncertainty)),
                100.0 * limit.heard,
                told(format!("{:+.1}", limit.lateral_deg)),
            )?;
        }
    }
    writeln!(
        out,
        "\nThe first sound, all facings; said L/C/R/–: left, centre, right, nothing heard:\n"
    )?;
    header(
        out,
        &[
            "profile",
            "waves",
            "it.",
            "hits",
            "unheard",
            "error from source",
            "bias",
            "outward bias",
            "spread",
            "error from limit",
            "bias",
            "left said L/C/R/–",
            "centre",
            "right",
            "side right",
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
    let right = cell.side_right.map_or_else(none, |of| {
        let [low, high] = of.interval.map(|end| 100.0 * end);
        format!("{:.0} % ({low:.0} … {high:.0})", 100.0 * of.share)
    });
    let (source, limit) = (cell.source.as_ref(), cell.limit.as_ref());
    let median = |of: &ErrorFigures| Some(of.median_abs);
    writeln!(
        out,
        "| {} | {} | {} | {:.1} | {:.0} % | {} | {} | {} | {} | {} | {} | {} | {right} |",
        cell.profile,
        cell.waves,
        cell.iterations,
        cell.hits,
        100.0 * cell.unheard,
        with_interval(source, median, 1),
        with_interval(source, |of| Some(of.bias), 1),
        with_interval(source, |of| of.outward_bias, 1),
        with_interval(source, |of| of.spread, 1),
        with_interval(limit, median, 1),
        with_interval(limit, |of| Some(of.bias), 1),
        said.join(" | "),
    )
}

fn write_plateaus(report: &LocaliseReport, out: &mut String) -> std::fmt::Result {
    let shown = shown_plateaus(report);
    writeln!(out, "## Where more stops helping\n")?;
    writeln!(
        out,
        "From: the smallest count from which on the figure is within the upper end of the \
         largest count's interval, or\nwithin {AUDIBLE_DEG}° of it, which is the least turn that \
         people notice ahead (Mills 1958). \"Not by\": only the largest count\nitself is, so it \
         may go on getting better. A count at which half of the trials hear nothing does not \
         qualify.\nLeast: the count with the smallest figure. The first sound; the rest in the \
         JSON file.\n"
    )?;
    header(
        out,
        &[
            "scene",
            "of",
            "along",
            "with",
            "profile",
            "from",
            "least",
            "of counts to",
            "there",
        ],
    )?;
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
    let of = match plateau.of {
        "spread" => "spread".to_owned(),
        truth => format!("error from {truth}"),
    };
    let there = plateau.there.map_or_else(none, |figure| {
        let ends = figure.interval_deg;
        let ends = ends.map(|[low, high]| format!(" ({low:.1} … {high:.1})"));
        format!("{:.1}{}", figure.deg, ends.unwrap_or_default())
    });
    writeln!(
        out,
        "| {} | {of} | {} | {} {other} | {} | {} | {} | {} | {there} |",
        as_markdown(&plateau.scene),
        plateau.along,
        plateau.fixed,
        plateau.profile,
        plateau.told(),
        plateau.least.map_or_else(none, |n| n.to_string()),
        plateau.largest,
    )
}

/// Trials in which nothing arrives: the sound is then in the middle, whatever the truth.
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
        "- Front from back, above from the height of the ears: the answers are the same (above). \
         Truth and answer are\n  lateral angles, folded to the front.\n\
         - One sound from another: the answers differ by {:.1e}° at the most, since the gains \
         are the same at every frequency.\n\
         - A source in the middle from silence: when no wave arrives the sound goes on, in the \
         middle.\n\
         - Where a hidden source is: what arrives comes from the openings and walls. The error \
         of the converged panning of\n  `hybrid` from the source is the panning's, not that of \
         too few waves.",
        report.largest_difference_of_sounds_deg
    )
}

fn header(out: &mut String, headings: &[&str]) -> std::fmt::Result {
    writeln!(out, "| {} |", headings.join(" | "))?;
    writeln!(out, "|{}", " --- |".repeat(headings.len()))
}
