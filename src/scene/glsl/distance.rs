//! The signed distance to everything: what the thesis' march evaluates.

use super::cells::{grid_files, of_kind};
use super::field::{field_files, value_text};
use super::{Source, Text, add_once, distance_file, source};
use crate::scene::Scene;
use std::borrow::Cow;
use std::fmt::Write;

/// The distance functions of `scene`: `surfaceDistance(p, object)` over the surfaces
/// and `distanceFunction(p, object)` over surfaces and listener, in world metres.
pub fn distance_sources(scene: &Scene) -> Vec<Source> {
    let text = Text::new(scene);
    let mut sources = text.shape_files(distance_file);
    add_once(&mut sources, text.data_file());
    let fields = field_files(text.fields(), false, &text.assets);
    add_once(&mut sources, fields);
    sources.extend(text.turn_file());
    sources.push(source!("distance/listener.glsl"));
    let values = text.uniforms() + &text.of_fields(|_| true, value_text);
    sources.push((Cow::Borrowed("the surfaces"), Cow::Owned(values)));
    sources.extend(surface_distance_sources(&text));
    let function = Cow::Borrowed(DISTANCE_FUNCTION);
    sources.push((Cow::Borrowed("the scene and the listener"), function));
    sources
}

/// `surfaceDistance(p, object)`, after the functions of the fields.
pub(super) fn surface_distance_sources(text: &Text) -> Vec<Source> {
    let mut sources = distance_in_cells(text);
    let function = surface_distance(text);
    sources.push((Cow::Borrowed("the scene's distance"), Cow::Owned(function)));
    sources
}

/// What `surfaceDistance` calls for the surfaces in cells.
fn distance_in_cells(text: &Text) -> Vec<Source> {
    if text.kinds.is_empty() {
        return Vec::new();
    }
    let kinds = of_kind(
        text,
        "// Signed distance to a surface in cells, by its kind and the place of its values.\n\
         float surfaceOfKind(float kind, int data, vec3 p) {\n",
        |_| true,
        |named| format!("return {};", named.distance("p")),
        "    return 1e30;\n",
    );
    let mut sources = grid_files();
    sources.push((Cow::Borrowed("the distances of kinds"), Cow::Owned(kinds)));
    sources.push(source!("cells/distance.glsl"));
    sources
}

fn surface_distance(text: &Text) -> String {
    let mut out = String::from(
        "// Signed distance to the nearest surface, and its number from 1.\n\
         float surfaceDistance(vec3 p, out float object) {\n",
    );
    let mut is_first = true;
    for named in &text.loose {
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
        if is_first && text.loose.len() > 1 {
            out.push_str("    float candidate;\n");
        }
        is_first = false;
    }
    if is_first {
        out.push_str("    float nearest = 1e30;\n    object = 1.0;\n");
    }
    if !text.kinds.is_empty() {
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
