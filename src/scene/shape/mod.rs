//! Implicit surfaces as trees of shapes and operators.
//!
//! A [`Shape`] is a function of space whose sign separates air (positive) from solid (negative). The leaves of a tree
//! are shapes, and its inner nodes are operators, with any nesting depth. The `Properties` of a tree state whether its
//! value is the distance to the surface, a bound of the distance, or only Lipschitz continuous (Hart 1996, section 3).
//! They also contain the bounds of the solid, and state whether it is convex.
//!
//! Each shape has a file in this folder, and the operators are in `operator`. Each shape and operator also has a file
//! under `glsl/`. The module `list` contains the list of all.
//!
//! Theory: Hart 1996, "Sphere tracing"; Quilez, "distance functions", for the common names of the operators. Values
//! here are computed in `f64` with code that is independent of the shaders. Tests compare both for a table of shapes,
//! so that each reveals errors of the other.

mod asset;
mod capsule;
mod cone;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod grid;
mod half_space;
mod height_field;
mod hyperboloid;
mod list;
mod mesh;
mod npy;
#[cfg(test)]
mod octahedron;
mod operator;
mod paraboloid;
mod part;
mod plane;
mod prism;
mod properties;
mod quadric;
mod room;
mod rooms;
mod rounded_box;
mod sampled_field;
mod sphere;
#[cfg(test)]
pub(crate) mod tests;
mod torus;
mod user;
mod user_glsl;

pub(crate) use asset::{Asset, UserSamples, WaveDomain};
pub(crate) use list::{ShapeFile, every_part, form_of, numbered, shape_names};
pub(crate) use part::{LARGEST, Numbers, Parameter, Part};
use quadric::Quadric;
#[doc(hidden)]
pub use user_glsl::code_lines;

pub use asset::{HeightImage, UserField};
pub use capsule::Capsule;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::{CappedCylinder, Cylinder};
pub use ellipsoid::Ellipsoid;
pub use grid::Grid;
pub use half_space::HalfSpace;
pub use height_field::HeightField;
pub use hyperboloid::Hyperboloid;
#[doc(hidden)]
pub use list::Node;
pub use mesh::Mesh;
#[cfg(test)]
pub use octahedron::Octahedron;
pub(crate) use operator::Copies;
#[doc(hidden)]
pub use operator::{
    Bend, Complement, Difference, Elongate, Intersection, Mirror, Morph, Offset, Repeat, Rotate,
    Scale, Shell, SmoothUnion, Translate, Twist, Union,
};
pub use paraboloid::Paraboloid;
pub use plane::Plane;
pub use prism::Prism;
pub use properties::Bounds3;
pub(crate) use properties::SurfaceKind;
#[doc(hidden)]
pub use properties::{Exactness, Properties};
pub use quadric::GeneralQuadric;
pub use room::Room;
pub use rooms::{AirBox, Rooms};
pub use rounded_box::RoundedBox;
pub use sampled_field::SampledField;
pub use sphere::Sphere;
pub use torus::Torus;
pub use user::User;

use super::mesh::TriangleMesh;
use glam::DVec3;
use part::in_range;
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
///
/// Operators are methods of the shape:
///
/// ```
/// use echomarch::Shape;
/// use echomarch::glam::{DVec3, Vec3};
/// use echomarch::scene::shape::{Cuboid, Sphere};
///
/// let ball = Shape::from(Sphere { radius: 2.0 });
/// let slab = Shape::from(Cuboid { size: Vec3::new(9.0, 1.0, 9.0) });
/// let bowl = ball.shell(0.2).minus([slab.translate(Vec3::Y * 2.0)]);
/// assert!(bowl.value(DVec3::ZERO) > 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The shape or operator, with its own numbers.
    #[doc(hidden)]
    pub node: Node,
    /// The operands of an operator; empty for a shape.
    #[doc(hidden)]
    pub children: Vec<Shape>,
}

impl Node {
    /// The user's field, if this shape is one.
    pub fn user(&self) -> Option<&Arc<UserField>> {
        match self.asset() {
            Some(Asset::User(field)) => Some(field),
            _ => None,
        }
    }

    /// Whether the CPU knows only samples of the value: its curvature is unknown.
    pub(crate) fn is_sampled(&self) -> bool {
        matches!(self.asset(), Some(Asset::User(_) | Asset::Samples(_)))
    }

    /// See [`Part::asset`].
    pub(crate) fn asset(&self) -> Option<Asset<'_>> {
        self.part().asset()
    }
}

