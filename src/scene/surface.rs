//! A surface: a shape and its position.

use super::{Bounds3, Driver, Node, SceneError, Shape, WALL_COUNT};
use glam::{DMat3, Quat, Vec3};

/// A shape placed in the world.
///
/// ```
/// use echomarch::Surface;
/// use echomarch::glam::Vec3;
/// use echomarch::scene::shape::Torus;
///
/// let ring = Torus { ring: 2.0, tube: 0.5 };
/// let surface = Surface::new(ring).at(Vec3::new(0.0, 1.0, 0.0)).with_material("brick");
/// assert_eq!(surface.bounds().max.y, 1.5);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Surface {
    /// Name in reports; without one, its number is used.
    pub name: Option<String>,
    /// Its form and size.
    pub shape: Shape,
    /// World position of the shape's own origin in metres.
    pub position: Vec3,
    /// Turns the shape's own axes into the world's.
    pub rotation: Quat,
    /// Declares that the rotation will change although it is the identity now.
    ///
    /// A surface that is not turned has no rotation in its shader text. One that is turned, or
    /// declared here as turning, takes its rotation from a uniform, so that turning it never
    /// compiles a shader.
    pub dynamic_rotation: bool,
    /// The angles of a driven rotation in radians, about x, then y, then z.
    pub angles: Vec3,
    /// The drivers of its numbers; empty when it does not move.
    pub drivers: Vec<Driver>,
    /// The name of its material, one of the scene's or a built-in one; without one it reflects all.
    pub material: Option<String>,
    /// For a [`Room`](super::shape::Room): the materials of walls that differ from the surface's,
    /// in the order of [`WALL_NAMES`](super::WALL_NAMES). They turn with the room.
    pub walls: [Option<String>; WALL_COUNT],
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
            material: None,
            walls: Default::default(),
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

    /// The same surface with the material of this name.
    pub fn with_material(mut self, name: impl Into<String>) -> Surface {
        self.material = Some(name.into());
        self
    }

    /// The same room with the material of this name on one of its walls (0 to 5, see
    /// [`WALL_NAMES`](super::WALL_NAMES)).
    ///
    /// # Errors
    /// [`SceneError::NoSuchWall`](super::SceneError::NoSuchWall) if the number is out of range.
    pub fn with_wall_material(
        mut self,
        wall: usize,
        name: impl Into<String>,
    ) -> Result<Surface, SceneError> {
        let material = self.walls.get_mut(wall);
        *material.ok_or(SceneError::NoSuchWall { wall })? = Some(name.into());
        Ok(self)
    }

    /// The name of the material of a wall, or of the surface.
    pub(super) fn material_name(&self, wall: Option<usize>) -> Option<&str> {
        let of_wall = wall.and_then(|wall| self.walls.get(wall)?.as_deref());
        of_wall.or(self.material.as_deref())
    }

    /// The names of all materials of the surface: its own, then its walls'.
    pub(super) fn material_names(&self) -> impl Iterator<Item = &str> {
        let walls = self.walls.iter();
        self.material
            .iter()
            .chain(walls.flatten())
            .map(String::as_str)
    }

    /// Whether its shape has walls that may be of different materials.
    pub(super) fn has_walls(&self) -> bool {
        matches!(self.shape.node, Node::Room(_))
    }

    /// Whether the two are equal except for the paths of the files that they name.
    pub fn is_alike(&self, other: &Surface) -> bool {
        let at_one_place = Surface {
            shape: other.shape.clone(),
            ..self.clone()
        };
        at_one_place == *other && self.shape.is_alike(&other.shape)
    }

    /// The same surface, declared as turning: see [`dynamic_rotation`](Surface::dynamic_rotation).
    pub fn turning(mut self) -> Surface {
        self.dynamic_rotation = true;
        self
    }

    /// Bounds of its solid, in world metres.
    pub fn bounds(&self) -> Bounds3 {
        let own = self.shape.properties().bounds;
        let turned = if self.has_rotation() {
            own.turned(DMat3::from_quat(self.rotation.as_dquat()))
        } else {
            own
        };
        turned.moved(self.position.as_dvec3())
    }

    /// Whether the shader text contains its rotation.
    pub fn has_rotation(&self) -> bool {
        self.dynamic_rotation || self.rotation != Quat::IDENTITY
    }
}
