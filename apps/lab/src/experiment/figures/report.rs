//! The four tables as a report.

use super::plot::plot_svg;
use super::{FigureRow, FigureTable, FiguresReport};
use crate::columns;
use crate::report::{Column, Document, PlotError, Report, Row, Table};

const LEGEND: &str = "init to read: median times of the parts of a frame; frame: of the whole frame. hits: \
    waves that reached the listener. zero: share of all iterations that end at distance 0. step \
    limit: marches that reached the step limit. se: difference of the hits from the thesis' in standard \
    errors, √(ours + thesis).";

/// A row of the report, with its table.
struct Line<'a> {
    report: &'a FiguresReport,
    table: &'a FigureTable,
    row: &'a FigureRow,
}

impl Row for Line<'_> {
    fn columns() -> Vec<Column<Self>> {
        columns! { line: Line;
            ("figure") => line.table.figure;
            ("scene") => line.table.scene;
            ("iterations") => line.table.iterations;
            ("profile", "profile") => &line.row.profile, text();
            ("waves", "waves") => line.row.waves;
            ("initialise_ms", "init") => line.row.milliseconds.initialise, unit("ms").fixed(2);
            ("march_ms", "march") => line.row.milliseconds.march, unit("ms").fixed(2);
            ("pan_ms", "pan") => line.row.milliseconds.pan, unit("ms").fixed(2);
            ("read_back_ms", "read") => line.row.milliseconds.read_back, unit("ms").fixed(2);
            ("total_ms", "frame") => line.row.milliseconds.total, unit("ms").fixed(2);
            ("listener_hits", "hits") => line.row.counts.listener_hits;
            ("dead", "dead") => line.row.counts.dead;
            ("travelling", "travelling") => line.row.counts.travelling;
            ("zero_length_passes") => line.row.counts.zero_length_passes;
            ("zero_length_share", "not moved") => line.row.zero_length_share, percent(1);
            ("step_limit_reached", "step limit") => line.row.counts.step_limit_reached;
            ("pan") => line.row.pan;
            ("thesis_mobile_ms", "printed mobile") => line.row.thesis.mobile_ms, unit("ms").fixed(2);
            ("thesis_desktop_ms", "printed desktop") => line.row.thesis.desktop_ms, unit("ms").fixed(2);
            ("thesis_listener_hits", "printed hits") => line.row.thesis.listener_hits;
            ("standard_errors", "se") => line.row.standard_errors(), signed(1);
            ("renderer") => &line.report.renderer;
            ("clock") => &line.report.clock;
        }
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
