//! Plots the four tables: time and hits against waves, with logarithmic axes.

use super::{FRAME_BUDGET_MS, FigureRow, FigureTable, FiguresReport};
use crate::experiment::plot::{
    HYBRID, LogAxis, MARCH, Panel, Point, Sheet, Stroke, THESIS, chart, draw_legend, draw_line,
};
use crate::report::PlotError;
use plotters::prelude::*;

const SHEET: Sheet = Sheet {
    width: 1240,
    title_height: 40,
    row_height: 340,
};
/// Width of a plot in pixels; the legend fills the remaining width.
const PLOT_WIDTH: u32 = 510;

/// Line styles. The two machines of the thesis are grey, and the measured profiles are coloured. Later lines are drawn
/// over earlier ones. Later lines are thinner or dashed, so that the earlier lines stay visible.
const MOBILE: Stroke = Stroke::new(RGBColor(185, 185, 185), 7, None);
const DESKTOP: Stroke = Stroke::new(RGBColor(110, 110, 110), 7, None);
const BUDGET: Stroke = Stroke::new(RGBColor(204, 121, 167), 1, Some((12, 4)));
const OURS: [Stroke; 4] = [
    Stroke::new(THESIS, 3, None),
    Stroke::new(MARCH, 4, None),
    Stroke::new(HYBRID, 2, Some((7, 7))),
    Stroke::new(RGBColor(230, 159, 0), 2, Some((2, 5))),
];

struct Curve {
    label: String,
    stroke: Stroke,
    points: Vec<Point>,
}

/// The report as an SVG picture: a row of two plots for each table, and the legend.
///
/// # Errors
/// If drawing fails. The error contains the reason.
pub(super) fn plot_svg(report: &FiguresReport) -> Result<String, PlotError> {
    let title = format!("Figures 11.1 to 11.4, on {}", report.renderer);
    SHEET.svg(&title, report.tables.len(), |rows| {
        for (row, table) in rows.iter().zip(&report.tables) {
            let (times, rest) = row.split_horizontally(PLOT_WIDTH);
            let (hits, legend) = rest.split_horizontally(PLOT_WIDTH);
            let (of_times, of_hits) = (times_of(table), hits_of(table));
            plot(&times, table, "milliseconds per frame", &of_times)?;
            plot(&hits, table, "waves at the listener", &of_hits)?;
            draw_legend(&legend, &entries(&of_times))?;
        }
        Ok(())
    })
}

fn entries(curves: &[Curve]) -> Vec<(String, Stroke)> {
    let entry = |curve: &Curve| (curve.label.clone(), curve.stroke);
    curves.iter().map(entry).collect()
}

fn times_of(table: &FigureTable) -> Vec<Curve> {
    let mut curves = vec![
        thesis_curve(table, "printed, mobile", MOBILE, |row| row.thesis.mobile_ms),
        thesis_curve(table, "printed, desktop; printed hits", DESKTOP, |row| {
            row.thesis.desktop_ms
        }),
    ];
    curves.extend(our_curves(table, |row| row.milliseconds.total));
    let (first, last) = wave_range(table);
    curves.push(Curve {
        label: format!("{FRAME_BUDGET_MS:.1} ms"),
        stroke: BUDGET,
        points: vec![(first, FRAME_BUDGET_MS), (last, FRAME_BUDGET_MS)],
    });
    curves
}

/// The curves of hits. The thesis has one curve, because its counts are the same on both machines.
fn hits_of(table: &FigureTable) -> Vec<Curve> {
    let hits = |row: &FigureRow| row.thesis.listener_hits as f64;
    let mut curves = vec![thesis_curve(table, "printed", DESKTOP, hits)];
    curves.extend(our_curves(table, |row| row.counts.listener_hits as f64));
    curves
}

fn thesis_curve(
    table: &FigureTable,
    label: &str,
    stroke: Stroke,
    value: impl Fn(&FigureRow) -> f64,
) -> Curve {
    let mut points: Vec<_> = table
        .rows
        .iter()
        .map(|r| (f64::from(r.waves), value(r)))
        .collect();
    // The row of the thesis is repeated for every profile.
    points.dedup();
    Curve {
        label: label.to_owned(),
        stroke,
        points,
    }
}

fn our_curves(table: &FigureTable, value: impl Fn(&FigureRow) -> f64) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for row in &table.rows {
        let label = format!("here, {}", row.profile);
        let point = (f64::from(row.waves), value(row));
        match curves.iter_mut().find(|curve| curve.label == label) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                label,
                stroke: OURS[curves.len() % OURS.len()],
                points: vec![point],
            }),
        }
    }
    curves
}

fn wave_range(table: &FigureTable) -> (f64, f64) {
    let waves = table.rows.iter().map(|row| f64::from(row.waves));
    let first = waves.clone().fold(f64::INFINITY, f64::min);
    let last = waves.fold(1.0, f64::max);
    (first.min(last), last.max(2.0 * first))
}

/// One plot with logarithmic axes.
fn plot(panel: &Panel, table: &FigureTable, what: &str, curves: &[Curve]) -> Result<(), PlotError> {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = LogAxis::around(points().map(|point| point.0));
    let y = LogAxis::around(points().map(|point| point.1));
    let caption = format!(
        "{}: {}, {} iterations",
        table.figure, table.scene, table.iterations
    );
    let mut chart = chart(panel, &caption, [x, y], ["sound waves", what])?;
    for curve in curves {
        let place = |&(waves, value): &Point| (waves, y.place(value));
        let shown: Vec<Point> = curve.points.iter().map(place).collect();
        let stroke = curve.stroke;
        draw_line(&mut chart, shown.clone(), stroke)?;
        if shown.len() > 2 {
            let radius = 2 + stroke.width as i32 / 2;
            let dot = |&point: &Point| Circle::new(point, radius, stroke.colour.filled());
            chart.draw_series(shown.iter().map(dot))?;
        }
    }
    Ok(())
}
