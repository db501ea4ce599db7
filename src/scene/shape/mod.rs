//! Shapes: implicit surfaces as trees of shapes and operators.
//!
//! A [`Shape`] is a function of space whose sign separates air (positive) from solid (negative).
//! Its leaves are shapes, its inner nodes operators, nested to any depth. The `Properties` of a
//! tree state whether its value is the distance to the surface, a bound of it, or only Lipschitz
//! (Hart 1996, section 3), the bounds of the solid, and whether it is convex.
//!
//! Each shape has a file in this folder, the operators are in `operator`, and each shape and operator has a file under
//! `glsl/`; `list` lists them all.
//!
//! Theory: Hart 1996, "Sphere tracing"; Quilez, "distance functions", for the operators' customary names. Values here
//! are computed in `f64`, independently of the shader's text, so that each can reveal errors of the other; tests
//! compare both for a table of shapes.

mod asset;
mod capsule;
mod cone;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod half_space;
mod height_field;
mod hyperboloid;
mod list;
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
mod rounded_box;
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
pub use half_space::HalfSpace;
pub use height_field::HeightField;
pub use hyperboloid::Hyperboloid;
#[doc(hidden)]
pub use list::Node;
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
pub use rounded_box::RoundedBox;
pub use sphere::Sphere;
pub use torus::Torus;
pub use user::User;

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
/// Operators are its methods:
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

    /// See [`Part::asset`].
    pub(crate) fn asset(&self) -> Option<Asset<'_>> {
        self.part().asset()
    }
}

impl Shape {
    /// An operator over several fields.
    #[doc(hidden)]
    pub fn over(node: impl Into<Node>, children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape {
            node: node.into(),
            children: children.into_iter().collect(),
        }
    }

    /// Whether the tree is a single one of the thesis' five shapes: a plane, a box, a room, a sphere or a cylinder. The
    /// sizes of basic shapes are passed to the shader with every frame, relative to the listener; the numbers of all
    /// other trees are in the shader's text.
    pub fn is_basic(&self) -> bool {
        use Node::{Cuboid, Cylinder, Plane, Room, Sphere};
        matches!(
            self.node,
            Plane(_) | Cuboid(_) | Room(_) | Sphere(_) | Cylinder(_)
        )
    }

    /// Whether it is a single shape that has only plane faces.
    pub(crate) fn is_flat(&self) -> bool {
        self.children.is_empty() && self.node.part().surface_kind().flat
    }

    /// Whether its whole surface consists of planes, however they are combined and copied.
    pub(crate) fn has_planes_alone(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat)
    }

    /// Whether its surface has no edges and no corners: it is a smooth shape or a blend of such shapes, moved, turned,
    /// scaled or inverted.
    pub(crate) fn is_smooth(&self) -> bool {
        self.all_parts(|part| part.surface_kind().smooth)
    }

    /// Whether sheets of its surface may meet in a hollow edge, around which less than half of space is air: an edge of
    /// a room, or a point where two solids touch.
    pub(crate) fn may_have_hollow_edges(&self) -> bool {
        if self.is_convex() || self.is_smooth() {
            return false;
        }
        !self.node.part().keeps_apart(&self.children)
            || self.children.iter().any(Shape::may_have_hollow_edges)
    }

    /// Whether its whole surface lies in the planes of its leaves.
    pub(crate) fn has_planes_of_leaves(&self) -> bool {
        self.all_parts(|part| part.surface_kind().flat && !part.copies())
    }

    /// Whether it is hollow and curved, and may therefore focus sound.
    #[doc(hidden)]
    pub fn gathers_sound(&self) -> bool {
        !self.has_planes_alone() && !self.is_convex()
    }

    /// Whether `holds` returns true for all nodes of the tree.
    fn all_parts(&self, holds: fn(&dyn Part) -> bool) -> bool {
        holds(self.node.part()) && self.children.iter().all(|child| child.all_parts(holds))
    }

    /// The tree, unless it is a [basic](Shape::is_basic) shape.
    #[doc(hidden)]
    pub fn field(&self) -> Option<&Shape> {
        (!self.is_basic()).then_some(self)
    }

    /// Properties of the tree.
    #[doc(hidden)]
    pub fn properties(&self) -> Properties {
        self.node.part().properties(&self.children)
    }

    /// The value at a point in the tree's own axes (metres): positive in the air. It is the distance to the surface, or
    /// grows with that distance: for most operators it is at most the distance.
    pub fn value(&self, p: DVec3) -> f64 {
        self.node.part().value(&self.children, p)
    }

    /// See [`Part::slowness`].
    pub(crate) fn slowness(&self) -> f64 {
        self.node.part().slowness(&self.children)
    }

    /// The numbers of the outermost node that the shader's text uses.
    pub(crate) fn shader_numbers(&self) -> Vec<f64> {
        self.node.part().shader_numbers(&self.children)
    }

    /// The largest length in the computation of its value, in metres: that of its bounds if they are finite, otherwise
    /// the largest among its nodes. 0 for a plane.
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

    /// Adds the users' fields of the tree, in order, with the part of each in which waves can be if those of the tree
    /// are in `waves`.
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
    /// A node's own numbers have their names in a scene file (`radius`, `size.x`); the names of the n-th child's
    /// numbers (from 0) begin with `n.` (`0.radius`, `1.0.by.y`).
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

