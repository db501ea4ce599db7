//! Speed against error as one picture: two plots a scene, log-log, a colour a profile, and
//! the Pareto front of each.

use super::recommend::{ITERATIONS, comparable, pareto_front};
use super::report::{AccuracyReport, Row, SceneReport};
use crate::trace::Profile;
use plotters::coord::Shift;
use plotters::prelude::*;

type PlotError = Box<dyn std::error::Error + Send + Sync>;

const WIDTH: u32 = 1200;
const TITLE_HEIGHT: u32 = 48;
const ROW_HEIGHT: u32 = 460;

/// Told apart by colour-blind eyes too (Okabe and Ito).
const COLOURS: [(Profile, RGBColor); 3] = [
    (Profile::Thesis, RGBColor(213, 94, 0)),
    (Profile::March, RGBColor(0, 114, 178)),
    (Profile::Hybrid, RGBColor(0, 158, 115)),
];
const FRONT: RGBColor = RGBColor(60, 60, 60);

/// Milliseconds and error.
type Point = (f64, f64);

/// A row's point, and the radius that its number of waves is drawn with.
type Dot = (Point, i32);

/// The report as an SVG picture: a row of two plots for each scene.
///
/// # Errors
/// When the drawing fails, which its text says.
pub fn plot_svg(report: &AccuracyReport) -> Result<String, PlotError> {
    let mut svg = String::new();
    let rows = report.scenes.len().max(1);
    {
        let height = TITLE_HEIGHT + ROW_HEIGHT * rows as u32;
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let title = format!(
            "Speed against error, {ITERATIONS} iterations, {} (larger dots: more waves)",
            report.renderer
        );
        let body = root.titled(&title, ("sans-serif", 20))?;
        let panels = body.split_evenly((rows, 2));
        for (index, scene) in report.scenes.iter().enumerate() {
            let seeds = report.seeds;
            let what = format!("RMS panning error over {seeds} seeds");
            let corner = SeriesLabelPosition::LowerLeft;
            plot(&panels[2 * index], scene, &what, corner, |row| {
                row.panning.rms
            })?;
            let what = "median end-point error, metres";
            let middle = SeriesLabelPosition::MiddleLeft;
            plot(&panels[2 * index + 1], scene, what, middle, |row| {
                row.waves.end.median
            })?;
        }
        root.present()?;
    }
    Ok(svg)
}

/// One log-log plot. A logarithm has no zero: such points are left out.
fn plot(
    panel: &DrawingArea<SVGBackend, Shift>,
    scene: &SceneReport,
    what: &str,
    legend: SeriesLabelPosition,
    error: impl Fn(&Row) -> f64,
) -> Result<(), PlotError> {
    let dots = COLOURS.map(|(profile, colour)| (profile, colour, dots(scene, profile, &error)));
    let all: Vec<Point> = dots
        .iter()
        .flat_map(|of| of.2.iter().map(|dot| dot.0))
        .collect();
    let x = range(all.iter().map(|point| point.0), 1.3);
    let y = decades(range(all.iter().map(|point| point.1), 1.2));
    let mut chart = ChartBuilder::on(panel)
        .margin(14)
        .margin_right(30)
        .caption(&scene.scene, ("sans-serif", 17))
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("milliseconds a frame")
        .y_desc(what)
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(BLACK.mix(0.04))
        .draw()?;
    let front = pareto_front(&all);
    chart
        .draw_series(LineSeries::new(steps(&front, x.1), FRONT.stroke_width(1)))?
        .label("Pareto front")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], FRONT.stroke_width(1)));
    for (profile, colour, dots) in dots {
        let circle = |&(point, size): &Dot| Circle::new(point, size, colour.mix(0.75).filled());
        chart
            .draw_series(dots.iter().map(circle))?
            .label(profile.to_string())
            .legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
    }
    let ring = |&point: &Point| Circle::new(point, 9, FRONT.stroke_width(1));
    chart.draw_series(front.iter().map(ring))?;
    chart
        .configure_series_labels()
        .position(legend)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2))
        .draw()?;
    Ok(())
}

/// The [`comparable`] rows of a profile; those that a logarithm cannot show are left out.
fn dots(scene: &SceneReport, profile: Profile, error: impl Fn(&Row) -> f64) -> Vec<Dot> {
    let name = profile.to_string();
    comparable(&scene.rows)
        .filter(|row| row.case.profile == name)
        .map(|row| ((row.speed.total_ms, error(row)), radius(row.case.waves)))
        .filter(|((time, error), _)| *time > 0.0 && *error > 0.0)
        .collect()
}

/// In pixels: 3 for 4096 waves, one more for each four times as many.
fn radius(waves: u32) -> i32 {
    ((f64::from(waves.max(1)).log2() - 6.0) / 2.0)
        .round()
        .clamp(2.0, 9.0) as i32
}

/// The front as stairs: between two points the earlier one is the best there is.
fn steps(front: &[Point], end: f64) -> Vec<Point> {
    let mut stairs = Vec::new();
    for (index, &point) in front.iter().enumerate() {
        let until = front.get(index + 1).map_or(end, |next| next.0);
        stairs.extend([point, (until, point.1)]);
    }
    stairs
}

/// From a bit below the least to a bit above the most of these; something for nothing.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (least, most) = values.fold((f64::INFINITY, 0.0), |(least, most), value| {
        (f64::min(least, value), f64::max(most, value))
    });
    if most > 0.0 {
        (least / margin, most * margin)
    } else {
        (0.1, 10.0)
    }
}

/// The powers of ten around a range: an axis that begins and ends with a number.
fn decades((least, most): (f64, f64)) -> (f64, f64) {
    let power = |value: f64| 10f64.powf(value);
    (power(least.log10().floor()), power(most.log10().ceil()))
}

/// A tick of the axis: one digit that counts.
fn short(value: &f64) -> String {
    let power = value.log10().floor() as i32;
    match power {
        -2 | -1 => format!("{value:.*}", power.unsigned_abs() as usize),
        0..=4 => format!("{value:.0}"),
        _ => format!("{value:.0e}"),
    }
}