impl Shape {
    /// An operator applied to children.
    #[doc(hidden)]
    pub fn over(node: impl Into<Node>, children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape {
            node: node.into(),
            children: children.into_iter().collect(),
        }
    }

    /// Whether the tree is one of the five shapes of the thesis: a plane, a box, a room, a sphere or a cylinder. The
    /// sizes of these basic shapes are passed to the shader in every frame, relative to the listener. The numbers of
    /// all other trees are part of the shader text.
    pub fn is_basic(&self) -> bool {
        use Node::{Cuboid, Cylinder, Plane, Room, Sphere};
        matches!(
            self.node,
            Plane(_) | Cuboid(_) | Room(_) | Sphere(_) | Cylinder(_)
        )
    }

    /// Whether the tree is a single shape whose faces are all plane.
    pub(crate) fn is_flat(&self) -> bool {
        self.children.is_empty() && self.node.part().surface_kind().flat
    }

    /// Whether the whole surface consists of planes, including combined and copied planes.
    pub(crate) fn has_planes_alone(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat)
    }

    /// Whether the surface has no edges and no corners: a smooth shape or a blend of smooth shapes, possibly moved,
    /// rotated, scaled or inverted.
    pub(crate) fn is_smooth(&self) -> bool {
        self.all_parts(|part| part.surface_kind().smooth)
    }

    /// Whether sheets of the surface may meet in a hollow edge. Less than half of the space around such an edge is air.
    /// Examples are an edge of a room, and a point where two solids touch.
    pub(crate) fn may_have_hollow_edges(&self) -> bool {
        if self.is_convex() || self.is_smooth() {
            return false;
        }
        !self.node.part().keeps_apart(&self.children)
            || self.children.iter().any(Shape::may_have_hollow_edges)
    }

    /// Whether the whole surface lies in the planes of the tree's leaves.
    pub(crate) fn has_planes_of_leaves(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat && !part.copies())
    }

    /// Whether the surface is curved and the solid is not convex, so that the surface may focus sound.
    #[doc(hidden)]
    pub fn gathers_sound(&self) -> bool {
        !self.has_planes_alone() && !self.is_convex()
    }

    /// Whether `holds` returns true for all nodes of the tree.
    fn all_parts(&self, holds: fn(&dyn Part) -> bool) -> bool {
        holds(self.node.part()) && self.children.iter().all(|child| child.all_parts(holds))
    }

    /// The solids whose union is the solid of the tree: the children of a union, or the tree itself.
    pub(crate) fn united(&self) -> Vec<&Shape> {
        match self.node {
            Node::Union(_) => self.children.iter().flat_map(Shape::united).collect(),
            _ => vec![self],
        }
    }

    /// Whether the value is known to be a convex function in the air: the distance to a convex solid is one, and so is the
    /// maximum of convex functions.
    pub(crate) fn has_convex_value(&self) -> bool {
        if let Node::Intersection(_) = self.node {
            return self.children.iter().all(Shape::has_convex_value);
        }
        let properties = self.properties();
        properties.convex && properties.in_air == Exactness::Exact
    }

    /// The tree, unless it is a [basic](Shape::is_basic) shape.
    #[doc(hidden)]
    pub fn field(&self) -> Option<&Shape> {
        (!self.is_basic()).then_some(self)
    }

    /// The triangles, if the shape is a mesh or rooms.
    pub(crate) fn mesh(&self) -> Option<&Arc<TriangleMesh>> {
        match &self.node {
            Node::Mesh(of) => Some(&of.mesh),
            Node::Rooms(of) => Some(of.mesh()),
            _ => None,
        }
    }

    /// Properties of the tree.
    #[doc(hidden)]
    pub fn properties(&self) -> Properties {
        self.node.part().properties(&self.children)
    }

    /// The value at a point in the tree's own axes (metres): positive in the air. The value is the distance to the
    /// surface, or a function that grows with this distance. For most operators it is at most the distance.
    pub fn value(&self, p: DVec3) -> f64 {
        self.node.part().value(&self.children, p)
    }

    /// See [`Part::slowness`].
    pub(crate) fn slowness(&self) -> f64 {
        self.node.part().slowness(&self.children)
    }

    /// The numbers of the root node that the shader text uses.
    pub(crate) fn shader_numbers(&self) -> Vec<f64> {
        self.node.part().shader_numbers(&self.children)
    }

    /// The largest length in the computation of the value, in metres: the largest coordinate of the bounds if they are
    /// finite, otherwise the largest length among the nodes. 0 for a plane.
    #[doc(hidden)]
    pub fn extent(&self) -> f64 {
        let bounds = self.properties().bounds;
        if bounds.is_finite() && !bounds.is_empty() {
            return bounds.min.abs().max(bounds.max.abs()).max_element();
        }
        let nodes = self.nodes().into_iter();
        let lengths = nodes.map(|tree| tree.node.part().own_length());
        lengths.fold(0.0, f64::max)
    }

    /// Adds the users' fields of the tree in order, each with the part that waves can reach. `waves` is the part of the
    /// tree that waves can reach.
    pub(crate) fn add_users<'a>(
        &'a self,
        waves: WaveDomain,
        to: &mut Vec<(&'a Arc<UserField>, WaveDomain)>,
    ) {
        let part = self.node.part();
        if let Some(Asset::User(field)) = part.asset() {
            to.push((field, waves));
        }
        for (index, child) in self.children.iter().enumerate() {
            let below = match part.keeps_air(index) {
                true => waves,
                false => WaveDomain::BothSides,
            };
            child.add_users(below, to);
        }
    }

    /// Whether both trees are equal, ignoring the paths of their files.
    pub(crate) fn is_alike(&self, other: &Shape) -> bool {
        let nodes_are_alike = match (&self.node, &other.node) {
            (Node::User(one), Node::User(other)) => one.field.has_text_of(&other.field),
            (Node::HeightField(one), Node::HeightField(other)) => {
                one.size == other.size && one.image.has_heights_of(&other.image)
            }
            (Node::Grid(one), Node::Grid(other)) => one.field.has_values_of(&other.field),
            (Node::Mesh(one), Node::Mesh(other)) => one.mesh.has_faces_of(&other.mesh),
            (one, other) => one == other,
        };
        let mut children = self.children.iter().zip(&other.children);
        nodes_are_alike
            && self.children.len() == other.children.len()
            && children.all(|(one, other)| one.is_alike(other))
    }

    /// All numbers of the tree that can move.
    ///
    /// The names of a node's own numbers are those in a scene file (`radius`, `size.x`). The names of the n-th child's
    /// numbers (from 0) have the prefix `n.` (`0.radius`, `1.0.by.y`).
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

    /// Whether the solid is convex, so that a wave cannot hit it twice in succession.
    pub fn is_convex(&self) -> bool {
        self.properties().convex
    }

    /// The name of the root node in reports.
    pub fn name(&self) -> &'static str {
        self.node.name()
    }

    /// All nodes of the tree, the root first.
    pub fn nodes(&self) -> Vec<&Shape> {
        let mut all = vec![self];
        for child in &self.children {
            all.extend(child.nodes());
        }
        all
    }
}

