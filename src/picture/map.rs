//! A map: the plan of a scene, coloured by a value at each point of a lattice, with a colour bar.

use super::PictureError;
use super::labels::{ADVANCE, draw_scale_bar, write};
use super::marks::{INK, draw_source_mark, fill, paint, rectangle};
use super::plan::{Bounds, Plan};
use super::slice::{check_size, cut};
use crate::error::Error;
use crate::gl::Context;
use crate::scene::{Listener, Pair, Scene};
use glam::{Vec2, Vec3};
use image::{Rgba, RgbaImage};
use tiny_skia::{BlendMode, PathBuilder, PixmapMut, Rect};

/// Width of the colour bar's area, as a share of the plan's width.
const BAR_SHARE: f32 = 0.2;

/// Height of the title line, in the plan's stroke unit.
const TITLE: f32 = 26.0;

/// Maximum number of steps between marks on the colour bar.
const STEPS: f64 = 6.0;

/// Length of a mark beside the colour bar, in the plan's stroke unit.
const MARK: f32 = 4.0;

/// The colour of a point without a value.
const NOTHING: [u8; 3] = [225, 225, 225];

/// Options of a map: values at the points of a lattice, and their presentation.
pub struct MapOptions<'a> {
    /// Width of the plan in pixels; the colour bar is beside it.
    pub width: u32,
    /// World y of the cut in metres.
    pub height: f32,
    /// The first and the last point of the lattice; y is ignored.
    pub ends: [Vec3; 2],
    /// Number of points along x and along z, 2 or more each.
    pub counts: [u32; 2],
    /// The values, x fastest; `None` for points without a value.
    pub values: &'a [Option<f64>],
    /// The title above the map: the quantity and its location.
    pub title: &'a str,
    /// Whether 0 is in the middle of the colours, for signed values.
    pub around_zero: bool,
    /// The unit after a number on the colour bar: `dB`, `s`, or empty.
    pub unit: &'a str,
    /// The colour for a value's position, from 0 at the lowest value to 1 at the highest.
    pub colour: fn(f64) -> [u8; 3],
}

/// Draws a map: lattice points are coloured rectangles, solids are pale as in a plan, and the source is marked. The
/// listener is not marked, because it was at every lattice point.
pub fn map(context: &Context, pair: Pair, options: &MapOptions) -> Result<RgbaImage, Error> {
    let scene = pair.scene;
    check_size(context, options.width, 1)?;
    let [from, to] = options.ends;
    // The plan covers the lattice and the sources, but not the scene's own listeners.
    let in_middle = Listener {
        position: from.lerp(to, 0.5),
        ..pair.listener.clone()
    };
    let lattice = Bounds {
        min: Vec2::new(from.x.min(to.x), from.z.min(to.z)),
        max: Vec2::new(from.x.max(to.x), from.z.max(to.z)),
    };
    let mut bounds = Bounds::with_listeners(scene, &[in_middle], options.height);
    bounds.min = bounds.min.min(lattice.min);
    bounds.max = bounds.max.max(lattice.max);
    let plan = Plan::new(bounds, options.width)?;
    let mut picture = cut(context, scene, options.height, &plan)?;
    let places = places(scene, options);
    let ends = ends_of(places.iter().map(|place| place.value));
    let ends = match options.around_zero {
        true => ends.map(around_zero),
        false => ends,
    };
    if let Some(mut canvas) = PixmapMut::from_bytes(&mut picture, plan.width, plan.height) {
        draw_places(&mut canvas, &plan, options, &places, ends);
        draw_source_mark(&mut canvas, &plan, pair.source.position, 1.0);
        draw_scale_bar(&mut canvas, &plan);
    }
    with_colour_bar(&picture, &plan, options, ends)
}

/// A lattice point to draw.
struct Place {
    column: u32,
    row: u32,
    value: Option<f64>,
}

/// The lattice points in the air. Points in solids are left out, because listeners cannot be in solids.
fn places(scene: &Scene, options: &MapOptions) -> Vec<Place> {
    let [columns, rows] = options.counts;
    let [from, to] = options.ends;
    let place = |(at, value): (usize, &Option<f64>)| {
        let (column, row) = (at as u32 % columns, at as u32 / columns);
        let share = Vec2::new(
            column as f32 / (columns - 1) as f32,
            row as f32 / (rows - 1) as f32,
        );
        let x = from.x + share.x * (to.x - from.x);
        let z = from.z + share.y * (to.z - from.z);
        let clear = scene.surface_distance(Vec3::new(x, options.height, z));
        (clear.distance > 0.0).then_some(Place {
            column,
            row,
            value: *value,
        })
    };
    options
        .values
        .iter()
        .enumerate()
        .filter_map(place)
        .collect()
}

