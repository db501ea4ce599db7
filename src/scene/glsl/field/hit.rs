//! Where a line meets a field, for those that have a closed form.
//!
//! A quadric's value along a line, A t² + 2 B t + C, goes from air to solid at no more than
//! one place: where its growth 2 (A t + B) is negative, t = (−B − √(B² − A C)) / A. That one
//! formula serves outside and inside, convex or not, and never finds the place that a wave
//! leaves. Moving, turning and scaling carry the line along; a union is met at the nearest.
//! Of copies that end, each within its own cell, the line is taken through the cells: the
//! first copy that it meets is the nearest.

use super::numbers::literal;
use super::text::arguments;
use super::{Assets, Place, Writer};
use crate::scene::glsl::{Source, source};
use crate::scene::{Copies, Field, Node};
use glam::Vec3;

/// Whether [`hit_text`] can be written for it.
pub(in crate::scene::glsl) fn has_closed_form(field: &Field) -> bool {
    match &field.node {
        Node::Translate { .. } | Node::Rotate { .. } | Node::Scale { .. } => {
            has_closed_form(&field.of[0])
        }
        Node::Union => field.of.iter().all(has_closed_form),
        Node::Repeat { period, count } => {
            walks_copies(field, *period, *count) && has_closed_form(&field.of[0])
        }
        Node::Complement => inside_out(&field.of[0]).is_some(),
        node => field.of.is_empty() && hit_files(node).is_some(),
    }
}

/// Cells that a line may have to be taken through.
const MOST_CELLS: u32 = 1024;

/// Whether a line can be taken through the copies' cells: they end, and each keeps to its own.
fn walks_copies(field: &Field, period: Vec3, count: [u32; 3]) -> bool {
    let repeated = (0..3).filter(|&axis| period[axis] > 0.0);
    let ends = repeated.clone().all(|axis| count[axis] > 0);
    let cells: u64 = repeated.map(|axis| u64::from(count[axis])).sum();
    let within = |copies: &Copies| !matches!(copies, Copies::Around(_));
    ends && cells <= u64::from(MOST_CELLS) && field.copies().is_ok_and(|c| c.iter().all(within))
}

/// The field whose complement has a closed form, seen through moves.
fn inside_out(field: &Field) -> Option<&'static str> {
    match &field.node {
        Node::Translate { .. } | Node::Rotate { .. } | Node::Scale { .. } => {
            inside_out(&field.of[0])
        }
        Node::Ellipsoid { .. } => Some("Ellipsoid"),
        Node::Paraboloid { .. } => Some("Paraboloid"),
        Node::Hyperboloid { .. } => Some("Hyperboloid"),
        Node::Quadric { .. } => Some("Quadric"),
        Node::Box { .. } => Some("Room"),
        _ => None,
    }
}

/// `float hit<number>(vec3 p, vec3 d, float slack)`: metres along the unit vector d from p,
/// which is in the air, or NO_HIT. `slack` is what rounding may do to p.
pub(in crate::scene::glsl) fn hit_text(field: &Field, place: &Place, assets: &Assets) -> String {
    let mut writer = Writer::new(place, assets);
    let result = writer.hit(
        field,
        Line {
            p: "p",
            d: "d",
            slack: "slack",
        },
        false,
    );
    format!(
        "{}float hit{}(vec3 p, vec3 d, float slack{}) {{\n{}    return {result};\n}}\n\n",
        writer.functions, place.tag, place.parameter, writer.body
    )
}

/// The names of a line, and of what rounding may do to its start, in some axes.
#[derive(Clone, Copy)]
struct Line<'a> {
    p: &'a str,
    d: &'a str,
    slack: &'a str,
}

