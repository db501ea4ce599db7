//! A surface: a shape, and where it stands.

use super::{Driver, Field, Node};
use glam::{Quat, Vec3};

/// A shape placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// What reports call it; a number when there is none.
    pub name: Option<String>,
    /// Its form and size.
    pub shape: Shape,
    /// World position of the shape's own origin in metres.
    pub position: Vec3,
    /// Turns the shape's own axes into the world's.
    pub rotation: Quat,
    /// Says that the rotation will change although it is the identity now.
    ///
    /// A surface that is not turned has no rotation in its shader text. One that
    /// is turned, or says here that it will be, takes its rotation from a uniform,
    /// so that turning it never compiles a shader.
    pub turns: bool,
    /// The angles in radians, about x, then y, then z, that a driven rotation is made of.
    pub angles: Vec3,
    /// What moves its numbers; empty when nothing does.
    pub drivers: Vec<Driver>,
}

/// The forms a surface can have. Air is where the distance is positive.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The plane y = 0 of its own axes; air above, solid below.
    Plane,
    /// A solid box.
    Box {
        /// Full width, height and depth in metres.
        size: Vec3,
    },
    /// The inside of a box: air within, solid without.
    Room {
        /// Full width, height and depth of the air in metres.
        size: Vec3,
    },
    /// A solid ball.
    Sphere {
        /// Radius in metres.
        radius: f32,
    },
    /// A solid endless cylinder about its own y axis.
    Cylinder {
        /// Radius in metres.
        radius: f32,
    },
    /// Any other shape, or operators on shapes.
    Field(Field),
}

impl From<Node> for Shape {
    fn from(node: Node) -> Shape {
        Shape::Field(Field::from(node))
    }
}

impl From<Field> for Shape {
    fn from(field: Field) -> Shape {
        Shape::Field(field)
    }
}

impl Surface {
    /// A shape at the world's origin, not turned.
    pub fn new(shape: impl Into<Shape>) -> Surface {
        Surface {
            name: None,
            shape: shape.into(),
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            turns: false,
            angles: Vec3::ZERO,
            drivers: Vec::new(),
        }
    }

    /// The same surface with its origin at `position` (metres).
    pub fn at(mut self, position: Vec3) -> Surface {
        self.position = position;
        self
    }

    /// The same surface turned by `rotation`.
    pub fn turned(mut self, rotation: Quat) -> Surface {
        self.rotation = rotation;
        self
    }

    /// The same surface with a name for reports.
    pub fn named(mut self, name: impl Into<String>) -> Surface {
        self.name = Some(name.into());
        self
    }

    /// Whether its rotation stands in the shader text at all.
    pub fn has_rotation(&self) -> bool {
        self.turns || self.rotation != Quat::IDENTITY
    }
}

impl Shape {
    /// Whether the solid is convex: a wave that was mirrored at it cannot meet it next.
    pub fn is_convex(&self) -> bool {
        match self {
            Shape::Room { .. } => false,
            Shape::Field(field) => field.properties().convex,
            _ => true,
        }
    }

    /// The name that scene files and reports use.
    pub fn name(&self) -> &'static str {
        match self {
            Shape::Plane => "Plane",
            Shape::Box { .. } => "Box",
            Shape::Room { .. } => "Room",
            Shape::Sphere { .. } => "Sphere",
            Shape::Cylinder { .. } => "Cylinder",
            Shape::Field(field) => field.node.name(),
        }
    }

    /// The field, if it is no basic shape.
    pub fn field(&self) -> Option<&Field> {
        match self {
            Shape::Field(field) => Some(field),
            _ => None,
        }
    }
}
