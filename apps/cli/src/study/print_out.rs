//! The output of `echomarch study`.

use crate::options::Common;
use crate::print;
use echomarch_lab::study::{EmptyCells, Estimate, Joined, Shard, Study};
use indicatif::{HumanBytes, HumanCount, HumanDuration};
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// Prints the estimated size and time of a study.
pub fn estimate(
    common: &Common,
    study: &Study,
    renderer: &str,
    estimate: &Estimate,
) -> anyhow::Result<()> {
    let seconds = estimate.seconds();
    let shards = estimate.shard_bytes_a_point * estimate.points as f64;
    let csv = estimate.csv_bytes_a_point * estimate.points as f64;
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "renderer": renderer,
            "sample": estimate, "seconds": seconds,
            "points_a_core_hour": estimate.points_a_core_hour(),
            "shard_bytes": shards, "csv_bytes": csv,
        }));
    }
    let (mean, error) = (estimate.seconds_a_point, estimate.seconds_a_point_error);
    let mut lines = vec![
        format!(
            "{}: {} points; a sample of {} took {:.3} ms each, ± {:.3} ms",
            study.name(),
            HumanCount(estimate.points),
            estimate.sampled,
            1e3 * mean,
            1e3 * error
        ),
        format!(
            "  in one process here  {}",
            match seconds < 1.0 {
                true => "less than a second".to_owned(),
                false => {
                    let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
                    HumanDuration(time).to_string()
                }
            }
        ),
    ];
    if let Some(points) = estimate.points_a_core_hour() {
        let points = HumanCount(points as u64);
        lines.push(format!("  points a core hour   {points}"));
    }
    lines.push(format!(
        "  shards               {}",
        HumanBytes(shards as u64)
    ));
    lines.push(format!("  study.csv            {}", HumanBytes(csv as u64)));
    print::line(&lines.join("\n"))
}

/// Prints that a shard is complete.
pub fn shard(common: &Common, study: &Study, shard: Shard, folder: &Path) -> anyhow::Result<()> {
    let file = shard.file(folder).display().to_string();
    let points = shard.points(study.points());
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "shard": shard.number(),
            "of": shard.of(), "points": points, "file": file,
        }));
    }
    print::line(&format!("shard {shard}: {points} points in {file}"))
}

/// Prints the names of the tables and pictures that were written.
pub fn joined(common: &Common, study: &Study, joined: &Joined) -> anyhow::Result<()> {
    let files: Vec<String> = joined
        .files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    if common.json {
        return print::json(&json!({
            "name": study.name(), "study": study.hash(), "renderer": joined.renderer,
            "points": joined.points, "shards": joined.shards, "files": files,
            "empty": empty_of(joined),
        }));
    }
    tell_empty(common, joined);
    let (points, shards) = (joined.points, joined.shards);
    let s = if shards == 1 { "" } else { "s" };
    print::line(&format!(
        "{}: {points} points of {shards} shard{s}\nwritten: {}",
        study.name(),
        files.join(", ")
    ))
}

/// Maximum number of columns whose empty cells are reported individually. study.json lists all columns.
const MOST_COLUMNS: usize = 12;

/// Prints the number of empty cells of the tables, and the reasons.
fn tell_empty(common: &Common, joined: &Joined) {
    let mut columns: Vec<(&str, Vec<&EmptyCells>)> = Vec::new();
    for cells in &joined.empty {
        match columns.last_mut() {
            Some((column, of_column)) if *column == cells.column => of_column.push(cells),
            _ => columns.push((&cells.column, vec![cells])),
        }
    }
    for (column, of_column) in columns.iter().take(MOST_COLUMNS) {
        let all: u64 = of_column.iter().map(|cells| cells.cells).sum();
        let reasons = of_column
            .iter()
            .map(|cells| format!("{} {}", cells.why, cells.cells));
        common.note(&format!(
            "note: {column}: {all} of {} cells are empty: {}",
            joined.points,
            reasons.collect::<Vec<_>>().join(", ")
        ));
    }
    if let Some(more) = columns
        .len()
        .checked_sub(MOST_COLUMNS)
        .filter(|more| *more > 0)
    {
        common.note(&format!(
            "note: {more} more columns have empty cells: study.json lists all"
        ));
    }
}

/// The empty cells as JSON.
fn empty_of(joined: &Joined) -> Vec<serde_json::Value> {
    let cells = joined.empty.iter();
    let cells = cells.map(|of| json!({"column": of.column, "why": of.why, "cells": of.cells}));
    cells.collect()
}
