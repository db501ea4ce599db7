//! The length over which a line is free of a field: a lower bound of the field's value along the
//! line.
//!
//! A bound is a vector (value, slope, bend, reach), see `glsl/common/bound.glsl`. It is written for
//! the air, and for the solid (of the value with its sign changed), because a complement, a
//! difference or a shell exchanges air and solid.

use super::copies::Axis;
use super::value::{arguments, asset_arguments, mirrored, quadric_steepness};
use super::{CopyAxes, Place, Writer, keep_to_cells};
use crate::scene::shape::{Mirror, Repeat};
use crate::scene::{Copies, Node, Shape};
use crate::shader::structure::Assets;
use crate::shader::text::link::has_function;

/// Maximum nesting of shells with a bound: each shell doubles the text.
const MOST_SHELLS: usize = 3;

/// The side of a surface on which the wave is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Air,
    Solid,
}

use Side::{Air, Solid};

impl Side {
    fn other(self) -> Side {
        if self == Air { Solid } else { Air }
    }

    fn sign(self) -> &'static str {
        if self == Air { "1.0" } else { "-1.0" }
    }

    fn suffix(self) -> &'static str {
        if self == Air { "" } else { "Solid" }
    }
}

/// The names of a line, and of the rounding error of its start, in some axes.
#[derive(Clone, Copy)]
struct Line<'a> {
    p: &'a str,
    d: &'a str,
    error_bound: &'a str,
    /// Whether only the sign of the value matters: then a bound need only be greater than 0 where
    /// the value is greater than 0.
    sign_alone: bool,
}

/// `float free<number>(vec3 p, vec3 d, float errorBound)`: the metres along the unit vector d from
/// p that are certainly free of the field. p is in the air, or up to `errorBound` in the solid.
pub(in crate::shader) fn free_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    let head = format!(
        "float free{}(vec3 p, vec3 d, float errorBound{}) {{\n",
        place.tag, place.parameter
    );
    if !is_bounded(field) {
        return head + "    return 0.0;\n}\n\n";
    }
    let mut writer = Writer::new(place, assets);
    let line = Line {
        p: "p",
        d: "d",
        error_bound: "errorBound",
        sign_alone: true,
    };
    let bound = writer.along(field, line, Air);
    format!(
        "{}{head}{}    return freeAlong({bound}, errorBound);\n}}\n\n",
        writer.functions, writer.body
    )
}

/// Maximum turns of the traversals of copies in one evaluation of the field's bound.
pub(in crate::shader) fn leaps(field: &Shape) -> u64 {
    // As in glsl/operator/repeat.glsl.
    const LEAPS: u64 = 4;
    let nodes = field.nodes().into_iter();
    let repetitions = nodes.filter(|node| matches!(node.node, Node::Repeat(_)));
    LEAPS * repetitions.count() as u64
}

/// Whether a field has a bound along lines in addition to its value: a user's text has none, and neither have sampled
/// distances.
pub(in crate::shader) fn is_bounded(field: &Shape) -> bool {
    let known = |node: &Shape| match node.node {
        Node::Twist(_) | Node::Bend(_) | Node::Grid(_) => false,
        Node::Repeat(_) => keep_to_cells(node),
        _ => true,
    };
    let nodes = field.nodes();
    let own = |node: &&Shape| node.children.is_empty() && node.node.user().is_none();
    nodes.iter().any(own) && nodes.into_iter().all(known) && shells(field) <= MOST_SHELLS
}

fn shells(field: &Shape) -> usize {
    let below = field.children.iter().map(shells).max().unwrap_or(0);
    below + usize::from(matches!(field.node, Node::Shell(_)))
}

