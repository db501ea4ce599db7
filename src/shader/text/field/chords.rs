//! Chords of a line, computed once for a flight: where it runs through convex parts of a field's air, and through the
//! box around a field's solid.
//!
//! A complement of a union, smooth or not, is air wherever one of the operands is solid. Where the line is in such a
//! part, it is free up to the end of the part's chord; and a line that is not in the box around a solid is free up to
//! this box. The functions `chord…` of convex shapes are in `glsl/shape/`.

use super::value::arguments;
use super::{Place, Writer, literal};
use crate::scene::{Bounds3, Node, Shape};
use crate::shader::structure::Assets;
use crate::shader::text::link::has_function;
use std::fmt::Write as _;

/// Maximum chords of a field: each costs as much as a shape's hit.
const MOST_CHORDS: usize = 16;

/// The chords of a field, `void findChords<number>(vec3 p, vec3 d, float errorBound)`, which finds them for the line
/// from p along d, and `float through<number>(float t)`: the metres from p up to which the line is free, if it is free
/// up to t metres. Empty for a field without chords.
pub(in crate::shader) fn chords_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    let found = Chords::of(field, place, assets);
    if found.names.is_empty() && found.bounds.is_none() {
        return String::new();
    }
    let tag = place.tag;
    let mut declarations = String::new();
    let mut statements = found.body;
    let mut steps = String::new();
    for (index, name) in found.names.iter().enumerate() {
        let chord = format!("chord{tag}_{index}");
        let _ = writeln!(declarations, "vec2 {chord} = vec2(0.0);");
        let _ = writeln!(
            statements,
            "    {chord} = {name} + vec2(errorBound, -errorBound);"
        );
        // Not `x <= t ? max(t, y) : t`: SwiftShader compiles four such lines (`cave`) for over a minute.
        let _ = writeln!(
            steps,
            "    t = {chord}.x <= t && t < {chord}.y ? {chord}.y : t;"
        );
    }
    // Each chord extends the free length once. A line that runs from a part to one before it in the list takes a further
    // step, which costs less than another turn for all lines.
    let mut body = steps;
    if let Some(bounds) = found.bounds {
        let chord = format!("chord{tag}_bounds");
        let _ = writeln!(declarations, "vec2 {chord} = vec2(0.0);");
        let _ = writeln!(
            statements,
            "    {chord} = {bounds} + vec2(-errorBound, errorBound);"
        );
        let _ = writeln!(
            body,
            "    t = t < {chord}.x ? {chord}.x : t;\n    t = {chord}.x > {chord}.y || t > {chord}.y ? NO_END : t;"
        );
    }
    format!(
        "{declarations}void findChords{tag}(vec3 p, vec3 d, float errorBound) {{\n{statements}}}\n\
         float through{tag}(float t) {{\n{body}    return t;\n}}\n\n"
    )
}

/// Whether [`chords_text`] is not empty.
pub(in crate::shader) fn has_chords(field: &Shape, moving: &[bool]) -> bool {
    fixed_bounds(field, moving).is_some() || parts(field, false) > 0
}

/// Whether the air of a field has convex parts whose chords are found.
pub(in crate::shader) fn has_parts_of_air(field: &Shape) -> bool {
    parts(field, false) > 0
}

/// The box around a solid whose numbers do not move, if it is finite.
fn fixed_bounds(field: &Shape, moving: &[bool]) -> Option<Bounds3> {
    let bounds = field.properties().bounds;
    let is_fixed = !moving.contains(&true);
    (is_fixed && bounds.is_finite() && !bounds.is_empty()).then_some(bounds)
}

/// Number of convex parts of a field's air, or of its solid.
fn parts(field: &Shape, in_solid: bool) -> usize {
    let count: usize = match sides(field, in_solid) {
        Some(sides) => {
            let children = field.children.iter().zip(sides);
            children
                .map(|(child, side)| side.map_or(0, |in_solid| parts(child, in_solid)))
                .sum()
        }
        None => usize::from(has_chord(&field.node, in_solid)),
    };
    count.min(MOST_CHORDS)
}

