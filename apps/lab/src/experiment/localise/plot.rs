//! Plots the report: first the open field, then the errors of each room against waves and iterations. Each profile has
//! a colour, and bars show the confidence intervals of the medians. A point is hollow if at least half of its trials
//! hear nothing, and missing if all of them hear nothing.

use super::report::{Cell, LocaliseReport, SceneReport};
use super::report_contents::{first_sound, measured};
use super::statistics::{ErrorFigures, Figure, LEAST_DRAWN};
use crate::experiment::plot::{HYBRID, MARCH, Panel, Sheet, Stroke, THESIS, draw_legend};
use crate::report::PlotError;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

const SHEET: Sheet = Sheet {
    width: 1640,
    title_height: 48,
    row_height: 360,
};
/// Width of a row's plots in pixels; the legend fills the remaining width.
const PLOTS_WIDTH: u32 = 1230;

const COLOURS: [(&str, RGBColor); 3] = [("thesis", THESIS), ("march", MARCH), ("hybrid", HYBRID)];

/// The line style of a profile. All three profiles often have the same errors. The lines are therefore drawn over each
/// other in different widths: `march` wide, `hybrid` narrower, and `thesis` narrow and dashed. Points and bars are
/// placed side by side.
struct Look {
    profile: &'static str,
    /// Line width in pixels.
    width: u32,
    /// Lengths of a dash and of the following gap, in pixels.
    dash: Option<(i32, i32)>,
    /// Horizontal offset of points and bars, as a share of the panel's width.
    beside: f64,
}

/// The styles in drawing order: the lowest layer comes first.
const LOOKS: [Look; 3] = [
    Look {
        profile: "march",
        width: 9,
        dash: None,
        beside: -0.008,
    },
    Look {
        profile: "hybrid",
        width: 5,
        dash: None,
        beside: 0.008,
    },
    Look {
        profile: "thesis",
        width: 2,
        dash: Some((7, 7)),
        beside: 0.0,
    },
];

impl Look {
    /// The style of a profile; other names get a narrow solid line.
    fn of(profile: &str) -> &'static Look {
        const PLAIN: Look = Look {
            profile: "",
            width: 2,
            dash: None,
            beside: 0.0,
        };
        LOOKS
            .iter()
            .find(|look| look.profile == profile)
            .unwrap_or(&PLAIN)
    }
}
const GROUND: RGBColor = RGBColor(120, 120, 120);
const BARE: RGBColor = RGBColor(204, 121, 167);

/// Number of iterations in the panels along the number of waves. If it was not measured, the largest measured number is
/// used.
const ITERATIONS: u32 = 8;
/// Number of waves in the panels along the number of iterations. If it was not measured, the largest measured number is
/// used.
const WAVES: u32 = 65_536;

/// Share of unheard trials from which on a point is hollow.
const HOLLOW: f64 = 0.5;

/// A number of waves or iterations, or an azimuth, with the error there.
#[derive(Clone, Copy)]
struct Point {
    x: f64,
    /// `None` if nothing was heard, which leaves a gap in the line.
    error: Option<Figure>,
    is_hollow: bool,
}

impl Point {
    fn new(x: f64, error: Option<ErrorFigures>, unheard: f64) -> Point {
        let error = error.map(|error| error.median_abs);
        let is_hollow = unheard >= HOLLOW;
        Point {
            x,
            error,
            is_hollow,
        }
    }
}

/// A line of a panel, with its points.
struct Line {
    name: String,
    colour: RGBColor,
    /// Line width in pixels; `dash` as in [`LOOKS`].
    width: u32,
    dash: Option<(i32, i32)>,
    /// Horizontal offset of the points, as a share of the panel's width.
    beside: f64,
    points: Vec<Point>,
}