impl Writer<'_> {
    fn hit(&mut self, field: &Field, line: Line, inside_out: bool) -> String {
        let n = self.numbers.next(field);
        let Line { p, d, slack } = line;
        match &field.node {
            Node::Translate { .. } => {
                let p = &self.point(&format!("{p} - vec3({}, {}, {})", n[0], n[1], n[2]));
                self.hit(&field.of[0], Line { p, ..line }, inside_out)
            }
            Node::Rotate { .. } => {
                let turn = format!("mat3({})", n.join(", "));
                let p = &self.point(&format!("{turn} * {p}"));
                let d = &self.point(&format!("{turn} * {d}"));
                self.hit(&field.of[0], Line { p, d, slack }, inside_out)
            }
            Node::Scale { .. } => {
                let p = &self.point(&format!("{p} / {}", n[0]));
                let slack = &self.length(&format!("{slack} / {}", n[0]));
                let t = self.hit(&field.of[0], Line { p, d, slack }, inside_out);
                self.length(&format!("{t} < NO_HIT ? {t} * {} : NO_HIT", n[0]))
            }
            Node::Complement => self.hit(&field.of[0], line, true),
            Node::Union => {
                let mut nearest = self.hit(&field.of[0], line, inside_out);
                for child in &field.of[1..] {
                    let other = self.hit(child, line, inside_out);
                    nearest = self.length(&format!("min({nearest}, {other})"));
                }
                nearest
            }
            Node::Repeat { period, count } => {
                let axes = CopyAxes::new(*period, *count, &n);
                self.hit_copies(&field.of[0], line, &axes)
            }
            node => self.hit_shape(node, line, &n, inside_out),
        }
    }

    /// The first of the copies that the line meets, cell by cell.
    fn hit_copies(&mut self, of: &Field, line: Line, axes: &CopyAxes) -> String {
        let child = self.child_hit(of);
        let Line { p, d, slack } = line;
        let q = self.point(&format!("{p} - {}", axes.shift));
        let inverse = self.point(&format!("safeInverse({d})"));
        let copy = self.name("copy");
        let t = self.length("NO_HIT");
        let CopyAxes {
            period,
            first,
            last,
            ..
        } = axes;
        let argument = self.place.argument;
        self.line(&format!("vec3 {copy};"));
        self.line(&format!(
            "if (enterCopies({q}, {d}, {inverse}, {period}, {first}, {last}, {copy})) {{"
        ));
        self.line(&format!(
            "    do {{ {t} = {child}({q} - {period} * {copy}, {d}, {slack}{argument}); }}"
        ));
        self.line(&format!(
            "    while ({t} >= NO_HIT && nextCopy({q}, {inverse}, {period}, {first}, {last}, {copy}));"
        ));
        self.line("}");
        t
    }

    /// The hit of a field as a function of its own.
    fn child_hit(&mut self, field: &Field) -> String {
        let name = self.name(&format!("hit{}_", self.place.tag));
        let outer = std::mem::take(&mut self.body);
        let line = Line {
            p: "p",
            d: "d",
            slack: "slack",
        };
        let result = self.hit(field, line, false);
        let body = std::mem::replace(&mut self.body, outer);
        self.functions += &format!(
            "float {name}(vec3 p, vec3 d, float slack{}) {{\n{body}    return {result};\n}}\n\n",
            self.place.parameter
        );
        name
    }

    fn hit_shape(&mut self, node: &Node, line: Line, n: &[String], out: bool) -> String {
        let Line { p, d, slack } = line;
        let name = node.name();
        let call = match node {
            Node::Ellipsoid { .. }
            | Node::Paraboloid { .. }
            | Node::Hyperboloid { .. }
            | Node::Quadric { .. } => {
                let sign = if out { "-1.0" } else { "1.0" };
                let arguments = arguments(node, &n[..n.len() - 1]);
                format!("hit{name}({p}, {d}, {sign}{arguments})")
            }
            Node::Box { .. } if out => format!("hitRoom({p}, {d}{})", arguments(node, n)),
            Node::Box { .. } => format!("hitBox({p}, {d}, vec4({}, {slack}))", n.join(", ")),
            Node::Plane | Node::Room { .. } | Node::Sphere { .. } | Node::Cylinder { .. } => {
                format!("hit{name}({p}, {d}{})", arguments(node, n))
            }
            _ => format!("hit{name}({p}, {d}{}, {slack})", arguments(node, n)),
        };
        self.length(&call)
    }

    fn length(&mut self, expression: &str) -> String {
        let name = self.name("t");
        self.line(&format!("float {name} = {expression};"));
        name
    }
}

