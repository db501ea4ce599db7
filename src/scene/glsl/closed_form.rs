//! Where a line meets each surface: no march at all, but for fields without a closed form.

use super::cells::{of_kind, walk_files};
use super::field::{field_files, gradient_text, hit_text, normal_text, value_text};
use super::fields_ahead::{Marched, fields_ahead};
use super::land::{land_files, land_text};
use super::source::without_uncalled;
use super::{Named, Source, Text, add_once, source};
use crate::scene::Scene;
use std::borrow::Cow;
use std::fmt::Write;

/// `nearestHit(p, d, last, object)` and `land(object, d, p, normal)` of a scene; where fields
/// have no closed form `marchFields(p, d, last, limit, object, guardHit)` for these.
pub fn closed_form_sources(scene: &Scene) -> Vec<Source> {
    let text = Text::new(scene);
    let mut sources = vec![
        source!("rounding.glsl"),
        source!("hit/none.glsl"),
        source!("hit/ball.glsl"),
    ];
    for named in text.all() {
        add_once(&mut sources, named.hit_files());
    }
    add_once(&mut sources, text.data_file());
    let fields = field_files(text.fields(), true, &text.assets);
    add_once(&mut sources, fields);
    sources.extend(land_files(&text));
    sources.extend(text.turn_file());
    sources.push(source!("distance/listener.glsl"));
    sources.push(source!("hit/listener.glsl"));
    let marched = |named: &Named| Marched::Others.takes(named);
    let mut functions = text.uniforms();
    functions += &text.of_fields(|named| named.has_closed_form(), hit_text);
    functions += &text.of_fields(marched, value_text);
    functions += &text.of_fields(|_| true, gradient_text);
    functions += &text.of_fields(|_| true, normal_text);
    sources.push((Cow::Borrowed("the surfaces"), Cow::Owned(functions)));
    add_once(&mut sources, hit_in_cells(&text));
    let functions = nearest_hit(&text) + &land_text(&text);
    sources.push((Cow::Borrowed("the scene"), Cow::Owned(functions)));
    add_once(&mut sources, fields_ahead(&text, Marched::Others));
    without_uncalled(sources)
}

/// What `nearestHit` calls for the surfaces in cells.
fn hit_in_cells(text: &Text) -> Vec<Source> {
    if text.kinds.is_empty() {
        return Vec::new();
    }
    let kinds = of_kind(
        text,
        "// Where a line meets a surface in cells, by its kind and the place of its values.\n\
         float hitOfKind(float kind, int data, vec3 p, vec3 d, bool left) {\n",
        |named| named.has_closed_form(),
        |named| {
            let hit = named.hit("p", "d");
            format!("return {};", named.unless_left("left", "NO_HIT", &hit))
        },
        "    return NO_HIT;\n",
    );
    let mut sources = walk_files();
    sources.push((Cow::Borrowed("the kinds"), Cow::Owned(kinds)));
    sources.push(source!("cells/hit.glsl"));
    sources
}

fn nearest_hit(text: &Text) -> String {
    let mut out = String::from(
        "// How far from p along d the next object is, and its number. A convex surface is\n\
         // not met by the wave that leaves it (last). Where nothing is met the distance is\n\
         // NO_HIT and the number means nothing.\n\
         float nearestHit(vec3 p, vec3 d, float last, out float object) {\n    \
         float nearest = hitListener(p, d);\n    object = 0.0;\n",
    );
    let closed: Vec<&Named> = text.loose.iter().filter(|n| n.has_closed_form()).collect();
    if !closed.is_empty() {
        out.push_str("    float candidate;\n");
    }
    for named in closed {
        let hit = named.unless_left(&named.left(), "NO_HIT", &named.hit("p", "d"));
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {hit};\n    \
             if (candidate < nearest) {{ nearest = candidate; object = {}.0; }}",
            named.label, named.tag
        );
    }
    if text.kinds.iter().any(Named::has_closed_form) {
        out.push_str("    hitInCells(p, d, last, nearest, object);\n");
    }
    out + "    return nearest;\n}\n\n"
}