/// The report as an SVG plot.
///
/// # Errors
/// If drawing fails. The error contains the reason.
pub(super) fn plot_svg(report: &LocaliseReport) -> Result<String, PlotError> {
    let interval = match report.rough {
        true => format!("rough interval (fewer than {LEAST_DRAWN} seeds)"),
        false => format!("{:.0} % interval", 100.0 * report.confidence),
    };
    let title = format!(
        "Localisation by levels: median absolute error with its {interval}, {}",
        report.renderer
    );
    SHEET.svg(&title, 1 + report.scenes.len(), |rows| {
        plot_open(&rows[0], report)?;
        for (row, scene) in rows[1..].iter().zip(&report.scenes) {
            plot_scene(row, scene)?;
        }
        Ok(())
    })
}

fn plot_open(row: &Panel, report: &LocaliseReport) -> Result<(), PlotError> {
    let line = |open: &super::OpenReport| {
        let (heard, colour) = match (open.iterations, open.ground) {
            (1, _) => ("", colour(&open.profile)),
            (_, true) => (" with the ground", GROUND),
            (_, false) => (", more iterations, no ground", BARE),
        };
        // Further lines of the same profile have their own colour.
        let look = Look::of(if heard.is_empty() { &open.profile } else { "" });
        let points = open.azimuths.iter();
        let points = points.map(|at| Point::new(at.azimuth_deg, at.error, 0.0));
        Line {
            name: format!("{}, {} waves{heard}", open.profile, open.waves),
            colour,
            width: look.width,
            dash: look.dash,
            beside: look.beside,
            points: points.collect(),
        }
    };
    let lines: Vec<Line> = report.open.iter().map(line).collect();
    let caption = "open-field, the source around the listener";
    let axes = (
        "azimuth of the source, degrees",
        "error from source, degrees",
    );
    let (plot, legend) = row.split_horizontally(PLOTS_WIDTH);
    plot_lines(&plot, caption, axes, false, &lines)?;
    draw_legend(&legend, &entries(&lines))
}

fn plot_scene(row: &Panel, scene: &SceneReport) -> Result<(), PlotError> {
    let (Some(iterations), Some(waves)) = (
        measured(scene, ITERATIONS, |cell| cell.iterations),
        measured(scene, WAVES, |cell| cell.waves),
    ) else {
        return Ok(());
    };
    let (plots, legend) = row.split_horizontally(PLOTS_WIDTH);
    let panels = plots.split_evenly((1, 3));
    let name = &scene.scene;
    let by_waves = |error: fn(&Cell) -> Option<ErrorFigures>| {
        lines(scene, |cell| {
            let point = || Point::new(cell.waves.into(), error(cell), cell.unheard);
            (cell.iterations == iterations).then(point)
        })
    };
    let caption = format!("{name}, {iterations} iterations");
    let axes = ("waves", "error from limit, degrees");
    plot_lines(
        &panels[0],
        &caption,
        axes,
        true,
        &by_waves(|cell| cell.limit),
    )?;
    let axes = ("waves", "error from source, degrees");
    plot_lines(
        &panels[1],
        &caption,
        axes,
        true,
        &by_waves(|cell| cell.source),
    )?;
    let by_iterations = lines(scene, |cell| {
        let point = || Point::new(cell.iterations.into(), cell.source, cell.unheard);
        (cell.waves == waves).then(point)
    });
    let caption = format!("{name}, {waves} waves");
    let axes = ("iterations", "error from source, degrees");
    plot_lines(&panels[2], &caption, axes, true, &by_iterations)?;
    draw_legend(&legend, &entries(&by_iterations))
}

/// One line per profile through the cells that `pick` selects.
fn lines(scene: &SceneReport, pick: impl Fn(&Cell) -> Option<Point>) -> Vec<Line> {
    let line = |(name, colour): (&str, RGBColor)| Line {
        name: name.to_owned(),
        colour,
        width: Look::of(name).width,
        dash: Look::of(name).dash,
        beside: Look::of(name).beside,
        points: first_sound(scene)
            .filter(|cell| cell.profile == name)
            .filter_map(&pick)
            .collect(),
    };
    COLOURS.into_iter().map(line).collect()
}

/// The legend entries of the lines that have points.
fn entries(lines: &[Line]) -> Vec<(String, Stroke)> {
    let shown = lines.iter().filter(|line| !line.points.is_empty());
    let entry = |line: &Line| {
        let stroke = Stroke::new(line.colour, line.width, line.dash);
        (line.name.clone(), stroke)
    };
    shown.map(entry).collect()
}