/// For each child of an operator, whether the wanted side of the operator contains the child's solid (true), its air
/// (false), or neither (`None`); `None` for a shape.
fn sides(field: &Shape, in_solid: bool) -> Option<Vec<Option<bool>>> {
    let count = field.children.len();
    if count == 0 {
        return None;
    }
    let all = |side| vec![side; count];
    Some(match &field.node {
        Node::Translate(_) | Node::Rotate(_) | Node::Scale(_) => all(Some(in_solid)),
        Node::Complement(_) => all(Some(!in_solid)),
        Node::Union(_) | Node::SmoothUnion(_) if in_solid => all(Some(true)),
        Node::Intersection(_) if !in_solid => all(Some(false)),
        Node::Difference(_) if !in_solid => {
            let mut sides = all(Some(true));
            sides[0] = Some(false);
            sides
        }
        _ => all(None),
    })
}

/// Whether a shape's solid or air is convex, with a function for its chord.
fn has_chord(node: &Node, in_solid: bool) -> bool {
    match node {
        Node::Room(_) => !in_solid,
        Node::HalfSpace(_) | Node::Plane(_) => true,
        node => in_solid && has_function(&format!("chord{}", node.name_in_shaders())),
    }
}

/// The chords of a field, as names in the statements of `body`.
struct Chords {
    names: Vec<String>,
    bounds: Option<String>,
    body: String,
}

impl Chords {
    fn of(field: &Shape, place: &Place, assets: &Assets) -> Chords {
        let mut writer = Writer::new(place, assets);
        let names = writer.chords(field, ("p", "d"), false);
        let vector = |v: glam::DVec3| format!("vec3({})", v.to_array().map(literal).join(", "));
        let bounds = fixed_bounds(field, place.moving).map(|bounds| {
            let (middle, half) = (vector(bounds.middle()), vector(bounds.half_size()));
            writer.chord(&format!("chordBox(p - {middle}, d, {half} + errorBound)"))
        });
        Chords {
            names,
            bounds,
            body: writer.body,
        }
    }
}

impl Writer<'_> {
    /// Writes the statements for the chords of a node's convex parts, and returns their names.
    fn chords(&mut self, field: &Shape, (p, d): (&str, &str), in_solid: bool) -> Vec<String> {
        if parts(field, in_solid) == 0 {
            self.numbers.skip(field);
            return Vec::new();
        }
        let n = self.numbers.next(field);
        let Some(sides) = sides(field, in_solid) else {
            return vec![self.chord_of(&field.node, p, d, &n, in_solid)];
        };
        let (p, d) = match &field.node {
            Node::Translate(_) => (
                self.point(&format!("{p} - vec3({})", n.join(", "))),
                d.to_owned(),
            ),
            Node::Rotate(_) => {
                let turn = format!("mat3({})", n.join(", "));
                (
                    self.point(&format!("{turn} * {p}")),
                    self.point(&format!("{turn} * {d}")),
                )
            }
            Node::Scale(_) => (self.point(&format!("{p} / {}", n[0])), d.to_owned()),
            _ => (p.to_owned(), d.to_owned()),
        };
        let mut all = Vec::new();
        for (child, side) in field.children.iter().zip(sides) {
            match side {
                Some(in_solid) => all.extend(self.chords(child, (&p, &d), in_solid)),
                None => self.numbers.skip(child),
            }
        }
        all.truncate(MOST_CHORDS);
        match &field.node {
            Node::Scale(_) => all
                .iter()
                .map(|name| self.chord(&format!("{name} * {}", n[0])))
                .collect(),
            _ => all,
        }
    }

    fn chord_of(&mut self, node: &Node, p: &str, d: &str, n: &[String], in_solid: bool) -> String {
        let more = arguments(node, n);
        let call = match node {
            Node::Room(_) => format!("chordBox({p}, {d}{more})"),
            Node::Cuboid(_) => format!("chordBox({p}, {d}{more})"),
            Node::HalfSpace(_) | Node::Plane(_) => {
                let sign = if in_solid { "1.0" } else { "-1.0" };
                format!("chord{}({p}, {d}, {sign}{more})", node.name_in_shaders())
            }
            node => format!("chord{}({p}, {d}{more})", node.name_in_shaders()),
        };
        self.chord(&call)
    }

    fn chord(&mut self, expression: &str) -> String {
        let name = self.name("c");
        self.line(&format!("vec2 {name} = {expression};"));
        name
    }
}
