//! The landing: the point met, put onto the surface met, and the normal there.

use super::{Named, Source, named, shape_files, source};
use crate::scene::{Scene, Shape};
use std::fmt::Write;

/// The files that [`land_text`] calls.
pub(super) fn land_files(scene: &Scene) -> Vec<Source> {
    shape_files(scene, |shape| {
        Some(match shape {
            Shape::Plane => source!("land/plane.glsl"),
            Shape::Box { .. } => source!("land/box.glsl"),
            Shape::Room { .. } => source!("land/room.glsl"),
            Shape::Sphere { .. } => source!("land/sphere.glsl"),
            Shape::Cylinder { .. } => source!("land/cylinder.glsl"),
            Shape::Field(_) => source!("land/field.glsl"),
        })
    })
}

/// `land(object, d, p, normal)` over all surfaces.
pub(super) fn land_text(scene: &Scene) -> String {
    let mut text = String::from(
        "// Puts p, met along d, onto the object met; the normal there.\n\
         void land(float object, vec3 d, inout vec3 p, out vec3 normal) {\n    vec3 q;\n    \
         normal = -d;\n",
    );
    for named in named(scene) {
        if matches!(named.surface.shape, Shape::Field(_)) {
            text += &land_on_field(&named);
            continue;
        }
        let direction = match named.surface.shape {
            Shape::Box { .. } | Shape::Room { .. } => format!(", {}", named.vector("d")),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "    if (object == {}.0) {{ // {}",
            named.number, named.label
        );
        let _ = writeln!(text, "        q = {};", named.point("p"));
        let _ = writeln!(
            text,
            "        land{}(q{direction}{}, normal);",
            named.shape(),
            named.size()
        );
        let _ = writeln!(
            text,
            "        p = {} + uSurfaces[{}].xyz;",
            named.outward("q"),
            named.first
        );
        let _ = writeln!(
            text,
            "        normal = {};\n    }}",
            named.outward("normal")
        );
    }
    text.push_str("}\n\n");
    text
}

/// A Newton step onto the field's surface, and the gradient there.
fn land_on_field(named: &Named) -> String {
    let number = named.number;
    format!(
        "    if (object == {number}.0) {{ // {}\n        q = {};\n        \
         q = ontoField(q, gradient{number}(q));\n        \
         normal = facing(gradient{number}(q).xyz, {});\n        \
         p = {} + uSurfaces[{}].xyz;\n        normal = {};\n    }}\n",
        named.label,
        named.point("p"),
        named.vector("d"),
        named.outward("q"),
        named.first,
        named.outward("normal")
    )
}
