//! A surface: a shape, and where it stands.

use super::{Bounds3, Driver, Shape};
use glam::{DMat3, Quat, Vec3};

/// A shape placed in the world.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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
    pub dynamic_rotation: bool,
    /// The angles in radians, about x, then y, then z, that a driven rotation is made of.
    pub angles: Vec3,
    /// What moves its numbers; empty when nothing does.
    pub drivers: Vec<Driver>,
}

impl Surface {
    /// A shape at the world's origin, not turned.
    pub fn new(shape: impl Into<Shape>) -> Surface {
        Surface {
            name: None,
            shape: shape.into(),
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            dynamic_rotation: false,
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

    /// Whether the two are alike but for where the files lie that they name.
    #[cfg(feature = "demo")]
    pub(crate) fn is_alike(&self, other: &Surface) -> bool {
        let at_one_place = Surface {
            shape: other.shape.clone(),
            ..self.clone()
        };
        at_one_place == *other && self.shape.is_alike(&other.shape)
    }

    /// The same surface, whose rotation will change: see
    /// [`dynamic_rotation`](Surface::dynamic_rotation).
    pub fn turning(mut self) -> Surface {
        self.dynamic_rotation = true;
        self
    }

    /// What holds its solid, in world metres.
    pub fn bounds(&self) -> Bounds3 {
        let own = self.shape.properties().bounds;
        let turned = if self.has_rotation() {
            own.turned(DMat3::from_quat(self.rotation.as_dquat()))
        } else {
            own
        };
        turned.moved(self.position.as_dvec3())
    }

    /// Whether its rotation stands in the shader text at all.
    pub fn has_rotation(&self) -> bool {
        self.dynamic_rotation || self.rotation != Quat::IDENTITY
    }
}
