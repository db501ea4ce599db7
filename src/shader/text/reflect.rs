//! The reflection of a wave at the surface that it hits: the point on the surface, and the mirrored
//! direction.
//!
//! Surfaces of a kind share one piece of text: it selects the values of the surface that was hit,
//! then computes one box or one cylinder. Waves that are drawn together hit different surfaces, and
//! a renderer that draws them in lockstep would compute every branch for all of them.

use super::link::{fill, source};
use super::scene_text::{Text, of_kind};
use super::surface_names::Named;
use crate::scene::Node;
use crate::shader::layout::SurfaceStructure;
use std::fmt::Write;

/// Surfaces that share one piece of text for the reflection.
enum Group<'a> {
    /// Rooms and boxes along the axes.
    Faces(Vec<&'a Named<'a>>),
    /// Basic shapes of one kind.
    Kind(Vec<&'a Named<'a>>),
    /// Fields that differ in numbers that do not move, and in position and rotation.
    Fields(Vec<&'a Named<'a>>),
}

/// The text of `reflectWave(object, t, p, d)` for all surfaces.
pub(super) fn reflect_text(text: &Text) -> String {
    let mut out = String::new();
    if !text.instanced.is_empty() {
        out += &of_kind(
            text,
            "// Projects p, hit along d, onto a surface in cells, and returns the normal there.\n\
             void projectOntoKind(float kind, int data, vec3 d, inout vec3 p, out vec3 normal) {\n    \
             vec3 q;\n    normal = -d;\n",
            |_| true,
            |named| projection(named, "p", "d").join(" "),
            "",
        );
    }
    let mut surfaces = String::new();
    for (index, group) in groups(text).into_iter().enumerate() {
        surfaces += &match group {
            Group::Faces(members) => at_faces(&members),
            Group::Kind(members) => at_kind(&members),
            Group::Fields(members) if members.len() == 1 => at_field(members[0]),
            Group::Fields(members) => {
                let one = representative(&members).selected_field(format!("Group{index}"));
                out += &text.functions_of_group(&one);
                at_fields(&members, &one)
            }
        };
    }
    if !text.instanced.is_empty() {
        let skeleton = source!("template/reflect_in_cells.glsl");
        surfaces += &fill(&skeleton, &[("others", &text.not_unrolled())]);
    }
    let skeleton = source!("template/reflect_wave.glsl");
    out + &fill(&skeleton, &[("surfaces", &surfaces)])
}

fn groups<'a>(text: &'a Text) -> Vec<Group<'a>> {
    let mut groups: Vec<Group> = Vec::new();
    for named in &text.unrolled {
        let same = groups.iter_mut().find_map(|group| match group {
            Group::Faces(members) if has_faces_along_axes(named) => Some(members),
            Group::Kind(members) if is_same_kind(members[0], named) => Some(members),
            Group::Fields(members) if are_alike(members[0], named) => Some(members),
            _ => None,
        });
        match same {
            Some(members) => members.push(named),
            None if named.field().is_some() => groups.push(Group::Fields(vec![named])),
            None if has_faces_along_axes(named) => groups.push(Group::Faces(vec![named])),
            None => groups.push(Group::Kind(vec![named])),
        }
    }
    groups
}

/// Maximum vectors of numbers of a field that are selected: selecting more costs more than the field.
const MOST_SELECTED: usize = 4;

/// Whether two fields differ in numbers, position and rotation alone.
fn are_alike(one: &Named, other: &Named) -> bool {
    let is_small = |named: &Named| {
        let numbers = named.literal_numbers();
        numbers.is_some_and(|numbers| numbers.len() <= MOST_SELECTED)
    };
    is_small(one) && is_small(other) && SurfaceStructure::have_one_text(one.surface, other.surface)
}

/// The surface whose text serves all members: one with a rotation, if there is one.
fn representative<'a>(members: &[&'a Named<'a>]) -> &'a Named<'a> {
    let turned = members.iter().find(|named| named.surface.has_rotation());
    turned.unwrap_or(&members[0])
}

/// Fields that share the functions of the group `one`.
fn at_fields(members: &[&Named], one: &Named) -> String {
    let is_turned = one.surface.has_rotation();
    at_alike(members, one, |named| {
        let mut all = vec![named.value(0)];
        if is_turned {
            all.push(match named.surface.has_rotation() {
                true => named.value(1),
                false => "vec4(0.0, 0.0, 0.0, 1.0)".to_owned(),
            });
        }
        all.extend(named.literal_numbers().unwrap_or_default());
        all
    })
}

fn has_faces_along_axes(named: &Named) -> bool {
    is_box(named) && !named.surface.has_rotation()
}

fn is_box(named: &Named) -> bool {
    matches!(named.surface.shape.node, Node::Cuboid(_) | Node::Room(_))
}

fn is_same_kind(one: &Named, other: &Named) -> bool {
    one.shape() == other.shape() && one.surface.has_rotation() == other.surface.has_rotation()
}

