//! The columns of the report on the observer model, and of the report on people.

use super::report::{Cell as RoomCell, LocaliseReport, OpenDirection, OpenReport};
use super::score::Group;
use super::statistics::{ErrorFigures, Figure, Share};
use crate::columns;
use crate::report::{Cell, Column, Row};

/// The names of the sides, for sources and for answers.
const SIDES: [&str; 3] = ["left", "centre", "right"];
const SAID: [&str; 4] = ["left", "centre", "right", "nothing"];

/// One line of the report on the observer model: a direction in the open, or a sound and setting in a room. Angles are
/// in degrees, positive to the right. In CSV and JSON, shares are numbers from 0 to 1.
#[derive(Default)]
pub(super) struct Line<'a> {
    /// `open` (all around the listener), `alike` (three sources with the same levels) or `room`.
    kind: &'static str,
    scene: &'a str,
    sound: Option<&'a str>,
    profile: &'a str,
    waves: u32,
    iterations: u32,
    azimuth: Option<f64>,
    elevation: Option<f64>,
    trials: u32,
    unheard: f64,
    hits: Option<f64>,
    mean_answer: Option<f64>,
    source: Option<ErrorFigures>,
    limit: Option<ErrorFigures>,
    blind: Option<ErrorFigures>,
    confusion: Option<[[u32; 4]; 3]>,
    side_right: Option<Share>,
    renderer: &'a str,
}

impl<'a> Line<'a> {
    pub fn open(
        report: &'a LocaliseReport,
        open: &'a OpenReport,
        kind: &'static str,
        at: &OpenDirection,
    ) -> Line<'a> {
        let first = report.scenes.first().and_then(|scene| scene.cells.first());
        let heard = at.error.map_or(0, |error| error.answers);
        Line {
            kind,
            scene: match open.ground {
                true => "open-field",
                false => "open-field without ground",
            },
            sound: first.map(|cell| cell.sound.as_str()),
            profile: &open.profile,
            waves: open.waves,
            iterations: open.iterations,
            azimuth: Some(at.azimuth_deg),
            elevation: Some(at.elevation_deg),
            trials: report.seeds,
            unheard: 1.0 - heard as f64 / f64::from(report.seeds.max(1)),
            mean_answer: at.answer_deg,
            source: at.error,
            blind: at.blind,
            renderer: &report.renderer,
            ..Line::default()
        }
    }

    pub fn room(report: &'a LocaliseReport, scene: &'a str, cell: &'a RoomCell) -> Line<'a> {
        Line {
            kind: "room",
            scene,
            sound: Some(&cell.sound),
            profile: &cell.profile,
            waves: cell.waves,
            iterations: cell.iterations,
            trials: cell.trials,
            unheard: cell.unheard,
            hits: Some(cell.hits),
            source: cell.source,
            limit: cell.limit,
            confusion: Some(cell.confusion),
            side_right: cell.side_right,
            renderer: &report.renderer,
            ..Line::default()
        }
    }
}

impl Row for Line<'_> {
    fn columns() -> Vec<Column<Self>> {
        let side_right = |line: &Line| {
            line.side_right.map(|of| Cell::Interval {
                value: of.share,
                ends: Some(of.interval),
                rough: false,
            })
        };
        let source = ["error from source", "bias", "outward bias", "spread"];
        let limit = ["error from limit", "bias"];
        columns! { line: Line;
            ("kind") => line.kind;
            ("scene") => line.scene;
            ("sound") => line.sound;
            ("profile", "profile") => line.profile, text();
            ("waves", "waves") => line.waves;
            ("iterations", "it.") => line.iterations;
            ("azimuth") => line.azimuth;
            ("elevation") => line.elevation;
            ("trials") => line.trials;
            ("unheard", "unheard") => line.unheard, percent(0);
            ("hits", "hits") => line.hits, fixed(1);
            ("mean_answer") => line.mean_answer;
            ..errors("source", &source, |line: &Line| line.source);
            ..errors("limit", &limit, |line: &Line| line.limit);
            ..errors("blind", &[], |line: &Line| line.blind);
            ..confusion(SAID, "left said L/C/R/–", |line: &Line| line.confusion);
            ("side_right", "side right") => side_right(line), interval().percent(0);
            ("renderer") => line.renderer;
        }
    }
}

/// A cell for a figure with its interval.
pub(super) fn figure(figure: Option<Figure>, rough: bool) -> Cell {
    figure.map_or(Cell::None, |figure| Cell::Interval {
        value: figure.deg,
        ends: figure.interval_deg,
        rough,
    })
}

