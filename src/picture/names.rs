//! The names of sources and listeners, drawn on a plan.

use super::font::{ADVANCE, write};
use super::marks::{PLATE, PLATE_COLOUR, rectangle};
use super::plan::Plan;
use crate::scene::Scene;
use glam::Vec3;
use tiny_skia::PixmapMut;

/// Maximum letters drawn of a name.
const LONGEST_NAME: usize = 24;

/// Writes the names of the sources if there are several, and those of the listeners likewise.
pub(super) fn draw(canvas: &mut PixmapMut, plan: &Plan, scene: &Scene) {
    let unit = plan.stroke();
    if !scene.further_sources.is_empty() {
        for (source, name) in scene.sources().zip(scene.source_labels()) {
            write_beside(canvas, plan, source.position, 12.0 * unit, &name);
        }
    }
    if !scene.further_listeners.is_empty() {
        for (listener, name) in scene.listeners().zip(scene.listener_labels()) {
            let right = plan.pixels(listener.radius) + 6.0 * unit;
            write_beside(canvas, plan, listener.position, right, &name);
        }
    }
}

/// Writes a name `right` pixels to the right of a place.
fn write_beside(canvas: &mut PixmapMut, plan: &Plan, place: Vec3, right: f32, name: &str) {
    let dot = (1.6 * plan.stroke()).round().max(1.0);
    let middle = plan.pixel(place);
    let left = (middle.x + right).round();
    let top = (middle.y - 3.5 * dot).round();
    let shown: String = name.chars().take(LONGEST_NAME).collect();
    let width = dot * (ADVANCE * shown.chars().count()) as f32;
    let plate = [
        left - 2.0 * dot,
        top - 2.0 * dot,
        width + 3.0 * dot,
        11.0 * dot,
    ];
    rectangle(canvas, plate, PLATE_COLOUR, PLATE);
    write(canvas, &shown, left, top, dot);
}
