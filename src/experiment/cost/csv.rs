//! The rows as CSV, a line a surface and a line an option.

use super::{Change, CostReport, Timing};
use crate::text::csv_cell;
use std::io::{self, Write};

/// The first line: times in milliseconds, shares in percent, levels in dB.
const COLUMNS: [&str; 24] = [
    "scene",
    "section",
    "name",
    "against",
    "march_base_ms",
    "march_changed_ms",
    "march_saved_ms",
    "march_saved_percent",
    "march_spread_ms",
    "march_beyond_noise",
    "total_base_ms",
    "total_changed_ms",
    "total_saved_ms",
    "total_saved_percent",
    "total_spread_ms",
    "total_beyond_noise",
    "met",
    "heard_percent",
    "heard_percent_rms",
    "pan",
    "pan_rms",
    "level_db",
    "level_db_rms",
    "within_noise",
];

/// One line, before it is written.
struct Line<'a> {
    section: &'a str,
    name: &'a str,
    against: &'a str,
    march: Option<&'a Timing>,
    total: Option<&'a Timing>,
    met: Option<u32>,
    change: Option<&'a Change>,
    within_noise: Option<bool>,
}

/// Writes the report; columns as named in its first line, empty where there is no figure. The
/// line `noise` has what another seed changes.
///
/// # Errors
/// Those of `out`.
pub fn write_csv(report: &CostReport, out: &mut dyn Write) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(COLUMNS)?;
    for line in lines(report) {
        writer.write_record(record(report, &line))?;
    }
    writer.flush()
}

fn lines(report: &CostReport) -> Vec<Line<'_>> {
    let control = Line {
        section: "noise",
        name: "everything, beside itself; another seed",
        against: "",
        march: Some(&report.control),
        total: Some(&report.control_total),
        met: None,
        change: None,
        within_noise: None,
    };
    let surfaces = report.surfaces.iter().map(|row| Line {
        section: "surface",
        name: &row.name,
        against: "",
        march: row.march.as_ref(),
        total: row.total.as_ref(),
        met: Some(row.met),
        change: row.change.as_ref(),
        within_noise: row
            .change
            .map(|_| row.verdict == super::Verdict::CanBeLeftOut),
    });
    let options = report.options.iter().map(|row| Line {
        section: "option",
        name: &row.name,
        against: &row.against,
        march: Some(&row.march),
        total: Some(&row.total),
        met: None,
        change: row.change.as_ref(),
        within_noise: row.change.map(|_| row.within_noise),
    });
    std::iter::once(control)
        .chain(surfaces)
        .chain(options)
        .collect()
}

fn record(report: &CostReport, line: &Line) -> Vec<String> {
    let mut cells = vec![
        csv_cell(&report.scene),
        line.section.to_owned(),
        csv_cell(line.name),
        csv_cell(line.against),
    ];
    cells.extend(times(line.march));
    cells.extend(times(line.total));
    cells.push(line.met.map_or(String::new(), |met| met.to_string()));
    match (line.section, line.change) {
        ("noise", _) => {
            let noise = &report.noise;
            let level = noise.level_db.map_or(String::new(), |db| db.to_string());
            let of = [
                noise.heard_percent.to_string(),
                noise.pan.to_string(),
                level,
            ];
            cells.extend(of.into_iter().flat_map(|rms| [String::new(), rms]));
        }
        (_, change) => cells.extend(changes(change)),
    }
    cells.push(line.within_noise.map_or(String::new(), |is| is.to_string()));
    cells
}

fn times(timing: Option<&Timing>) -> [String; 6] {
    timing.map_or_else(Default::default, |of| {
        [
            format!("{:.4}", of.base_ms),
            format!("{:.4}", of.changed_ms),
            format!("{:.4}", of.saved_ms),
            format!("{:.2}", of.saved_percent),
            format!("{:.4}", of.spread_ms),
            of.beyond_noise.to_string(),
        ]
    })
}

fn changes(change: Option<&Change>) -> [String; 6] {
    let sizes = [
        change.map(|c| c.heard_percent),
        change.map(|c| c.pan),
        change.and_then(|c| c.level_db),
    ];
    let mut cells: [String; 6] = Default::default();
    for (cells, size) in cells.as_chunks_mut::<2>().0.iter_mut().zip(sizes) {
        if let Some(size) = size {
            *cells = [size.mean.to_string(), size.rms.to_string()];
        }
    }
    cells
}
