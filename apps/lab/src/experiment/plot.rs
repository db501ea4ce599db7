//! Common parts of the plots: a sheet of rows, the colours of the profiles, a legend, charts with two logarithmic axes
//! (whole decades, a single number notation, a line for zero), and line styles that stay distinguishable where lines
//! overlap.

use crate::report::PlotError;
use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

pub(super) type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// The colours of the profiles. Colour-blind readers can also distinguish them (Okabe and Ito).
pub(super) const THESIS: RGBColor = RGBColor(213, 94, 0);
pub(super) const MARCH: RGBColor = RGBColor(0, 114, 178);
pub(super) const HYBRID: RGBColor = RGBColor(0, 200, 140);

/// Size of a plot in pixels. A plot has a title above rows of equal height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheet {
    pub width: u32,
    pub title_height: u32,
    pub row_height: u32,
}

impl Sheet {
    /// Returns the plot as SVG. `draw` fills the rows.
    ///
    /// # Errors
    /// If drawing fails. The error contains the reason.
    pub fn svg(
        self,
        title: &str,
        rows: usize,
        draw: impl FnOnce(&[Panel]) -> Result<(), PlotError>,
    ) -> Result<String, PlotError> {
        let mut svg = String::new();
        {
            let size = (
                self.width,
                self.title_height + self.row_height * rows as u32,
            );
            let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            root.fill(&WHITE)?;
            let body = root.titled(title, ("sans-serif", 20))?;
            draw(&body.split_evenly((rows, 1)))?;
            root.present()?;
        }
        Ok(svg)
    }
}

/// A point of a chart: a number of waves or a time, and a value.
pub(super) type Point = (f64, f64);

/// A logarithmic axis between two powers of ten. Zero has no logarithm, so it has a separate position one decade below
/// the smallest power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LogAxis {
    low: f64,
    high: f64,
    has_zero: bool,
}

impl LogAxis {
    /// An axis over the decades that contain these values, with at least one decade.
    pub fn around(values: impl Iterator<Item = f64> + Clone) -> LogAxis {
        let positive = values.clone().filter(|value| *value > 0.0);
        let least = positive.clone().fold(f64::INFINITY, f64::min);
        let most = positive.fold(0.0, f64::max);
        let (least, most) = if most > 0.0 {
            (least, most)
        } else {
            (1.0, 1.0)
        };
        let low = least.log10().floor();
        let high = most.log10().ceil().max(low + 1.0);
        LogAxis {
            low: 10f64.powf(low),
            high: 10f64.powf(high),
            has_zero: values.into_iter().any(|value| value == 0.0),
        }
    }

    /// The axis position of zero, whether or not zero occurs in the data.
    fn zero(self) -> f64 {
        self.low / 10.0
    }

    fn start(self) -> f64 {
        if self.has_zero { self.zero() } else { self.low }
    }

    /// The axis range. The range is extended slightly at both ends, because rounding would remove the outermost labels.
    fn range(self) -> std::ops::Range<f64> {
        const HAIR: f64 = 1.001;
        self.start() / HAIR..self.high * HAIR
    }

    /// The largest number on the axis.
    pub fn end(self) -> f64 {
        self.high
    }

    /// The axis position of a value.
    pub fn place(self, value: f64) -> f64 {
        if value > 0.0 { value } else { self.zero() }
    }

    /// The label of an axis position: a power of ten or 0. Other positions have an empty label.
    fn tick(self, value: f64) -> String {
        if self.has_zero && value < 0.5 * self.low {
            return "0".to_owned();
        }
        let power = value.log10();
        if (power - power.round()).abs() > 1e-6 {
            return String::new();
        }
        power_of_ten(power.round() as i32)
    }

    /// The maximum number of labels.
    fn ticks(self) -> usize {
        (self.high / self.start()).log10().round() as usize + 2
    }
}

/// A power of 10 as text.
fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let sign = if power < 0 { "⁻" } else { "" };
    let digits = power.unsigned_abs().to_string();
    let digits = digits
        .bytes()
        .map(|digit| RAISED[usize::from(digit - b'0')]);
    format!("10{sign}{}", digits.collect::<String>())
}

/// The style of a line or dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub colour: RGBColor,
    /// Line width in pixels; 0 for a dot without a line.
    pub width: u32,
    /// Lengths of a dash and of the following gap, in pixels; `None` for a solid line.
    pub dash: Option<(i32, i32)>,
}

