//! Value and gradient of a tree, and its value on a line.

use super::function_kind::{Kind, has_differences};
use super::{Numbers, Place, Writer, has_slope, literal};
use crate::scene::shape::{Asset, Mirror, User};
use crate::scene::{Node, Shape, UserField};
use crate::shader::structure::Assets;
use crate::shader::text::link::has_function;
use std::fmt::Write;

/// `float field<number>(vec3 p)`: the value, by which a march may step.
pub(in crate::shader) fn value_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    Writer::new(place, assets).whole(field, Kind::Value)
}

/// `vec4 gradient<number>(vec3 p)`: the gradient of `field<number>`, and its value.
pub(in crate::shader) fn gradient_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    Writer::new(place, assets).whole(field, Kind::Gradient)
}

/// `vec4 normal<number>(vec3 p)`: the same gradient with a more exact direction, for a field whose
/// gradient is computed by differences; empty for any other field.
pub(in crate::shader) fn normal_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    if !has_differences(field) {
        return String::new();
    }
    Writer::new(place, assets).whole(field, Kind::Normal)
}

/// `OnLine onLine<number>(vec3 p, vec3 d)`: the field on the line through p along d (`glsl/common/on_line.glsl`); empty
/// for a field with a user's text whose bend is not stated.
pub(in crate::shader) fn line_text(field: &Shape, place: &Place, assets: &Assets) -> String {
    if !is_known_on_lines(field) {
        return String::new();
    }
    Writer::new(place, assets).whole(field, Kind::Line)
}

/// Whether [`line_text`] can be written for a field.
pub(in crate::shader) fn is_known_on_lines(field: &Shape) -> bool {
    let knows_bend = |user: &UserField| user.bend.is_some() && has_slope(user);
    let nodes = field.nodes().into_iter();
    nodes
        .filter_map(|node| node.node.user())
        .all(|user| knows_bend(user))
}

/// Whether the field has a second derivative with a bound at almost every point next to its surface, so that its value
/// on a line shows how far the line is free.
pub(in crate::shader) fn is_smooth_on_lines(field: &Shape) -> bool {
    let smooth = |node: &Shape| match &node.node {
        Node::Translate(_)
        | Node::Rotate(_)
        | Node::Scale(_)
        | Node::Complement(_)
        | Node::SmoothUnion(_)
        | Node::Offset(_)
        | Node::Morph(_) => true,
        node => is_quadric(node) || has_function(&format!("bend{}", node.name_in_shaders())),
    };
    field.nodes().into_iter().all(smooth)
}

/// Whether an operator turns lines into curves or breaks them.
fn turns_lines(node: &Node) -> bool {
    matches!(
        node,
        Node::Repeat(_) | Node::Twist(_) | Node::Bend(_) | Node::Mirror(_) | Node::Elongate(_)
    )
}

fn is_quadric(node: &Node) -> bool {
    matches!(
        node,
        Node::Ellipsoid(_) | Node::Paraboloid(_) | Node::Hyperboloid(_) | Node::GeneralQuadric(_)
    )
}

