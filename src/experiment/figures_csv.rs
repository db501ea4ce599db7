//! The four tables as CSV, a line a row and profile.

use super::figures::{FigureRow, FigureTable, FiguresReport};
use std::io::{self, Write};

const COLUMNS: [&str; 23] = [
    "figure",
    "scene",
    "iterations",
    "profile",
    "waves",
    "initialise_ms",
    "march_ms",
    "pan_ms",
    "read_back_ms",
    "total_ms",
    "listener_hits",
    "dead",
    "travelling",
    "zero_length_passes",
    "zero_length_share",
    "step_limit_reached",
    "pan",
    "thesis_mobile_ms",
    "thesis_desktop_ms",
    "thesis_listener_hits",
    "standard_errors",
    "renderer",
    "clock",
];

/// Writes the report; columns as named in its first line, times in milliseconds.
///
/// # Errors
/// Those of `out`.
pub fn write_csv(report: &FiguresReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for table in &report.tables {
        for row in &table.rows {
            writer.write_record(record(report, table, row))?;
        }
    }
    writer.flush()
}

fn record(report: &FiguresReport, table: &FigureTable, row: &FigureRow) -> [String; 23] {
    let times = &row.milliseconds;
    let counts = &row.counts;
    [
        table.figure.to_owned(),
        table.scene.to_owned(),
        table.iterations.to_string(),
        row.profile.clone(),
        row.waves.to_string(),
        format!("{:.4}", times.initialise),
        format!("{:.4}", times.march),
        format!("{:.4}", times.pan),
        format!("{:.4}", times.read_back),
        format!("{:.4}", times.total),
        counts.listener_hits.to_string(),
        counts.dead.to_string(),
        counts.travelling.to_string(),
        counts.zero_length_passes.to_string(),
        format!("{:.5}", row.zero_length_share),
        counts.step_limit_reached.to_string(),
        format!("{:.6}", row.pan),
        row.thesis.mobile_ms.to_string(),
        row.thesis.desktop_ms.to_string(),
        row.thesis.listener_hits.to_string(),
        format!("{:.2}", row.standard_errors()),
        report.renderer.clone(),
        report.clock.clone(),
    ]
}
