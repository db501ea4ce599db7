//! The projection of a hit onto the surface that was hit, and the normal there.

use super::named::Named;
use super::of_kind::of_kind;
use super::scene_text::Text;
use crate::scene::Node;
use std::fmt::Write;

/// `project(object, d, p, normal)` over all surfaces.
pub(super) fn project_text(text: &Text) -> String {
    let mut out = String::new();
    if !text.instanced.is_empty() {
        out += &of_kind(
            text,
            "// Puts p, met along d, onto a surface in cells; the normal there.\n\
             void projectOntoKind(float kind, int data, vec3 d, inout vec3 p, out vec3 normal) {\n    \
             vec3 q;\n    normal = -d;\n",
            |_| true,
            |named| statements(named).join(" "),
            "",
        );
    }
    out += "// Puts p, met along d, onto the object met; the normal there.\n\
         void project(float object, vec3 d, inout vec3 p, out vec3 normal) {\n    vec3 q;\n    \
         normal = -d;\n";
    for named in &text.unrolled {
        let _ = writeln!(
            out,
            "    if (object == {}.0) {{ // {}",
            named.tag, named.label
        );
        for statement in statements(named) {
            let _ = writeln!(out, "        {statement}");
        }
        out.push_str("        return;\n    }\n");
    }
    if !text.instanced.is_empty() {
        out.push_str(
            "    if (object > 0.0) {\n        vec4 entry = entryOf(object);\n        \
             projectOntoKind(entry.y, int(entry.z), d, p, normal);\n    }\n",
        );
    }
    out + "}\n\n"
}

fn statements(named: &Named) -> Vec<String> {
    let mut statements = vec![format!("q = {};", named.point("p"))];
    let vector = named.vector("d");
    match named.surface.shape.node {
        Node::Cuboid(_) | Node::Room(_) => statements.push(format!(
            "project{}(q, {vector}{}, normal);",
            named.shape(),
            named.size()
        )),
        _ if named.field().is_none() => statements.push(format!(
            "project{}(q{}, normal);",
            named.shape(),
            named.size()
        )),
        _ => {
            // A Newton step onto the field's surface, and the gradient there.
            let gradient = named.field_gradient("q");
            statements.push(format!("q = ontoField(q, {gradient});"));
            let normal = named.field_normal("q");
            statements.push(format!("normal = facing({normal}.xyz, {vector});"));
        }
    }
    let (q, normal) = (named.outward("q"), named.outward("normal"));
    statements.push(format!("p = {q} + {}.xyz;", named.value(0)));
    statements.push(format!("normal = {normal};"));
    statements
}
