//! The report as a document for people.

use super::columns::{Line, figure};
use super::plot::plot_svg;
use super::report::{
    FacingReport, LimitReport, LocaliseReport, OpenDirection, OpenReport, Plateau, SceneReport,
};
use super::report_contents::{first_sound, shown_plateaus};
use super::score::{ScoreReport, SessionLine};
use super::statistics::{ErrorFigures, Figure, LEAST_DRAWN};
use super::{AUDIBLE_DEG, MOST_WORK};
use crate::columns;
use crate::experiment::{THESIS_TABLES, ThesisTable, WAVE_COUNTS};
use crate::report::{Cell, Column, Document, PlotError, Report, Row, Table};
use echomarch::tracer::Profile;

impl Report for LocaliseReport {
    const NAME: &'static str = "localise";
    const HAS_PLOT: bool = true;

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.heading(1, "Localisation by an observer");
        document.paragraph(format!(
            "{}, panning law {}, {} seeds for each setting and facing, {:.0} s. Angles are in \
             degrees, positive to the right; errors are medians of the absolute errors. Intervals: \
             percentile bootstrap, {} resamples, {}. The centre reaches to {}° on either side. \
             Trials in which no wave is heard are in no error.",
            self.renderer,
            self.law,
            self.seeds,
            self.seconds,
            self.resamples,
            intervals(self),
            self.centre_deg
        ));
        tell_left_out(self, &mut document);
        tell_open(self, &mut document);
        for scene in &self.scenes {
            tell_scene(self, scene, &mut document);
        }
        tell_plateaus(self, &mut document);
        tell_unheard(self, &mut document);
        tell_limits_of_levels(self, &mut document);
        document
    }

    fn table(&self) -> Table {
        let mut lines = Vec::new();
        for open in &self.open {
            for (kind, directions) in [("open", &open.azimuths), ("alike", &open.alike)] {
                lines.extend(directions.iter().map(|at| Line::open(self, open, kind, at)));
            }
        }
        for scene in &self.scenes {
            let cells = scene.cells.iter();
            lines.extend(cells.map(|cell| Line::room(self, &scene.scene, cell)));
        }
        Table::of(lines)
    }

    fn plot_svg(&self) -> Result<String, PlotError> {
        plot_svg(self)
    }
}

/// Describes the confidence intervals.
fn intervals(report: &LocaliseReport) -> String {
    match report.rough {
        true => format!("rough: fewer than {LEAST_DRAWN} seeds"),
        false => format!(
            "{:.0} % (~: rough, fewer than {LEAST_DRAWN} heard answers per truth)",
            100.0 * report.confidence
        ),
    }
}

fn tell_left_out(report: &LocaliseReport, document: &mut Document) {
    if report.left_out.is_empty() {
        return;
    }
    let told = |&(waves, iterations): &(u32, u32)| format!("{waves} × {iterations}");
    let told: Vec<String> = report.left_out.iter().map(told).collect();
    document.paragraph(format!(
        "Omitted, because they have more than {MOST_WORK} waves × iterations: {}.",
        told.join(", ")
    ));
}

fn tell_open(report: &LocaliseReport, document: &mut Document) {
    document.heading(2, "In the open");
    document.paragraph(
        "The source is placed around the listener of open-field. With 1 iteration only the direct path \
         is heard; with more iterations the ground is also heard, from below, if there is one. The \
         observer knows the distance of the source, which no person does. The blind observer does not \
         know it, and assumes a distant source.",
    );
    document.table(&report.open);
    document.paragraph(
        "Ahead, behind and above: three sources 30° from the median plane, and the mean answers to \
         them.",
    );
    let alike = report.open.iter().flat_map(|open| {
        let directions = open.alike.iter();
        directions.map(move |at| Alike { open, at })
    });
    document.table(alike);
}

impl Row for &OpenReport {
    fn columns() -> Vec<Column<Self>> {
        type Pick = fn(&ErrorFigures) -> Option<Figure>;
        fn error(of: Option<&ErrorFigures>, pick: Pick) -> Cell {
            of.map_or(Cell::None, |error| figure(pick(error), error.rough))
        }
        columns! { open: &OpenReport;
            (_, "profile") => &open.profile, text();
            (_, "waves") => open.waves;
            (_, "it.") => open.iterations;
            (_, "ground") => open.ground;
            (_, "distance") => open.distance_m, unit("m");
            (_, "m") => open.mean_side, fixed(4);
            (_, "azimuths") => open.azimuths.len();
            (_, "error") => error(open.all.as_ref(), |of| Some(of.median_abs)), fixed(2);
            (_, "outward bias") => error(open.all.as_ref(), |of| of.outward_bias), signed(2);
            (_, "spread") => error(open.all.as_ref(), |of| of.spread), fixed(2);
            (_, "worst azimuth") => worst_azimuth(open);
            (_, "blind m") => open.blind_mean_side, fixed(4);
            (_, "blind error") => error(open.blind.as_ref(), |of| Some(of.median_abs)), fixed(1);
            (_, "blind outward bias") => error(open.blind.as_ref(), |of| of.outward_bias), signed(1);
        }
    }
}

