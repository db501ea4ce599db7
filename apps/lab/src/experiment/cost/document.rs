//! The report as a document: one table of all changes, and the conclusions.

use super::{Change, CostReport, Noise, OptionRow, ShaderReport, SurfaceRow, Timing, Verdict};
use crate::columns;
use crate::report::{Cell, Column, Document, Report, Row, Table};
use echomarch::internals::fields_cost::FieldsCost;

const LEGEND: &str = "\
    Each row changes one thing: a surface is left out, or an option is set. met: waves that meet \
    the surface. saves: the time of a frame that the change saves (negative: the change costs \
    time), as the median of the pairs ± half the distance between their quartiles; noise: within \
    the noise of the clock. heard: the change of the number of heard waves. level: the change at \
    the ear with the larger change (silence: one ear hears nothing). heard, pan and level are root \
    mean squares for a single frame. A change is inaudible if another seed changes all three as \
    much. Two surfaces or options that can each be left out alone may be audible together. \
    Absorption is ignored, because a frame carries no energy.";

/// A row of the table.
struct Line<'a> {
    scene: &'a str,
    section: &'static str,
    name: &'a str,
    march: Option<&'a Timing>,
    total: Option<&'a Timing>,
    met: Option<(u32, f64)>,
    heard: Heard<'a>,
    verdict: Option<Verdict>,
    leaves_cells: bool,
}

/// The audible effect in a row.
enum Heard<'a> {
    /// The audible effect of another seed.
    Noise(&'a Noise),
    /// The audible effect of a change; `None` if it cannot be estimated.
    Change(Option<&'a Change>),
}

impl<'a> Line<'a> {
    fn noise(report: &'a CostReport) -> Line<'a> {
        Line {
            scene: &report.scene,
            section: "noise",
            name: "complete scene, compared with itself and with another seed",
            march: Some(&report.control),
            total: Some(&report.control_total),
            met: None,
            heard: Heard::Noise(&report.noise),
            verdict: None,
            leaves_cells: false,
        }
    }

    fn surface(report: &'a CostReport, row: &'a SurfaceRow) -> Line<'a> {
        Line {
            section: "surface",
            name: &row.name,
            march: row.march.as_ref(),
            total: row.total.as_ref(),
            met: Some((row.met, row.met_percent)),
            heard: Heard::Change(row.change.as_ref()),
            verdict: Some(row.verdict),
            leaves_cells: row.leaves_cells,
            ..Line::noise(report)
        }
    }

    fn option(report: &'a CostReport, row: &'a OptionRow) -> Line<'a> {
        Line {
            section: "option",
            name: &row.name,
            march: Some(&row.march),
            total: Some(&row.total),
            heard: Heard::Change(row.change.as_ref()),
            verdict: Some(match (row.change, row.within_noise) {
                (None, _) => Verdict::NothingHeard,
                (Some(_), true) => Verdict::CanBeLeftOut,
                (Some(_), false) => Verdict::IsHeard,
            }),
            ..Line::noise(report)
        }
    }

    /// The change as text.
    fn change(&self) -> String {
        if self.verdict.is_none() {
            return "another seed".to_owned();
        }
        let star = if self.leaves_cells { " *" } else { "" };
        format!("{}{star}", self.name)
    }

    fn saves(&self) -> Option<String> {
        let time = self.total?;
        let percent = 100.0 * time.spread_ms / time.base_ms.max(f64::MIN_POSITIVE);
        Some(match (self.section, time.beyond_noise) {
            ("noise", _) => format!("± {:.0}", time.own_noise_percent()),
            (_, true) => format!("{:+.0} ± {percent:.0}", time.saved_percent),
            (_, false) => "noise".to_owned(),
        })
    }

    fn level(&self) -> Cell {
        match self.heard {
            Heard::Noise(noise) => noise.level_db.map_or("unbounded".into(), Cell::from),
            Heard::Change(None) => Cell::None,
            Heard::Change(Some(change)) => {
                let level = change.level_db;
                level.map_or("silence".into(), |level| level.rms.into())
            }
        }
    }

    fn said(&self) -> Option<&'static str> {
        Some(match (self.verdict?, self.section) {
            (Verdict::CanBeLeftOut, "surface") => "can be left out",
            (Verdict::CanBeLeftOut, _) => "not heard",
            (Verdict::IsHeard, _) => "heard",
            (Verdict::LeavesNothing, _) => "leaves no surface",
            (Verdict::NothingHeard, _) => "nothing is heard",
        })
    }

    /// Whether the change is within the noise; `None` if it cannot be estimated.
    fn within_noise(&self) -> Option<bool> {
        match self.heard {
            Heard::Change(Some(_)) => Some(self.verdict == Some(Verdict::CanBeLeftOut)),
            _ => None,
        }
    }
}

impl Row for Line<'_> {
    fn columns() -> Vec<Column<Self>> {
        columns! { line: Line;
            ("scene") => line.scene;
            ("section") => line.section;
            ("name") => line.name;
            (_, "changed") => line.change(), text();
            ..times("march", |line: &Line| line.march.copied());
            ..times("total", |line: &Line| line.total.copied());
            ("met") => line.met.map(|met| met.0);
            (_, "met") => line.met.map(|met| met.1), unit("%").fixed(1);
            (_, "saves") => line.saves(), unit("%");
            ..heard();
            ("within_noise") => line.within_noise();
            (_, "verdict") => line.said(), text();
        }
    }
}

