//! Marks of listeners and sources, their key-framed paths, and the paths of waves, drawn on a plan.
//!
//! The colours are those of Okabe and Ito, which readers with any colour vision can distinguish.

use super::plan::{Plan, flat};
use crate::scene::{Listener, Path as KeyPath, Source, Viewpoint};
use crate::tracer::{Fate, Wave};
use glam::{Vec2, Vec3};
use std::ptr;
use tiny_skia::{
    Color, FillRule, GradientStop, LineCap, LineJoin, LinearGradient, Paint, Path, PathBuilder,
    PixmapMut, Point, Rect, SpreadMode, Stroke, StrokeDash, Transform,
};

/// The listener and its path.
const BLUE: [u8; 3] = [0, 114, 178];
/// The source and its path.
const ORANGE: [u8; 3] = [230, 159, 0];
/// The path of a source: darker, because its lines are thin.
const SOURCE_PATH: [u8; 3] = [176, 116, 0];
/// Background of letters.
pub(super) const PLATE_COLOUR: [u8; 3] = [255, 255, 255];
/// Opacity of the background of letters.
pub(super) const PLATE: f32 = 0.82;
/// Outlines, the viewing direction and letters.
pub(super) const INK: [u8; 3] = [38, 42, 46];

/// Opacity of the marks of sources and listeners outside the pair. Their waves are not drawn.
const OTHERS: f32 = 0.4;

/// Draws the marks of all sources and listeners. The marks of the pair are on top.
pub(super) fn draw(canvas: &mut PixmapMut, plan: &Plan, seen: Viewpoint) {
    let is_other = |listener: &&Listener| !seen.listener.is_some_and(|own| ptr::eq(own, *listener));
    for listener in seen.scene.listeners.iter().rev().filter(is_other) {
        draw_listener(canvas, plan, listener, OTHERS);
    }
    let is_other = |source: &&Source| !seen.source.is_some_and(|own| ptr::eq(own, *source));
    for source in seen.scene.sources.iter().rev().filter(is_other) {
        draw_source(canvas, plan, source, OTHERS);
    }
    if let Some(listener) = seen.listener {
        draw_listener(canvas, plan, listener, 1.0);
    }
    if let Some(source) = seen.source {
        draw_source(canvas, plan, source, 1.0);
    }
}

fn draw_key_path(
    canvas: &mut PixmapMut,
    plan: &Plan,
    path: &KeyPath,
    colour: [u8; 3],
    opacity: f32,
) {
    let unit = plan.stroke();
    let points: Vec<Vec2> = path.keys().iter().map(|k| plan.pixel(k.position)).collect();
    let dashes = Stroke {
        dash: StrokeDash::new(vec![7.0 * unit, 5.0 * unit], 0.0),
        ..round(2.0 * unit)
    };
    stroke(canvas, polyline(&points), &paint(colour, opacity), &dashes);
    for &point in &points {
        let dot = PathBuilder::from_circle(point.x, point.y, 3.0 * unit);
        fill(canvas, dot, &paint(colour, opacity));
    }
}

fn draw_listener(canvas: &mut PixmapMut, plan: &Plan, listener: &Listener, opacity: f32) {
    draw_key_path(canvas, plan, &listener.path, BLUE, opacity);
    let unit = plan.stroke();
    let centre = plan.pixel(listener.position);
    let radius = plan.pixels(listener.radius);
    let blue = paint(BLUE, opacity);
    let circle = PathBuilder::from_circle(centre.x, centre.y, radius);
    fill(canvas, circle.clone(), &paint(BLUE, 0.16 * opacity));
    stroke(canvas, circle, &blue, &round(2.4 * unit));
    // The viewing direction as seen from above: the line is shorter if the listener looks up or down.
    let gaze = flat(listener.forward());
    let tip = centre + gaze * (radius + 16.0 * unit);
    let shaft = polyline(&[centre, tip]);
    stroke(canvas, shaft, &blue, &round(2.4 * unit));
    if let Some(ahead) = gaze.try_normalize() {
        let barb = |side: f32| tip - 10.0 * unit * ahead + side * 6.5 * unit * ahead.perp();
        let head = polyline(&[barb(1.0), tip, barb(-1.0)]);
        stroke(canvas, head, &blue, &round(2.4 * unit));
    }
    let dot = PathBuilder::from_circle(centre.x, centre.y, 3.2 * unit);
    fill(canvas, dot, &blue);
}

/// Draws a source and its key-framed path.
fn draw_source(canvas: &mut PixmapMut, plan: &Plan, source: &Source, opacity: f32) {
    draw_key_path(canvas, plan, &source.path, SOURCE_PATH, opacity);
    draw_source_mark(canvas, plan, source.position, opacity);
}

/// Draws the mark of a source at its position.
pub(super) fn draw_source_mark(canvas: &mut PixmapMut, plan: &Plan, position: Vec3, opacity: f32) {
    let unit = plan.stroke();
    let centre = plan.pixel(position);
    let dot = PathBuilder::from_circle(centre.x, centre.y, 7.0 * unit);
    fill(canvas, dot.clone(), &paint(ORANGE, opacity));
    stroke(canvas, dot, &paint(INK, opacity), &round(1.8 * unit));
}

/// A line through points in pixels; `None` for fewer than two points or for points that are not finite.
fn polyline(points: &[Vec2]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first.x, first.y);
    for point in rest {
        builder.line_to(point.x, point.y);
    }
    builder.finish()
}

/// A paint of one colour with the given opacity.
pub(super) fn paint([red, green, blue]: [u8; 3], opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(colour([red, green, blue], opacity));
    paint.anti_alias = true;
    paint
}

