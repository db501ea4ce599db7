//! Plots error against time: two plots with logarithmic axes for each scene, with a colour and a Pareto front for each
//! profile.

use super::recommend::{ITERATIONS, comparable, pareto_front};
use super::report::{AccuracyReport, Row, SceneReport};
use super::responses;
use crate::experiment::plot::{
    HYBRID, LogAxis, MARCH, Panel, Point, Sheet, Stroke, THESIS, chart, draw_legend, draw_line,
};
use crate::report::PlotError;
use echomarch::tracer::Profile;
use plotters::prelude::*;

const SHEET: Sheet = Sheet {
    width: 1280,
    title_height: 48,
    row_height: 460,
};
/// Width of a plot in pixels; the legend fills the remaining width.
const PLOT_WIDTH: u32 = 560;

const COLOURS: [(Profile, RGBColor); 3] = [
    (Profile::Thesis, THESIS),
    (Profile::March, MARCH),
    (Profile::Hybrid, HYBRID),
];
const FRONT: RGBColor = RGBColor(60, 60, 60);
const FRONT_LINE: Stroke = Stroke::solid(FRONT, 1);

/// The point of a row (milliseconds and error), and the radius of its dot. The radius depends on the number of waves.
type Dot = (Point, i32);

/// The report as an SVG picture: a row of two plots for each scene.
///
/// # Errors
/// If drawing fails. The error contains the reason.
pub(super) fn plot_svg(report: &AccuracyReport) -> Result<String, PlotError> {
    let title = format!(
        "Speed against error, {ITERATIONS} iterations, {} (larger dots: more waves)",
        report.renderer
    );
    let more = usize::from(!report.responses.is_empty());
    SHEET.svg(&title, (report.scenes.len() + more).max(1), |rows| {
        for (row, scene) in rows.iter().zip(&report.scenes) {
            let (left, rest) = row.split_horizontally(PLOT_WIDTH);
            let (right, legend) = rest.split_horizontally(PLOT_WIDTH);
            let what = format!("RMS panning error over {} seeds", report.seeds);
            plot(&left, scene, &what, |row| row.panning.rms)?;
            let what = "median end-point error, metres";
            plot(&right, scene, what, |row| row.waves.end.median)?;
            draw_legend(&legend, &entries())?;
        }
        if more > 0 {
            let (left, rest) = rows[report.scenes.len()].split_horizontally(PLOT_WIDTH);
            let (right, legend) = rest.split_horizontally(PLOT_WIDTH);
            responses::plot([&left, &right, &legend], report)?;
        }
        Ok(())
    })
}

/// The entries of the legend.
fn entries() -> Vec<(String, Stroke)> {
    let dot =
        |(profile, colour): (Profile, RGBColor)| (profile.to_string(), Stroke::solid(colour, 0));
    let mut all: Vec<(String, Stroke)> = COLOURS.into_iter().map(dot).collect();
    all.push(("Pareto front".to_owned(), FRONT_LINE));
    all
}

/// One plot with logarithmic axes.
fn plot(
    panel: &Panel,
    scene: &SceneReport,
    what: &str,
    error: impl Fn(&Row) -> f64,
) -> Result<(), PlotError> {
    let dots = COLOURS.map(|(profile, colour)| (colour, dots(scene, profile, &error)));
    let all: Vec<Point> = dots
        .iter()
        .flat_map(|of| of.1.iter().map(|dot| dot.0))
        .collect();
    let x = LogAxis::around(all.iter().map(|point| point.0));
    let y = LogAxis::around(all.iter().map(|point| point.1));
    let place = |point: Point| (point.0, y.place(point.1));
    let axes = ["milliseconds per frame", what];
    let mut chart = chart(panel, &scene.scene, [x, y], axes)?;
    let front = pareto_front(&all);
    let stairs = steps(&front, x.end()).into_iter().map(place).collect();
    draw_line(&mut chart, stairs, FRONT_LINE)?;
    for (colour, dots) in dots {
        let circle =
            |&(point, size): &Dot| Circle::new(place(point), size, colour.mix(0.75).filled());
        chart.draw_series(dots.iter().map(circle))?;
    }
    let ring = |&point: &Point| Circle::new(place(point), 9, FRONT.stroke_width(1));
    chart.draw_series(front.iter().map(ring))?;
    Ok(())
}

/// The points of the [`comparable`] rows of a profile. Rows without a time are excluded.
fn dots(scene: &SceneReport, profile: Profile, error: impl Fn(&Row) -> f64) -> Vec<Dot> {
    let name = profile.to_string();
    comparable(&scene.rows)
        .filter(|row| row.case.profile == name)
        .map(|row| ((row.speed.total_ms, error(row)), radius(row.case.waves)))
        .filter(|((time, error), _)| *time > 0.0 && error.is_finite())
        .collect()
}

/// Radius of a dot in pixels: 3 for 4096 waves, 1 more for each factor of four.
fn radius(waves: u32) -> i32 {
    ((f64::from(waves.max(1)).log2() - 6.0) / 2.0)
        .round()
        .clamp(2.0, 9.0) as i32
}

/// The Pareto front as steps: between two points, the earlier point is the best one available.
fn steps(front: &[Point], end: f64) -> Vec<Point> {
    let mut stairs = Vec::new();
    for (index, &point) in front.iter().enumerate() {
        let until = front.get(index + 1).map_or(end, |next| next.0);
        stairs.extend([point, (until, point.1)]);
    }
    stairs
}
