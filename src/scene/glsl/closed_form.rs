//! Where a line meets each surface: no march at all.

use super::land::{land_files, land_text};
use super::{Source, named, shape_files, source, turn_file, uniforms_text};
use crate::scene::{Scene, Shape};
use std::borrow::Cow;
use std::fmt::Write;

/// `nearestHit(p, d, last, object)` and `land(object, d, p, normal)` of a scene.
pub fn closed_form_sources(scene: &Scene) -> Vec<Source> {
    let mut sources = vec![
        source!("rounding.glsl"),
        source!("hit/none.glsl"),
        source!("hit/ball.glsl"),
    ];
    let slabs = |shape: &Shape| matches!(shape, Shape::Box { .. } | Shape::Room { .. });
    if scene.surfaces.iter().any(|s| slabs(&s.shape)) {
        sources.push(source!("hit/safe_inverse.glsl"));
    }
    sources.extend(shape_files(scene, |shape| match shape {
        Shape::Plane => source!("hit/plane.glsl"),
        Shape::Box { .. } => source!("hit/box.glsl"),
        Shape::Room { .. } => source!("hit/room.glsl"),
        Shape::Sphere { .. } => source!("hit/sphere.glsl"),
        Shape::Cylinder { .. } => source!("hit/cylinder.glsl"),
    }));
    sources.extend(land_files(scene));
    sources.extend(turn_file(scene));
    sources.push(source!("distance/listener.glsl"));
    sources.push(source!("hit/listener.glsl"));
    let text = uniforms_text(scene) + &nearest_hit(scene) + &land_text(scene);
    sources.push(("the scene", Cow::Owned(text)));
    sources
}

fn nearest_hit(scene: &Scene) -> String {
    let mut text = String::from(
        "// How far from p along d the next object is, and its number. A convex surface is\n\
         // not met by the wave that leaves it (last). Where nothing is met the distance is\n\
         // NO_HIT and the number means nothing.\n\
         float nearestHit(vec3 p, vec3 d, float last, out float object) {\n    \
         float nearest = hitListener(p, d);\n    object = 0.0;\n    float candidate;\n",
    );
    for named in named(scene) {
        let size = match named.surface.shape {
            Shape::Box { .. } => format!(", uSurfaces[{}]", named.first + 1),
            _ => named.size(),
        };
        let hit = format!(
            "hit{}({}, {}{size})",
            named.shape(),
            named.point("p"),
            named.vector("d"),
        );
        let number = named.number;
        let _ = writeln!(text, "    // {}", named.label);
        if named.surface.shape.is_convex() {
            let _ = writeln!(text, "    candidate = last == {number}.0 ? NO_HIT : {hit};");
        } else {
            let _ = writeln!(text, "    candidate = {hit};");
        }
        let _ = writeln!(
            text,
            "    if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}"
        );
    }
    text.push_str("    return nearest;\n}\n\n");
    text
}