impl Stroke {
    pub const fn new(colour: RGBColor, width: u32, dash: Option<(i32, i32)>) -> Stroke {
        Stroke {
            colour,
            width,
            dash,
        }
    }

    /// A solid line.
    pub const fn solid(colour: RGBColor, width: u32) -> Stroke {
        Stroke::new(colour, width, None)
    }
}

/// A chart builder with margins, a caption and space for labels.
pub(super) fn builder<'a, 'b>(
    panel: &'a Panel<'b>,
    caption: &str,
) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut builder = ChartBuilder::on(panel);
    builder
        .margin(12)
        .margin_right(24)
        .caption(caption, ("sans-serif", 16))
        .x_label_area_size(42)
        .y_label_area_size(66);
    builder
}

/// An empty chart with its axes. If zero occurs, a grey band separates its position from the others.
pub(super) fn chart<'a, 'b>(
    panel: &'a Panel<'b>,
    caption: &str,
    [x, y]: [LogAxis; 2],
    [x_name, y_name]: [&str; 2],
) -> Result<Chart<'a, 'b>, PlotError> {
    let mut chart =
        builder(panel, caption).build_cartesian_2d(x.range().log_scale(), y.range().log_scale())?;
    if y.has_zero {
        let band = [(x.start(), y.zero()), (x.high, y.low)];
        chart.draw_series([Rectangle::new(band, BLACK.mix(0.06).filled())])?;
    }
    chart
        .configure_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .x_labels(x.ticks())
        .y_labels(y.ticks())
        .x_label_formatter(&|value| x.tick(*value))
        .y_label_formatter(&|value| y.tick(*value))
        .bold_line_style(BLACK.mix(0.15))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(chart)
}

/// Draws a line through points in axis coordinates.
pub(super) fn draw_line<'b, X, Y>(
    chart: &mut ChartContext<'_, SVGBackend<'b>, Cartesian2d<X, Y>>,
    points: Vec<Point>,
    stroke: Stroke,
) -> Result<(), PlotError>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let style = stroke.colour.stroke_width(stroke.width);
    match stroke.dash {
        None => chart.draw_series(LineSeries::new(points, style))?,
        Some((dash, gap)) => chart.draw_series(DashedLineSeries::new(points, dash, gap, style))?,
    };
    Ok(())
}

/// Draws the legend as a vertical list of entries.
pub(super) fn draw_legend(panel: &Panel, entries: &[(String, Stroke)]) -> Result<(), PlotError> {
    const TOP: i32 = 60;
    const LINE: i32 = 24;
    const SAMPLE: i32 = 36;
    for (index, (label, stroke)) in entries.iter().enumerate() {
        let y = TOP + LINE * index as i32;
        let (dash, gap) = stroke.dash.unwrap_or((SAMPLE, 1));
        let style = stroke.colour.stroke_width(stroke.width);
        if stroke.width == 0 {
            panel.draw(&Circle::new((SAMPLE / 2, y), 5, stroke.colour.filled()))?;
        }
        let mut from = 0;
        while stroke.width > 0 && from < SAMPLE {
            let to = (from + dash).min(SAMPLE);
            panel.draw(&PathElement::new([(from, y), (to, y)], style))?;
            from = to + gap;
        }
        let at = (SAMPLE + 8, y - 7);
        panel.draw(&Text::new(label.clone(), at, ("sans-serif", 14)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects axes: they have whole decades, zero one decade below, and a single number notation.
    #[test]
    fn an_axis_ends_at_powers_of_ten_and_has_room_for_zero() {
        let of = |values: &[f64]| LogAxis::around(values.iter().copied());
        let axis = of(&[0.0, 3.0, 250.0]);
        assert_eq!((axis.low, axis.high, axis.place(0.0)), (1.0, 1000.0, 0.1));
        let ticks = [0.1, 1.0, 10.0, 20.0, 1000.0].map(|value| axis.tick(value));
        assert_eq!(ticks, ["0", "10⁰", "10¹", "", "10³"]);
        let axis = of(&[0.002, 0.003]);
        assert_eq!((axis.start(), axis.high), (0.001, 0.01));
        assert_eq!(axis.tick(0.001), "10⁻³");
        assert_eq!(of(&[]), of(&[1.0]));
        assert_eq!(of(&[10.0]).high, 100.0);
    }
}
