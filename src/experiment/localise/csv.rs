//! The figures as CSV: a line an azimuth in the open, then a line a sound and setting in each
//! room.

use super::report::{Cell, LocaliseReport, OpenAzimuth, OpenReport};
use super::statistics::ErrorFigures;
use std::io::{self, Write};

/// The first line: angles in degrees, positive to the right; the share unheard 0 … 1;
/// `said_right_when_left` counts trials, and so on.
pub const COLUMNS: [&str; 32] = [
    "kind",
    "scene",
    "sound",
    "profile",
    "waves",
    "iterations",
    "azimuth",
    "trials",
    "unheard",
    "hits",
    "source_median_abs",
    "source_low",
    "source_high",
    "source_bias",
    "source_outward_bias",
    "source_spread",
    "limit_median_abs",
    "limit_low",
    "limit_high",
    "limit_bias",
    "limit_outward_bias",
    "limit_spread",
    "said_left_when_left",
    "said_centre_when_left",
    "said_right_when_left",
    "said_left_when_centre",
    "said_centre_when_centre",
    "said_right_when_centre",
    "said_left_when_right",
    "said_centre_when_right",
    "said_right_when_right",
    "renderer",
];

/// Columns of the open field that have nothing in them: of the limit and the confusion.
const ROOM_ONLY: usize = 15;

/// Writes the report; columns as in [`COLUMNS`].
///
/// # Errors
/// Those of `out`.
pub fn write_csv(report: &LocaliseReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for open in &report.open {
        for azimuth in &open.azimuths {
            writer.write_record(open_record(report, open, azimuth))?;
        }
    }
    for scene in &report.scenes {
        for cell in &scene.cells {
            writer.write_record(cell_record(report, &scene.scene, cell))?;
        }
    }
    writer.flush()
}

fn open_record(report: &LocaliseReport, open: &OpenReport, at: &OpenAzimuth) -> Vec<String> {
    let sound = report.scenes.first().and_then(|scene| scene.cells.first());
    let mut record = vec![
        "open".to_owned(),
        "open-field".to_owned(),
        sound.map(|cell| cell.sound.clone()).unwrap_or_default(),
        open.profile.clone(),
        open.waves.to_string(),
        open.iterations.to_string(),
        at.azimuth_deg.to_string(),
        report.seeds.to_string(),
        String::new(),
        String::new(),
    ];
    record.extend(errors(&at.error));
    record.extend(vec![String::new(); ROOM_ONLY]);
    record.push(report.renderer.clone());
    record
}

fn cell_record(report: &LocaliseReport, scene: &str, cell: &Cell) -> Vec<String> {
    let mut record = vec![
        "room".to_owned(),
        scene.to_owned(),
        cell.sound.clone(),
        cell.profile.clone(),
        cell.waves.to_string(),
        cell.iterations.to_string(),
        String::new(),
        cell.trials.to_string(),
        format!("{:.5}", cell.unheard),
        format!("{:.2}", cell.hits),
    ];
    record.extend(errors(&cell.source));
    record.extend(errors(&cell.limit));
    record.extend(cell.confusion.iter().flatten().map(u32::to_string));
    record.push(report.renderer.clone());
    record
}

fn errors(error: &ErrorFigures) -> [String; 6] {
    [
        error.median_abs_deg,
        error.low_deg,
        error.high_deg,
        error.bias_deg,
        error.outward_bias_deg,
        error.spread_deg,
    ]
    .map(|degrees| format!("{degrees:.4}"))
}
