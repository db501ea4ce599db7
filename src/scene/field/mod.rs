//! Fields: implicit surfaces as trees of shapes and operators.
//!
//! A [`Field`] is a function of space whose sign tells air (positive) from solid
//! (negative). Its leaves are shapes, its inner nodes operators, nested to any depth.
//! What a tree promises about its value is in its [`Properties`]: whether the value is
//! the distance to the surface, a bound of it, or only Lipschitz (Hart 1996, section 3);
//! where it lies in space; whether the solid is convex.
//!
//! Theory: Hart 1996, "Sphere tracing"; Quilez, "distance functions", for the operators'
//! customary names. Values here are computed in `f64`, apart from the shader's text
//! (`scene::glsl::field`), so that the two can disagree; a table of tests walks both.

mod bounds;
mod build;
mod check;
mod height;
mod parameters;
mod properties;
mod repeat;
mod text;
mod user;
mod value;

pub(crate) use check::halton;

pub use bounds::Bounds3;
pub use height::HeightImage;
pub use properties::{Exactness, Properties};
pub use repeat::Copies;
pub use user::{UserField, UserSamples};

use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A shape, or an operator on the fields below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// What it is, with its own numbers.
    pub node: Node,
    /// What an operator works on; empty for a shape.
    pub of: Vec<Field>,
}

/// What one node of a tree is. Lengths are in metres, angles in radians; shapes are
/// centred on the origin of their own axes unless it says otherwise.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// The plane y = 0: solid below.
    Plane,
    /// Solid where `normal · p < offset`; the normal need not be a unit vector.
    HalfSpace {
        /// Out of the solid.
        normal: Vec3,
        /// Distance of the boundary from the origin along the unit normal.
        offset: f32,
    },
    /// A solid box.
    Box {
        /// Full width, height and depth.
        size: Vec3,
    },
    /// The inside of a box: air within, solid without.
    Room {
        /// Full width, height and depth of the air.
        size: Vec3,
    },
    /// A box whose edges and vertices are rounded.
    RoundedBox {
        /// Full width, height and depth, the rounding included.
        size: Vec3,
        /// Radius of the rounding, at most half the least size.
        rounding: f32,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// An endless cylinder about y.
    Cylinder {
        /// Radius.
        radius: f32,
    },
    /// A cylinder about y that ends.
    CappedCylinder {
        /// Radius.
        radius: f32,
        /// Full height.
        height: f32,
    },
    /// A cylinder about y with round ends.
    Capsule {
        /// Radius of cylinder and ends.
        radius: f32,
        /// Height between the centres of the round ends.
        height: f32,
    },
    /// A ring about y.
    Torus {
        /// Radius of the ring's centre line.
        ring: f32,
        /// Radius of the tube.
        tube: f32,
    },
    /// A cone about y that ends: base at −height/2, tip at height/2.
    Cone {
        /// Radius of the base.
        radius: f32,
        /// Full height.
        height: f32,
    },
    /// A triangle in the xy plane, extruded along z.
    Prism {
        /// The triangle's corners (x, y), in either sense of rotation.
        corners: [Vec2; 3],
        /// Full length along z.
        depth: f32,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Half axes along x, y and z.
        radii: Vec3,
    },
    /// A solid paraboloid that opens towards +y: y > (x² + z²) / (4 focal length).
    Paraboloid {
        /// Distance of the focus from the vertex (the origin).
        focal_length: f32,
    },
    /// A hyperboloid about y. One sheet: x² + z² < waist² (1 + y²/rise²), a solid with a
    /// waist. Two sheets: y² > rise² (1 + (x² + z²)/waist²), two solid bowls.
    Hyperboloid {
        /// Radius at the waist; of two sheets that of the hyperbola's box.
        waist: f32,
        /// Height over which the asymptotic cone is as wide as the waist.
        rise: f32,
        /// Whether there are two sheets.
        two_sheets: bool,
    },
    /// Solid where A x² + B y² + C z² + D xy + E yz + F zx + G x + H y + I z + J < 0.
    Quadric {
        /// A to J in this order.
        coefficients: [f32; 10],
    },
    /// Ground under an image of heights: solid below, within a box that is centred on
    /// the origin. Black lies on its floor, white at its ceiling.
    HeightField {
        /// The heights.
        image: Arc<HeightImage>,
        /// Full width (the image's), height and depth.
        size: Vec3,
    },
    /// A user's GLSL `float field(vec3 p)`, within a box that is centred on the origin.
    User {
        /// The text and what it promises.
        field: Arc<UserField>,
    },
    /// Solid where any is.
    Union,
    /// Solid where all are.
    Intersection,
    /// The first, less all the others.
    Difference,
    /// Air and solid exchanged.
    Complement,
    /// The surface alone as a wall of this thickness.
    Shell {
        /// Full thickness, half of it to either side.
        thickness: f32,
    },
    /// The union, blended where two are about equally near (quadratic polynomial).
    SmoothUnion {
        /// Difference of distances below which they blend.
        radius: f32,
    },
    /// Grown by a length (rounding edges), or shrunk by a negative one.
    Offset {
        /// How far the surface moves out.
        by: f32,
    },
    /// Moved.
    Translate {
        /// How far.
        by: Vec3,
    },
    /// Turned about x, then y, then z of the outer axes.
    Rotate {
        /// Angles in radians, right-handed.
        by: Vec3,
    },
    /// Made larger, about the origin.
    Scale {
        /// Factor, greater than 0.
        by: f32,
    },
    /// What lies on the positive side of some axes, on both sides.
    Mirror {
        /// For x, y and z: whether it is mirrored there.
        axes: [bool; 3],
    },
    /// The same again and again.
    Repeat {
        /// Distance from one to the next along x, y, z; 0 where it is not repeated.
        period: Vec3,
        /// How many along each axis, centred about the origin; 0 for endless.
        count: [u32; 3],
    },
    /// Cut at the origin's planes and pulled apart, the gap filled straight.
    Elongate {
        /// How far each half moves along x, y and z.
        by: Vec3,
    },
    /// Turned about y the further up one looks.
    Twist {
        /// Radians per metre of y.
        rate: f32,
        /// How fast the value may grow; 0 to have it from the bounds.
        lipschitz: f32,
    },
    /// Turned about z (right-handed) the further right one looks: a bar along x becomes an arc.
    Bend {
        /// Radians per metre of x.
        rate: f32,
        /// How fast the value may grow; 0 to have it from the bounds.
        lipschitz: f32,
    },
    /// Between two fields: the first at 0, the second at 1.
    Morph {
        /// 0 to 1.
        amount: f32,
    },
}

