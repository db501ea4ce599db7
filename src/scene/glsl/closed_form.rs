//! Where a line meets each surface: no march at all.

use super::field::{
    field_files, files_of_hits, gradient_text, has_closed_form, hit_text, value_text,
};
use super::fields_ahead::{Marched, fields_ahead};
use super::land::{land_files, land_text};
use super::{Named, Source, Text, add_once, named, shape_files, source, turn_file, uniforms_text};
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
    sources.extend(shape_files(scene, |shape| {
        Some(match shape {
            Shape::Plane => source!("hit/plane.glsl"),
            Shape::Box { .. } => source!("hit/box.glsl"),
            Shape::Room { .. } => source!("hit/room.glsl"),
            Shape::Sphere { .. } => source!("hit/sphere.glsl"),
            Shape::Cylinder { .. } => source!("hit/cylinder.glsl"),
            Shape::Field(_) => return None,
        })
    }));
    let text = Text::new(scene);
    for field in text.fields().filter(|field| has_closed_form(field)) {
        add_once(&mut sources, files_of_hits(field));
    }
    add_once(&mut sources, field_files(text.fields(), true, &text.assets));
    sources.extend(land_files(scene));
    sources.extend(turn_file(scene));
    sources.push(source!("distance/listener.glsl"));
    sources.push(source!("hit/listener.glsl"));
    let closed = |named: &Named| named.surface.shape.field().is_some_and(has_closed_form);
    let mut out = uniforms_text(scene);
    out += &text.of_fields(closed, hit_text);
    out += &text.of_fields(|named| Marched::Others.takes(named), value_text);
    out += &text.of_fields(|_| true, gradient_text);
    out += &nearest_hit(scene);
    out += &land_text(scene);
    out += &fields_ahead(&text, Marched::Others);
    sources.push((Cow::Borrowed("the scene"), Cow::Owned(out)));
    if marches_some_fields(scene) {
        sources.push(source!("march_fields.glsl"));
    }
    sources
}

/// Whether the scene has fields without a closed form.
pub fn marches_some_fields(scene: &Scene) -> bool {
    let mut fields = scene.surfaces.iter().filter_map(|s| s.shape.field());
    fields.any(|field| !has_closed_form(field))
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
        if let Shape::Field(field) = &named.surface.shape {
            if has_closed_form(field) {
                text += &hit_field(&named);
            }
            continue;
        }
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

fn hit_field(named: &Named) -> String {
    let number = named.number;
    let hit = format!(
        "hit{number}({}, {}, {})",
        named.point("p"),
        named.vector("d"),
        named.slack()
    );
    let candidate = match named.surface.shape.is_convex() {
        true => format!("last == {number}.0 ? NO_HIT : {hit}"),
        false => hit,
    };
    format!(
        "    // {}\n    candidate = {candidate};\n    \
         if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}\n",
        named.label
    )
}