/// A figure of errors: its name, whether it is signed, and the function that returns its value.
type Pick = (&'static str, bool, fn(&ErrorFigures) -> Option<Figure>);

const FIGURES: [Pick; 4] = [
    ("median_abs", false, |error| Some(error.median_abs)),
    ("bias", true, |error| Some(error.bias)),
    ("outward_bias", true, |error| error.outward_bias),
    ("spread", false, |error| error.spread),
];

/// The columns of errors. Tables for people have one column per figure. `…_rough` is 1 if the intervals are computed
/// from too few answers to be 95 % intervals.
fn errors<R>(
    of: &str,
    headings: &[&str],
    errors: impl Fn(&R) -> Option<ErrorFigures> + Copy + 'static,
) -> Vec<Column<R>> {
    let answers = move |row: &R| errors(row).map(|error| error.answers);
    let mut columns = vec![Column::for_programs(&format!("{of}_answers"), answers)];
    for (index, (name, has_sign, pick)) in FIGURES.into_iter().enumerate() {
        let name = format!("{of}_{name}");
        let cell = move |row: &R| {
            let error = errors(row);
            error.map(|error| figure(pick(&error), error.rough))
        };
        let column = match headings.get(index) {
            Some(heading) => Column::new(&name, heading, cell),
            None => Column::for_programs(&name, cell),
        };
        let column = column.interval();
        columns.push(match has_sign {
            true => column.signed(1),
            false => column.fixed(1),
        });
    }
    let rough = move |row: &R| errors(row).map(|error| u8::from(error.rough));
    columns.push(Column::for_programs(&format!("{of}_rough"), rough));
    columns
}

/// The columns of a confusion table, which counts trials. CSV and JSON have one column per pair of sides
/// (`said_right_when_left` and so on). Tables for people have one column per side of the source.
fn confusion<R, const N: usize>(
    said: [&str; N],
    first: &str,
    counts: impl Fn(&R) -> Option<[[u32; N]; 3]> + Copy + 'static,
) -> Vec<Column<R>> {
    let mut columns = Vec::new();
    for (side, name) in SIDES.into_iter().enumerate() {
        for (said, what) in said.into_iter().enumerate() {
            let cell = move |row: &R| counts(row).map(|counts| counts[side][said]);
            columns.push(Column::for_programs(
                &format!("said_{what}_when_{name}"),
                cell,
            ));
        }
    }
    for (side, name) in SIDES.into_iter().enumerate() {
        let heading = if side == 0 { first } else { name };
        let cell = move |row: &R| {
            let counts = counts(row)?[side].map(|count| count.to_string());
            Some(counts.join("/"))
        };
        columns.push(Column::for_people(heading, cell));
    }
    columns
}

/// A property that distinguishes groups: its name, its heading, and the function that returns its value. The value is
/// empty in a group over all values.
type Kind = (&'static str, &'static str, fn(&Group) -> Cell);

const KINDS: [Kind; 6] = [
    ("scene", "scene", |group| named(&group.scene)),
    ("sound", "sound", |group| named(&group.sound)),
    ("law", "law", |group| named(&group.law)),
    ("profile", "profile", |group| named(&group.profile)),
    ("waves", "waves", |group| group.waves.into()),
    ("iterations", "it.", |group| group.iterations.into()),
];

fn named(name: &str) -> Cell {
    match name {
        "" => Cell::None,
        name => name.into(),
    }
}

impl Row for &Group {
    fn columns() -> Vec<Column<Self>> {
        let mut columns = Vec::new();
        for (name, _, of) in KINDS {
            columns.push(Column::for_programs(name, move |group: &&Group| of(group)));
        }
        for (_, heading, of) in KINDS {
            let cell = move |group: &&Group| match of(group) {
                Cell::None if group.heard => "all".into(),
                Cell::None => "silent".into(),
                cell => cell,
            };
            columns.push(Column::for_people(heading, cell).text());
        }
        let source = ["error from source", "bias", "outward bias"];
        columns.extend(columns! { group: &Group;
            ("heard") => group.heard;
            ("answers", "answers") => group.answers;
            ("people", "people") => group.people;
            ..errors("source", &source, |group: &&Group| group.source);
            (_, "spread") => spread(group), fixed(1);
            ..errors("observer", &["error from observer"], |group: &&Group| group.observer);
            ..confusion(SIDES, "left said L/C/R", |group: &&Group| Some(group.confusion));
            ("side_is_clicked") => group.side_is_clicked;
            ("clicked_behind", "clicked behind") => group.clicked_behind, percent(0);
            ("confidence", "confidence") => group.confidence, fixed(1);
        });
        columns
    }
}

/// The spread of people's answers; empty if too few people answered for a confidence interval.
fn spread(group: &Group) -> Cell {
    let error = group.source.as_ref();
    let spread = error.and_then(|error| error.spread);
    figure(spread.filter(|spread| spread.interval_deg.is_some()), false)
}