impl Writer<'_> {
    /// Writes the statements for the bound of a node, and returns the name of the bound.
    fn along(&mut self, field: &Shape, line: Line, side: Side) -> String {
        if let Node::Shell(_) = field.node {
            return self.shell_along(field, line, side);
        }
        let n = self.numbers.next(field);
        if field.children.is_empty() {
            return self.shape_along(field, line, side, &n);
        }
        let levels = matches!(
            field.node,
            Node::SmoothUnion(_) | Node::Morph(_) | Node::Offset(_)
        );
        let line = Line {
            sign_alone: line.sign_alone && !levels,
            ..line
        };
        match &field.node {
            Node::Union(_) | Node::Intersection(_) | Node::Difference(_) | Node::SmoothUnion(_) => {
                self.folded_along(field, line, side, &n)
            }
            Node::Morph(_) => {
                let from = self.along(&field.children[0], line, side);
                let to = self.along(&field.children[1], line, side);
                self.bound(&format!(
                    "vec4(mix({from}.xyz, {to}.xyz, {}), min({from}.w, {to}.w))",
                    n[0]
                ))
            }
            Node::Complement(_) => self.along(&field.children[0], line, side.other()),
            Node::Offset(_) => {
                let of = self.along(&field.children[0], line, side);
                self.bound(&format!(
                    "{of} - vec4({} * {}, 0.0, 0.0, 0.0)",
                    side.sign(),
                    n[0]
                ))
            }
            Node::Repeat(_) => self.copy_along(field, line, side, &n),
            _ => self.moved_along(field, line, side, &n),
        }
    }

    fn bound(&mut self, expression: &str) -> String {
        let name = self.name("b");
        self.line(&format!("vec4 {name} = {expression};"));
        name
    }

    fn folded_along(&mut self, field: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let error_bound = line.error_bound;
        let mut result = self.along(&field.children[0], line, side);
        for child in &field.children[1..] {
            let flips = matches!(field.node, Node::Difference(_));
            let of = if flips { side.other() } else { side };
            let other = self.along(child, line, of);
            let lower = matches!(field.node, Node::Union(_)) == (side == Air);
            result = self.bound(&match field.node {
                Node::SmoothUnion(_) => format!(
                    "orPlain(blend{}Along({result}, {other}, {}), {error_bound})",
                    side.suffix(),
                    n[0]
                ),
                _ if lower => format!("lowerAlong({result}, {other}, {error_bound})"),
                _ => format!("upperAlong({result}, {other}, {error_bound})"),
            });
        }
        result
    }

    /// The bound of a shell, |value| - half the thickness: from the side on which the wave is, or
    /// from both sides.
    fn shell_along(&mut self, field: &Shape, line: Line, side: Side) -> String {
        let half = self.numbers.next(field)[0].clone();
        let child = &field.children[0];
        let line = Line {
            sign_alone: false,
            ..line
        };
        let mark = self.numbers.mark();
        if side == Solid {
            let air = self.along(child, line, Air);
            self.numbers.back_to(mark);
            let solid = self.along(child, line, Solid);
            let thick = format!("vec4({half}, 0.0, 0.0, 0.0)");
            return self.bound(&format!(
                "lowerAlong({air} + {thick}, {solid} + {thick}, {})",
                line.error_bound
            ));
        }
        let value = self.value(child, line.p);
        let result = self.bound("vec4(0.0)");
        for (side, head) in [
            (Solid, format!("if ({value} < 0.0) {{")),
            (Air, "} else {".to_owned()),
        ] {
            self.numbers.back_to(mark);
            self.line(&head);
            let of = self.along(child, line, side);
            self.line(&format!("{result} = {of} - vec4({half}, 0.0, 0.0, 0.0);"));
        }
        self.line("}");
        result
    }

    fn shape_along(&mut self, field: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let Line {
            p, d, error_bound, ..
        } = line;
        let (name, sign) = (field.node.name_in_shaders(), side.sign());
        let more = arguments(&field.node, n);
        match &field.node {
            Node::HeightField(_) => {
                let assets = asset_arguments(field, self.assets);
                let bound = format!(
                    "along{name}{}({p}, {d}{more}{assets}, {error_bound})",
                    side.suffix()
                );
                return self.bound(&format!("orPlain({bound}, {error_bound})"));
            }
            Node::User(_) => {
                let value = format!("sd{}({p}{more})", self.shape_name(field));
                return self.bound(&format!("plainAlong({sign} * {value})"));
            }
            _ => (),
        }
        let gradient = self.bound(&format!("gd{name}({p}{more})"));
        let straight =
            format!("vec4({sign} * {gradient}.w, {sign} * dot({gradient}.xyz, {d}), 0.0, NO_END)");
        let concave = |way: String| format!("concaveAlong({sign} * {gradient}.w, {way})");
        let bound = match (&field.node, side) {
            (Node::Plane(_) | Node::HalfSpace(_), _) | (Node::Room(_), Solid) => straight,
            (Node::Room(_), Air) => concave(format!("exitBox({p}, {d}{more})")),
            (Node::Torus(_), _) => {
                format!("along{name}{}({gradient}, {p}, {d}{more})", side.suffix())
            }
            (Node::RoundedBox(_), Solid) => {
                concave(format!("exitRoundedBox({p}, {d}{more}, {error_bound})"))
            }
            (
                Node::Ellipsoid(_)
                | Node::Paraboloid(_)
                | Node::Hyperboloid(_)
                | Node::GeneralQuadric(_),
                _,
            ) => return self.quadric_along(&field.node, line, side, n, &gradient),
            // Only the value of the shape can be bounded.
            _ if !has_function(&format!("exit{name}")) => {
                format!("plainAlong({sign} * {gradient}.w)")
            }
            (_, Solid) => concave(format!("exit{name}({p}, {d}{more})")),
            (_, Air) => straight,
        };
        self.bound(&format!("orPlain({bound}, {error_bound})"))
    }

    /// The bound of a quadric, whose gradient and value are `gradient`; if only the sign matters, the bound is the
    /// length up to the hit.
    fn quadric_along(
        &mut self,
        node: &Node,
        line: Line,
        side: Side,
        n: &[String],
        gradient: &str,
    ) -> String {
        let Line {
            p, d, error_bound, ..
        } = line;
        let (name, sign) = (node.name_in_shaders(), side.sign());
        let (steepness, norm) = quadric_steepness(node, p, n);
        let near = format!(
            "orPlain(quadricAlong({sign}, {gradient}, {d}, {steepness}, {norm}), {error_bound})"
        );
        if !line.sign_alone {
            return self.bound(&near);
        }
        // Just before the surface, rounding may put the root behind the wave.
        let numbers = arguments(node, &n[..n.len() - 1]);
        let falling = format!("{sign} * dot({gradient}.xyz, {d}) < 0.0");
        let free = format!("hit{name}({p}, {d}, {sign}{numbers})");
        self.bound(&format!(
            "{sign} * {gradient}.w <= {error_bound} && {falling} ? {near} \
             : vec4({sign} * {gradient}.w, 0.0, 0.0, {free})"
        ))
    }

    /// The bound of an operator on space: along the line in the inner axes, up to where the line
    /// bends there.
    fn moved_along(&mut self, field: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let Line {
            p, d, error_bound, ..
        } = line;
        let child = &field.children[0];
        match &field.node {
            Node::Translate(_) => {
                let p = &self.point(&format!("{p} - vec3({}, {}, {})", n[0], n[1], n[2]));
                self.along(child, Line { p, ..line }, side)
            }
            Node::Rotate(_) => {
                let turn = format!("mat3({})", n.join(", "));
                let p = &self.point(&format!("{turn} * {p}"));
                let d = &self.point(&format!("{turn} * {d}"));
                self.along(child, Line { p, d, ..line }, side)
            }
            Node::Scale(_) => {
                let by = &n[0];
                let p = &self.point(&format!("{p} / {by}"));
                let within = self.name("errorBound");
                self.line(&format!("float {within} = {error_bound} / {by};"));
                let error_bound = &within;
                let of = self.along(
                    child,
                    Line {
                        p,
                        d,
                        error_bound,
                        ..line
                    },
                    side,
                );
                self.bound(&format!("{of} * vec4({by}, 1.0, 1.0 / {by}, {by})"))
            }
            Node::Mirror(Mirror { axes }) => self.mirrored_along(child, line, side, *axes),
            _ => self.elongated_along(child, line, side, n),
        }
    }

    fn mirrored_along(&mut self, child: &Shape, line: Line, side: Side, axes: [bool; 3]) -> String {
        let Line { p, d, .. } = line;
        let inner = self.point(&mirrored(p, axes).0);
        let way = each_axis(|axis, c| match axes[axis] {
            true => format!("foldSide({p}.{c}, {d}.{c}) * {d}.{c}"),
            false => format!("{d}.{c}"),
        });
        let d = self.point(&way);
        let folded = (0..3).filter(|&axis| axes[axis]);
        let reaches = folded.map(|axis| {
            let c = AXES[axis];
            format!("foldReach({inner}.{c}, {d}.{c})")
        });
        let reaches = reaches.collect();
        let inner = Line {
            p: &inner,
            d: &d,
            ..line
        };
        self.within_reach(child, inner, side, reaches)
    }

    fn elongated_along(&mut self, child: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let Line { p, d, .. } = line;
        let by = format!("vec3({}, {}, {})", n[0], n[1], n[2]);
        let inner = self.point(&format!("{p} - clamp({p}, -{by}, {by})"));
        let way = each_axis(|axis, c| format!("cutSpeed({p}.{c}, {d}.{c}, {})", n[axis]));
        let reaches = (0..3).map(|axis| {
            let c = AXES[axis];
            format!("cutReach({p}.{c}, {d}.{c}, {})", n[axis])
        });
        let reaches = reaches.collect();
        let d = self.point(&way);
        let inner = Line {
            p: &inner,
            d: &d,
            ..line
        };
        self.within_reach(child, inner, side, reaches)
    }

    /// The bound of copies that keep to their cells: up to the first box around a copy; or, if each
    /// copy is alone in its cell, the bound of the repeated shape.
    fn copy_along(&mut self, field: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let free = match (side, line.sign_alone) {
            (Air, true) => self.free_of_copies(field, line, n),
            _ => None,
        };
        let alone = |copies: &[Copies; 3]| copies.iter().all(|c| c.count() == 1);
        if field.copies().is_ok_and(|copies| alone(&copies)) {
            let near = self.own_copy_along(field, line, side, n);
            let Some(free) = free else {
                return near;
            };
            let (error_bound, further) = (line.error_bound, free_bound(&free));
            return self.bound(&format!(
                "{free} > freeAlong({near}, {error_bound}) ? {further} : {near}"
            ));
        }
        self.numbers.skip(&field.children[0]);
        // Next to a copy, and where more than the sign matters, only the value is a bound.
        self.bound(&free.map_or_else(|| free_bound("0.0"), |free| free_bound(&free)))
    }

    /// The length over which a line is free of the boxes around the copies.
    fn free_of_copies(&mut self, field: &Shape, line: Line, n: &[String]) -> Option<String> {
        let axes = CopyAxes::new(field, n)?;
        let q = self.point(&format!("{} - {}", line.p, axes.shift));
        let free = self.name("free");
        let traversal = axes.traversal(&q, line.d, line.error_bound);
        self.line(&format!("float {free} = freeOfCopies({traversal});"));
        Some(free)
    }

    /// The bound of copies that are each alone in their cell.
    fn own_copy_along(&mut self, field: &Shape, line: Line, side: Side, n: &[String]) -> String {
        let copies = field.copies().unwrap_or([Copies::Own; 3]);
        let Node::Repeat(Repeat { count, .. }) = field.node else {
            return String::new();
        };
        let axes = [0, 1, 2].map(|axis| Axis {
            coordinate: format!("{}.{}", line.p, AXES[axis]),
            period: n[axis].clone(),
            count: count[axis],
            copies: copies[axis],
        });
        let inner = self.point(&each_axis(|axis, _| axes[axis].copy("0.0")));
        let repeated = (0..3).filter(|&axis| copies[axis] != Copies::None);
        let reaches = repeated.map(|axis| {
            let (q, rest) = axes[axis].range();
            format!("copyReach({q}, {}.{}, {rest})", line.d, AXES[axis])
        });
        let reaches = reaches.collect();
        self.within_reach(
            &field.children[0],
            Line { p: &inner, ..line },
            side,
            reaches,
        )
    }

    fn within_reach(
        &mut self,
        child: &Shape,
        line: Line,
        side: Side,
        reaches: Vec<String>,
    ) -> String {
        let error_bound = line.error_bound;
        let of = self.along(child, line, side);
        let reach = reaches
            .into_iter()
            .fold(format!("{of}.w"), |all, next| format!("min({all}, {next})"));
        self.bound(&format!("orPlain(vec4({of}.xyz, {reach}), {error_bound})"))
    }
}

/// The bound outside the boxes around copies, where the value is greater than 0.
fn free_bound(free: &str) -> String {
    format!("vec4(0.0, 0.0, 0.0, {free})")
}

const AXES: [&str; 3] = ["x", "y", "z"];

fn each_axis(of: impl Fn(usize, &str) -> String) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| of(axis, AXES[axis]));
    format!("vec3({x}, {y}, {z})")
}
