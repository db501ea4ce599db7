//! The four tables as a report.

use super::plot::plot_svg;
use super::{FigureRow, FigureTable, FiguresReport};
use crate::report::{Column, Document, PlotError, Report, Row, Table};

const LEGEND: &str = "init to read: median times of the parts of a frame; frame: of all of it. hits: \
    waves that reached the listener. zero: share of all iterations that end at distance 0. step \
    limit: marches that reached it. se: difference of the hits from the thesis' in standard \
    errors, √(ours + thesis).";

/// A row with its context.
struct Line<'a> {
    report: &'a FiguresReport,
    table: &'a FigureTable,
    row: &'a FigureRow,
}

impl Row for Line<'_> {
    fn columns() -> Vec<Column<Self>> {
        fn ms<'a>(name: &str, heading: &str, of: fn(&FigureRow) -> f64) -> Column<Line<'a>> {
            Column::new(name, heading, move |line: &Line| of(line.row))
                .unit("ms")
                .fixed(2)
        }
        fn count<'a>(name: &str, heading: &str, of: fn(&FigureRow) -> u64) -> Column<Line<'a>> {
            Column::new(name, heading, move |line: &Line| of(line.row))
        }
        vec![
            Column::for_programs("figure", |line: &Line| line.table.figure),
            Column::for_programs("scene", |line: &Line| line.table.scene),
            Column::for_programs("iterations", |line: &Line| line.table.iterations),
            Column::new("profile", "profile", |line: &Line| &line.row.profile).label(),
            Column::new("waves", "waves", |line: &Line| line.row.waves).key(),
            ms("initialise_ms", "init", |row| row.milliseconds.initialise),
            ms("march_ms", "march", |row| row.milliseconds.march),
            ms("pan_ms", "pan", |row| row.milliseconds.pan),
            ms("read_back_ms", "read", |row| row.milliseconds.read_back),
            ms("total_ms", "frame", |row| row.milliseconds.total),
            count("listener_hits", "hits", |row| row.counts.listener_hits),
            count("dead", "dead", |row| row.counts.dead),
            count("travelling", "travelling", |row| row.counts.travelling),
            Column::for_programs("zero_length_passes", |line: &Line| {
                line.row.counts.zero_length_passes
            }),
            Column::new("zero_length_share", "not moved", |line: &Line| {
                line.row.zero_length_share
            })
            .percent(1),
            count("step_limit_reached", "step limit", |row| {
                row.counts.step_limit_reached
            }),
            Column::for_programs("pan", |line: &Line| line.row.pan),
            ms("thesis_mobile_ms", "printed mobile", |row| {
                row.thesis.mobile_ms
            }),
            ms("thesis_desktop_ms", "printed desktop", |row| {
                row.thesis.desktop_ms
            }),
            count("thesis_listener_hits", "printed hits", |row| {
                row.thesis.listener_hits
            }),
            Column::new("standard_errors", "se", |line: &Line| {
                line.row.standard_errors()
            })
            .signed(1),
            Column::for_programs("renderer", |line: &Line| &line.report.renderer),
            Column::for_programs("clock", |line: &Line| &line.report.clock),
        ]
    }
}

impl FiguresReport {
    fn lines<'a>(&'a self, table: &'a FigureTable) -> impl Iterator<Item = Line<'a>> {
        table.rows.iter().map(move |row| Line {
            report: self,
            table,
            row,
        })
    }
}

impl Report for FiguresReport {
    const NAME: &'static str = "figures";
    const HAS_PLOT: bool = true;

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.heading(1, "Figures 11.1 to 11.4");
        document.paragraph(format!(
            "{} (times: {}, median of {}; seed {})",
            self.renderer, self.clock, self.runs, self.seed
        ));
        for table in &self.tables {
            document.heading(
                2,
                format!(
                    "Figure {}: {}, {} iterations",
                    table.figure, table.scene, table.iterations
                ),
            );
            document.table(self.lines(table));
        }
        document.paragraph(LEGEND);
        document
    }

    fn table(&self) -> Table {
        Table::of(self.tables.iter().flat_map(|table| self.lines(table)))
    }

    fn plot_svg(&self) -> Result<String, PlotError> {
        plot_svg(self)
    }
}