/// A limited repetition as the walk takes it: vectors of expressions.
struct CopyAxes {
    shift: String,
    period: String,
    first: String,
    last: String,
}

impl CopyAxes {
    fn new(period: Vec3, count: [u32; 3], expressions: &[String]) -> CopyAxes {
        /// The width of the one cell along an axis without repetition, in metres.
        const ENDLESS: f64 = 2e9;
        let mut shift = Vec::new();
        let mut periods = Vec::new();
        let mut first = Vec::new();
        let mut last = Vec::new();
        for axis in 0..3 {
            let repeats = period[axis] > 0.0;
            let count = if repeats { count[axis] } else { 1 };
            // Copies of an even number lie about the origin, none at it.
            shift.push(match count.is_multiple_of(2) {
                true => format!("0.5 * {}", expressions[axis]),
                false => "0.0".to_owned(),
            });
            periods.push(match repeats {
                true => expressions[axis].clone(),
                false => literal(ENDLESS),
            });
            first.push(literal(-f64::from(count / 2)));
            last.push(literal(f64::from(count - 1 - count / 2)));
        }
        let vector = |numbers: Vec<String>| format!("vec3({})", numbers.join(", "));
        CopyAxes {
            shift: vector(shift),
            period: vector(periods),
            first: vector(first),
            last: vector(last),
        }
    }
}

/// The files of all hits in a field that has a closed form.
pub(in crate::scene::glsl) fn files_of_hits(field: &Field) -> Vec<Source> {
    let mut files = Vec::new();
    for node in field.nodes() {
        files.extend(hit_files(&node.node).unwrap_or_default());
        if matches!(node.node, Node::Repeat { .. }) {
            files.extend([
                source!("hit/safe_inverse.glsl"),
                source!("operator/repeat_walk.glsl"),
            ]);
        }
        if node.node == Node::Complement && inside_out(&node.of[0]) == Some("Room") {
            files.extend([source!("hit/safe_inverse.glsl"), source!("hit/room.glsl")]);
        }
    }
    files
}

pub(super) fn hit_files(node: &Node) -> Option<Vec<Source>> {
    let quadric = |file| Some(vec![source!("hit/quadric_line.glsl"), file]);
    match node {
        Node::Plane => Some(vec![source!("hit/plane.glsl")]),
        Node::HalfSpace { .. } => Some(vec![source!("hit/half_space.glsl")]),
        Node::Box { .. } => Some(vec![
            source!("hit/safe_inverse.glsl"),
            source!("hit/box.glsl"),
        ]),
        Node::Room { .. } => Some(vec![
            source!("hit/safe_inverse.glsl"),
            source!("hit/room.glsl"),
        ]),
        Node::Sphere { .. } => Some(vec![source!("hit/sphere.glsl")]),
        Node::Cylinder { .. } => Some(vec![source!("hit/cylinder.glsl")]),
        Node::CappedCylinder { .. } => Some(vec![
            source!("hit/chord.glsl"),
            source!("hit/capped_cylinder.glsl"),
        ]),
        Node::Capsule { .. } => Some(vec![source!("hit/capsule.glsl")]),
        Node::Cone { .. } => Some(vec![
            source!("hit/quadric_line.glsl"),
            source!("hit/cone.glsl"),
        ]),
        Node::Prism { .. } => Some(vec![source!("hit/chord.glsl"), source!("hit/prism.glsl")]),
        Node::Ellipsoid { .. } => quadric(source!("hit/ellipsoid.glsl")),
        Node::Paraboloid { .. } => quadric(source!("hit/paraboloid.glsl")),
        Node::Hyperboloid { .. } => quadric(source!("hit/hyperboloid.glsl")),
        Node::Quadric { .. } => quadric(source!("hit/quadric.glsl")),
        _ => None,
    }
}
