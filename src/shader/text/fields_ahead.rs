//! The fields that are marched: their least value, and the gradient of one of them.

use super::field::{free_text, is_bounded};
use super::link::{Part, parts, source};
use super::scene_text::{Text, by_object, of_kind};
use super::surface_names::{Marched, Named};
use std::fmt::Write;

/// The parts of `fieldsAhead(p, d, last, object, reach, within)`, `fieldsFree(p, d, last,
/// errorBound)`, `fieldGradient(p, object, errorBound)` and the march that calls them; empty if no
/// field is marched.
pub(super) fn fields_ahead(text: &Text, marched: Marched) -> Vec<Part> {
    if !text.marches(marched) {
        return Vec::new();
    }
    let in_cells = text.instanced.iter().any(|named| marched.takes(named));
    let mut all = Vec::new();
    if any_is_bounded(text, marched) {
        text.add_fields(&mut all, |named| marched.takes(named), free_text);
        text.add(&mut all, "the bounds of kinds", free_of_kind(text, marched));
    }
    if in_cells {
        let kinds = field_of_kind(text, marched) + &gradient_of_kind(text, marched);
        text.add(&mut all, "the kinds of fields", kinds);
    }
    let functions = value(text, marched, in_cells)
        + &free(text, marched, in_cells)
        + &gradient(text, marched, in_cells);
    text.add(&mut all, "the fields", functions);
    all.extend(parts(source!("common/march_fields.glsl")));
    all
}

/// Whether one of the fields has a bound along lines in addition to its value.
fn any_is_bounded(text: &Text, marched: Marched) -> bool {
    text.all()
        .any(|named| marched.takes(named) && named.field().is_some_and(is_bounded))
}

fn field_of_kind(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// The value of a field in cells, by its kind and the index of its numbers.\n\
         float fieldOfKind(float kind, int data, vec3 p, bool left) {\n",
        |named| marched.takes(named),
        |named| {
            let value = named.distance("p");
            format!("return {};", named.unless_left("left", "1e30", &value))
        },
        "    return 1e30;\n",
    )
}

fn free_of_kind(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// Distance along d from p that is free of a field in cells.\n\
         float freeOfKind(float kind, int data, vec3 p, vec3 d, float errorBound) {\n",
        |named| marched.takes(named),
        |named| format!("return {};", named.free("p", "d", "errorBound")),
        "    return 0.0;\n",
    )
}

fn gradient_of_kind(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// The gradient of a field in cells, and the error bound of its value.\n\
         vec3 fieldGradientOfKind(float kind, int data, vec3 p, out float errorBound) {\n    \
         errorBound = 0.0;\n",
        |named| marched.takes(named),
        gradient_statement,
        "    return vec3(0.0);\n",
    )
}

fn gradient_statement(named: &Named) -> String {
    let gradient = named.field_gradient(&named.point("p")) + ".xyz";
    format!(
        "errorBound = {}; return {};",
        named.error_bound(),
        named.outward(&gradient)
    )
}

fn value(text: &Text, marched: Marched, in_cells: bool) -> String {
    let mut out = String::from(
        "// The least value of the fields that a wave at p along d can hit, and that field's\n\
         // number. The value is valid up to reach along d; the same fields are evaluated up to within.\n\
         // A convex field that the wave leaves (last) cannot be hit.\n\
         float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach, out float within) {\n    \
         float nearest = 1e30;\n    reach = 1e30;\n    within = 1e30;\n    object = -1.0;\n    float candidate;\n",
    );
    for named in text.unrolled.iter().filter(|named| marched.takes(named)) {
        let value = named.unless_left(&named.left(), "1e30", &named.distance("p"));
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {value};\n    \
             if (candidate < nearest) {{ nearest = candidate; object = {}.0; }}",
            named.label, named.tag
        );
    }
    if in_cells {
        out.push_str("    fieldsInCells(p, d, last, nearest, object, reach, within);\n");
    }
    out + "    return nearest;\n}\n\n"
}

fn free(text: &Text, marched: Marched, in_cells: bool) -> String {
    if !any_is_bounded(text, marched) {
        return String::from(
            "// The fields have no bound along lines.\n\
             float fieldsFree(vec3 p, vec3 d, float last, float errorBound) { return 0.0; }\n\n",
        );
    }
    let mut out = String::from(
        "// Distance along d from p that is certainly free of every field; errorBound is the rounding\n\
         // error of their values.\n\
         float fieldsFree(vec3 p, vec3 d, float last, float errorBound) {\n    \
         float way = NO_END;\n    float candidate;\n",
    );
    for named in text.unrolled.iter().filter(|named| marched.takes(named)) {
        let value = named.unless_left(&named.left(), "NO_END", &named.distance("p"));
        let free = named.free("p", "d", "errorBound");
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {value};\n    \
             if (candidate < way) {{ way = min(way, max(candidate, {free})); }}",
            named.label
        );
    }
    if in_cells {
        out.push_str("    fieldsFreeInCells(p, d, last, errorBound, way);\n");
    }
    out + "    return way;\n}\n\n"
}

fn gradient(text: &Text, marched: Marched, in_cells: bool) -> String {
    let mut out = String::from(
        "// The gradient of one field, and the error bound of its value.\n\
         vec3 fieldGradient(vec3 p, float object, out float errorBound) {\n    errorBound = 0.0;\n",
    );
    let taken = text.unrolled.iter().filter(|named| marched.takes(named));
    out += &by_object(taken, gradient_statement);
    if in_cells {
        out.push_str(
            "    if (object > 0.0) {\n        vec4 entry = entryOf(object);\n        \
             return fieldGradientOfKind(entry.y, int(entry.z), p, errorBound);\n    }\n",
        );
    }
    out + "    return vec3(0.0);\n}\n\n"
}
