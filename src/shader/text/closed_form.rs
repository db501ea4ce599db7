//! Intersections of a line with surfaces in closed form. Only fields without a closed form are marched.
//!
//! Each unrolled surface has its own lines of text. Each kind in cells has a loop over its records
//! (`shader/scene_data.rs`). The surfaces of a kind without a closed form are marched one after another. Their records
//! contain the boxes around the surfaces, and a surface is marched only if the line enters its box.

use super::field::{gradient_text, hit_text, normal_text, value_text};
use super::fields_ahead::{fields_ahead, functions_alone, march_alone, on_own_line};
use super::link::{Part, fill, source};
use super::reflect::reflect_text;
use super::scene_text::{ListenerText, Text};
use super::surface_names::{Marched, Named};
use crate::scene::Node;
use crate::shader::layout::GRID_VECTORS;
use crate::shader::origin_rebasing::BOX_VECTORS;
use crate::shader::scene_data::Record;
use std::fmt::Write;

/// The parts of `closestHit(p, d, last, limit, object)` and `reflectWave(object, t, p, d)` for a scene, and of
/// `marchFields(p, d, last, limit, object, limitReached)` for the fields without a closed form.
pub fn closed_form_parts(text: &Text, listener: ListenerText) -> Vec<Part> {
    let marched = |named: &Named| Marched::Others.takes(named) && !named.is_data();
    let mut parts = text.parts();
    text.add_fields(&mut parts, |named| named.has_closed_form(), hit_text);
    text.add_fields(&mut parts, marched, value_text);
    text.add_fields(&mut parts, |_| true, gradient_text);
    text.add_fields(&mut parts, |_| true, normal_text);
    text.add(&mut parts, "the grids of kinds", grids_text(text));
    let functions = closest_of_kinds(text) + &closest_hit(text, listener) + &reflect_text(text);
    text.add(&mut parts, "the scene", functions);
    if text.instanced.iter().any(|kind| !kind.has_closed_form()) {
        text.add(&mut parts, "the marched kinds", marched_kinds(text));
    }
    parts.extend(fields_ahead(text, Marched::Others));
    parts
}

fn closest_hit(text: &Text, listener: ListenerText) -> String {
    let first = match listener {
        ListenerText::Solid => "min(hitListener(p, d), limit)",
        ListenerText::Transparent => "limit",
    };
    let mut surfaces = String::new();
    if text.all().any(Named::has_step_limit) {
        surfaces.push_str("    copySteps = uCopySteps;\n");
    }
    let closed: Vec<&Named> = text
        .unrolled
        .iter()
        .filter(|n| n.has_closed_form())
        .collect();
    if !closed.is_empty() {
        surfaces.push_str("    float candidate;\n");
    }
    let (limited, others): (Vec<&Named>, Vec<&Named>) =
        closed.into_iter().partition(|named| named.has_step_limit());
    for named in others {
        surfaces += &candidate(named);
    }
    surfaces += &kind_calls(text);
    // A step limit counts only if the line hits nothing nearer.
    for named in limited {
        surfaces += &candidate(named);
    }
    let result = match text.instanced.iter().all(Named::has_closed_form) {
        true => "nearest",
        false => "object < 0.0 ? GIVEN_UP : nearest",
    };
    let skeleton = source!("template/closest_hit.glsl");
    let texts = [
        ("first", first),
        ("surfaces", &surfaces),
        ("result", result),
    ];
    fill(&skeleton, &texts)
}

fn candidate(named: &Named) -> String {
    let hit = named.hit("p", "d", "nearest");
    let mut out = format!("    // {}\n    candidate = {hit};\n", named.label);
    if named.surface.shape.is_convex() {
        let _ = writeln!(
            out,
            "    candidate = {} ? NO_HIT : candidate;",
            named.left()
        );
    }
    let _ = writeln!(
        out,
        "    object = candidate < nearest ? {}.0 : object;\n    \
         nearest = min(candidate, nearest);",
        named.tag
    );
    out
}

/// The grids of the kinds, and the axes of their cells.
fn grids_text(text: &Text) -> String {
    let kinds = text.instanced.len();
    if kinds == 0 {
        return String::new();
    }
    let axes: String = ["x", "y", "z"]
        .iter()
        .zip(text.unbounded_axes)
        .filter(|(_, unbounded)| !unbounded)
        .map(|(axis, _)| *axis)
        .collect();
    let vector = ["float", "vec2", "vec3"][axes.len().max(1) - 1];
    format!(
        "#define CELL_VECTOR {vector}\n\n#define CELL_AXES {axes}\n\n\
         uniform vec4 uGrids[{}];\n\n",
        GRID_VECTORS * kinds
    )
}

