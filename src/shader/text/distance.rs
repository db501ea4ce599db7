//! The distance functions of a scene: the distance to all objects, for the march of `thesis` and for pictures; and the
//! distance to the objects that can be hit ahead, with its gradient, for the march of `march`.

use super::field::{gradient_text, hit_text, normal_text, value_text};
use super::fields_ahead::fields_ahead;
use super::link::Part;
use super::reflect::reflect_text;
use super::scene_text::{ListenerText, Text, by_object, of_kind};
use super::surface_names::{Marched, Named};
use crate::scene::Node;
use std::fmt::Write;

/// The parts of the distance functions of a scene: `surfaceDistance(p, object)` over the surfaces, and
/// `distanceFunction(p, object)` over the surfaces and the listener. Distances are in metres, and points in world
/// coordinates.
pub fn distance_parts(text: &Text) -> Vec<Part> {
    let mut parts = text.parts();
    text.add_fields(&mut parts, |_| true, value_text);
    text.add(&mut parts, "the scene's distance", surface_distances(text));
    text.add(&mut parts, "the scene and the listener", DISTANCE_FUNCTION);
    parts
}

/// `surfaceDistance(p, object)`, and the functions for surfaces in cells that it calls.
fn surface_distances(text: &Text) -> String {
    distance_of_kind(text) + &surface_distance(text)
}

fn distance_of_kind(text: &Text) -> String {
    of_kind(
        text,
        "// Signed distance to a surface in cells, by its kind and the index of its values.\n\
         float surfaceOfKind(float kind, int data, vec3 p) {\n",
        |_| true,
        |named| format!("return {};", named.distance("p")),
        "    return 1e30;\n",
    )
}

fn surface_distance(text: &Text) -> String {
    let mut out = String::from(
        "// Signed distance to the nearest surface, and its number from 1.\n\
         float surfaceDistance(vec3 p, out float object) {\n",
    );
    let mut is_first = true;
    for named in &text.unrolled {
        let (call, number) = (named.distance("p"), &named.tag);
        let _ = writeln!(out, "    // {}", named.label);
        let _ = if is_first {
            writeln!(out, "    float nearest = {call};\n    object = {number}.0;")
        } else {
            writeln!(
                out,
                "    candidate = {call};\n    \
                 if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}"
            )
        };
        if is_first && text.unrolled.len() > 1 {
            out.push_str("    float candidate;\n");
        }
        is_first = false;
    }
    if is_first {
        out.push_str("    float nearest = 1e30;\n    object = 1.0;\n");
    }
    if !text.instanced.is_empty() {
        out.push_str("    distanceInCells(p, nearest, object);\n");
    }
    out.push_str("    return nearest;\n}\n\n");
    out
}

/// The function `distanceFunction` of the thesis, in which the listener is object number 0.
const DISTANCE_FUNCTION: &str = "\
// Signed distance to the nearest surface or to the listener, whose number is 0.
float distanceFunction(vec3 p, out float object) {
    float nearest = surfaceDistance(p, object);
    float listener = listenerDistance(p);
    if (listener <= nearest) { nearest = listener; object = 0.0; }
    return nearest;
}
";

/// The parts of `directedDistance(p, d, last, object, second)`, `directedGradient(p, d, object, errorBound)`
/// and `reflectWave(object, t, p, d)` for a scene, and of `marchFields(p, d, last, limit, object,
/// limitReached)` if it has fields.
pub fn directed_parts(text: &Text, listener: ListenerText) -> Vec<Part> {
    let mut parts = text.parts();
    text.add_fields(&mut parts, |_| true, value_text);
    text.add_fields(&mut parts, |_| true, gradient_text);
    text.add_fields(&mut parts, |_| true, normal_text);
    text.add_fields(&mut parts, |named| named.is_mesh(), hit_text);
    let functions = of_kinds(text)
        + &directed_distance(text, listener)
        + &directed_gradient(text)
        + &closest_mesh(text);
    text.add(&mut parts, "the scene", functions + &reflect_text(text));
    parts.extend(fields_ahead(text, Marched::All));
    parts
}

