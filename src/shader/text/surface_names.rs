//! The names of a surface, or of a kind of surfaces, in generated text.

use super::field::{self, has_closed_form};
use super::link::no_comment;
use crate::scene::{Node, Scene, Shape, Surface};
use crate::shader::origin_rebasing::{number_vectors, value_count};
use crate::shader::structure::Assets;

/// An unrolled surface, or a kind whose surfaces are in cells.
pub(in crate::shader) struct Named<'a> {
    pub surface: &'a Surface,
    /// The suffix of the names of its functions: the surface's number, or `Kind` and a number.
    pub tag: String,
    /// The name of the surface in comments.
    pub label: String,
    values: Values,
}

/// The fields of a scene that are marched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::shader) enum Marched {
    /// All of them.
    All,
    /// The fields without a closed form.
    Others,
}

/// Whether every profile marches to a surface, because its field has no closed form.
pub fn is_marched(surface: &Surface) -> bool {
    let field = surface.shape.field();
    field.is_some_and(|field| !has_closed_form(field))
}

impl Marched {
    pub fn takes(self, named: &Named) -> bool {
        let is_candidate = named.field().is_some() && !named.is_mesh();
        is_candidate && (self == Marched::All || !named.has_closed_form())
    }
}

/// The place where the values of a surface are stored.
#[derive(Clone, Copy)]
enum Values {
    /// In variables that are copies of `uSurfaces`, starting at this vector.
    Uniforms(usize),
    /// In the scene's data, starting at the vector `data`.
    Data,
    /// In variables that hold the values of the hit surface.
    Selected,
    /// In variables that hold the values of one surface of a kind whose surfaces are marched one at a time.
    Loaded,
}

/// The variable that holds a copy of a vector of `uSurfaces`.
pub(in crate::shader) fn value_name(place: usize) -> String {
    format!("surfaceValue{place}")
}

/// The variable of a surface's squared radius, by the index of its first value.
fn squared_radius_name(place: usize) -> String {
    format!("squaredRadius{place}")
}

impl<'a> Named<'a> {
    /// The surface with this index, whose values begin at vector `first` of `uSurfaces`.
    pub fn surface(scene: &'a Scene, index: usize, first: usize) -> Named<'a> {
        let surface = &scene.surfaces[index];
        Named {
            surface,
            tag: (index + 1).to_string(),
            label: surface.label(index).replace(no_comment, " "),
            values: Values::Uniforms(first),
        }
    }

    /// A kind, represented by one of its surfaces.
    pub fn kind(scene: &'a Scene, index: usize, kind: usize) -> Named<'a> {
        let surface = &scene.surfaces[index];
        Named {
            surface,
            tag: format!("Kind{kind}"),
            label: format!("kind {kind} ({})", surface.shape.name()),
            values: Values::Data,
        }
    }

    /// The same surface, with values that are selected among the surfaces of its kind.
    pub fn selected(&self) -> Named<'a> {
        self.with(self.tag.clone(), Values::Selected)
    }

    fn with(&self, tag: String, values: Values) -> Named<'a> {
        Named {
            surface: self.surface,
            tag,
            label: self.label.clone(),
            values,
        }
    }

