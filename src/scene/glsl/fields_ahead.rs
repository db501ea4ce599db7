//! The fields that are marched: their least value, and the gradient of one of them.

use super::field::has_closed_form;
use super::{Named, Text};
use crate::scene::Shape;
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
        match &named.surface.shape {
            Shape::Field(field) => self == Marched::All || !has_closed_form(field),
            _ => false,
        }
    }
}

/// `fieldsAhead(p, d, last, object, reach)` and `fieldGradient(p, object, slack)`; nothing
/// where nothing is marched.
pub(super) fn fields_ahead(text: &Text, marched: Marched) -> String {
    let named: Vec<&Named> = text.named.iter().filter(|n| marched.takes(n)).collect();
    if named.is_empty() {
        return String::new();
    }
    let mut out = String::from(
        "// The least value of the fields that a wave at p along d can meet, and whose it is. It\n\
         // holds as far as reach along d. A convex one that the wave leaves is out of its way.\n\
         float fieldsAhead(vec3 p, vec3 d, float last, out float object, out float reach) {\n    \
         float nearest = 1e30;\n    reach = 1e30;\n    object = -1.0;\n    float candidate;\n",
    );
    for named in &named {
        let value = named.field_value("p");
        let number = named.number;
        let _ = writeln!(out, "    // {}", named.label);
        let _ = match named.surface.shape.is_convex() {
            true => writeln!(out, "    candidate = last == {number}.0 ? 1e30 : {value};"),
            false => writeln!(out, "    candidate = {value};"),
        };
        let _ = writeln!(
            out,
            "    if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}"
        );
    }
    out.push_str("    return nearest;\n}\n\n");
    out.push_str(
        "// The gradient of one of them, and what rounding may do to its value.\n\
         vec3 fieldGradient(vec3 p, float object, out float slack) {\n",
    );
    for named in &named {
        let gradient = format!("gradient{}({}).xyz", named.number, named.point("p"));
        let _ = writeln!(
            out,
            "    if (object == {}.0) {{ slack = {}; return {}; }} // {}",
            named.number,
            named.slack(),
            named.outward(&gradient),
            named.label
        );
    }
    out.push_str("    slack = 0.0;\n    return vec3(0.0);\n}\n\n");
    out
}
