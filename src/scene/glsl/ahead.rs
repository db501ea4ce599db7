//! The distance to what can be met ahead, and its gradient: for a march that is right.

use super::distance::{distance_file, surface_distance};
use super::field::{field_files, gradient_text, value_text};
use super::fields_ahead::{Marched, fields_ahead};
use super::land::{land_files, land_text};
use super::{Source, Text, add_once, named, shape_files, source, turn_file, uniforms_text};
use crate::scene::{Scene, Shape};
use std::borrow::Cow;
use std::fmt::Write;

/// `distanceAhead(p, d, last, object, second)`, `gradientAhead(p, d, object, slack)`,
/// `land(object, d, p, normal)` of a scene, and `surfaceDistance(p, object)` where normals
/// are taken from differences of it.
pub fn ahead_sources(scene: &Scene, difference_normals: bool) -> Vec<Source> {
    let mut sources = vec![source!("rounding.glsl")];
    sources.extend(shape_files(scene, distance_file));
    sources.extend(land_files(scene));
    sources.extend(shape_files(scene, |shape| {
        Some(match shape {
            Shape::Plane => source!("gradient/plane.glsl"),
            Shape::Box { .. } => source!("gradient/box.glsl"),
            Shape::Room { .. } => source!("gradient/room.glsl"),
            Shape::Sphere { .. } => source!("gradient/sphere.glsl"),
            Shape::Cylinder { .. } => source!("gradient/cylinder.glsl"),
            Shape::Field(_) => return None,
        })
    }));
    let text = Text::new(scene);
    add_once(&mut sources, field_files(text.fields(), true, &text.assets));
    sources.extend(turn_file(scene));
    sources.push(source!("distance/listener.glsl"));
    let mut out = uniforms_text(scene);
    out += &text.of_fields(|_| true, value_text);
    out += &text.of_fields(|_| true, gradient_text);
    if difference_normals {
        out += &surface_distance(scene);
    }
    out += &distance_ahead(scene);
    out += &gradient_ahead(scene);
    out += &land_text(scene);
    out += &fields_ahead(&text, Marched::All);
    sources.push((Cow::Borrowed("the scene"), Cow::Owned(out)));
    if marches_all_fields(scene) {
        sources.push(source!("march_fields.glsl"));
    }
    sources
}

/// Whether the scene has fields: the march takes all of them.
pub fn marches_all_fields(scene: &Scene) -> bool {
    scene.surfaces.iter().any(|s| s.shape.field().is_some())
}

fn distance_ahead(scene: &Scene) -> String {
    let mut text = String::from(
        "// Distance to the nearest object that a wave at p along d can meet, its number, and\n\
         // the distance to the second nearest. What the wave leaves (last) is out of its way\n\
         // when it is convex; of a room only the walls ahead count.\n\
         float distanceAhead(vec3 p, vec3 d, float last, out float object, out float second) {\n    \
         float nearest = listenerDistance(p);\n    object = 0.0;\n    second = 1e30;\n    \
         float candidate;\n",
    );
    for named in named(scene) {
        let number = named.number;
        let (shape, point, size) = (named.shape(), named.point("p"), named.size());
        let distance = match named.surface.shape {
            Shape::Field(_) => continue,
            Shape::Room { .. } => {
                format!("sdRoomAhead({point}, {}{size})", named.vector("d"))
            }
            _ => format!("last == {number}.0 ? 1e30 : sd{shape}({point}{size})"),
        };
        let _ = writeln!(text, "    // {}\n    candidate = {distance};", named.label);
        let _ = writeln!(
            text,
            "    if (candidate < nearest) {{ second = nearest; nearest = candidate; object = {number}.0; }}\n    \
             else {{ second = min(second, candidate); }}"
        );
    }
    text.push_str("    return nearest;\n}\n\n");
    text
}

fn gradient_ahead(scene: &Scene) -> String {
    let mut text = String::from(
        "// The gradient of the distance to one object, and what rounding may do to it.\n\
         vec3 gradientAhead(vec3 p, vec3 d, float object, out float slack) {\n",
    );
    for named in named(scene) {
        let (shape, point, size) = (named.shape(), named.point("p"), named.size());
        let gradient = match named.surface.shape {
            Shape::Field(_) => continue,
            Shape::Room { .. } => {
                format!("gradientRoomAhead({point}, {}{size})", named.vector("d"))
            }
            Shape::Box { .. } => format!("gradientBox({point}{size})"),
            Shape::Plane | Shape::Sphere { .. } | Shape::Cylinder { .. } => {
                format!("gradient{shape}({point})")
            }
        };
        let _ = writeln!(
            text,
            "    if (object == {}.0) {{ slack = {}; return {}; }} // {}",
            named.number,
            named.slack(),
            named.outward(&gradient),
            named.label
        );
    }
    text.push_str(
        "    slack = roundSlack(uListener);\n    \
         return normalize(p - uListener.xyz);\n}\n\n",
    );
    text
}