/// The lowest and the highest value; `None` without values.
fn ends_of(values: impl Iterator<Item = Option<f64>> + Clone) -> Option<(f64, f64)> {
    let numbers = values.flatten();
    let least = numbers.clone().reduce(f64::min)?;
    Some((least, numbers.reduce(f64::max)?))
}

/// A range symmetric about 0 that contains both ends.
fn around_zero((least, most): (f64, f64)) -> (f64, f64) {
    let size = least.abs().max(most.abs());
    (-size, size)
}

/// Colours every lattice point by multiplication, so that solids and lines remain visible.
fn draw_places(
    canvas: &mut PixmapMut,
    plan: &Plan,
    options: &MapOptions,
    places: &[Place],
    ends: Option<(f64, f64)>,
) {
    let [columns, rows] = options.counts;
    let [from, to] = options.ends.map(|end| plan.pixel(end));
    let step = (to - from) / Vec2::new((columns - 1) as f32, (rows - 1) as f32);
    for &Place { column, row, value } in places {
        // Edges lie on whole pixels, so that neighbouring rectangles touch.
        let edge = |place: u32, from: f32, step: f32| (from + step * (place as f32 - 0.5)).round();
        let xs = [column, column + 1].map(|place| edge(place, from.x, step.x));
        let ys = [row, row + 1].map(|place| edge(place, from.y, step.y));
        let (left, right) = (xs[0].min(xs[1]), xs[0].max(xs[1]));
        let (top, bottom) = (ys[0].min(ys[1]), ys[0].max(ys[1]));
        let Some(place) = Rect::from_ltrb(left, top, right, bottom) else {
            continue;
        };
        let colour = value.zip(ends).map_or(NOTHING, |(value, (least, most))| {
            (options.colour)(share(value, least, most))
        });
        let mut paint = paint(colour, 1.0);
        paint.blend_mode = BlendMode::Multiply;
        fill(canvas, Some(PathBuilder::from_rect(place)), &paint);
    }
}

/// Position of a value between the least and the most, 0 to 1; 0.5 if these are equal.
fn share(value: f64, least: f64, most: f64) -> f64 {
    let share = (value - least) / (most - least);
    if share.is_finite() { share } else { 0.5 }
}

/// The picture below its title, with a colour bar to its right. The highest value is at the bar's top.
fn with_colour_bar(
    picture: &RgbaImage,
    plan: &Plan,
    options: &MapOptions,
    ends: Option<(f64, f64)>,
) -> Result<RgbaImage, Error> {
    let unit = plan.stroke();
    let dot = plan.dot();
    let marks = bar_marks(ends, options.unit);
    let longest = marks.iter().map(|mark| mark.label.chars().count());
    let longest = longest.max().unwrap_or(0);
    let text = dot * (ADVANCE * longest) as f32;
    let beside = (BAR_SHARE * plan.width as f32).max(text + 52.0 * unit) as u32;
    let head = (TITLE * unit).round();
    let (width, height) = (plan.width + beside, plan.height + head as u32);
    let mut whole = RgbaImage::from_pixel(width, height, Rgba([255; 4]));
    image::imageops::replace(&mut whole, picture, 0, head as i64);
    let Some(mut canvas) = PixmapMut::from_bytes(&mut whole, width, height) else {
        return Err(PictureError::size([width, height], u32::MAX).into());
    };
    let (left, bar) = (plan.width as f32 + 16.0 * unit, 18.0 * unit);
    let top = head + (16.0 * unit).round();
    let length = (plan.height as f32 - 32.0 * unit).round();
    let room = width as f32 - 32.0 * unit;
    let across = options.title.chars().count() * ADVANCE;
    let title_dot = dot.min((room / across.max(1) as f32).floor()).max(1.0);
    write(
        &mut canvas,
        options.title,
        (16.0 * unit).round(),
        (head - 7.0 * title_dot) / 2.0,
        title_dot,
    );
    for row in 0..length as u32 {
        let colour = (options.colour)(1.0 - f64::from(row) / f64::from(length - 1.0).max(1.0));
        rectangle(&mut canvas, [left, top + row as f32, bar, 1.0], colour, 1.0);
    }
    for mark in &marks {
        let y = top + length * (1.0 - mark.share as f32);
        let line = [
            left + bar,
            (y - 0.5 * unit).round(),
            MARK * unit,
            unit.max(1.0),
        ];
        rectangle(&mut canvas, line, INK, 1.0);
        let at = (y - 3.5 * dot).clamp(top, top + length - 7.0 * dot);
        let x = (left + bar + (MARK + 5.0) * unit).round();
        write(&mut canvas, &mark.label, x, at.round(), dot);
    }
    Ok(whole)
}