fn times<R>(of: &str, timing: impl Fn(&R) -> Option<Timing> + Copy + 'static) -> Vec<Column<R>> {
    type Part = (&'static str, fn(Timing) -> Cell);
    const PARTS: [Part; 6] = [
        ("base_ms", |of| of.base_ms.into()),
        ("changed_ms", |of| of.changed_ms.into()),
        ("saved_ms", |of| of.saved_ms.into()),
        ("saved_percent", |of| of.saved_percent.into()),
        ("spread_ms", |of| of.spread_ms.into()),
        ("beyond_noise", |of| of.beyond_noise.into()),
    ];
    let column = |(name, part): Part| {
        Column::for_programs(&format!("{of}_{name}"), move |row: &R| {
            timing(row).map(part)
        })
    };
    PARTS.map(column).into()
}

/// The columns of the audible effect; noise has no mean.
fn heard<'a>() -> Vec<Column<Line<'a>>> {
    type OfChange = fn(&Change) -> Option<super::Size>;
    fn both(line: &Line, change: OfChange, noise: fn(&Noise) -> Option<f64>) -> [Cell; 2] {
        match line.heard {
            Heard::Noise(of) => [Cell::None, noise(of).into()],
            Heard::Change(of) => {
                let size = of.and_then(change);
                [size.map(|it| it.mean).into(), size.map(|it| it.rms).into()]
            }
        }
    }
    let percent = |line: &Line| {
        both(
            line,
            |it| Some(it.heard_percent),
            |it| Some(it.heard_percent),
        )
    };
    let pan = |line: &Line| both(line, |it| Some(it.pan), |it| Some(it.pan));
    let level = |line: &Line| both(line, |it| it.level_db, |it| it.level_db);
    let second = |[_, rms]: [Cell; 2]| rms;
    let first = |[mean, _]: [Cell; 2]| mean;
    columns! { line: Line;
        ("heard_percent") => first(percent(line));
        ("heard_percent_rms", "heard") => second(percent(line)), unit("%").fixed(1);
        ("pan") => first(pan(line));
        ("pan_rms", "pan") => second(pan(line)), fixed(3);
        ("level_db") => first(level(line));
        ("level_db_rms") => second(level(line));
        (_, "level") => line.level(), unit("dB").fixed(2);
    }
}

impl CostReport {
    fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        let surfaces = self.surfaces.iter().map(|row| Line::surface(self, row));
        let options = self.options.iter().map(|row| Line::option(self, row));
        let noise = std::iter::once(Line::noise(self));
        noise.chain(surfaces).chain(options)
    }
}

impl Report for CostReport {
    const NAME: &'static str = "cost";

    fn document(&self) -> Document {
        let mut document = Document::default();
        document.paragraph(format!(
            "{}: {} waves, {} iterations, profile {}, {} directions, seeds from {}. {} (times: {}, \
             median of {} pairs). With all surfaces a frame takes {:.2} ms, and {:.1} waves are heard.",
            self.scene,
            self.waves,
            self.iterations,
            self.profile,
            self.directions,
            self.seed,
            self.renderer,
            self.clock,
            self.runs,
            self.control_total.base_ms,
            self.noise.heard
        ));
        if let Some(fields) = &self.fields {
            document.paragraph(of_fields(fields));
        }
        document.table(self.lines());
        let mut legend = format!("{LEGEND} met is out of {} waves.", self.followed);
        if self.surfaces.iter().any(|row| row.leaves_cells) {
            legend += " *: without this surface the others are no longer in cells, but unrolled.";
        }
        document.paragraph(legend);
        document.paragraph(shader(&self.shader));
        document.paragraph(self.advice.join(" "));
        document
    }

    fn table(&self) -> Table {
        Table::of(self.lines())
    }
}

/// The cost of all marched surfaces together, with the spread of the pairs.
fn of_fields(fields: &FieldsCost) -> String {
    let surfaces = match fields.surfaces {
        1 => "1 marched surface".to_owned(),
        many => format!("{many} marched surfaces"),
    };
    format!(
        "{surfaces}: {fields} (± {:.0} % of a frame of \
         {:.2} ms).",
        fields.spread_percent, fields.frame_ms
    )
}

fn shader(shader: &ShaderReport) -> String {
    let features = shader.features.iter().map(|feature| {
        let name = &feature.name;
        match (feature.in_scene, feature.called_by.is_empty()) {
            (true, _) => name.clone(),
            (false, false) => format!("{name} (for {})", feature.called_by.join(", ")),
            (false, true) => format!("{name} (not in the scene!)"),
        }
    });
    let features: Vec<String> = features.collect();
    format!(
        "The shader of the march has {} lines in {} functions (of one plane: {} in {}), with {}.",
        shader.lines,
        shader.functions,
        shader.least_lines,
        shader.least_functions,
        features.join(", ")
    )
}