/// Draws one panel. If `by_powers` is true, the x axis is logarithmic with one step per doubling.
fn plot_lines(
    panel: &Panel,
    caption: &str,
    (x_name, y_name): (&str, &str),
    by_powers: bool,
    lines: &[Line],
) -> Result<(), PlotError> {
    let place = |x: f64| if by_powers { x.log2() } else { x };
    let all = || lines.iter().flat_map(|line| &line.points);
    let (least, most) = all().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), point| (least.min(place(point.x)), most.max(place(point.x))),
    );
    if least > most {
        return Ok(());
    }
    let margin = (0.04 * (most - least)).max(0.1);
    let high = |error: Figure| error.interval_deg.map_or(error.deg, |[_, high]| high);
    let highest = all().filter_map(|point| point.error);
    let highest = highest.fold(1.0, |highest, error| f64::max(highest, high(error)));
    let mut chart = ChartBuilder::on(panel)
        .margin(12)
        .margin_right(22)
        .caption(caption, ("sans-serif", 16))
        .x_label_area_size(42)
        .y_label_area_size(52)
        .build_cartesian_2d(least - margin..most + margin, 0.0..1.08 * highest)?;
    let tick = |x: &f64| match by_powers {
        true if (x - x.round()).abs() < 1e-9 => format!("{}", x.exp2().round()),
        true => String::new(),
        false => format!("{x:.0}"),
    };
    chart
        .configure_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .x_labels(8)
        .x_label_formatter(&tick)
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(BLACK.mix(0.04))
        .draw()?;
    let mut shown: Vec<&Line> = lines
        .iter()
        .filter(|line| !line.points.is_empty())
        .collect();
    // A wide line is visible on both sides of a narrow line drawn over it, and every line is visible between dashes.
    shown.sort_by_key(|line| (line.dash.is_some(), std::cmp::Reverse(line.width)));
    for line in shown {
        let beside = line.beside * (most - least + 2.0 * margin);
        draw_line(&mut chart, line, |x| place(x) + beside)?;
    }
    Ok(())
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the medians as a line with gaps, and their confidence intervals as bars.
fn draw_line(chart: &mut Chart, line: &Line, place: impl Fn(f64) -> f64) -> Result<(), PlotError> {
    let (colour, width) = (line.colour, line.width);
    let stroke = colour.stroke_width(width);
    let spot = |point: &Point| Some((place(point.x), point.error?.deg));
    let joined = line.points.split(|point| point.error.is_none());
    let joined = joined.map(|points| points.iter().filter_map(spot).collect::<Vec<_>>());
    let joined = joined.filter(|points| points.len() > 1);
    for points in joined {
        match line.dash {
            None => chart.draw_series([PathElement::new(points, stroke)])?,
            Some((dash, gap)) => {
                chart.draw_series(DashedLineSeries::new(points, dash, gap, stroke))?
            }
        };
    }
    let dots = |hollow: bool| {
        let wanted = line
            .points
            .iter()
            .filter(move |point| point.is_hollow == hollow);
        wanted.filter_map(spot)
    };
    let full = dots(false).map(|at| Circle::new(at, 3, colour.filled()));
    chart.draw_series(full)?;
    let white = dots(true).map(|at| Circle::new(at, 4, WHITE.filled()));
    chart.draw_series(white)?;
    let ring = dots(true).map(|at| Circle::new(at, 4, colour.stroke_width(2)));
    chart.draw_series(ring)?;
    let bars = line.points.iter().filter_map(|point| {
        let [low, high] = point.error?.interval_deg?;
        let ends = [(place(point.x), low), (place(point.x), high)];
        Some(PathElement::new(ends, colour.mix(0.5).stroke_width(4)))
    });
    chart.draw_series(bars)?;
    Ok(())
}

fn colour(profile: &str) -> RGBColor {
    let known = COLOURS.iter().find(|(name, _)| *name == profile);
    known.map_or(GROUND, |(_, colour)| *colour)
}
