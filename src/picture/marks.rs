//! Listener, source and their key-framed paths, drawn on a plan.
//!
//! The colours are those of Okabe and Ito, which people with any colour vision tell apart.

use super::plan::Plan;
use crate::scene::{Path as KeyPath, Scene};
use glam::{Vec2, Vec3};
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, PixmapMut, Rect, Stroke,
    StrokeDash, Transform,
};

/// The listener and its path.
const BLUE: [u8; 3] = [0, 114, 178];
/// The source and its path.
const ORANGE: [u8; 3] = [230, 159, 0];
/// Outlines and the gaze.
const INK: [u8; 3] = [38, 42, 46];

/// Draws the marks of `scene`.
pub(super) fn draw(canvas: &mut PixmapMut, plan: &Plan, scene: &Scene) {
    draw_key_path(canvas, plan, &scene.source.path, [176, 116, 0]);
    draw_key_path(canvas, plan, &scene.listener.path, BLUE);
    draw_listener(canvas, plan, scene);
    draw_source(canvas, plan, scene.source.position);
}

fn draw_key_path(canvas: &mut PixmapMut, plan: &Plan, path: &KeyPath, colour: [u8; 3]) {
    let unit = plan.stroke();
    let points: Vec<Vec2> = path.keys().iter().map(|k| plan.pixel(k.position)).collect();
    let dashes = Stroke {
        dash: StrokeDash::new(vec![7.0 * unit, 5.0 * unit], 0.0),
        ..round(2.0 * unit)
    };
    stroke(canvas, polyline(&points), &paint(colour, 1.0), &dashes);
    for &point in &points {
        let dot = PathBuilder::from_circle(point.x, point.y, 3.0 * unit);
        fill(canvas, dot, &paint(colour, 1.0));
    }
}

fn draw_listener(canvas: &mut PixmapMut, plan: &Plan, scene: &Scene) {
    let unit = plan.stroke();
    let listener = &scene.listener;
    let centre = plan.pixel(listener.position);
    let radius = plan.pixels(listener.radius);
    let circle = PathBuilder::from_circle(centre.x, centre.y, radius);
    fill(canvas, circle.clone(), &paint(BLUE, 0.16));
    stroke(canvas, circle, &paint(BLUE, 1.0), &round(2.4 * unit));
    // The gaze as seen from above: shorter when it rises or falls.
    let gaze = super::plan::flat(listener.forward());
    let tip = centre + gaze * (radius + 16.0 * unit);
    let shaft = polyline(&[centre, tip]);
    stroke(canvas, shaft, &paint(BLUE, 1.0), &round(2.4 * unit));
    if let Some(ahead) = gaze.try_normalize() {
        let barb = |side: f32| tip - 10.0 * unit * ahead + side * 6.5 * unit * ahead.perp();
        let head = polyline(&[barb(1.0), tip, barb(-1.0)]);
        stroke(canvas, head, &paint(BLUE, 1.0), &round(2.4 * unit));
    }
    let dot = PathBuilder::from_circle(centre.x, centre.y, 3.2 * unit);
    fill(canvas, dot, &paint(BLUE, 1.0));
}

/// Draws a source.
pub(super) fn draw_source(canvas: &mut PixmapMut, plan: &Plan, position: Vec3) {
    let unit = plan.stroke();
    let centre = plan.pixel(position);
    let dot = PathBuilder::from_circle(centre.x, centre.y, 7.0 * unit);
    fill(canvas, dot.clone(), &paint(ORANGE, 1.0));
    stroke(canvas, dot, &paint(INK, 1.0), &round(1.8 * unit));
}

/// A line through points in pixels; `None` for fewer than two, or for none finite.
pub(super) fn polyline(points: &[Vec2]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first.x, first.y);
    for point in rest {
        builder.line_to(point.x, point.y);
    }
    builder.finish()
}

/// One colour, of that opacity.
pub(super) fn paint([red, green, blue]: [u8; 3], opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(colour([red, green, blue], opacity));
    paint.anti_alias = true;
    paint
}

/// A colour of that opacity.
pub(super) fn colour([red, green, blue]: [u8; 3], opacity: f32) -> Color {
    let mut colour = Color::from_rgba8(red, green, blue, 255);
    colour.set_alpha(opacity);
    colour
}

/// A line of that width in pixels, with round ends and joins.
pub(super) fn round(width: f32) -> Stroke {
    Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    }
}

pub(super) fn stroke(canvas: &mut PixmapMut, path: Option<Path>, paint: &Paint, stroke: &Stroke) {
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