fn worst_azimuth(open: &OpenReport) -> Option<String> {
    let median = |at: &OpenDirection| Some((at.error?.median_abs.deg, at.azimuth_deg));
    let medians = open.azimuths.iter().filter_map(median);
    let (error, at) = medians.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!("{error:.2} at {at}"))
}

/// One of three sources with the same levels.
struct Alike<'a> {
    open: &'a OpenReport,
    at: &'a OpenDirection,
}

impl Row for Alike<'_> {
    fn columns() -> Vec<Column<Self>> {
        let spread = |alike: &Alike| {
            let error = alike.at.error?;
            Some(error.spread?.deg)
        };
        columns! { alike: Alike;
            (_, "profile") => &alike.open.profile, text();
            (_, "it.") => alike.open.iterations;
            (_, "ground") => alike.open.ground;
            (_, "azimuth") => alike.at.azimuth_deg, signed(0);
            (_, "height") => alike.at.elevation_deg, signed(0);
            (_, "lateral") => alike.at.lateral_deg, signed(1);
            (_, "answer") => alike.at.answer_deg, signed(1);
            (_, "spread") => spread(alike), fixed(1);
        }
    }
}

fn tell_scene(report: &LocaliseReport, scene: &SceneReport, document: &mut Document) {
    document.heading(2, &scene.scene);
    document.paragraph(format!(
        "Source {:.2} m away, listener {:.2} m in radius, m = {:.4}. The converged panning of \
         hybrid, by facing:",
        scene.distance_m, scene.radius_m, scene.mean_side
    ));
    let limits = scene.facings.iter().flat_map(|facing| {
        let limits = facing.limits.iter();
        limits.map(move |limit| FacingLimit { facing, limit })
    });
    document.table(limits);
    document.paragraph(
        "The first sound, all facings; said L/C/R/–: left, centre, right, nothing heard:",
    );
    document.table(first_sound(scene).map(|cell| Line::room(report, &scene.scene, cell)));
}

/// The converged panning for one facing of the listener.
struct FacingLimit<'a> {
    facing: &'a FacingReport,
    limit: &'a LimitReport,
}

impl Row for FacingLimit<'_> {
    fn columns() -> Vec<Column<Self>> {
        fn heard(limit: &LimitReport, value: f64) -> Option<f64> {
            (limit.heard > 0.0).then_some(value)
        }
        columns! { row: FacingLimit;
            (_, "source at") => row.facing.azimuth_deg, signed(1);
            (_, "lateral") => row.facing.lateral_deg, signed(1);
            (_, "it.") => row.limit.iterations;
            (_, "pan") => heard(row.limit, row.limit.pan), signed(4);
            (_, "±") => heard(row.limit, row.limit.uncertainty), fixed(4);
            (_, "heard") => row.limit.heard, percent(4);
            (_, "answer") => heard(row.limit, row.limit.lateral_deg), signed(1);
        }
    }
}

fn tell_plateaus(report: &LocaliseReport, document: &mut Document) {
    document.heading(2, "Where more stops helping");
    document.paragraph(format!(
        "From: the smallest count from which on the figure is within the upper end of the interval at \
         the largest count, or within {AUDIBLE_DEG}° of the figure there, which is the smallest angle \
         that people notice ahead (Mills 1958). \"Not by\": only the largest count itself satisfies \
         this, so a larger count may be better. A count at which half of the trials hear nothing does \
         not qualify. Least: the count with the smallest figure. The table shows the first sound; the \
         JSON file has all sounds."
    ));
    document.table(shown_plateaus(report));
}

impl Row for &Plateau {
    fn columns() -> Vec<Column<Self>> {
        let of = |plateau: &&Plateau| match plateau.of {
            "spread" => "spread".to_owned(),
            truth => format!("error from {truth}"),
        };
        let with = |plateau: &&Plateau| match plateau.along {
            "waves" => format!("{} iterations", plateau.fixed),
            _ => format!("{} waves", plateau.fixed),
        };
        columns! { plateau: &Plateau;
            (_, "scene") => &plateau.scene, text();
            (_, "of") => of(plateau), text();
            (_, "along") => plateau.along, text();
            (_, "with") => with(plateau), text();
            (_, "profile") => &plateau.profile, text();
            (_, "from") => plateau.told();
            (_, "least") => plateau.least;
            (_, "of counts to") => plateau.largest;
            (_, "there") => figure(plateau.there, false), fixed(1);
        }
    }
}