/// Rooms and boxes along the axes: their mirrored directions are exact.
fn at_faces(members: &[&Named]) -> String {
    let side = |named: &Named| match named.surface.shape.node {
        Node::Room(_) => "1.0",
        _ => "-1.0",
    };
    let values = |named: &Named| {
        [
            ("vec3 centre".to_owned(), format!("{}.xyz", named.value(0))),
            (
                "vec3 halfSize".to_owned(),
                format!("{}.xyz", named.value(1)),
            ),
            ("float side".to_owned(), side(named).to_owned()),
        ]
        .to_vec()
    };
    let reflection = "        vec3 onto = from;\n        vec3 mirrored = along;\n        \
                      reflectAtFace(onto, mirrored, t, centre, halfSize, side);\n";
    block(members, &select(members, values), reflection)
}

/// Basic shapes of one kind.
fn at_kind(members: &[&Named]) -> String {
    let count = members[0].value_count();
    at_alike(members, &members[0].selected(), |named| {
        (0..count).map(|n| named.value(n)).collect()
    })
}

/// Surfaces that share the text of `one`, whose vectors are selected among those that `values` gives for each.
fn at_alike(members: &[&Named], one: &Named, values: impl Fn(&Named) -> Vec<String>) -> String {
    let declared = |named: &Named| {
        let vectors = values(named).into_iter().enumerate();
        let vectors = vectors.map(|(n, value)| (format!("vec4 {}", one.value(n)), value));
        vectors.collect::<Vec<_>>()
    };
    let mut reflection = String::from("        vec3 onto = hit;\n");
    for statement in projection(one, "onto", "along") {
        let _ = writeln!(reflection, "        {statement}");
    }
    reflection.push_str("        vec3 mirrored = mirror(along, normal);\n");
    block(members, &select(members, declared), &reflection)
}

/// Declares the values of the first of some surfaces, and selects those of the surface that was
/// hit.
fn select(members: &[&Named], values: impl Fn(&Named) -> Vec<(String, String)>) -> String {
    let mut out = String::new();
    for (declaration, value) in values(members[0]) {
        let _ = writeln!(out, "        {declaration} = {value};");
    }
    for named in &members[1..] {
        let is_met = named.is_met();
        for (declaration, value) in values(named) {
            let name = declaration.rsplit(' ').next().unwrap_or(&declaration);
            let _ = writeln!(out, "        {name} = {is_met} ? {value} : {name};");
        }
    }
    out
}

/// The reflection of the waves that hit one of some surfaces.
fn block(members: &[&Named], values: &str, reflection: &str) -> String {
    let labels: Vec<&str> = members.iter().map(|named| named.label.as_str()).collect();
    let met: Vec<String> = members.iter().map(|named| named.is_met()).collect();
    let texts = [
        ("labels", labels.join(", ")),
        ("is_met", met.join(" || ")),
        ("values", values.to_owned()),
        ("reflection", reflection.to_owned()),
    ];
    let texts = texts.each_ref().map(|(name, text)| (*name, text.as_str()));
    fill(&source!("template/reflect_group.glsl"), &texts)
}

fn at_field(named: &Named) -> String {
    let statements = projection(named, "p", "along");
    let lines: String = statements
        .iter()
        .map(|statement| format!("        {statement}\n"))
        .collect();
    let texts = [
        ("label", named.label.as_str()),
        ("is_met", &named.is_met()),
        ("projection", &lines),
    ];
    fill(&source!("template/reflect_field.glsl"), &texts)
}

/// Projects the point `p`, hit along `d`, onto a surface, and computes the normal there.
fn projection(named: &Named, p: &str, d: &str) -> Vec<String> {
    let mut statements = vec![format!("q = {};", named.point(p))];
    let vector = named.vector(d);
    if is_box(named) {
        let (shape, size) = (named.shape(), named.size());
        statements.push(format!("project{shape}(q, {vector}{size}, normal);"));
    } else if named.field().is_none() {
        let (shape, size) = (named.shape(), named.size());
        statements.push(format!("project{shape}(q{size}, normal);"));
    } else {
        statements.extend(onto_field(named, p, &vector));
    }
    let (q, normal) = (named.outward("q"), named.outward("normal"));
    statements.push(format!("{p} = {q} + {}.xyz;", named.value(0)));
    statements.push(format!("normal = {normal};"));
    statements
}

/// A Newton step that takes `q` onto a field's surface, and the normal of the sheet that a wave along `vector` hits there;
/// 0 if it hits none. One gradient serves both, unless sheets meet there.
fn onto_field(named: &Named, p: &str, vector: &str) -> Vec<String> {
    let shape = &named.surface.shape;
    if !shape.may_have_hollow_edges() {
        return vec![
            format!("vec4 gradient = {};", named.field_normal("q")),
            "q = ontoField(q, gradient);".to_owned(),
            format!("normal = facing(gradient.xyz, {vector});"),
        ];
    }
    // At an edge or a corner the gradient is that of one sheet, and the wave may hit another sheet:
    // this one is the nearest at a small offset from the first.
    let apart = format!("APART * roundingAt({p}, {})", named.error_bound());
    let gradient = named.field_normal("at");
    vec![
        "vec3 at = q;".to_owned(),
        "normal = vec3(0.0);".to_owned(),
        "for (int sheet = 0; sheet < SHEETS && normal == vec3(0.0); ++sheet) {".to_owned(),
        format!("    vec4 gradient = {gradient};"),
        "    q = sheet == 0 ? ontoField(q, gradient) : q;".to_owned(),
        format!("    normal = facing(gradient.xyz, {vector});"),
        format!("    at = (sheet == 0 ? q : at) + {apart} * unitOrZero(gradient.xyz);"),
        "}".to_owned(),
    ]
}
