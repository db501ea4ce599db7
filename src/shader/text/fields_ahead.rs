//! The fields that are marched: what a march knows of them at a point of its line.

use super::field::{Write, chords_text, free_text, line_text, value_text};
use super::link::{Part, fill, source};
use super::scene_text::{Text, of_kind};
use super::surface_names::{Marched, Named};

/// The parts of `fieldsAhead(p, d, last, errorBound)` and of the march that calls it; empty if no field is marched.
pub(super) fn fields_ahead(text: &Text, marched: Marched) -> Vec<Part> {
    if !text.marches(marched) {
        return Vec::new();
    }
    let mut all = Vec::new();
    let in_cells = text.marches_kinds(marched);
    let takes = |named: &Named| marched.takes(named) && (in_cells || !named.is_data());
    text.add_fields(&mut all, takes, line_text);
    text.add_fields(
        &mut all,
        |named| takes(named) && named.needs_bound(),
        free_text,
    );
    text.add_fields(
        &mut all,
        |named| takes(named) && named.has_chords(),
        chords_text,
    );
    if in_cells {
        text.add(&mut all, "the kinds of fields", kinds(text, marched));
    }
    let taken = || text.unrolled.iter().filter(|named| takes(named));
    let mut surfaces: String = taken().map(ahead_of_surface).collect();
    let chords: String = taken()
        .filter(|named| named.has_chords())
        .map(find_chords)
        .collect();
    let mut at_start: String = taken().map(free_at_start).collect();
    if in_cells {
        surfaces.push_str("    fieldsInCells(p, d, last, errorBound, ahead);\n");
        at_start.push_str("    free = 0.0;\n");
    }
    let skeleton = source!("template/fields_ahead.glsl");
    text.add(
        &mut all,
        "the fields",
        fill(
            &skeleton,
            &[
                ("chords", &chords),
                ("at_start", &at_start),
                ("surfaces", &surfaces),
            ],
        ),
    );
    let is_free = !in_cells && taken().all(Named::has_free_steps);
    let march = [
        ("name", "Fields"),
        ("is_free", if is_free { "true" } else { "false" }),
        ("given", "last"),
        (
            "start",
            "    findChords(origin, d, ROUNDING * size);\n    float start = freeAtStart(last, ROUNDING * size);\n",
        ),
        ("steps", "uFieldSteps"),
        ("ahead", "fieldsAhead(t, p, d, last, rounding)"),
        ("taken", ""),
    ];
    text.add(&mut all, "the march of the fields", march_text(&march));
    all
}

/// The skeleton of a march, filled with these texts.
fn march_text(texts: &[(&str, &str)]) -> String {
    fill(&source!("template/march.glsl"), texts)
}

/// A surface that is marched alone on its line, whose point and direction in the surface's own axes are `q` and
/// `lineAlong`, and the length that is free of it.
pub(super) fn on_own_line(loaded: &Named) -> [String; 2] {
    [
        loaded.on_line("q", "lineAlong"),
        loaded.free("q", "lineAlong", "errorBound"),
    ]
}

/// The function that marches a surface of a kind alone, which has been loaded.
pub(super) fn march_alone(kind: usize) -> String {
    march_text(&[
        ("name", &kind.to_string()),
        ("is_free", "false"),
        ("given", "start"),
        ("start", ""),
        ("steps", "fieldSteps"),
        ("ahead", &format!("ahead{kind}(t, rounding)")),
        ("taken", "    fieldSteps -= min(i + 1, stepLimit);\n"),
    ])
}

/// The functions of a field that [`on_own_line`] calls.
pub(super) fn functions_alone(text: &Text, loaded: &Named) -> String {
    let mut writes: Vec<Write> = vec![value_text, line_text];
    if loaded.needs_bound() {
        writes.push(free_text);
    }
    let functions = writes.into_iter();
    functions
        .map(|write| text.functions_of(loaded, write))
        .collect()
}

/// The statement that finds the chords of a line with a field.
fn find_chords(named: &Named) -> String {
    let (tag, point, vector) = (&named.tag, named.point("p"), named.vector("d"));
    let error_bound = format!("CHORD_MARGIN * max(errorBound, {})", named.error_bound());
    format!("    findChords{tag}({point}, {vector}, {error_bound});\n")
}

/// The statement that limits the free length at the start of a flight to that of a field.
fn free_at_start(named: &Named) -> String {
    let free = match named.has_chords() {
        true => format!(
            "freeBy(through{0}({early}), {early})",
            named.tag,
            early = format_args!("EARLY * max(errorBound, {})", named.error_bound())
        ),
        false => "0.0".to_owned(),
    };
    let free = named.unless_left(&named.left(), "NO_END", &free);
    format!("    free = min(free, {free});\n")
}

fn ahead_of_surface(named: &Named) -> String {
    let statements = ahead_of(named, &format!("{}.0", named.tag));
    let condition = match named.surface.shape.is_convex() {
        true => format!("if (!({})) ", named.left()),
        false => String::new(),
    };
    format!(
        "    // {}\n    {condition}{{\n{statements}    }}\n",
        named.label
    )
}

/// The statements that add a field to what is ahead.
fn ahead_of(named: &Named, object: &str) -> String {
    let through = match named.has_chords() {
        true => format!("        free = through{}(t + free) - t;\n", named.tag),
        false => String::new(),
    };
    format!(
        "        OnLine field = {};\n        float free = freeOf(field, {});\n{through}        \
         addField(ahead, {object}, field, free, {});\n",
        named.on_line(&named.point("p"), &named.vector("d")),
        named.free(&named.point("p"), &named.vector("d"), "errorBound"),
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
            let left = match named.surface.shape.is_convex() {
                true => "if (left) { return; }",
                false => "",
            };
            format!("{left}\n{}    ", ahead_of(named, "object"))
        },
        "",
    )
}
