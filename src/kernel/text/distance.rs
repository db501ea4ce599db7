//! The signed distance to everything: what the thesis' march evaluates.

use super::field::value_text;
use super::link::Part;
use super::over_kinds::of_kind;
use super::scene_text::Text;
use crate::kernel::cells::Lists;
use crate::scene::Scene;
use std::fmt::Write;

/// The distance functions of `scene`: `surfaceDistance(p, object)` over the surfaces
/// and `distanceFunction(p, object)` over surfaces and listener, in world metres.
pub fn distance_parts(scene: &Scene) -> Vec<Part> {
    let text = Text::new(scene, Lists::NearestCandidates);
    let mut parts = text.parts();
    text.add_fields(&mut parts, |_| true, value_text);
    text.add(&mut parts, "the scene's distance", surface_distances(&text));
    text.add(&mut parts, "the scene and the listener", DISTANCE_FUNCTION);
    parts
}

/// `surfaceDistance(p, object)`, and what it calls for the surfaces in cells.
pub(super) fn surface_distances(text: &Text) -> String {
    distance_of_kind(text) + &surface_distance(text)
}

fn distance_of_kind(text: &Text) -> String {
    of_kind(
        text,
        "// Signed distance to a surface in cells, by its kind and the place of its values.\n\
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