    /// A field that represents a group with this tag. Its values are selected among those of the group's surfaces.
    pub fn selected_field(&self, tag: String) -> Named<'a> {
        self.with(tag, Values::Selected)
    }

    /// The vectors of the field's numbers as literals, or `None` if some numbers may move.
    pub fn literal_numbers(&self) -> Option<Vec<String>> {
        let field = self.field()?;
        let is_fixed = !self.is_data() && !self.surface.moving_nodes(field).contains(&true);
        let vector = |v: glam::Vec4| {
            let numbers = v.to_array().map(|number| field::literal(number.into()));
            format!("vec4({})", numbers.join(", "))
        };
        let vectors = || number_vectors(field, &vec![true; field.nodes().len()]);
        is_fixed.then(|| vectors().into_iter().map(vector).collect())
    }

    /// A surface of the kind, with values that were loaded from the scene's data.
    pub fn loaded(&self) -> Named<'a> {
        self.with(format!("Loaded{}", self.tag), Values::Loaded)
    }

    pub fn field(&self) -> Option<&'a Shape> {
        self.surface.shape.field()
    }

    /// Whether the surface is a mesh, which no profile marches to, except by its distance.
    pub fn is_mesh(&self) -> bool {
        self.surface.shape.mesh().is_some()
    }

    /// Whether a line is intersected with the surface in closed form.
    pub fn has_closed_form(&self) -> bool {
        self.field().is_none_or(has_closed_form)
    }

    /// Whether the intersection in closed form has a step limit.
    pub fn has_step_limit(&self) -> bool {
        self.has_closed_form() && self.field().is_some_and(field::has_step_limit)
    }

    /// Number of vectors of the surface's values.
    pub fn value_count(&self) -> usize {
        value_count(self.surface, self.has_all_numbers())
    }

    pub fn is_data(&self) -> bool {
        matches!(self.values, Values::Data)
    }

    /// Whether the surface's values include all numbers of its field.
    fn has_all_numbers(&self) -> bool {
        !matches!(self.values, Values::Uniforms(_))
    }

    /// The parameters of a field's functions in addition to the point: the index of the values for a kind, or the
    /// selected numbers.
    pub fn data_parameter(&self) -> String {
        match self.values {
            Values::Uniforms(_) | Values::Loaded => String::new(),
            Values::Data => ", int data".to_owned(),
            Values::Selected => self.each_selected(", vec4 "),
        }
    }

    pub fn data_argument(&self) -> String {
        match self.values {
            Values::Uniforms(_) | Values::Loaded => String::new(),
            Values::Data => ", data".to_owned(),
            Values::Selected => self.each_selected(", "),
        }
    }

    fn each_selected(&self, before: &str) -> String {
        let vectors = self.first_number()..self.value_count();
        vectors
            .map(|n| format!("{before}{}", self.value(n)))
            .collect()
    }

    /// The n-th vector of the surface's values.
    pub fn value(&self, n: usize) -> String {
        match self.values {
            Values::Uniforms(first) => value_name(first + n),
            Values::Data => format!("sceneData(data + {n})"),
            Values::Selected => format!("selected{n}"),
            Values::Loaded => format!("loaded{n}"),
        }
    }

    /// A world point in the surface's own axes.
    pub fn point(&self, p: &str) -> String {
        self.vector(&format!("{p} - {}.xyz", self.value(0)))
    }

    /// A world direction in the surface's own axes.
    pub fn vector(&self, v: &str) -> String {
        match self.rotation() {
            Some(rotation) => format!("turn({rotation}, {v})"),
            None => v.to_owned(),
        }
    }

    /// A direction in the surface's own axes as a world direction.
    pub fn outward(&self, v: &str) -> String {
        match self.rotation() {
            Some(rotation) => format!("turn({rotation} * vec4(-1, -1, -1, 1), {v})"),
            None => v.to_owned(),
        }
    }

    fn rotation(&self) -> Option<String> {
        let place = match self.surface.shape.node {
            Node::Cuboid(_) | Node::Room(_) => 2,
            _ => 1,
        };
        self.surface.has_rotation().then(|| self.value(place))
    }

    /// The index of the first vector with moving numbers of the field.
    pub fn first_number(&self) -> usize {
        1 + usize::from(self.surface.has_rotation())
    }

    /// Whether the numbers of each node of the field move. If the numbers are data, all nodes count as moving.
    pub fn moving_nodes(&self, field: &Shape) -> Vec<bool> {
        match self.has_all_numbers() {
            true => vec![true; field.nodes().len()],
            false => self.surface.moving_nodes(field),
        }
    }

    /// The size, with a comma before it. The size is the last argument of the shape's functions.
    pub fn size(&self) -> String {
        match self.surface.shape.node {
            Node::Cuboid(_) | Node::Room(_) => format!(", {}.xyz", self.value(1)),
            Node::Sphere(_) | Node::Cylinder(_) => format!(", {}.w", self.value(0)),
            _ => String::new(),
        }
    }

    /// The square of the radius of a sphere or a cylinder. The square is stored, because a product of uniforms within a
    /// loop adds 15 % to the time of a march in an empty room with llvmpipe.
    fn squared_radius(&self) -> String {
        match self.values {
            Values::Uniforms(first) => squared_radius_name(first),
            _ => format!("{0}.w * {0}.w", self.value(0)),
        }
    }

    /// The variable of [`Named::squared_radius`], and the expression of its value.
    pub fn squared_radius_of(&self) -> Option<(String, String)> {
        let is_round = matches!(self.surface.shape.node, Node::Sphere(_) | Node::Cylinder(_));
        match self.values {
            Values::Uniforms(first) if is_round => {
                Some((squared_radius_name(first), value_name(first)))
            }
            _ => None,
        }
    }

    /// Maximum rounding error of the distance to the surface, in metres.
    pub fn error_bound(&self) -> String {
        match self.surface.shape.node {
            Node::Cuboid(_) | Node::Room(_) => format!("{}.w", self.value(1)),
            Node::Sphere(_) | Node::Cylinder(_) => {
                format!("roundErrorBound({})", self.value(0))
            }
            _ => format!("{}.w", self.value(0)),
        }
    }

    pub fn shape(&self) -> &'static str {
        self.surface.shape.node.name_in_shaders()
    }

    /// The signed distance at a world point. For a field it is the field's value.
    pub fn distance(&self, p: &str) -> String {
        let point = self.point(p);
        match self.field() {
            Some(_) => format!("field{}({point}{})", self.tag, self.data_argument()),
            None => format!("sd{}({point}{})", self.shape(), self.size()),
        }
    }

    /// The distance to a basic shape, if a wave at `p` along `d` can still hit the shape.
    pub fn directed_distance(&self, p: &str, d: &str) -> String {
        let (shape, point, vector) = (self.shape(), self.point(p), self.vector(d));
        let size = match self.surface.shape.node {
            // The vector includes the error bound, within which rounding decides the side of a face.
            Node::Cuboid(_) => format!(", {}", self.value(1)),
            _ => self.size(),
        };
        format!("sd{shape}Directed({point}, {vector}{size})")
    }

    /// The gradient of a field at a point in its own axes, with the value as the last component.
    pub fn field_gradient(&self, q: &str) -> String {
        format!("gradient{}({q}{})", self.tag, self.data_argument())
    }

    /// The gradient of a field for callers that need only the direction of the normal.
    pub fn field_normal(&self, q: &str) -> String {
        match self.field().is_some_and(field::has_differences) {
            true => format!("normal{}({q}{})", self.tag, self.data_argument()),
            false => self.field_gradient(q),
        }
    }

    /// The distance to the hit of a line with the surface, if the surface has a closed form. Hits beyond `limit` need
    /// not be found.
    pub fn hit(&self, p: &str, d: &str, limit: &str) -> String {
        let (point, vector) = (self.point(p), self.vector(d));
        if let Some(field) = self.field() {
            let limit = match field::takes_limit(field) {
                true => format!(", {limit}"),
                false => String::new(),
            };
            let (tag, error_bound, data) = (&self.tag, self.error_bound(), self.data_argument());
            return format!("hit{tag}({point}, {vector}, {error_bound}{limit}{data})");
        }
        match self.surface.shape.node {
            Node::Cuboid(_) => format!("hitBox({point}, {vector}, {})", self.value(1)),
            Node::Sphere(_) => format!("hitBall({point}, {vector}, {})", self.squared_radius()),
            Node::Cylinder(_) => {
                format!("hitCircle({point}, {vector}, {})", self.squared_radius())
            }
            _ => format!("hit{}({point}, {vector}{})", self.shape(), self.size()),
        }
    }

    /// The value and slope of a marched field on a line in the surface's own axes.
    pub fn on_line(&self, point: &str, vector: &str) -> String {
        match self.field().is_some_and(field::is_known_on_lines) {
            true => format!(
                "onLine{}({point}, {vector}{})",
                self.tag,
                self.data_argument()
            ),
            false => format!(
                "valueOnLine(field{}({point}{}))",
                self.tag,
                self.data_argument()
            ),
        }
    }

    /// Whether a march takes free steps alone: slope and bend are known, and lines leave convex parts of the air in one
    /// step. The limits of the second derivative are only known for values that grow by at most 1.
    pub fn has_free_steps(&self) -> bool {
        let is_smooth =
            |field| field::is_smooth_on_lines(field) && field.properties().lipschitz <= 1.0;
        let has = |field| is_smooth(field) && field::has_parts_of_air(field);
        !self.has_all_numbers() && self.field().is_some_and(has)
    }

    /// Whether the chords of a line with a marched field are found once per flight.
    pub fn has_chords(&self) -> bool {
        let has = |field| field::has_chords(field, &self.moving_nodes(field));
        !self.has_all_numbers() && self.field().is_some_and(has)
    }

    /// Whether a lower bound along lines reaches further than the value on the line does.
    pub fn needs_bound(&self) -> bool {
        let needs = |field| field::is_bounded(field) && !field::is_smooth_on_lines(field);
        self.field().is_some_and(needs)
    }

    /// The length over which a line in the surface's own axes is free of a marched field.
    pub fn free(&self, point: &str, vector: &str, error_bound: &str) -> String {
        if !self.needs_bound() {
            return "0.0".to_owned();
        }
        let error_bound = format!("max({error_bound}, {})", self.error_bound());
        format!(
            "free{}({point}, {vector}, {error_bound}{})",
            self.tag,
            self.data_argument()
        )
    }

    /// The expression, or `none` if the surface is convex and the wave leaves it.
    pub fn unless_left(&self, left: &str, none: &str, expression: &str) -> String {
        match self.surface.shape.is_convex() {
            true => format!("{left} ? {none} : {expression}"),
            false => expression.to_owned(),
        }
    }

    /// The condition that a wave hits this surface.
    pub fn is_met(&self) -> String {
        format!("object == {}.0", self.tag)
    }

    /// The condition that a wave leaves this surface.
    pub fn left(&self) -> String {
        format!("last == {}.0", self.tag)
    }

    /// The text of the functions of its field; empty for a basic shape.
    pub fn field_functions(&self, write: field::Write, assets: &Assets) -> String {
        let Some(field) = self.field() else {
            return String::new();
        };
        let moving = self.moving_nodes(field);
        let first = self.first_number();
        let value = |n: usize| self.value(first + n);
        let place = field::Place {
            tag: &self.tag,
            parameter: &self.data_parameter(),
            argument: &self.data_argument(),
            moving: &moving,
            value: &value,
        };
        format!("// {}\n{}", self.label, write(field, &place, assets))
    }
}
