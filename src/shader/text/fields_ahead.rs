//! The fields that are marched: what a march knows of them at a point of its line.

use super::field::{free_text, is_bounded, is_known_on_lines, is_smooth_on_lines, line_text};
use super::link::{Part, fill, parts, source};
use super::scene_text::{Text, of_kind};
use super::surface_names::{Marched, Named};

/// The parts of `fieldsAhead(p, d, last, errorBound)` and of the march that calls it; empty if no field is marched.
pub(super) fn fields_ahead(text: &Text, marched: Marched) -> Vec<Part> {
    if !text.marches(marched) {
        return Vec::new();
    }
    let mut all = Vec::new();
    let takes = |named: &Named| marched.takes(named);
    text.add_fields(&mut all, takes, line_text);
    text.add_fields(&mut all, |named| takes(named) && needs_bound(named), free_text);
    let in_cells = text.instanced.iter().any(takes);
    if in_cells {
        text.add(&mut all, "the kinds of fields", kinds(text, marched));
    }
    let taken = text.unrolled.iter().filter(|named| takes(named));
    let mut surfaces: String = taken.map(ahead_of_surface).collect();
    if in_cells {
        surfaces.push_str("    fieldsInCells(p, d, last, errorBound, ahead);\n");
    }
    let skeleton = source!("template/fields_ahead.glsl");
    text.add(&mut all, "the fields", fill(&skeleton, &[("surfaces", &surfaces)]));
    all.extend(parts(source!("common/ahead.glsl")));
    all.extend(parts(source!("common/march_fields.glsl")));
    all
}

/// Whether a lower bound along lines reaches further than the value on the line shows.
fn needs_bound(named: &Named) -> bool {
    let is = |field| is_bounded(field) && !(is_known_on_lines(field) && is_smooth_on_lines(field));
    named.field().is_some_and(is)
}

fn ahead_of_surface(named: &Named) -> String {
    let statement = ahead_of(named, &format!("{}.0", named.tag));
    let statement = match named.surface.shape.is_convex() {
        true => format!("if (!({})) {{ {statement} }}", named.left()),
        false => statement,
    };
    format!("    // {}\n    {statement}\n", named.label)
}

/// The statement that adds a field to what is ahead.
fn ahead_of(named: &Named, object: &str) -> String {
    format!(
        "addField(ahead, {object}, {}, {}, {}, errorBound);",
        named.on_line("p", "d"),
        named.free("p", "d", "errorBound"),
        named.error_bound()
    )
}

fn kinds(text: &Text, marched: Marched) -> String {
    of_kind(
        text,
        "// Adds a field in cells, by its number, its kind and the index of its numbers.\n\
         void addFieldOfKind(float object, float kind, int data, vec3 p, vec3 d, bool left, float errorBound, inout Ahead ahead) {\n",
        |named| marched.takes(named),
        |named| {
            let statement = ahead_of(named, "object");
            match named.surface.shape.is_convex() {
                true => format!("if (!left) {{ {statement} }}"),
                false => statement,
            }
        },
        "",
    )
}