/// A mark on the colour bar.
#[derive(Debug, PartialEq)]
struct Mark {
    /// Position on the bar, from 0 at the bottom to 1.
    share: f64,
    label: String,
}

/// The marks of the bar, from the bottom, at multiples of 1, 2 or 5 times a power of ten. There is a single mark if all
/// values are equal.
fn bar_marks(ends: Option<(f64, f64)>, unit: &str) -> Vec<Mark> {
    let Some((least, most)) = ends else {
        return Vec::new();
    };
    let step = round_step((most - least) / STEPS);
    let mark = |number: f64, digits: usize| Mark {
        share: share(number, least, most),
        label: format!("{number:.digits$} {unit}").trim_end().to_owned(),
    };
    // Excludes equal ends, and ends without a representable number between them.
    if !(step.is_finite() && step > 0.0 && least + step > least) {
        return vec![mark(least, 2)];
    }
    let digits = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    let first = (least / step - ROUNDING).ceil();
    let count = (most / step + ROUNDING).floor() - first;
    let numbers = (0..=count as u32).map(|index| (first + f64::from(index)) * step);
    // Avoids −0.
    numbers.map(|number| mark(number + 0.0, digits)).collect()
}

/// The smallest of 1, 2, 5, 10, 20, 50 … that is at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|step| step * power);
    let fits = steps
        .into_iter()
        .find(|step| *step >= least * (1.0 - ROUNDING));
    fits.unwrap_or(10.0 * power)
}

/// A fraction of a step that counts as rounding.
const ROUNDING: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the colour bar: the labels of its marks differ and have their unit.
    #[test]
    fn the_bar_says_what_the_colours_mean() {
        let values = [Some(-3.0), None, Some(5.0)];
        assert_eq!(ends_of(values.into_iter()), Some((-3.0, 5.0)));
        assert_eq!(ends_of([None].into_iter()), None);
        assert_eq!(around_zero((-0.25, 0.5)), (-0.5, 0.5));
        assert_eq!(share(1.0, 0.0, 4.0), 0.25);
        assert_eq!(share(2.0, 2.0, 2.0), 0.5);
    }

    /// Protects the reader of a colour bar from uneven numbers: its marks have round numbers at the right positions.
    #[test]
    fn marks_are_at_round_numbers() {
        let labels = |least, most| -> Vec<String> {
            let marks = bar_marks(Some((least, most)), "dB");
            for mark in &marks {
                let number: f64 = mark.label.trim_end_matches(" dB").parse().unwrap();
                let place = share(number, least, most);
                assert!(
                    least == most || (mark.share - place).abs() < 1e-9,
                    "{mark:?}"
                );
            }
            marks.into_iter().map(|mark| mark.label).collect()
        };
        assert_eq!(labels(19.5, 23.8), ["20 dB", "21 dB", "22 dB", "23 dB"]);
        assert_eq!(labels(-3.0, 5.0), ["-2 dB", "0 dB", "2 dB", "4 dB"]);
        assert_eq!(labels(-0.5, 0.5)[0], "-0.4 dB");
        assert_eq!(
            labels(0.0, 0.012),
            [
                "0.000 dB", "0.002 dB", "0.004 dB", "0.006 dB", "0.008 dB", "0.010 dB", "0.012 dB"
            ]
        );
        assert_eq!(labels(120.0, 1400.0), ["500 dB", "1000 dB"]);
        assert_eq!(labels(2.0, 2.0), ["2.00 dB"]);
        assert!(bar_marks(None, "dB").is_empty());
        // Two values without a representable number between them.
        assert_eq!(
            bar_marks(Some((1e300, 1e300 * (1.0 + f64::EPSILON))), "").len(),
            1
        );
    }
}
