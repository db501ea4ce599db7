//! The reflection of a wave at the surface that it hits: the point on the surface, and the mirrored direction.
//!
//! Surfaces of a kind share one piece of text, which selects the values of the surface that was hit and then computes
//! the reflection once. Waves that are drawn together hit different surfaces, and a renderer that draws them in
//! lockstep would compute a separate branch for every surface for all of these waves.

use super::field::rooms_projection;
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
    /// Fields that differ only in fixed numbers, position and rotation.
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
    let mut mirrors = !text.instanced.is_empty();
    for (index, group) in groups(text).into_iter().enumerate() {
        mirrors |= !matches!(group, Group::Faces(_));
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
    // The direction is mirrored once, because renderers that draw waves in lockstep compute every block for all waves.
    let (met, mirror) = match mirrors {
        true => (
            "    vec3 metNormal = vec3(0.0);\n    bool isMirrored = false;\n",
            "    d = isMirrored ? mirror(along, metNormal) : d;\n",
        ),
        false => ("", ""),
    };
    let texts = [("surfaces", &*surfaces), ("met", met), ("mirror", mirror)];
    out + &fill(&skeleton, &texts)
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

/// Maximum vectors of a field's numbers that are selected. The selection of more vectors costs more than a separate
/// field.
const MOST_SELECTED: usize = 4;

/// Whether two fields differ only in numbers, position and rotation.
fn are_alike(one: &Named, other: &Named) -> bool {
    let is_small = |named: &Named| {
        let numbers = named.literal_numbers();
        numbers.is_some_and(|numbers| numbers.len() <= MOST_SELECTED)
    };
    let has_own_text = |named: &Named| matches!(named.surface.shape.node, Node::Rooms(_));
    !has_own_text(one)
        && is_small(one)
        && is_small(other)
        && SurfaceStructure::have_one_text(one.surface, other.surface)
}

/// The surface whose text serves all members. If a member has a rotation, it is a member with a rotation.
fn representative<'a>(members: &[&'a Named<'a>]) -> &'a Named<'a> {
    let turned = members.iter().find(|named| named.surface.has_rotation());
    turned.unwrap_or(&members[0])
}

/// The reflection at fields that share the functions of `one`, the field that represents their group.
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

/// The reflection at rooms and boxes along the axes. Their mirrored directions are exact.
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
    let mirrored = "        d = isMet ? mirrored : d;\n";
    block(members, &select(members, values), reflection, mirrored)
}

/// The reflection at basic shapes of one kind.
fn at_kind(members: &[&Named]) -> String {
    let count = members[0].value_count();
    at_alike(members, &members[0].selected(), |named| {
        (0..count).map(|n| named.value(n)).collect()
    })
}

/// The reflection at surfaces that share the text of `one`. Their vectors, which `values` returns for each surface, are
/// selected.
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
    let met = "        metNormal = isMet ? normal : metNormal;\n        \
               isMirrored = isMet || isMirrored;\n";
    block(members, &select(members, declared), &reflection, met)
}

/// Declares variables with the values of the first member. If another member was hit, its values replace them.
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

/// The reflection of the waves that hit one of the members; `result` sets what remains of it for these waves.
fn block(members: &[&Named], values: &str, reflection: &str, result: &str) -> String {
    let labels: Vec<&str> = members.iter().map(|named| named.label.as_str()).collect();
    let met: Vec<String> = members.iter().map(|named| named.is_met()).collect();
    let texts = [
        ("labels", labels.join(", ")),
        ("is_met", met.join(" || ")),
        ("values", values.to_owned()),
        ("reflection", reflection.to_owned()),
        ("result", result.to_owned()),
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

/// The statements that project the point `p`, hit along `d`, onto a surface, and compute the normal there.
fn projection(named: &Named, p: &str, d: &str) -> Vec<String> {
    let mut statements = vec![format!("q = {};", named.point(p))];
    let vector = named.vector(d);
    if is_box(named) {
        let (shape, size) = (named.shape(), named.size());
        statements.push(format!("project{shape}(q, {vector}{size}, normal);"));
    } else if named.field().is_none() {
        let (shape, size) = (named.shape(), named.size());
        statements.push(format!("project{shape}(q{size}, normal);"));
    } else if let Node::Rooms(rooms) = &named.surface.shape.node {
        statements.extend(rooms_projection(rooms, &named.point("from"), &vector));
    } else if named.is_mesh() {
        let from = named.point("from");
        let error_bound = named.error_bound();
        statements.push(format!(
            "projectMesh({from}, {vector}, {error_bound}, q, normal);"
        ));
    } else {
        statements.extend(onto_field(named, p, &vector));
    }
    let (q, normal) = (named.outward("q"), named.outward("normal"));
    statements.push(format!("{p} = {q} + {}.xyz;", named.value(0)));
    statements.push(format!("normal = {normal};"));
    statements
}

/// The statements of a Newton step that moves `q` onto the surface of a field, and of the normal of the sheet that a
/// wave along `vector` hits there. The normal is 0 if the wave hits no sheet. One gradient gives both, unless sheets
/// meet at the point.
fn onto_field(named: &Named, p: &str, vector: &str) -> Vec<String> {
    let shape = &named.surface.shape;
    if !shape.may_have_hollow_edges() {
        return vec![
            format!("vec4 gradient = {};", named.field_normal("q")),
            "q = ontoField(q, gradient);".to_owned(),
            format!("normal = facing(gradient.xyz, {vector});"),
        ];
    }
    // At an edge or a corner the gradient is that of one sheet, but the wave may hit another sheet. The other sheet is
    // the nearest at a small offset from the first sheet.
    let apart = format!("APART * roundingAt({p}, {})", named.error_bound());
    let gradient = named.field_normal("at");
    vec![
        "vec3 at = q;".to_owned(),
        "normal = vec3(0.0);".to_owned(),
        format!("int sheets = turnsOf(SHEETS, largest({p}));"),
        "for (int sheet = 0; sheet < sheets && normal == vec3(0.0); ++sheet) {".to_owned(),
        format!("    vec4 gradient = {gradient};"),
        "    q = sheet == 0 ? ontoField(q, gradient) : q;".to_owned(),
        format!("    normal = facing(gradient.xyz, {vector});"),
        format!("    at = (sheet == 0 ? q : at) + {apart} * unitOrZero(gradient.xyz);"),
        "}".to_owned(),
    ]
}
