//! Intersections of a line with fields that have a closed form.
//!
//! A quadric's value along a line, A t² + 2 B t + C, changes from air to solid at one t at most, where its derivative
//! 2 (A t + B) is negative: t = (−B − √(B² − A C)) / A. This formula holds outside and inside, for convex and other
//! quadrics, and never gives the point that a wave leaves. To move, rotate or scale a shape, the line is transformed;
//! the hit of a union is the nearest of its operands' hits. A line is taken past copies that keep to their cells one
//! after another: the first copy hit is the nearest. If there may be too many copies for one flight, the traversal has
//! a step limit. The traversal also ends at the nearest hit of the other surfaces, so that the limit counts only if the
//! wave hits no other surface.

use super::value::arguments;
use super::{CopyAxes, Place, Writer, cells_crossed, has_step_limit, keep_to_cells};
use crate::scene::{Node, Shape};
use crate::shader::structure::Assets;
use crate::shader::text::link::has_function;

/// Whether [`hit_text`] can be written for a field.
pub(in crate::shader) fn has_closed_form(field: &Shape) -> bool {
    match &field.node {
        Node::Translate(_) | Node::Rotate(_) | Node::Scale(_) => {
            has_closed_form(&field.children[0])
        }
        Node::Union(_) => field.children.iter().all(has_closed_form),
        Node::Repeat(_) => keep_to_cells(field) && has_closed_form(&field.children[0]),
        Node::Complement(_) => inside_out(&field.children[0]).is_some(),
        node => has_hit_function(node),
    }
}

/// Whether a shape has a function for its intersection with a line.
fn has_hit_function(node: &Node) -> bool {
    node.part().operands() == (0, 0) && has_function(&format!("hit{}", node.name_in_shaders()))
}

/// Whether the function for the field's hit takes a limit of the distance.
pub(in crate::shader) fn takes_limit(field: &Shape) -> bool {
    let takes = |node: &&Shape| matches!(node.node, Node::Repeat(_)) || node.mesh().is_some();
    field.nodes().iter().any(takes)
}

/// The name of the shape whose hit function also serves the complement of the field, which may be moved; none without
/// a closed form.
fn inside_out(field: &Shape) -> Option<&'static str> {
    match &field.node {
        Node::Translate(_) | Node::Rotate(_) | Node::Scale(_) => inside_out(&field.children[0]),
        Node::Ellipsoid(_) => Some("Ellipsoid"),
        Node::Paraboloid(_) => Some("Paraboloid"),
        Node::Hyperboloid(_) => Some("Hyperboloid"),
        Node::GeneralQuadric(_) => Some("Quadric"),
        Node::Cuboid(_) => Some("Room"),
        _ => None,
    }
}

/// `float hit<number>(vec3 p, vec3 d, float errorBound)`: the metres along the unit vector d from
/// p, which is in the air, to the hit, or NO_HIT. `errorBound` is the rounding error of p. For
/// copies, `hit<number>(p, d, errorBound, limit)`: hits beyond `limit` metres need not be found,
/// and if a traversal has a step limit, the result may be GIVEN_UP.
pub(in crate::shader) fn hit_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    let mut writer = Writer::new(place, assets);
    let text = writer.hit_function(field, &format!("hit{}", place.tag));
    writer.functions + &text
}

/// The names of a line, of the rounding error of its start, and of its maximum length, in some
/// axes.
#[derive(Clone, Copy)]
struct Line<'a> {
    p: &'a str,
    d: &'a str,
    error_bound: &'a str,
    limit: &'a str,
}