/// Maximum number of nodes in a tree. The compilation of a larger tree takes too much memory and time: llvmpipe needed
/// more than 7 GB for a field of 4,000 nodes.
pub(crate) const MOST_NODES: usize = 512;

/// Number of points at which a stated Lipschitz constant is checked.
const TRIES: usize = 4096;

/// Maximum number of times at which a stated Lipschitz constant is checked at all `TRIES` points. If there are more
/// times, fewer points are checked at each time.
const TIMES_IN_FULL: usize = 64;

/// Minimum number of points at which a stated Lipschitz constant is checked at each time.
const LEAST_TRIES: usize = 32;

/// Tolerated relative excess of a difference quotient over a stated Lipschitz constant. It covers the rounding error of
/// the quotient.
const ROUNDING: f64 = 1e-3;

impl Shape {
    /// Checks the numbers of the tree, the number of each operator's children, and the safety of every repetition. This
    /// check is fast enough to run in every frame. [`Shape::check`] contains the checks that evaluate the tree.
    ///
    /// # Errors
    /// A message that names the node and states the requirement.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let nodes = self.nodes();
        if nodes.len() > MOST_NODES {
            let count = nodes.len();
            return Err(format!(
                "a field of {count} nodes is too large: at most {MOST_NODES}"
            ));
        }
        if nodes.len() > 1
            && let Some(mesh) = nodes.iter().find(|tree| tree.mesh().is_some())
        {
            let what = match mesh.node {
                Node::Rooms(_) => "Rooms are",
                _ => "a Mesh is",
            };
            return Err(format!(
                "{what} a whole surface, and no operand of an operator"
            ));
        }
        for tree in &nodes {
            let named = |why| format!("{}: {why}", tree.node.name());
            tree.check_operands()
                .and_then(|()| tree.node.check())
                .map_err(named)?;
        }
        // Properties are defined only for valid numbers.
        for tree in nodes {
            let checked = tree.node.part().check_over(&tree.children);
            checked.map_err(|why| format!("{}: {why}", tree.node.name()))?;
        }
        Ok(())
    }

    /// Checks the tree like [`Shape::validate`], and checks every stated Lipschitz constant by a few thousand
    /// evaluations. The text of users' fields is parsed, but not compiled.
    ///
    /// # Errors
    /// A message that names the node and states the requirement.
    pub(crate) fn check(&self) -> Result<(), String> {
        self.validate()?;
        for field in self.nodes() {
            field
                .check_growth(TRIES)
                .and_then(|()| field.check_text())
                .map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    /// Checks every stated Lipschitz constant in the current state of the tree, at one of `times` times. The checks at
    /// all times together take at most a few seconds.
    pub(in crate::scene) fn check_growth_at_one_of(&self, times: usize) -> Result<(), String> {
        let tries = TRIES * TIMES_IN_FULL / times.max(1);
        let tries = tries.clamp(LEAST_TRIES, TRIES);
        for field in self.nodes() {
            let checked = field.check_growth(tries);
            checked.map_err(|why| format!("{}: {why}", field.node.name()))?;
        }
        Ok(())
    }

    fn check_operands(&self) -> Result<(), String> {
        let (least, most) = self.node.part().operands();
        let count = self.children.len();
        if (least..=most).contains(&count) {
            return Ok(());
        }
        Err(match (least, most) {
            (0, _) => "is a shape and takes no fields".to_owned(),
            (least, most) if least == most => format!("takes {least} fields, not {count}"),
            (least, _) => format!("takes at least {least} fields, not {count}"),
        })
    }

    /// Checks the stated Lipschitz constant of a twist or a bend.
    fn check_growth(&self, tries: usize) -> Result<(), String> {
        let Some(stated) = self.node.part().stated_lipschitz() else {
            return Ok(());
        };
        let (steepest, place) = self.steepest_of(tries);
        if steepest <= f64::from(stated) * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(format!(
            "its value grows by {steepest:.3} per metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: state at least {:.3}, or omit it to have it computed",
            place.x,
            place.y,
            place.z,
            1.01 * steepest
        ))
    }

    /// Checks that a user's text defines the field function and needs no external input.
    fn check_text(&self) -> Result<(), String> {
        match &self.node {
            Node::User(User { field }) => field.check_text().map_err(|(line, why)| {
                let file = field.file.display();
                match line {
                    Some(line) => format!("{file}:{line}: {why}"),
                    None => format!("{file}: {why}"),
                }
            }),
            _ => Ok(()),
        }
    }

    /// The largest difference quotient among the tested points within the bounds, and its point.
    pub fn steepest(&self) -> (f64, DVec3) {
        self.steepest_of(TRIES)
    }

    fn steepest_of(&self, tries: usize) -> (f64, DVec3) {
        let bounds = self.properties().bounds;
        let reach = DVec3::splat(10.0);
        let box_ = Bounds3::new(bounds.min.max(-reach), bounds.max.min(reach));
        let step = 1e-4 * (box_.max - box_.min).max_element().max(1e-6);
        let mut found = (0.0, DVec3::ZERO);
        for index in 1..=tries {
            let p = box_.min + halton(index) * (box_.max - box_.min);
            let along = |axis: DVec3| {
                (self.value(p + axis * step) - self.value(p - axis * step)) / (2.0 * step)
            };
            let gradient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
            if gradient.length() > found.0 {
                found = (gradient.length(), p);
            }
        }
        found
    }
}

/// The n-th point of Halton's sequence in bases 2, 3 and 5. The points are evenly distributed in the unit cube.
pub(crate) fn halton(index: usize) -> DVec3 {
    let radical_inverse = |base: usize| {
        let (mut rest, mut share, mut sum) = (index, 1.0, 0.0);
        while rest > 0 {
            share /= base as f64;
            sum += share * (rest % base) as f64;
            rest /= base;
        }
        sum
    };
    DVec3::new(radical_inverse(2), radical_inverse(3), radical_inverse(5))
}

impl Node {
    /// Checks the node's own numbers against their ranges.
    fn check(&self) -> Result<(), String> {
        if !in_range(self.part()) {
            // The copy and the names are needed only for an error message.
            let mut copy = self.clone();
            let parameters = copy.part_mut().parameters_mut();
            parameters.iter().try_for_each(|number| number.check())?;
        }
        self.part().check()
    }
}