/// Maximum number of nodes in a tree: compiling a larger tree takes too much memory and time. A field of 4,000 nodes
/// took llvmpipe more than 7 GB.
pub(crate) const MOST_NODES: usize = 512;

/// Number of points at which a stated Lipschitz constant is checked.
const TRIES: usize = 4096;

/// Maximum number of times at which it is checked at all these points; if there are more times, they share the points.
const TIMES_IN_FULL: usize = 64;

/// Minimum number of points at which it is checked at each time.
const LEAST_TRIES: usize = 32;

/// Relative excess of a difference quotient over a stated constant that is tolerated: the effect of rounding on a
/// quotient over a thousandth of the size.
const ROUNDING: f64 = 1e-3;

impl Shape {
    /// Checks the tree's numbers, its operators' operands and that every repetition is safe: cheap enough for every
    /// frame. Checks that need evaluations are in [`Shape::check`].
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
        for tree in &nodes {
            let named = |why| format!("{}: {why}", tree.node.name());
            tree.check_operands()
                .and_then(|()| tree.node.check())
                .map_err(named)?;
        }
        // Properties are defined for valid numbers only.
        for tree in nodes {
            let checked = tree.node.part().check_over(&tree.children);
            checked.map_err(|why| format!("{}: {why}", tree.node.name()))?;
        }
        Ok(())
    }

    /// Checks the tree like [`Shape::validate`], and checks every stated Lipschitz constant by a few thousand
    /// evaluations; the text of users' fields is parsed, but not compiled.
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

    /// Checks every stated Lipschitz constant in the field's current state, at one of `times` times; the checks at all
    /// times together take at most a few seconds.
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

    /// Checks the stated constant of a twist or a bend.
    fn check_growth(&self, tries: usize) -> Result<(), String> {
        let Some(stated) = self.node.part().stated_lipschitz() else {
            return Ok(());
        };
        let (steepest, place) = self.steepest_of(tries);
        if steepest <= f64::from(stated) * (1.0 + ROUNDING) {
            return Ok(());
        }
        Err(format!(
            "its value grows by {steepest:.3} a metre at ({:.3}, {:.3}, {:.3}), more than the stated lipschitz of {stated}: state at least {:.3}, or leave it out to have it computed",
            place.x,
            place.y,
            place.z,
            1.01 * steepest
        ))
    }

    /// Checks that a user's text defines the function and needs no other inputs.
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

    /// The greatest difference quotient found at points within the field's bounds, and the point at which it was found.
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

/// The n-th point of Halton's sequence in bases 2, 3, 5, which is evenly distributed in the unit cube.
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