impl Writer<'_> {
    /// Writes the hit of a field as a separate function.
    fn hit_function(&mut self, field: &Shape, name: &str) -> String {
        let outer = std::mem::take(&mut self.body);
        let line = Line {
            p: "p",
            d: "d",
            error_bound: "errorBound",
            limit: "limit",
        };
        let result = self.hit(field, line, false);
        let body = std::mem::replace(&mut self.body, outer);
        let limit = if takes_limit(field) {
            ", float limit"
        } else {
            ""
        };
        format!(
            "float {name}(vec3 p, vec3 d, float errorBound{limit}{}) {{\n{body}    return {result};\n}}\n\n",
            self.place.parameter
        )
    }

    fn hit(&mut self, field: &Shape, line: Line, inside_out: bool) -> String {
        let n = self.numbers.next(field);
        let Line {
            p,
            d,
            error_bound,
            limit,
        } = line;
        match &field.node {
            Node::Translate(_) => {
                let p = &self.point(&format!("{p} - vec3({}, {}, {})", n[0], n[1], n[2]));
                self.hit(&field.children[0], Line { p, ..line }, inside_out)
            }
            Node::Rotate(_) => {
                let turn = format!("mat3({})", n.join(", "));
                let p = &self.point(&format!("{turn} * {p}"));
                let d = &self.point(&format!("{turn} * {d}"));
                self.hit(&field.children[0], Line { p, d, ..line }, inside_out)
            }
            Node::Scale(_) => {
                let p = &self.point(&format!("{p} / {}", n[0]));
                let error_bound = &self.length(&format!("{error_bound} / {}", n[0]));
                let limit = &match takes_limit(&field.children[0]) {
                    true => self.length(&format!("{limit} / {}", n[0])),
                    false => limit.to_owned(),
                };
                let line = Line {
                    p,
                    d,
                    error_bound,
                    limit,
                };
                let t = self.hit(&field.children[0], line, inside_out);
                self.length(&format!("{t} < NO_HIT ? {t} * {} : NO_HIT", n[0]))
            }
            Node::Complement(_) => self.hit(&field.children[0], line, true),
            Node::Union(_) => self.hit_union(field, line, inside_out),
            Node::Repeat(_) => self.hit_copies(field, line, &n),
            Node::Rooms(_) => self.hit_rooms([p, d, error_bound, limit], &n),
            _ => self.hit_shape(field, line, &n, inside_out),
        }
    }

    /// The nearest hit of several fields; those with a step limit come last and are traversed no
    /// further than the other hits.
    fn hit_union(&mut self, field: &Shape, line: Line, inside_out: bool) -> String {
        let start = self.numbers.mark();
        let mut nearest: Option<String> = None;
        for limited in [false, true] {
            self.numbers.back_to(start);
            for child in &field.children {
                if has_step_limit(child) != limited {
                    self.numbers.skip(child);
                    continue;
                }
                nearest = Some(match nearest {
                    None => self.hit(child, line, inside_out),
                    Some(known) => self.hit_before(&known, child, line, inside_out),
                });
            }
        }
        // A union has at least one operand.
        nearest.unwrap_or_else(|| "NO_HIT".to_owned())
    }

    fn hit_before(&mut self, known: &str, child: &Shape, line: Line, inside_out: bool) -> String {
        let limit = &match takes_limit(child) {
            true => self.length(&format!("min({}, {known})", line.limit)),
            false => line.limit.to_owned(),
        };
        let other = self.hit(child, Line { limit, ..line }, inside_out);
        self.length(&format!("min({known}, {other})"))
    }

    /// The first of the copies that the line intersects.
    fn hit_copies(&mut self, field: &Shape, line: Line, numbers: &[String]) -> String {
        // This function is called only for repetitions.
        let Some(axes) = CopyAxes::new(field, numbers) else {
            return "NO_HIT".to_owned();
        };
        let child = self.name(&format!("hit{}_", self.place.tag));
        let text = self.hit_function(&field.children[0], &child);
        self.functions += &text;
        let Line {
            p,
            d,
            error_bound,
            limit,
        } = line;
        let q = self.point(&format!("{p} - {}", axes.shift));
        let [traversal, comes] = ["traversal", "comes"].map(|stem| self.name(stem));
        let t = self.length("NO_HIT");
        self.line(&format!(
            "CopyTraversal {traversal} = {};",
            axes.traversal(&q, d, error_bound)
        ));
        self.line(&format!("bool {comes};"));
        let ahead = format!("{t} >= NO_HIT && nextCopy({traversal}, {limit}, {comes})");
        self.line(&format!("while ({ahead}) {{"));
        if cells_crossed(field).is_none() {
            self.line(&format!(
                "    if (!takeCopyStep()) {{ {t} = GIVEN_UP; break; }}"
            ));
        }
        let inner = match takes_limit(&field.children[0]) {
            true => format!(", {limit}"),
            false => String::new(),
        };
        let period = &axes.period;
        self.line(&format!(
            "    if ({comes}) {{ {t} = {child}({q} - {period} * {traversal}.met, {d}, {error_bound}{inner}{}); }}",
            self.place.argument
        ));
        self.line("}");
        t
    }

    fn hit_shape(&mut self, shape: &Shape, line: Line, n: &[String], out: bool) -> String {
        let node = &shape.node;
        let Line {
            p, d, error_bound, ..
        } = line;
        let name = node.name_in_shaders();
        let call = match node {
            Node::Ellipsoid(_)
            | Node::Paraboloid(_)
            | Node::Hyperboloid(_)
            | Node::GeneralQuadric(_) => {
                let sign = if out { "-1.0" } else { "1.0" };
                let arguments = arguments(node, &n[..n.len() - 1]);
                format!("hit{name}({p}, {d}, {sign}{arguments})")
            }
            Node::Cuboid(_) if out => format!("hitRoom({p}, {d}{})", arguments(node, n)),
            Node::Cuboid(_) => format!("hitBox({p}, {d}, vec4({}, {error_bound}))", n.join(", ")),
            Node::Plane(_) | Node::Room(_) | Node::Sphere(_) | Node::Cylinder(_) => {
                format!("hit{name}({p}, {d}{})", arguments(node, n))
            }
            _ => match shape.mesh() {
                Some(mesh) => {
                    let first = self.assets.mesh(mesh).unwrap_or(0);
                    format!("hitMesh({p}, {d}, {error_bound}, {}, {first})", line.limit)
                }
                None => format!("hit{name}({p}, {d}{}, {error_bound})", arguments(node, n)),
            },
        };
        self.length(&call)
    }

    fn length(&mut self, expression: &str) -> String {
        let name = self.name("t");
        self.line(&format!("float {name} = {expression};"));
        name
    }
}
