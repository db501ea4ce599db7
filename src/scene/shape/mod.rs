//! Shapes: implicit surfaces as trees of shapes and operators.
//!
//! A [`Shape`] is a function of space whose sign separates air (positive) from solid (negative).
//! Its leaves are shapes, its inner nodes operators, nested to any depth. The [`Properties`] of a
//! tree state whether its value is the distance to the surface, a bound of it, or only Lipschitz
//! (Hart 1996, section 3), the bounds of the solid, and whether it is convex.
//!
//! Each shape and operator has a file of its own here, and one under `glsl/`; `list` names them
//! all.
//!
//! Theory: Hart 1996, "Sphere tracing"; Quilez, "distance functions", for the operators' customary
//! names. Values here are computed in `f64`, independently of the shader's text, so that the two
//! can disagree; tests compare both for a table of shapes.

mod bounds;
mod build;
mod capped_cylinder;
mod capsule;
mod check;
mod cone;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod half_space;
mod height_field;
mod height_image;
mod hyperboloid;
mod list;
#[cfg(test)]
mod octahedron;
mod operator;
mod paraboloid;
mod parameter;
mod part;
mod plane;
mod prism;
mod properties;
mod quadric;
mod read;
mod room;
mod rounded_box;
mod sphere;
#[cfg(test)]
pub(crate) mod tests;
mod torus;
mod user;
mod user_field;
mod user_glsl;

pub(crate) use check::{MOST_NODES, halton};
pub(crate) use list::{ShapeFile, every_part, form_of, numbered, shape_names};
pub(crate) use parameter::{LARGEST, Numbers};
pub(crate) use part::{Asset, Part};
use quadric::Quadric;
pub(crate) use read::{FromFile, Operands};
#[doc(hidden)]
pub use user_glsl::code_lines;

pub use bounds::Bounds3;
pub use capped_cylinder::CappedCylinder;
pub use capsule::Capsule;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use ellipsoid::Ellipsoid;
pub use half_space::HalfSpace;
pub use height_field::HeightField;
pub use height_image::HeightImage;
pub use hyperboloid::Hyperboloid;
pub use list::Node;
pub(crate) use operator::Copies;
pub use operator::{
    Bend, Complement, Difference, Elongate, Intersection, Mirror, Morph, Offset, Repeat, Rotate,
    Scale, Shell, SmoothUnion, Translate, Twist, Union,
};
pub use paraboloid::Paraboloid;
pub(crate) use parameter::Parameter;
pub use plane::Plane;
pub use prism::Prism;
pub(crate) use properties::SurfaceKind;
pub use properties::{Exactness, Properties};
pub use quadric::GeneralQuadric;
pub use room::Room;
pub use rounded_box::RoundedBox;
pub use sphere::Sphere;
pub use torus::Torus;
pub use user::User;
pub use user_field::UserField;
pub(crate) use user_field::UserSamples;

use glam::DVec3;
use std::sync::Arc;

/// A shape, or an operator with its children.
///
/// ```
/// use echomarch::Shape;
/// use echomarch::glam::DVec3;
/// use echomarch::scene::shape::Sphere;
///
/// let hollow = Shape::from(Sphere { radius: 2.0 }).complement();
/// // Metres to the surface, positive in the air.
/// assert_eq!(hollow.value(DVec3::new(0.5, 0.0, 0.0)), 1.5);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The shape or operator, with its own numbers.
    pub node: Node,
    /// The operands of an operator; empty for a shape.
    pub children: Vec<Shape>,
}

impl Node {
    /// The user's field, if the shape is one.
    pub fn user(&self) -> Option<&Arc<UserField>> {
        match self.asset() {
            Some(Asset::User(field)) => Some(field),
            _ => None,
        }
    }

    /// See [`Part::asset`].
    pub(crate) fn asset(&self) -> Option<Asset<'_>> {
        self.part().asset()
    }
}

impl Shape {
    /// Whether the tree is a single one of the thesis' five shapes: a plane, a box, a room, a
    /// sphere or a cylinder. Their sizes are passed to the shader relative to the listener, with
    /// every frame; the numbers of all other trees are in its text.
    pub fn is_basic(&self) -> bool {
        self.node.part().is_basic()
    }

    /// Whether it is a single shape with plane faces only.
    pub(crate) fn is_flat(&self) -> bool {
        self.children.is_empty() && self.node.part().surface_kind().flat
    }