/// The functions for kinds, which the functions below call for surfaces in cells.
fn of_kinds(text: &Text) -> String {
    let basic = |named: &Named| named.field().is_none();
    let distance = of_kind(
        text,
        "// The distance to a basic shape in cells, by its kind and the index of its values.\n\
         float distanceOfKind(float kind, int data, vec3 p, vec3 d, bool left) {\n",
        basic,
        |named| {
            let distance = named.directed_distance("p", "d");
            format!("return {};", named.unless_left("left", "1e30", &distance))
        },
        "    return 1e30;\n",
    );
    let gradient = of_kind(
        text,
        "// The gradient of this distance, and the distance's error bound.\n\
         vec3 gradientOfKind(float kind, int data, vec3 p, vec3 d, out float errorBound) {\n    \
         errorBound = 0.0;\n",
        basic,
        gradient_statement,
        "    return vec3(0.0);\n",
    );
    distance + &gradient
}

fn directed_distance(text: &Text, listener: ListenerText) -> String {
    let first = match listener {
        ListenerText::Solid => "sdListenerDirected(p, d)",
        ListenerText::Transparent => "1e30",
    };
    let mut out = format!(
        "// Distance to the nearest object that a wave at p along d can hit, its number, and\n\
         // the distance to the second nearest. A convex surface that the wave\n\
         // leaves (last) or moves away from cannot be hit; of a room, only the walls ahead\n\
         // can be hit.\n\
         float directedDistance(vec3 p, vec3 d, float last, out float object, out float second) {{\n    \
         float nearest = {first};\n    object = 0.0;\n    second = 1e30;\n    \
         float candidate;\n",
    );
    for named in text.unrolled.iter().filter(|named| named.field().is_none()) {
        let distance = named.directed_distance("p", "d");
        let distance = named.unless_left(&named.left(), "1e30", &distance);
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {distance};\n    \
             if (candidate < nearest) {{ second = nearest; nearest = candidate; object = {}.0; }}\n    \
             else {{ second = min(second, candidate); }}",
            named.label, named.tag
        );
    }
    if text.instanced.iter().any(|named| named.field().is_none()) {
        out.push_str("    directedInCells(p, d, last, nearest, object, second);\n");
    }
    out + "    return nearest;\n}\n\n"
}

fn directed_gradient(text: &Text) -> String {
    let mut out = String::from(
        "// The gradient of the distance to one object, and the distance's error bound.\n\
         vec3 directedGradient(vec3 p, vec3 d, float object, out float errorBound) {\n",
    );
    let closed_forms = text.unrolled.iter().filter(|named| named.field().is_none());
    out += &by_object(closed_forms, gradient_statement);
    if text.instanced.iter().any(|named| named.field().is_none()) {
        out.push_str(
            "    if (object > 0.0) {\n        vec4 entry = entryOf(object);\n        \
             return gradientOfKind(entry.y, int(entry.z), p, d, errorBound);\n    }\n",
        );
    }
    out + "    errorBound = roundErrorBound(listener);\n    return normalize(p - listener.xyz);\n}\n\n"
}

/// `closestMesh(p, d, limit, object)`; empty without meshes.
fn closest_mesh(text: &Text) -> String {
    if !text.has_meshes() {
        return String::new();
    }
    let mut out = String::from(
        "// The distance from p along d to the nearest face of a mesh before limit, and the number of the mesh;\n\
         // at least limit without such a face.\n\
         float closestMesh(vec3 p, vec3 d, float limit, out float object) {\n    \
         float nearest = limit;\n    object = -1.0;\n    float candidate;\n",
    );
    for named in text.unrolled.iter().filter(|named| named.is_mesh()) {
        let hit = named.hit("p", "d", "nearest");
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {hit};\n    \
             object = candidate < nearest ? {}.0 : object;\n    \
             nearest = min(candidate, nearest);",
            named.label, named.tag
        );
    }
    out + "    return nearest;\n}\n\n"
}

fn gradient_statement(named: &Named) -> String {
    let (shape, point, size) = (named.shape(), named.point("p"), named.size());
    let gradient = match named.surface.shape.node {
        Node::Room(_) => format!("gradientRoomDirected({point}, {}{size})", named.vector("d")),
        Node::Cuboid(_) => format!("gradientBox({point}{size})"),
        _ => format!("gradient{shape}({point})"),
    };
    format!(
        "errorBound = {}; return {};",
        named.error_bound(),
        named.outward(&gradient)
    )
}