impl<'a> Writer<'a> {
    pub(super) fn new(place: &'a Place<'a>, assets: &'a Assets) -> Writer<'a> {
        Writer {
            numbers: Numbers::new(place),
            place,
            assets,
            stem: "free",
            direction: "d".to_owned(),
            next_name: 0,
            functions: String::new(),
            body: String::new(),
        }
    }

    fn whole(mut self, field: &Shape, kind: Kind) -> String {
        self.stem = kind.function();
        let result = match kind {
            // The rules for the reach on a line count on values that grow by at most 1.
            Kind::Line if field.properties().lipschitz > 1.0 => self.line_of_gradient(field, "p"),
            _ => self.node(field, kind, "p"),
        };
        let result = match self.numbers.lipschitz(field) {
            Some(inverse) if kind == Kind::Line => format!("onLineScaled({result}, {inverse})"),
            Some(inverse) => format!("{result} * {inverse}"),
            None => result,
        };
        format!(
            "{}{} {}{}({}{}) {{\n{}    return {result};\n}}\n\n",
            self.functions,
            kind.of_type(),
            kind.function(),
            self.place.tag,
            kind.parameters(),
            self.place.parameter,
            self.body
        )
    }

    /// A name that the function being written has not used yet.
    pub(super) fn name(&mut self, stem: &str) -> String {
        self.next_name += 1;
        format!("{stem}{}", self.next_name)
    }

    pub(super) fn line(&mut self, line: &str) {
        let _ = writeln!(self.body, "    {line}");
    }

    /// Writes the statements for a node, and returns the name of the result.
    pub(super) fn node(&mut self, field: &Shape, kind: Kind, p: &str) -> String {
        if kind == Kind::Line && turns_lines(&field.node) {
            return self.line_of_gradient(field, p);
        }
        let numbers = self.numbers.next(field);
        if field.children.is_empty() {
            return self.shape(field, kind, p, &numbers);
        }
        match &field.node {
            Node::Union(_) | Node::Intersection(_) | Node::Difference(_) | Node::SmoothUnion(_) => {
                self.folded(field, kind, p, &numbers)
            }
            Node::Morph(_) => {
                let from = self.node(&field.children[0], kind, p);
                let to = self.node(&field.children[1], kind, p);
                let operator = kind.operator();
                self.result(
                    kind,
                    &format!("{operator}Morph({from}, {to}, {})", numbers[0]),
                )
            }
            Node::Complement(_) => {
                let of = self.node(&field.children[0], kind, p);
                self.result(
                    kind,
                    &match kind {
                        Kind::Line => format!("onLineComplement({of})"),
                        _ => format!("-{of}"),
                    },
                )
            }
            Node::Shell(_) | Node::Offset(_) => {
                let of = self.node(&field.children[0], kind, p);
                let (operator, name) = (kind.operator(), field.node.name_in_shaders());
                self.result(kind, &format!("{operator}{name}({of}, {})", numbers[0]))
            }
            Node::Repeat(_) => self.repeated(field, kind, p, &numbers),
            Node::Twist(_) | Node::Bend(_) => self.turned(field, kind, p, &numbers),
            _ => self.moved(field, kind, p, &numbers),
        }
    }

    /// The value on a line from a gradient: without a limit of the second derivative.
    fn line_of_gradient(&mut self, field: &Shape, p: &str) -> String {
        let gradient = self.node(field, Kind::Gradient, p);
        let d = self.direction.clone();
        self.result(Kind::Line, &format!("onLine({gradient}, {d}, vec3(0.0))"))
    }

    /// Writes the statements for the value of a node, and returns its name.
    pub(super) fn value(&mut self, field: &Shape, p: &str) -> String {
        self.node(field, Kind::Value, p)
    }

    pub(super) fn result(&mut self, kind: Kind, expression: &str) -> String {
        let stem = if kind == Kind::Value { "d" } else { "g" };
        let name = self.name(stem);
        self.line(&format!("{} {name} = {expression};", kind.of_type()));
        name
    }

    fn shape(&mut self, field: &Shape, kind: Kind, p: &str, numbers: &[String]) -> String {
        if kind == Kind::Line {
            return self.shape_on_line(field, p, numbers);
        }
        let mut call = format!(
            "{}{}({p}{}",
            kind.prefix(&field.node),
            self.shape_name(field),
            arguments(&field.node, numbers)
        );
        call.push_str(&asset_arguments(field, self.assets));
        call.push(')');
        self.result(kind, &call)
    }

    fn shape_on_line(&mut self, field: &Shape, p: &str, numbers: &[String]) -> String {
        let d = self.direction.clone();
        if let Node::User(user) = &field.node {
            let (name, arguments) = (self.shape_name(field), arguments(&field.node, numbers));
            let sag = literal(user.bend().unwrap_or(0.0));
            return self.result(
                Kind::Line,
                &format!("onLine{name}({p}, {d}{arguments}, {sag})"),
            );
        }
        let gradient = self.shape(field, Kind::Gradient, p, numbers);
        let name = field.node.name_in_shaders();
        let bend = if is_quadric(&field.node) {
            let (steepness, norm) = quadric_steepness(&field.node, p, numbers);
            format!("bendOfQuadric({steepness}, {norm})")
        } else if has_function(&format!("bend{name}")) {
            let arguments = arguments(&field.node, numbers);
            format!("bend{name}({gradient}, {p}{arguments})")
        } else {
            "vec3(0.0)".to_owned()
        };
        self.result(Kind::Line, &format!("onLine({gradient}, {d}, {bend})"))
    }

    /// The name of the shape's functions; each user's field has its own.
    pub(super) fn shape_name(&self, field: &Shape) -> String {
        match &field.node {
            Node::User(User { field }) => format!("User{}", self.assets.user(field).unwrap_or(0)),
            node => node.name_in_shaders().to_owned(),
        }
    }

    fn folded(&mut self, field: &Shape, kind: Kind, p: &str, numbers: &[String]) -> String {
        let mut result = self.node(&field.children[0], kind, p);
        let more = numbers
            .first()
            .map(|n| format!(", {n}"))
            .unwrap_or_default();
        for child in &field.children[1..] {
            let other = self.node(child, kind, p);
            let name = field.node.name_in_shaders();
            let operator = kind.operator();
            result = self.result(kind, &format!("{operator}{name}({result}, {other}{more})"));
        }
        result
    }

    /// Operators on space, whose gradient is the child's gradient transformed back.
    fn moved(&mut self, field: &Shape, kind: Kind, p: &str, n: &[String]) -> String {
        if kind == Kind::Line {
            return self.moved_on_line(field, p, n);
        }
        let vector = |n: &[String]| format!("vec3({}, {}, {})", n[0], n[1], n[2]);
        let (inner, outward) = match &field.node {
            Node::Translate(_) => (format!("{p} - {}", vector(n)), None),
            Node::Rotate(_) => {
                let turn = format!("mat3({})", n.join(", "));
                (
                    format!("{turn} * {p}"),
                    Some(format!("vec4(#.xyz * {turn}, #.w)")),
                )
            }
            Node::Scale(_) => (
                format!("{p} / {}", n[0]),
                Some(format!("vec4(#.xyz, #.w * {})", n[0])),
            ),
            Node::Mirror(Mirror { axes }) => mirrored(p, *axes),
            _ => (
                format!("{p} - clamp({p}, -{0}, {0})", vector(n)),
                Some(format!("vec4(#.xyz * step({}, abs({p})), #.w)", vector(n))),
            ),
        };
        let q = self.point(&inner);
        let result = self.node(&field.children[0], kind, &q);
        match (kind, &field.node, outward) {
            (Kind::Value, Node::Scale(_), _) => self.result(kind, &format!("{result} * {}", n[0])),
            (Kind::Value, ..) | (_, _, None) => result,
            (_, _, Some(outward)) => self.result(kind, &outward.replace('#', &result)),
        }
    }

    /// The same for lines, which are moved instead of gradients.
    fn moved_on_line(&mut self, field: &Shape, p: &str, n: &[String]) -> String {
        let outer = self.direction.clone();
        let inner = match &field.node {
            Node::Rotate(_) => {
                let turn = format!("mat3({})", n.join(", "));
                self.direction = self.point(&format!("{turn} * {outer}"));
                format!("{turn} * {p}")
            }
            Node::Scale(_) => format!("{p} / {}", n[0]),
            _ => format!("{p} - vec3({})", n.join(", ")),
        };
        let q = self.point(&inner);
        let of = self.node(&field.children[0], Kind::Line, &q);
        self.direction = outer;
        match &field.node {
            Node::Scale(_) => {
                let by = &n[0];
                let call = format!(
                    "OnLine({of}.value * {by}, {of}.slope, {of}.sag / {by}, {of}.rise / {by}, {of}.reach * {by})"
                );
                self.result(Kind::Line, &call)
            }
            _ => of,
        }
    }

    pub(super) fn point(&mut self, expression: &str) -> String {
        let name = self.name("p");
        self.line(&format!("vec3 {name} = {expression};"));
        name
    }

    fn turned(&mut self, field: &Shape, kind: Kind, p: &str, n: &[String]) -> String {
        let turn = if matches!(field.node, Node::Twist(_)) {
            "twist"
        } else {
            "bend"
        };
        let beyond = self.name("beyond");
        self.line(&format!("float {beyond};"));
        let (rate, most, lipschitz) = (&n[0], &n[1], &n[2]);
        let q = self.point(&format!("{turn}({p}, {rate}, {most}, {beyond})"));
        let of = self.node(&field.children[0], kind, &q);
        match kind {
            Kind::Value => {
                self.result(kind, &format!("beyondTurning({of}, {beyond}, {lipschitz})"))
            }
            Kind::Gradient | Kind::Normal | Kind::Line => self.result(
                kind,
                &format!("un{turn}({of}, {p}, {q}, {rate}, {beyond}, {lipschitz})"),
            ),
        }
    }
}

pub(super) fn mirrored(p: &str, axes: [bool; 3]) -> (String, Option<String>) {
    let folded = |axis: usize| {
        let coordinate = format!("{p}.{}", ["x", "y", "z"][axis]);
        if axes[axis] {
            (
                format!("abs({coordinate})"),
                format!("({coordinate} < 0.0 ? -1.0 : 1.0)"),
            )
        } else {
            (coordinate, "1.0".to_owned())
        }
    };
    let [x, y, z] = [0, 1, 2].map(folded);
    (
        format!("vec3({}, {}, {})", x.0, y.0, z.0),
        Some(format!(
            "vec4(#.xyz * vec3({}, {}, {}), #.w)",
            x.1, y.1, z.1
        )),
    )
}

/// The length of the gradient of a quadric's function, and the norm of its form.
pub(super) fn quadric_steepness(node: &Node, p: &str, n: &[String]) -> (String, String) {
    let vector = |from: usize| format!("vec3({})", n[from..from + 3].join(", "));
    let diagonal = vector(0);
    let gradient = match node {
        Node::GeneralQuadric(_) => format!(
            "2.0 * quadricForm({p}, {diagonal}, {}) + {}",
            vector(3),
            vector(6)
        ),
        Node::Paraboloid(_) => format!("2.0 * {diagonal} * {p} - vec3(0.0, 1.0, 0.0)"),
        _ => format!("2.0 * {diagonal} * {p}"),
    };
    (format!("length({gradient})"), n[n.len() - 1].clone())
}

/// The place and the size of a shape's samples in the scene's data as arguments of its functions, each with a comma
/// before it.
pub(super) fn asset_arguments(field: &Shape, assets: &Assets) -> String {
    match field.node.asset() {
        Some(Asset::Image(image)) => {
            let (first, size) = (assets.image(image).unwrap_or(0), image.size());
            format!(", {first}, ivec2({}, {})", size.x, size.y)
        }
        Some(Asset::Samples(field)) => {
            let (first, size) = (assets.samples(field).unwrap_or(0), field.size());
            format!(", {first}, ivec3({}, {}, {})", size.x, size.y, size.z)
        }
        Some(Asset::Mesh(mesh)) => format!(", {}", assets.mesh(mesh).unwrap_or(0)),
        Some(Asset::User(_)) | None => String::new(),
    }
}

/// A shape's numbers as arguments of its functions, each with a comma before it.
pub(super) fn arguments(node: &Node, numbers: &[String]) -> String {
    let mut text = String::new();
    let mut left = numbers;
    for &width in node.part().arguments() {
        if left.len() < width {
            break;
        }
        let (group, rest) = left.split_at(width);
        left = rest;
        let _ = match width {
            1 => write!(text, ", {}", group[0]),
            _ => write!(text, ", vec{width}({})", group.join(", ")),
        };
    }
    text
}