/// The kinds with their numbers: either the marched kinds or those with a closed form.
fn kinds<'a>(text: &'a Text, marched: bool) -> impl Iterator<Item = (usize, &'a Named<'a>)> {
    let kinds = text.instanced.iter().enumerate();
    kinds.filter(move |(_, named)| named.has_closed_form() != marched)
}

/// The calls for all kinds. Each call looks only for a hit that is nearer than those found before. Marches come last,
/// because nearer hits shorten them.
fn kind_calls(text: &Text) -> String {
    let call = |(kind, _)| format!("    closestOfKind{kind}(p, d, last, nearest, object);\n");
    let mut calls: String = kinds(text, false).map(call).collect();
    let marched: String = kinds(text, true).map(call).collect();
    if !marched.is_empty() {
        calls.push_str("    fieldSteps = uFieldSteps;\n");
    }
    calls + &marched
}

/// The parts of `closestOfKindN(p, d, last, nearest, object)` for each kind with a closed form.
fn closest_of_kinds(text: &Text) -> String {
    kinds(text, false)
        .map(|(kind, named)| closest_of_kind(named, kind))
        .collect()
}

/// The parts of `closestOfKindN(p, d, last, nearest, object)` for each kind without a closed form.
fn marched_kinds(text: &Text) -> String {
    let vectors = kinds(text, true).map(|(_, named)| named.loaded().value_count());
    let loaded = (0..vectors.max().unwrap_or(0)).map(|n| format!("vec4 loaded{n} = vec4(0.0);\n"));
    let declared = loaded.collect::<String>() + "\n";
    let functions =
        kinds(text, true).map(|(kind, named)| closest_of_marched_kind(text, named, kind));
    declared + &functions.collect::<String>()
}

fn closest_of_marched_kind(text: &Text, named: &Named, kind: usize) -> String {
    let loaded = named.loaded();
    let record = Record::of(named.surface);
    let [field, free] = on_own_line(&loaded);
    let load: String = (0..loaded.value_count())
        .map(|n| format!("    {} = {};\n", loaded.value(n), named.value(n)))
        .collect();
    let texts = [
        ("label", named.label.as_str()),
        ("kind", &kind.to_string()),
        ("grid", &(GRID_VECTORS * kind).to_string()),
        ("vectors", &record.vectors.to_string()),
        ("box_vectors", &BOX_VECTORS.to_string()),
        ("load", &load),
        ("field", &field),
        ("free", &free),
        ("error_bound", &loaded.error_bound()),
        ("start", &loaded.point("p + start * d")),
        ("along", &loaded.vector("d")),
        ("point", &named.vector("p - centre")),
        ("vector", &named.vector("d")),
        ("is_left", is_left(named)),
    ];
    functions_alone(text, &loaded)
        + &fill(&source!("template/closest_of_marched_kind.glsl"), &texts)
        + &march_alone(kind)
}

/// The condition that excludes the convex surface that the wave leaves.
fn is_left(named: &Named) -> &'static str {
    match named.surface.shape.is_convex() {
        true => " && number != last",
        false => "",
    }
}

fn closest_of_kind(named: &Named, kind: usize) -> String {
    let record = Record::of(named.surface);
    let (vectors, tag) = (record.vectors, record.component());
    let data = if record.has_head { "at + 1" } else { "at" };
    let (of_line, candidate) = record_candidate(named);
    let texts = [
        ("label", named.label.as_str()),
        ("kind", &kind.to_string()),
        ("grid", &(GRID_VECTORS * kind).to_string()),
        ("of_line", of_line),
        ("vectors", &vectors.to_string()),
        ("tag", tag),
        ("data", data),
        ("candidate", &candidate),
        ("is_left", is_left(named)),
    ];
    fill(&source!("template/closest_of_kind.glsl"), &texts)
}

/// The values that are computed once per line, and the expression that intersects the line with the surface of a
/// record.
fn record_candidate(named: &Named) -> (&'static str, String) {
    let turned = named.surface.has_rotation();
    match named.surface.shape.node {
        Node::Cylinder(_) if !turned => (
            "    vec3 heading = planeHeading(d);\n",
            "enterCircle(p.xz - sceneData(data).xz, heading.xy, heading.z, \
             sceneData(data).w * sceneData(data).w)"
                .to_owned(),
        ),
        Node::Cuboid(_) if !turned => (
            "    vec3 heading = headingSigns(d);\n    vec3 slowness = inverseSpeeds(d);\n",
            "enterBox(p - sceneData(data).xyz, heading, slowness, sceneData(data + 1))".to_owned(),
        ),
        _ => ("", named.hit("p", "d", "end")),
    }
}
