//! The figures as CSV: lines of the open field, then a line a sound and setting in each room;
//! and the score of people's answers, a line a group.

use super::report::{Cell, LocaliseReport, OpenDirection, OpenReport};
use super::score::{Group, ScoreReport};
use super::statistics::{ErrorFigures, Figure};
use crate::text::csv_cell;
use std::io::{self, Write};

/// Whose errors: from the source, from the limit, and the blind observer's from the source.
const ERRORS: [&str; 3] = ["source", "limit", "blind"];
/// What there is of each, all but the first with `_low` and `_high`.
const FIGURES: [&str; 4] = ["median_abs", "bias", "outward_bias", "spread"];
/// Sides of the source, and what was said.
const SIDES: [&str; 3] = ["left", "centre", "right"];
const SAID: [&str; 4] = ["left", "centre", "right", "nothing"];

/// The first line: angles in degrees, positive to the right; shares 0 … 1;
/// `said_right_when_left` counts trials, and so on; `…_rough` is 1 if the intervals are drawn
/// from too few to be called 95 %. `kind` is `open` (all around the listener), `alike` (three
/// sources that levels cannot tell apart) or `room`.
pub fn columns() -> Vec<String> {
    let mut columns = [
        "kind",
        "scene",
        "sound",
        "profile",
        "waves",
        "iterations",
        "azimuth",
        "elevation",
        "trials",
        "unheard",
        "hits",
        "mean_answer",
    ]
    .map(str::to_owned)
    .to_vec();
    for errors in ERRORS {
        columns.extend(error_columns(errors));
    }
    for side in SIDES {
        columns.extend(SAID.map(|said| format!("said_{said}_when_{side}")));
    }
    columns.extend(
        [
            "side_right",
            "side_right_low",
            "side_right_high",
            "renderer",
        ]
        .map(Into::into),
    );
    columns
}

/// Columns of [`error_fields`].
fn error_columns(of: &str) -> Vec<String> {
    let mut columns = vec![format!("{of}_answers")];
    for figure in FIGURES {
        columns.extend(["", "_low", "_high"].map(|end| format!("{of}_{figure}{end}")));
    }
    columns.push(format!("{of}_rough"));
    columns
}

/// Fields of an error; all empty for none.
fn error_fields(error: Option<&ErrorFigures>) -> Vec<String> {
    let Some(error) = error else {
        return vec![String::new(); error_columns("").len()];
    };
    let mut fields = vec![error.answers.to_string()];
    for figure in [
        Some(error.median_abs),
        Some(error.bias),
        error.outward_bias,
        error.spread,
    ] {
        fields.extend(figure_fields(figure));
    }
    fields.push(u8::from(error.rough).to_string());
    fields
}

fn figure_fields(figure: Option<Figure>) -> [String; 3] {
    let told = |deg: f64| format!("{deg:.4}");
    let interval = figure.and_then(|figure| figure.interval_deg);
    let end = |index: usize| interval.map(|ends| told(ends[index]));
    [figure.map(|figure| told(figure.deg)), end(0), end(1)].map(Option::unwrap_or_default)
}

/// Writes the report; columns as in [`columns`].
///
/// # Errors
/// Those of `out`.
pub fn write_csv(report: &LocaliseReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(columns())?;
    for open in &report.open {
        for (kind, directions) in [("open", &open.azimuths), ("alike", &open.alike)] {
            for at in directions {
                writer.write_record(open_record(report, open, kind, at))?;
            }
        }
    }
    for scene in &report.scenes {
        for cell in &scene.cells {
            writer.write_record(cell_record(report, &scene.scene, cell))?;
        }
    }
    writer.flush()
}

fn open_record(
    report: &LocaliseReport,
    open: &OpenReport,
    kind: &str,
    at: &OpenDirection,
) -> Vec<String> {
    let sound = report.scenes.first().and_then(|scene| scene.cells.first());
    let scene = match open.ground {
        true => "open-field",
        false => "open-field without ground",
    };
    let heard = at.error.map_or(0, |error| error.answers);
    let unheard = 1.0 - heard as f64 / f64::from(report.seeds.max(1));
    let mut record = vec![
        kind.to_owned(),
        scene.to_owned(),
        sound.map(|cell| csv_cell(&cell.sound)).unwrap_or_default(),
        open.profile.clone(),
        open.waves.to_string(),
        open.iterations.to_string(),
        at.azimuth_deg.to_string(),
        at.elevation_deg.to_string(),
        report.seeds.to_string(),
        format!("{unheard:.5}"),
        String::new(),
        at.answer_deg
            .map(|deg| format!("{deg:.4}"))
            .unwrap_or_default(),
    ];
    record.extend(error_fields(at.error.as_ref()));
    record.extend(error_fields(None));
    record.extend(error_fields(at.blind.as_ref()));
    // No confusion, no share.
    record.resize(columns().len() - 1, String::new());
    record.push(report.renderer.clone());
    record
}

fn cell_record(report: &LocaliseReport, scene: &str, cell: &Cell) -> Vec<String> {
    let mut record = vec![
        "room".to_owned(),
        csv_cell(scene),
        csv_cell(&cell.sound),
        cell.profile.clone(),
        cell.waves.to_string(),
        cell.iterations.to_string(),
        String::new(),
        String::new(),
        cell.trials.to_string(),
        format!("{:.5}", cell.unheard),
        format!("{:.2}", cell.hits),
        String::new(),
    ];
    record.extend(error_fields(cell.source.as_ref()));
    record.extend(error_fields(cell.limit.as_ref()));
    record.extend(error_fields(None));
    record.extend(cell.confusion.iter().flatten().map(u32::to_string));
    let right = cell.side_right;
    let right = right.map(|of| [of.share, of.interval[0], of.interval[1]]);
    let told = right.map(|of| of.map(|share| format!("{share:.5}")));
    record.extend(told.unwrap_or_default());
    record.push(report.renderer.clone());
    record
}

/// The first line of a score; names and counts are empty for all.
pub fn score_columns() -> Vec<String> {
    let mut columns: Vec<String> = [
        "scene",
        "sound",
        "law",
        "profile",
        "waves",
        "iterations",
        "heard",
        "answers",
        "people",
    ]
    .map(Into::into)
    .to_vec();
    columns.extend(error_columns("source"));
    columns.extend(error_columns("observer"));
    for side in SIDES {
        columns.extend(SIDES.map(|said| format!("said_{said}_when_{side}")));
    }
    columns.extend(["side_is_clicked", "clicked_behind", "confidence"].map(Into::into));
    columns
}

/// Writes a score; columns as in [`score_columns`].
///
/// # Errors
/// Those of `out`.
pub fn write_score_csv(report: &ScoreReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(score_columns())?;
    for group in &report.groups {
        writer.write_record(group_record(group))?;
    }
    writer.flush()
}

fn group_record(group: &Group) -> Vec<String> {
    let number = |number: Option<u32>| number.map(|n| n.to_string()).unwrap_or_default();
    let mut record = vec![
        csv_cell(&group.scene),
        csv_cell(&group.sound),
        csv_cell(&group.law),
        csv_cell(&group.profile),
        number(group.waves),
        number(group.iterations),
        group.heard.to_string(),
        group.answers.to_string(),
        group.people.to_string(),
    ];
    record.extend(error_fields(group.source.as_ref()));
    record.extend(error_fields(group.observer.as_ref()));
    record.extend(group.confusion.iter().flatten().map(u32::to_string));
    let shares = [group.side_is_clicked, group.clicked_behind];
    record.extend(shares.map(|share| format!("{share:.5}")));
    record.push(format!("{:.2}", group.confidence));
    record
}