    /// Whether all of its surface lies in planes, however they are combined and copied.
    pub(crate) fn has_planes_alone(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat)
    }

    /// Whether its surface has no edges and no corners: it is a smooth shape or a blend of such shapes, moved, turned,
    /// scaled or inverted.
    pub(crate) fn is_smooth(&self) -> bool {
        self.all_parts(|part| part.surface_kind().smooth)
    }

    /// Whether sheets of its surface may meet in a hollow edge, where less than half of space is air: an edge of a
    /// room, or a place where two solids touch.
    pub(crate) fn may_have_hollow_edges(&self) -> bool {
        if self.is_convex() || self.is_smooth() {
            return false;
        }
        !self.node.part().keeps_apart(&self.children)
            || self.children.iter().any(Shape::may_have_hollow_edges)
    }

    /// Whether all of its surface lies in the planes of its leaves.
    pub(crate) fn has_planes_of_leaves(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat && !part.copies())
    }

    /// Whether it is hollow and curved, so that it may focus sound.
    pub fn gathers_sound(&self) -> bool {
        !self.has_planes_alone() && !self.is_convex()
    }

    /// Whether `holds` is true for all nodes of the tree.
    fn all_parts(&self, holds: fn(&dyn Part) -> bool) -> bool {
        holds(self.node.part()) && self.children.iter().all(|child| child.all_parts(holds))
    }

    /// The tree, unless it is a [basic](Shape::is_basic) shape.
    pub fn field(&self) -> Option<&Shape> {
        (!self.is_basic()).then_some(self)
    }

    /// Properties of the tree.
    pub fn properties(&self) -> Properties {
        self.node.part().properties(&self.children)
    }

    /// The value at a point of the tree's own axes (metres): positive in the air. Its
    /// relation to the distance is given by [`Shape::properties`].
    pub fn value(&self, p: DVec3) -> f64 {
        self.node.part().value(&self.children, p)
    }

    /// See [`Part::slowness`].
    pub(crate) fn slowness(&self) -> f64 {
        self.node.part().slowness(&self.children)
    }

    /// The numbers that the shader's text of the outermost node uses.
    pub(crate) fn shader_numbers(&self) -> Vec<f64> {
        self.node.part().shader_numbers(&self.children)
    }

    /// The largest length in the computation of its value, in metres: that of its bounds if they
    /// are finite, else the largest among its nodes. 0 for a plane.
    pub fn extent(&self) -> f64 {
        let bounds = self.properties().bounds;
        if bounds.is_finite() && !bounds.is_empty() {
            return bounds.min.abs().max(bounds.max.abs()).max_element();
        }
        let nodes = self.nodes().into_iter();
        let lengths = nodes.map(|tree| tree.node.part().own_length());
        lengths.fold(0.0, f64::max)
    }

    /// Whether the two are equal except for the paths of the files that they name.
    pub(crate) fn is_alike(&self, other: &Shape) -> bool {
        let nodes_are_alike = match (&self.node, &other.node) {
            (Node::User(one), Node::User(other)) => one.field.has_text_of(&other.field),
            (Node::HeightField(one), Node::HeightField(other)) => {
                one.size == other.size && one.image.has_heights_of(&other.image)
            }
            (one, other) => one == other,
        };
        let mut children = self.children.iter().zip(&other.children);
        nodes_are_alike
            && self.children.len() == other.children.len()
            && children.all(|(one, other)| one.is_alike(other))
    }

    /// Every number of the tree that may move.
    ///
    /// A node's own numbers are named as in a scene file (`radius`, `size.x`); the names of the
    /// n-th child's (from 0) begin with `n.` (`0.radius`, `1.0.by.y`).
    pub(crate) fn parameters_mut(&mut self) -> Vec<Parameter<'_>> {
        let mut all = self.node.part_mut().parameters_mut();
        for (index, child) in self.children.iter_mut().enumerate() {
            let below = child.parameters_mut().into_iter();
            all.extend(below.map(|parameter| Parameter {
                name: format!("{index}.{}", parameter.name),
                ..parameter
            }));
        }
        all
    }

    /// Whether the solid is convex: a wave reflected by it cannot hit it next.
    pub fn is_convex(&self) -> bool {
        self.properties().convex
    }

    /// The name of the outermost node in scene files and reports.
    pub fn name(&self) -> &'static str {
        self.node.name()
    }

    /// Every node of the tree, the outermost first.
    pub fn nodes(&self) -> Vec<&Shape> {
        let mut all = vec![self];
        for child in &self.children {
            all.extend(child.nodes());
        }
        all
    }
}
