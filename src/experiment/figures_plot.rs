//! The four tables as one picture: time and hits against waves, log-log.

use super::figures::{FRAME_BUDGET_MS, FigureRow, FigureTable, FiguresReport};
use plotters::coord::Shift;
use plotters::prelude::*;

type PlotError = Box<dyn std::error::Error + Send + Sync>;

const WIDTH: u32 = 1100;
const TITLE_HEIGHT: u32 = 40;
const ROW_HEIGHT: u32 = 340;

/// The thesis' two machines: greys. Colours for ours, told apart by colour-blind eyes
/// too (Okabe and Ito).
const MOBILE: RGBColor = RGBColor(150, 150, 150);
const DESKTOP: RGBColor = RGBColor(90, 90, 90);
const BUDGET: RGBColor = RGBColor(204, 121, 167);
const OURS: [RGBColor; 4] = [
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(230, 159, 0),
];

struct Curve {
    label: String,
    colour: RGBColor,
    points: Vec<(f64, f64)>,
}

/// The report as an SVG picture: a row of two plots for each table.
///
/// # Errors
/// When the drawing fails, which its text says.
pub fn plot_svg(report: &FiguresReport) -> Result<String, PlotError> {
    let mut svg = String::new();
    let height = TITLE_HEIGHT + ROW_HEIGHT * report.tables.len() as u32;
    {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let title = format!("Figures 11.1 to 11.4, on {}", report.renderer);
        let body = root.titled(&title, ("sans-serif", 20))?;
        let panels = body.split_evenly((report.tables.len(), 2));
        for (index, table) in report.tables.iter().enumerate() {
            plot_times(&panels[2 * index], table)?;
            plot_hits(&panels[2 * index + 1], table)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn plot_times(
    panel: &DrawingArea<SVGBackend, Shift>,
    table: &FigureTable,
) -> Result<(), PlotError> {
    let mut curves = vec![
        thesis_curve(table, "thesis, GT 330M", MOBILE, |row| row.thesis.mobile_ms),
        thesis_curve(table, "thesis, HD 3650", DESKTOP, |row| {
            row.thesis.desktop_ms
        }),
    ];
    curves.extend(our_curves(table, |row| row.milliseconds.total));
    let (first, last) = wave_range(table);
    curves.push(Curve {
        label: "33.3 ms".to_owned(),
        colour: BUDGET,
        points: vec![(first, FRAME_BUDGET_MS), (last, FRAME_BUDGET_MS)],
    });
    plot(panel, table, "milliseconds a frame", &curves)
}

fn plot_hits(panel: &DrawingArea<SVGBackend, Shift>, table: &FigureTable) -> Result<(), PlotError> {
    let hits = |row: &FigureRow| row.thesis.listener_hits as f64;
    let mut curves = vec![thesis_curve(table, "thesis", DESKTOP, hits)];
    curves.extend(our_curves(table, |row| row.counts.listener_hits as f64));
    plot(panel, table, "waves at the listener", &curves)
}

fn thesis_curve(
    table: &FigureTable,
    label: &str,
    colour: RGBColor,
    value: impl Fn(&FigureRow) -> f64,
) -> Curve {
    let mut points: Vec<_> = table
        .rows
        .iter()
        .map(|r| (f64::from(r.waves), value(r)))
        .collect();
    // Every profile's row repeats the thesis' own.
    points.dedup();
    Curve {
        label: label.to_owned(),
        colour,
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
                colour: OURS[curves.len() % OURS.len()],
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

/// One log-log plot. A logarithm has no zero: such points are left out.
fn plot(
    panel: &DrawingArea<SVGBackend, Shift>,
    table: &FigureTable,
    what: &str,
    curves: &[Curve],
) -> Result<(), PlotError> {
    let (first, last) = wave_range(table);
    let values = curves.iter().flat_map(|c| &c.points).map(|p| p.1);
    let least = values.clone().filter(|v| *v > 0.0).fold(1.0, f64::min);
    let most = values.fold(10.0, f64::max);
    let nothing = curves.iter().all(|c| c.points.iter().all(|p| p.1 == 0.0));
    let caption = format!(
        "{}: {}, {} iterations{}",
        table.figure,
        table.scene,
        table.iterations,
        if nothing { " (none)" } else { "" }
    );
    let mut chart = ChartBuilder::on(panel)
        .margin(12)
        .margin_right(36)
        .caption(caption, ("sans-serif", 16))
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(
            (first..last).log_scale(),
            (0.8 * least..1.5 * most).log_scale(),
        )?;
    chart
        .configure_mesh()
        .x_desc("sound waves")
        .y_desc(what)
        .x_label_formatter(&|v| format!("{v:.0}"))
        .y_label_formatter(&short)
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(BLACK.mix(0.04))
        .draw()?;
    for curve in curves {
        let shown: Vec<_> = curve.points.iter().copied().filter(|p| p.1 > 0.0).collect();
        let colour = curve.colour;
        chart
            .draw_series(LineSeries::new(shown.clone(), colour.stroke_width(2)))?
            .label(curve.label.clone())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        if shown.len() > 2 {
            chart.draw_series(shown.iter().map(|&p| Circle::new(p, 3, colour.filled())))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.2))
        .draw()?;
    Ok(())
}

fn short(value: &f64) -> String {
    if *value >= 1.0 {
        format!("{value:.0}")
    } else {
        format!("{value}")
    }
}
