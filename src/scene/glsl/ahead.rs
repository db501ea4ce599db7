//! The distance to what can be met ahead, and its gradient: for a march that is right.

use super::cells::{of_kind, walk_files};
use super::distance::surface_distance_sources;
use super::field::{field_files, gradient_text, normal_text, value_text};
use super::fields_ahead::{Marched, fields_ahead};
use super::land::{land_files, land_text};
use super::source::without_uncalled_bounds;
use super::{Named, Source, Text, add_once, distance_file, source};
use crate::scene::{Scene, Shape};
use std::borrow::Cow;
use std::fmt::Write;

/// `distanceAhead(p, d, last, object, second)`, `gradientAhead(p, d, object, slack)`,
/// `land(object, d, p, normal)` of a scene, `surfaceDistance(p, object)` where normals are
/// taken from differences of it, and `marchFields(p, d, last, limit, object, guardHit)` where
/// there are fields.
pub fn ahead_sources(scene: &Scene, difference_normals: bool) -> Vec<Source> {
    let text = Text::new(scene);
    let mut sources = vec![source!("rounding.glsl")];
    if difference_normals {
        sources.extend(text.shape_files(distance_file));
    }
    sources.extend(land_files(&text));
    sources.extend(text.shape_files(gradient_file));
    sources.extend(text.shape_files(ahead_file));
    add_once(&mut sources, text.data_file());
    let fields = field_files(text.fields(), true, &text.assets);
    add_once(&mut sources, fields);
    sources.extend(text.turn_file());
    sources.push(source!("distance/listener.glsl"));
    sources.push(source!("ahead/listener.glsl"));
    let mut functions = text.uniforms();
    functions += &text.of_fields(|_| true, value_text);
    functions += &text.of_fields(|_| true, gradient_text);
    functions += &text.of_fields(|_| true, normal_text);
    sources.push((Cow::Borrowed("the surfaces"), Cow::Owned(functions)));
    if difference_normals {
        add_once(&mut sources, surface_distance_sources(&text));
    }
    add_once(&mut sources, ahead_in_cells(&text));
    let functions = distance_ahead(&text) + &gradient_ahead(&text) + &land_text(&text);
    sources.push((Cow::Borrowed("the scene"), Cow::Owned(functions)));
    add_once(&mut sources, fields_ahead(&text, Marched::All));
    without_uncalled_bounds(sources)
}

fn gradient_file(shape: &Shape) -> Option<Source> {
    Some(match shape {
        Shape::Plane => source!("gradient/plane.glsl"),
        Shape::Box { .. } => source!("gradient/box.glsl"),
        Shape::Room { .. } => source!("gradient/room.glsl"),
        Shape::Sphere { .. } => source!("gradient/sphere.glsl"),
        Shape::Cylinder { .. } => source!("gradient/cylinder.glsl"),
        Shape::Field(_) => return None,
    })
}

/// The file of the distance to a basic shape that can still be met; a room's stands with its
/// gradient.
fn ahead_file(shape: &Shape) -> Option<Source> {
    Some(match shape {
        Shape::Plane => source!("ahead/plane.glsl"),
        Shape::Box { .. } => source!("ahead/box.glsl"),
        Shape::Sphere { .. } => source!("ahead/sphere.glsl"),
        Shape::Cylinder { .. } => source!("ahead/cylinder.glsl"),
        Shape::Room { .. } | Shape::Field(_) => return None,
    })
}

/// What the functions below call for the surfaces in cells.
fn ahead_in_cells(text: &Text) -> Vec<Source> {
    if text.kinds.is_empty() {
        return Vec::new();
    }
    let basic = |named: &Named| named.field().is_none();
    let distance = of_kind(
        text,
        "// The distance to a basic shape in cells, by its kind and the place of its values.\n\
         float distanceOfKind(float kind, int data, vec3 p, vec3 d, bool left) {\n",
        basic,
        |named| {
            let distance = named.distance_ahead("p", "d");
            format!("return {};", named.unless_left("left", "1e30", &distance))
        },
        "    return 1e30;\n",
    );
    let gradient = of_kind(
        text,
        "// Its gradient, and what rounding may do to it.\n\
         vec3 gradientOfKind(float kind, int data, vec3 p, vec3 d, out float slack) {\n    \
         slack = 0.0;\n",
        basic,
        gradient_statement,
        "    return vec3(0.0);\n",
    );
    let mut sources = walk_files();
    let kinds = distance + &gradient;
    sources.push((Cow::Borrowed("the kinds"), Cow::Owned(kinds)));
    sources.push(source!("cells/ahead.glsl"));
    sources
}

fn distance_ahead(text: &Text) -> String {
    let mut out = String::from(
        "// Distance to the nearest object that a wave at p along d can meet, its number, and\n\
         // the distance to the second nearest. What the wave leaves (last) is out of its way\n\
         // when it is convex, and so is all that it recedes from; of a room only the walls\n\
         // ahead count.\n\
         float distanceAhead(vec3 p, vec3 d, float last, out float object, out float second) {\n    \
         float nearest = sdListenerAhead(p, d);\n    object = 0.0;\n    second = 1e30;\n    \
         float candidate;\n",
    );
    for named in text.loose.iter().filter(|named| named.field().is_none()) {
        let distance = named.distance_ahead("p", "d");
        let distance = named.unless_left(&named.left(), "1e30", &distance);
        let _ = writeln!(
            out,
            "    // {}\n    candidate = {distance};\n    \
             if (candidate < nearest) {{ second = nearest; nearest = candidate; object = {}.0; }}\n    \
             else {{ second = min(second, candidate); }}",
            named.label, named.tag
        );
    }
    if text.kinds.iter().any(|named| named.field().is_none()) {
        out.push_str("    aheadInCells(p, d, last, nearest, object, second);\n");
    }
    out + "    return nearest;\n}\n\n"
}

fn gradient_ahead(text: &Text) -> String {
    let mut out = String::from(
        "// The gradient of the distance to one object, and what rounding may do to it.\n\
         vec3 gradientAhead(vec3 p, vec3 d, float object, out float slack) {\n",
    );
    for named in text.loose.iter().filter(|named| named.field().is_none()) {
        let (number, statement) = (&named.tag, gradient_statement(named));
        let label = &named.label;
        let _ = writeln!(
            out,
            "    if (object == {number}.0) {{ {statement} }} // {label}"
        );
    }
    if text.kinds.iter().any(|named| named.field().is_none()) {
        out.push_str(
            "    if (object > 0.0) {\n        vec4 entry = entryOf(object);\n        \
             return gradientOfKind(entry.y, int(entry.z), p, d, slack);\n    }\n",
        );
    }
    out + "    slack = roundSlack(uListener);\n    return normalize(p - uListener.xyz);\n}\n\n"
}

fn gradient_statement(named: &Named) -> String {
    let (shape, point, size) = (named.shape(), named.point("p"), named.size());
    let gradient = match named.surface.shape {
        Shape::Room { .. } => format!("gradientRoomAhead({point}, {}{size})", named.vector("d")),
        Shape::Box { .. } => format!("gradientBox({point}{size})"),
        _ => format!("gradient{shape}({point})"),
    };
    format!(
        "slack = {}; return {};",
        named.slack(),
        named.outward(&gradient)
    )
}
