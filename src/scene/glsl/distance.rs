//! The signed distance to everything: what the thesis' march evaluates.

use super::field::{field_files, value_text};
use super::{Source, Text, add_once, named, shape_files, source, turn_file, uniforms_text};
use crate::scene::{Scene, Shape};
use std::borrow::Cow;
use std::fmt::Write;

/// The distance functions of `scene`: `surfaceDistance(p, object)` over the surfaces
/// and `distanceFunction(p, object)` over surfaces and listener, in world metres.
pub fn distance_sources(scene: &Scene) -> Vec<Source> {
    let text = Text::new(scene);
    let mut sources = shape_files(scene, distance_file);
    add_once(
        &mut sources,
        field_files(text.fields(), false, &text.assets),
    );
    sources.extend(turn_file(scene));
    sources.push(source!("distance/listener.glsl"));
    let values = text.of_fields(|_| true, value_text);
    let text = uniforms_text(scene) + &values + &surface_distance(scene) + DISTANCE_FUNCTION;
    sources.push((Cow::Borrowed("the scene"), Cow::Owned(text)));
    sources
}

pub(super) fn distance_file(shape: &Shape) -> Option<Source> {
    Some(match shape {
        Shape::Plane => source!("distance/plane.glsl"),
        Shape::Box { .. } => source!("distance/box.glsl"),
        Shape::Room { .. } => source!("distance/room.glsl"),
        Shape::Sphere { .. } => source!("distance/sphere.glsl"),
        Shape::Cylinder { .. } => source!("distance/cylinder.glsl"),
        Shape::Field(_) => return None,
    })
}

pub(super) fn surface_distance(scene: &Scene) -> String {
    let mut text = String::from(
        "// Signed distance to the nearest surface, and its number from 1.\n\
         float surfaceDistance(vec3 p, out float object) {\n",
    );
    for named in named(scene) {
        let call = match named.surface.shape {
            Shape::Field(_) => named.field_value("p"),
            _ => format!("sd{}({}{})", named.shape(), named.point("p"), named.size()),
        };
        let number = named.number;
        let _ = writeln!(text, "    // {}", named.label);
        if number == 1 {
            let _ = writeln!(text, "    float nearest = {call};\n    object = 1.0;");
            if scene.surfaces.len() > 1 {
                text.push_str("    float candidate;\n");
            }
        } else {
            let _ = writeln!(text, "    candidate = {call};");
            let _ = writeln!(
                text,
                "    if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}"
            );
        }
    }
    text.push_str("    return nearest;\n}\n\n");
    text
}

/// The thesis' `distanceFunction`: the listener is an object too, number 0.
const DISTANCE_FUNCTION: &str = "\
// Signed distance to the nearest surface or to the listener, whose number is 0.
float distanceFunction(vec3 p, out float object) {
    float nearest = surfaceDistance(p, object);
    float listener = listenerDistance(p);
    if (listener <= nearest) { nearest = listener; object = 0.0; }
    return nearest;
}
";