/// A colour with the given opacity.
fn colour([red, green, blue]: [u8; 3], opacity: f32) -> Color {
    let mut colour = Color::from_rgba8(red, green, blue, 255);
    colour.set_alpha(opacity);
    colour
}

/// A stroke of the given width in pixels, with round ends and joins.
fn round(width: f32) -> Stroke {
    Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    }
}

fn stroke(canvas: &mut PixmapMut, path: Option<Path>, paint: &Paint, stroke: &Stroke) {
    if let Some(path) = path {
        canvas.stroke_path(&path, paint, stroke, Transform::identity(), None);
    }
}

pub(super) fn fill(canvas: &mut PixmapMut, path: Option<Path>, paint: &Paint) {
    if let Some(path) = path {
        canvas.fill_path(&path, paint, FillRule::Winding, Transform::identity(), None);
    }
}

/// Fills a rectangle: left, top, width, height.
pub(super) fn rectangle(
    canvas: &mut PixmapMut,
    [x, y, w, h]: [f32; 4],
    colour: [u8; 3],
    opacity: f32,
) {
    if let Some(rect) = Rect::from_xywh(x, y, w, h) {
        let path = PathBuilder::from_rect(rect);
        fill(canvas, Some(path), &paint(colour, opacity));
    }
}

/// Waves that reached the listener: vermilion.
const REACHED: [u8; 3] = [213, 94, 0];
/// Waves that are still travelling.
const TRAVELLING: [u8; 3] = [120, 128, 136];
/// Waves that are dead: bluish green.
const DEAD: [u8; 3] = [0, 158, 115];

/// Length of the stub that shows the direction of a dead wave, as a share of the width.
const STUB: f32 = 0.16;

/// One wave's line.
struct Line {
    fate: Fate,
    points: Vec<Vec2>,
    /// World position and direction where the wave died.
    stub: Option<(Vec3, Vec3)>,
}

/// The drawing style of a fate.
pub(super) struct Style {
    pub fate: Fate,
    pub colour: [u8; 3],
    pub opacity: f32,
    /// Width in the plan's stroke unit.
    pub width: f32,
    /// The text in the legend.
    pub meaning: &'static str,
}

/// The styles, in drawing order.
pub(super) const STYLES: [Style; 3] = [
    Style {
        fate: Fate::Dead,
        colour: DEAD,
        opacity: 0.7,
        width: 1.1,
        meaning: "gone: met nothing more",
    },
    Style {
        fate: Fate::Travelling,
        colour: TRAVELLING,
        opacity: 0.55,
        width: 0.9,
        meaning: "travelling at the end",
    },
    Style {
        fate: Fate::Listener,
        colour: REACHED,
        opacity: 0.95,
        width: 1.9,
        meaning: "reached the listener",
    },
];

/// Draws the waves of [`crate::Tracer::paths`] from a source, with the waves that reached the listener on top. Returns
/// the fates of the waves.
pub(super) fn draw_wave_paths(
    canvas: &mut PixmapMut,
    plan: &Plan,
    source: Vec3,
    states: &[Vec<Wave>],
) -> Vec<Fate> {
    let waves = states.first().map_or(0, Vec::len);
    // A source in a solid emits no waves: all waves are dead from the start.
    let lines: Vec<Line> = (0..waves)
        .filter(|&wave| states[0][wave].fate() != Fate::Dead)
        .map(|wave| follow(plan, source, states, wave))
        .collect();
    let unit = plan.stroke();
    for style in &STYLES {
        let pen = round(style.width * unit);
        for line in lines.iter().filter(|line| line.fate == style.fate) {
            let path = polyline(&line.points);
            stroke(canvas, path, &paint(style.colour, style.opacity), &pen);
            if let Some((from, direction)) = line.stub {
                draw_stub(canvas, plan, from, direction, style.opacity);
            }
        }
    }
    lines.iter().map(|line| line.fate).collect()
}

/// The positions of one wave until it reached the listener or died. Later states of a dead wave do not belong to its
/// path, because the shader marches such a wave again from the origin.
fn follow(plan: &Plan, source: Vec3, states: &[Vec<Wave>], wave: usize) -> Line {
    let mut line = Line {
        fate: Fate::Travelling,
        points: vec![plan.pixel(source)],
        stub: None,
    };
    let mut last = (source, Vec3::ZERO);
    for (iteration, waves) in states.iter().enumerate() {
        let state = &waves[wave];
        if iteration == 0 {
            last.1 = state.start_direction;
            continue;
        }
        line.fate = match state.fate() {
            Fate::NotFinite => Fate::Dead,
            fate => fate,
        };
        if line.fate == Fate::Dead {
            line.stub = Some(last);
            break;
        }
        line.points.push(plan.pixel(state.position));
        last = (state.position, state.direction);
        if line.fate == Fate::Listener {
            break;
        }
    }
    line
}

/// Draws a line that fades along the direction in which a wave was lost.
fn draw_stub(canvas: &mut PixmapMut, plan: &Plan, from: Vec3, direction: Vec3, opacity: f32) {
    let length = STUB * plan.width as f32 * plan.metres;
    let start = plan.pixel(from);
    let end = plan.pixel(from + length * direction);
    let stops = vec![
        GradientStop::new(0.0, colour(DEAD, opacity)),
        GradientStop::new(1.0, colour(DEAD, 0.0)),
    ];
    let gradient = LinearGradient::new(
        Point::from_xy(start.x, start.y),
        Point::from_xy(end.x, end.y),
        stops,
        SpreadMode::Pad,
        Transform::identity(),
    );
    // `None` for a stub of zero length.
    if let Some(shader) = gradient {
        let fading = Paint {
            shader,
            anti_alias: true,
            ..Paint::default()
        };
        let pen = round(1.1 * plan.stroke());
        stroke(canvas, polyline(&[start, end]), &fading, &pen);
    }
}
