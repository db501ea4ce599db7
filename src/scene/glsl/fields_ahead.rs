//! The fields that are marched: their least value, and the gradient of one of them.

use super::cells::of_kind;
use super::field::{files_of_bounds, free_text, is_bounded};
use super::{Named, Source, Text, add_once, source};
use std::borrow::Cow;
use std::fmt::Write;

/// Which fields of a scene a march has to take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marched {
    /// All of them.
    All,
    /// Those without a closed form.
    Others,
}

impl Marched {
    pub fn takes(self, named: &Named) -> bool {
        named.field().is_some() && (self == Marched::All || !named.has_closed_form())
    }
}

/// `fieldsAhead(p, d, last, object, reach)`, `fieldsFree(p, d, last, slack)`,
/// `fieldGradient(p, object, slack)` and the march that calls them; nothing where nothing is
/// marched. With cells, what walks them must stand before.
pub(super) fn fields_ahead(text: &Text, marched: Marched) -> Vec<Source> {
    if !text.all().any(|named| marched.takes(named)) {
        return Vec::new();
    }
    let in_cells = text.kinds.iter().any(|named| marched.takes(named));
    let bounded = any_is_bounded(text, marched);
    let mut sources = Vec::new();
    if bounded {
        sources = bounds(text, marched);
    }
    if in_cells {
        let kinds = field_of_kind(text, marched) + &gradient_of_kind(text, marched);
        sources.push((Cow::Borrowed("the kinds of fields"), Cow::Owned(kinds)));
        sources.push(source!("cells/fields.glsl"));
    }
    if in_cells && bounded {
        let kinds = free_of_kind(text, marched);
        sources.push((Cow::Borrowed("their bounds"), Cow::Owned(kinds)));
        sources.push(source!("cells/fields_free.glsl"));
    }
    let functions = value(text, marched, in_cells)
        + &free(text, marched, in_cells)
        + &gradient(text, marched, in_cells);
    sources.push((Cow::Borrowed("the fields"), Cow::Owned(functions)));
    sources.push(source!("march_fields.glsl"));
    sources
}

/// Whether anything is known of one of the fields but its value.
fn any_is_bounded(text: &Text, marched: Marched) -> bool {
    text.all()
        .any(|named| marched.takes(named) && named.field().is_some_and(is_bounded))
}

/// The bounds of the fields along a line, and the files that they call.
fn bounds(text: &Text, marched: Marched) -> Vec<Source> {
    let mut sources = Vec::new();
    for named in text.all().filter(|named| marched.takes(named)) {
        let files = named.field().map(files_of_bounds);
        add_once(&mut sources, files.into_iter().flatten());
    }
    let functions = text.of_fields(|named| marched.takes(named), free_text);
    sources.push((
        Cow::Borrowed("the fields along a line"),
        Cow::Owned(functions),
    ));
    sources
}

fn field_of_kind(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// The value of a field in cells, by its kind and the place of its numbers.\n\
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
        "// How far along d from p it leaves the way free.\n\
         float freeOfKind(float kind, int data, vec3 p, vec3 d, float slack) {\n",
        |named| marched.takes(named),
        |named| format!("return {};", named.free("p", "d", "slack")),
        "    return 0.0;\n",
    )
}

fn gradient_of_kind(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// Its gradient, and what rounding may do to its value.\n\
         vec3 fieldGradientOfKind(float kind, int data, vec3 p, out float slack) {\n    \
         slack = 0.0;\n",
        |named| marched.takes(named),
        gradient_statement,
        "    return vec3(0.0);\n",
    )
}

fn gradient_statement(named: &Named) -> String {
    let gradient = named.field_gradient(&named.point("p")) + ".xyz";
    format!(
        "slack = {}; return {};",
        named.slack(),
        named.outward(&gradient)
    )
}

fn value(text: &Text, marched: Marched, in_cells: bool) -> String {
    let mut out = String::from(
        "// The least value of the fields that a wave at p along d can meet, and whose it is. It\n\
         // holds as far as reach along d. A convex one that the wave leaves is out of its way.\n\
         float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach) {\n    \
         float nearest = 1e30;\n    reach = 1e30;\n    object = -1.0;\n    float candidate;\n",
    );
    for named in text.loose.iter().filter(|named| marched.takes(named)) {
        let value = named.unless_left(&named.left(), "1e30", &named.distance("p"));
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {value};\n    \
             if (candidate < nearest) {{ nearest = candidate; object = {}.0; }}",
            named.label, named.tag
        );
    }
    if in_cells {
        out.push_str("    fieldsInCells(p, d, last, nearest, object, reach);\n");
    }
    out + "    return nearest;\n}\n\n"
}

fn free(text: &Text, marched: Marched, in_cells: bool) -> String {
    if !any_is_bounded(text, marched) {
        return String::from(
            "// Nothing is known of the fields but their values.\n\
             float fieldsFree(vec3 p, vec3 d, float last, float slack) { return 0.0; }\n\n",
        );
    }
    let mut out = String::from(
        "// How far along d from p no field is met for sure, where slack is what rounding may do\n\
         // to their values.\n\
         float fieldsFree(vec3 p, vec3 d, float last, float slack) {\n    \
         float way = NO_END;\n    float candidate;\n",
    );
    for named in text.loose.iter().filter(|named| marched.takes(named)) {
        let value = named.unless_left(&named.left(), "NO_END", &named.distance("p"));
        let free = named.free("p", "d", "slack");
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {value};\n    \
             if (candidate < way) {{ way = min(way, max(candidate, {free})); }}",
            named.label
        );
    }
    if in_cells {
        out.push_str("    fieldsFreeInCells(p, d, last, slack, way);\n");
    }
    out + "    return way;\n}\n\n"
}

fn gradient(text: &Text, marched: Marched, in_cells: bool) -> String {
    let mut out = String::from(
        "// The gradient of one of them, and what rounding may do to its value.\n\
         vec3 fieldGradient(vec3 p, float object, out float slack) {\n    slack = 0.0;\n",
    );
    for named in text.loose.iter().filter(|named| marched.takes(named)) {
        let (number, statement) = (&named.tag, gradient_statement(named));
        let label = &named.label;
        let _ = writeln!(
            out,
            "    if (object == {number}.0) {{ {statement} }} // {label}"
        );
    }
    if in_cells {
        out.push_str(
            "    if (object > 0.0) {\n        vec4 entry = entryOf(object);\n        \
             return fieldGradientOfKind(entry.y, int(entry.z), p, slack);\n    }\n",
        );
    }
    out + "    return vec3(0.0);\n}\n\n"
}
