//! Where a line intersects each surface: no march at all, but for fields without a closed form.

use super::field::{gradient_text, hit_text, normal_text, value_text};
use super::fields_ahead::{Marched, fields_ahead};
use super::link::Part;
use super::listener::ListenerText;
use super::records;
use super::reflect::reflect_text;
use super::scene_text::Text;
use super::surface_names::Named;
use crate::kernel::cells::Lists;
use crate::scene::Scene;
use std::fmt::Write;

/// `closestHit(p, d, last, limit, object)` and `reflectWave(object, t, p, d)` of a scene; where
/// fields have no closed form `marchFields(p, d, last, limit, object, limitReached)` for these.
pub fn closed_form_parts(scene: &Scene, listener: ListenerText) -> Vec<Part> {
    let text = Text::new(scene, Lists::Lines);
    let marched = |named: &Named| Marched::Others.takes(named);
    let mut parts = text.parts();
    text.add_fields(&mut parts, |named| named.has_closed_form(), hit_text);
    text.add_fields(&mut parts, marched, value_text);
    text.add_fields(&mut parts, |_| true, gradient_text);
    text.add_fields(&mut parts, |_| true, normal_text);
    text.add(&mut parts, "the grids of kinds", records::grids_text(&text));
    let functions =
        records::closest_of_kinds(&text) + &closest_hit(&text, listener) + &reflect_text(&text);
    text.add(&mut parts, "the scene", functions);
    parts.extend(fields_ahead(&text, Marched::Others));
    parts
}

fn closest_hit(text: &Text, listener: ListenerText) -> String {
    let first = match listener {
        ListenerText::Solid => "min(hitListener(p, d), limit)",
        ListenerText::Transparent => "limit",
    };
    let mut out = format!(
        "// How far from p along d the next object is, and its number. A convex surface is\n\
         // not met by the wave that leaves it (last). Where nothing is met before limit the\n\
         // distance is limit and the number means nothing; it is GIVEN_UP where a step limit\n\
         // left open what comes first.\n\
         float closestHit(vec3 p, vec3 d, float last, float limit, out float object) {{\n    \
         float nearest = {first};\n    object = 0.0;\n",
    );
    if text.all().any(Named::has_step_limit) {
        out.push_str("    copySteps = uCopySteps;\n");
    }
    let closed: Vec<&Named> = text
        .unrolled
        .iter()
        .filter(|n| n.has_closed_form())
        .collect();
    if !closed.is_empty() {
        out.push_str("    float candidate;\n");
    }
    let (limited, others): (Vec<&Named>, Vec<&Named>) =
        closed.into_iter().partition(|named| named.has_step_limit());
    for named in others {
        out += &candidate(named);
    }
    out += &records::calls(text);
    // A step limit counts only where nothing else is met before.
    for named in limited {
        out += &candidate(named);
    }
    out + "    return nearest;\n}\n\n"
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