/// Explains trials without arrivals: their sound is in the middle, wherever the source is.
fn tell_unheard(report: &LocaliseReport, document: &mut Document) {
    document.heading(2, "What is heard at all");
    document.paragraph(
        "The mean number of waves that arrive in a trial, and the share of trials in which none \
         arrives. The sound of such a trial is in the middle, wherever the source is. Printed: figures \
         11.1 to 11.4 of the thesis.",
    );
    let mut rows = Vec::new();
    for table in &THESIS_TABLES {
        let of_table = |scene: &&SceneReport| scene.scene == table.scene;
        if let Some(scene) = report.scenes.iter().find(of_table) {
            rows.extend(arrivals(table, scene));
        }
    }
    document.table(rows);
}

/// The number of arriving waves, compared with a row of the thesis.
struct Arrivals {
    table: &'static ThesisTable,
    waves: u32,
    printed: u64,
    /// The counts, in the order of [`Profile::ALL`].
    heard: [Option<String>; 3],
}

fn arrivals(table: &'static ThesisTable, scene: &SceneReport) -> impl Iterator<Item = Arrivals> {
    let rows = WAVE_COUNTS.into_iter().zip(&table.rows);
    let rows = rows.map(move |(waves, row)| Arrivals {
        table,
        waves,
        printed: row.listener_hits,
        heard: Profile::ALL.map(|profile| {
            let mut cells = first_sound(scene);
            let cell = cells.find(|cell| {
                (cell.waves, cell.iterations) == (waves, table.iterations)
                    && cell.profile == profile.to_string()
            })?;
            Some(match cell.unheard {
                0.0 => format!("{:.1}", cell.hits),
                share => format!("{:.1} (none in {:.0} %)", cell.hits, 100.0 * share),
            })
        }),
    });
    rows.filter(|row| row.heard.iter().any(Option::is_some))
}

impl Row for Arrivals {
    fn columns() -> Vec<Column<Self>> {
        let mut columns = columns! { row: Arrivals;
            (_, "scene") => row.table.scene, text();
            (_, "it.") => row.table.iterations;
            (_, "waves") => row.waves;
            (_, "printed") => row.printed;
        };
        for (index, profile) in Profile::ALL.into_iter().enumerate().rev() {
            let heard = move |row: &Arrivals| row.heard[index].clone();
            columns.push(Column::for_people(&profile.to_string(), heard));
        }
        columns
    }
}

fn tell_limits_of_levels(report: &LocaliseReport, document: &mut Document) {
    document.heading(2, "What levels cannot distinguish");
    document.list(vec![
        "Front from back, and above from the height of the ears: the answers are the same (see above). \
         Truths and answers are lateral angles, folded to the front."
            .to_owned(),
        format!(
            "One sound from another: the answers differ by at most {:.1e}°, because the gains \
             are the same at every frequency.",
            report.largest_difference_of_sounds_deg
        ),
        "A source in the middle from silence: if no wave arrives, the sound continues in the \
         middle."
            .to_owned(),
        "The position of a hidden source: its sound arrives from openings and walls. The difference \
         between the converged panning of hybrid and the source is a property of the panning, and not \
         caused by too few waves."
            .to_owned(),
    ]);
}

impl Report for ScoreReport {
    const NAME: &'static str = "score";

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.table(&self.sessions);
        if self.groups.is_empty() {
            document.paragraph("No trial is answered.");
            return document;
        }
        document.table(&self.groups);
        document.paragraph(format!(
            "Errors: median absolute error, in degrees, of the click's azimuth folded to the front, \
             with its 95 % interval from a bootstrap over people. The interval and the spread need \
             {LEAST_DRAWN} people. Observer: the answers of the observer model to the levels of the \
             same sounds. Silent: no wave was heard, and the sound was in the middle."
        ));
        document
    }

    fn table(&self) -> Table {
        Table::of(&self.groups)
    }
}

impl Row for &SessionLine {
    fn columns() -> Vec<Column<Self>> {
        columns! { line: &SessionLine;
            (_, "session") => &line.session, text();
            (_, "participant") => &line.participant, text();
            (_, "form") => &line.experiment, text();
            (_, "answered") => line.answered;
            (_, "of") => line.trials;
        }
    }
}