impl Node {
    /// The name that scene files, shaders and reports use.
    pub fn name(&self) -> &'static str {
        match self {
            Node::Plane => "Plane",
            Node::HalfSpace { .. } => "HalfSpace",
            Node::Box { .. } => "Box",
            Node::Room { .. } => "Room",
            Node::RoundedBox { .. } => "RoundedBox",
            Node::Sphere { .. } => "Sphere",
            Node::Cylinder { .. } => "Cylinder",
            Node::CappedCylinder { .. } => "CappedCylinder",
            Node::Capsule { .. } => "Capsule",
            Node::Torus { .. } => "Torus",
            Node::Cone { .. } => "Cone",
            Node::Prism { .. } => "Prism",
            Node::Ellipsoid { .. } => "Ellipsoid",
            Node::Paraboloid { .. } => "Paraboloid",
            Node::Hyperboloid { .. } => "Hyperboloid",
            Node::Quadric { .. } => "Quadric",
            Node::HeightField { .. } => "HeightField",
            Node::User { .. } => "Field",
            Node::Union => "Union",
            Node::Intersection => "Intersection",
            Node::Difference => "Difference",
            Node::Complement => "Complement",
            Node::Shell { .. } => "Shell",
            Node::SmoothUnion { .. } => "SmoothUnion",
            Node::Offset { .. } => "Offset",
            Node::Translate { .. } => "Translate",
            Node::Rotate { .. } => "Rotate",
            Node::Scale { .. } => "Scale",
            Node::Mirror { .. } => "Mirror",
            Node::Repeat { .. } => "Repeat",
            Node::Elongate { .. } => "Elongate",
            Node::Twist { .. } => "Twist",
            Node::Bend { .. } => "Bend",
            Node::Morph { .. } => "Morph",
        }
    }

    /// The user's field that it is, if it is one.
    pub fn user(&self) -> Option<&Arc<UserField>> {
        match self {
            Node::User { field } => Some(field),
            _ => None,
        }
    }

    /// How many fields it works on: least and most.
    pub fn operands(&self) -> (usize, usize) {
        match self {
            Node::Union | Node::Intersection | Node::SmoothUnion { .. } => (1, usize::MAX),
            Node::Difference => (2, usize::MAX),
            Node::Morph { .. } => (2, 2),
            Node::Complement
            | Node::Shell { .. }
            | Node::Offset { .. }
            | Node::Translate { .. }
            | Node::Rotate { .. }
            | Node::Scale { .. }
            | Node::Mirror { .. }
            | Node::Repeat { .. }
            | Node::Elongate { .. }
            | Node::Twist { .. }
            | Node::Bend { .. } => (1, 1),
            _ => (0, 0),
        }
    }
}

impl Field {
    /// Every node of the tree, the outermost first.
    pub fn nodes(&self) -> Vec<&Field> {
        let mut all = vec![self];
        for child in &self.of {
            all.extend(child.nodes());
        }
        all
    }
}
