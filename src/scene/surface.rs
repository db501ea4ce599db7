//! Surfaces, which are shapes placed in the world, and the signed distance of a scene on the CPU.
//!
//! Distances are computed in `f64`, with code that is independent of the shaders. A test compares both at the same
//! points, so that each reveals errors of the other. Distances are negative inside a solid.

use super::shape::{Room, Rooms};
use super::{Bounds3, Driver, Listener, Node, Scene, SceneError, Shape};
use glam::{DMat3, Quat, Vec3};
use std::collections::BTreeMap;

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
    /// Name in reports. Without a name, reports use the surface's number.
    pub name: Option<String>,
    /// Form and size of the surface.
    pub shape: Shape,
    /// World position of the origin of the shape's axes, in metres.
    pub position: Vec3,
    /// Rotation from the shape's axes to the world axes.
    pub rotation: Quat,
    /// Declares that the rotation will change, even if it is currently the identity.
    ///
    /// The shader text of a surface without a rotation contains no rotation. A surface that is rotated, or declared
    /// here as rotating, reads its rotation from a uniform, so that a change of the rotation compiles no shader.
    pub dynamic_rotation: bool,
    /// Angles of a driven rotation in radians, about x, then y, then z.
    pub angles: Vec3,
    /// The drivers of the surface's numbers; empty if nothing moves.
    #[doc(hidden)]
    pub drivers: Vec<Driver>,
    /// Name of the material, either one of the scene's own or a built-in material. A surface without a material
    /// reflects all sound.
    pub material: Option<String>,
    /// For a [`Room`](super::shape::Room), and for all boxes of [`Rooms`](super::shape::Rooms): the materials of the walls that differ from the surface's material, in the
    /// order of [`Room::WALL_NAMES`](super::shape::Room::WALL_NAMES). The walls rotate with the room.
    pub walls: [Option<String>; Room::WALL_COUNT],
    /// For a [`Mesh`](super::shape::Mesh): the materials of faces by the names of their groups. A group without an entry
    /// has the scene's material of the same name, otherwise the material of the surface. For
    /// [`Rooms`](super::shape::Rooms): the materials of a box (`hall`) or of one of its walls (`hall/floor`).
    pub faces: BTreeMap<String, String>,
}

impl Surface {
    /// Creates a surface with its shape at the world's origin, without a rotation.
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
            faces: BTreeMap::new(),
        }
    }

    /// Returns the surface with the origin of its axes at `position` (metres).
    #[must_use]
    pub fn at(mut self, position: impl Into<[f32; 3]>) -> Surface {
        self.position = position.into().into();
        self
    }

    /// Returns the surface rotated by `rotation`, a unit quaternion (x, y, z, w).
    #[must_use]
    pub fn turned(mut self, rotation: impl Into<[f32; 4]>) -> Surface {
        self.rotation = Quat::from_array(rotation.into());
        self
    }

    /// Returns the surface with a name for reports.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Surface {
        self.name = Some(name.into());
        self
    }

    /// Returns the surface with the material of this name.
    #[must_use]
    pub fn with_material(mut self, name: impl Into<String>) -> Surface {
        self.material = Some(name.into());
        self
    }

    /// Returns the room with the material of this name on one wall (0 to 5, see
    /// [`Room::WALL_NAMES`](super::shape::Room::WALL_NAMES)).
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

    /// Returns the mesh with the material of this name on the faces of a group.
    #[must_use]
    pub fn with_face_material(
        mut self,
        group: impl Into<String>,
        name: impl Into<String>,
    ) -> Surface {
        self.faces.insert(group.into(), name.into());
        self
    }

    /// Whether the surface is a union of convex solids whose values are convex functions.
    pub(crate) fn is_obstacle(&self) -> bool {
        let parts = self.shape.united();
        parts.into_iter().all(Shape::has_convex_value)
    }

    /// The name of the surface with this index (from 0) in messages.
    #[doc(hidden)]
    pub fn label(&self, index: usize) -> String {
        let number = index + 1;
        match &self.name {
            Some(name) => format!("surface {number} ({name})"),
            None => format!("surface {number} ({})", self.shape.name()),
        }
    }

    /// The short name of the surface with this index (from 0), or of one of its parts: `room`, `room/floor`. A surface
    /// without a name has its number from 1: `2/floor`.
    #[doc(hidden)]
    pub fn short_label(&self, index: usize, part: Option<usize>) -> String {
        let name = self.name.clone().unwrap_or((index + 1).to_string());
        match part.and_then(|part| self.part_name(part)) {
            Some(part) => format!("{name}/{part}"),
            None => name,
        }
    }

    /// The name of a wall's material. A wall without its own material has the material of the surface.
    pub(super) fn material_name(&self, wall: Option<usize>) -> Option<&str> {
        let of_wall = wall.and_then(|wall| match (self.rooms(), self.group_name(wall)) {
            (Some(rooms), Some(group)) => self.material_of_box(rooms, wall, group),
            (None, Some(group)) => self.faces.get(group).map(String::as_str),
            (_, None) => self.walls.get(wall)?.as_deref(),
        });
        of_wall.or(self.material.as_deref())
    }

    /// The name of the material of a group of rooms: that of the wall of the box, otherwise that of the box, otherwise that
    /// of this wall of all boxes.
    fn material_of_box(&self, rooms: &Rooms, group: usize, group_name: &str) -> Option<&str> {
        let (name, wall) = rooms.wall(group)?;
        let of_box = self.faces.get(group_name).or_else(|| self.faces.get(&name));
        of_box.or(self.walls[wall].as_ref()).map(String::as_str)
    }

    /// The rooms, if the shape is a union of boxes of air.
    pub(super) fn rooms(&self) -> Option<&Rooms> {
        match &self.shape.node {
            Node::Rooms(rooms) => Some(rooms),
            _ => None,
        }
    }

    /// The name of a mesh's group of faces; `None` for another shape.
    pub(crate) fn group_name(&self, group: usize) -> Option<&str> {
        let mesh = self.shape.mesh()?;
        mesh.groups().get(group).map(String::as_str)
    }

    /// Number of parts that can have different materials: the walls of a room, or the groups of a mesh; 0 for another
    /// shape.
    pub(crate) fn part_count(&self) -> usize {
        match (self.has_walls(), self.shape.mesh()) {
            (true, _) => Room::WALL_COUNT,
            (false, Some(mesh)) => mesh.groups().len(),
            (false, None) => 0,
        }
    }

    /// The name of a wall or of a group of faces; `None` without such a part.
    #[doc(hidden)]
    pub fn part_name(&self, part: usize) -> Option<&str> {
        match self.has_walls() {
            true => Room::WALL_NAMES.get(part).copied(),
            false => self.group_name(part),
        }
    }

    /// The names of all parts that can have a material of their own: walls of a room or of all boxes of rooms, boxes of
    /// rooms and their walls, and groups of faces of a mesh. A wall of a box that other boxes cover has no faces, and is
    /// not listed.
    #[doc(hidden)]
    pub fn part_names(&self) -> Vec<String> {
        let walls = Room::WALL_NAMES.iter().map(|wall| (*wall).to_owned());
        let walls = walls.filter(|_| self.takes_walls());
        let boxes = self.rooms().into_iter().flat_map(Rooms::names);
        let groups = (0..).map_while(|group| self.group_name(group));
        let has_faces = |group: &usize| self.rooms().is_none_or(|of| of.has_faces(*group));
        let groups = (0..).zip(groups).filter(|(group, _)| has_faces(group));
        let groups = groups.map(|(_, name)| name.to_owned());
        walls.chain(boxes).chain(groups).collect()
    }

    /// Gives the [part](Self::part_names) of this name a material. Returns whether there is such a part.
    #[doc(hidden)]
    pub fn set_part_material(&mut self, part: &str, material: &str) -> bool {
        if !self.part_names().iter().any(|name| name == part) {
            return false;
        }
        let wall = Room::WALL_NAMES.iter().position(|wall| *wall == part);
        match wall.filter(|_| self.takes_walls()) {
            Some(wall) => self.walls[wall] = Some(material.to_owned()),
            None => drop(self.faces.insert(part.to_owned(), material.to_owned())),
        }
        true
    }

    /// The names of all materials of the surface: its own, then those of its walls.
    #[doc(hidden)]
    pub fn material_names(&self) -> impl Iterator<Item = &str> {
        let walls = self.walls.iter();
        self.material
            .iter()
            .chain(walls.flatten())
            .chain(self.faces.values())
            .map(String::as_str)
    }

    /// Whether the shape has walls that can have different materials.
    pub(super) fn has_walls(&self) -> bool {
        matches!(self.shape.node, Node::Room(_))
    }

    /// Whether the shape has `walls` with their own materials.
    pub(super) fn takes_walls(&self) -> bool {
        self.has_walls() || self.rooms().is_some()
    }

    /// Whether both surfaces are equal, ignoring the paths of their files.
    #[doc(hidden)]
    pub fn is_alike(&self, other: &Surface) -> bool {
        let at_one_place = Surface {
            shape: other.shape.clone(),
            ..self.clone()
        };
        at_one_place == *other && self.shape.is_alike(&other.shape)
    }

    /// Returns the surface with a rotation that may change; see [`dynamic_rotation`](Surface::dynamic_rotation).
    #[must_use]
    pub fn turning(mut self) -> Surface {
        self.dynamic_rotation = true;
        self
    }

    /// Bounding box of the solid, in world metres.
    pub fn bounds(&self) -> Bounds3 {
        let own = self.shape.properties().bounds;
        let turned = if self.has_rotation() {
            own.turned(DMat3::from_quat(self.rotation.as_dquat()))
        } else {
            own
        };
        turned.moved(self.position.as_dvec3())
    }

    /// Whether the shader text contains a rotation for this surface.
    pub fn has_rotation(&self) -> bool {
        self.dynamic_rotation || self.rotation != Quat::IDENTITY
    }
}

/// Result of a distance function at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearest {
    /// Signed distance in metres, negative in a solid.
    pub distance: f32,
    /// Number of the nearest object: 0 is the listener, n is surface n, counted from 1.
    pub object: u32,
}

impl Scene {
    /// Signed distance to the nearest surface; the listener is ignored.
    pub fn surface_distance(&self, point: impl Into<[f32; 3]>) -> Nearest {
        let nothing = Nearest {
            distance: f32::INFINITY,
            object: 0,
        };
        self.nearest_surface(point.into().into(), nothing)
    }

    pub(super) fn nearest_surface(&self, point: Vec3, mut nearest: Nearest) -> Nearest {
        for (index, surface) in self.surfaces.iter().enumerate() {
            let distance = surface.distance(point);
            if distance < nearest.distance {
                let object = index as u32 + 1;
                nearest = Nearest { distance, object };
            }
        }
        nearest
    }
}

impl Surface {
    /// Signed distance from a world point to the surface, in metres.
    pub fn distance(&self, point: impl Into<[f32; 3]>) -> f32 {
        let offset = Vec3::from(point.into()) - self.position;
        if !self.has_rotation() {
            return self.shape.distance(offset);
        }
        self.shape.distance(self.rotation.conjugate() * offset)
    }
}

impl Listener {
    /// Signed distance from a world point to the listener's sphere, in metres.
    pub fn distance(&self, point: impl Into<[f32; 3]>) -> f32 {
        (Vec3::from(point.into()) - self.position).length() - self.radius
    }
}

impl Shape {
    /// Lower bound of the signed distance in metres, at a point in the tree's own axes (metres): the value divided by
    /// its Lipschitz constant.
    pub fn distance(&self, p: impl Into<[f32; 3]>) -> f32 {
        let p = Vec3::from(p.into());
        (self.value(p.as_dvec3()) / self.properties().lipschitz) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
    use crate::scene::{Node, Source};
    use glam::Quat;
    use std::f32::consts::FRAC_PI_2;

    fn assert_close(actual: f32, expected: f32) {
        assert!((actual - expected).abs() < 1e-5, "{actual} != {expected}");
    }

    /// Protects sign and magnitude of each shape's distance, by points computed by hand.
    #[test]
    fn shapes_have_their_distance() {
        let size = Vec3::new(2.0, 4.0, 6.0);
        let corner_gap = Vec3::new(3.0, 4.0, 12.0);
        assert_close(
            Shape::from(Node::Plane(Plane)).distance(Vec3::new(5.0, -2.0, 1.0)),
            -2.0,
        );
        let solid = Shape::from(Node::Cuboid(Cuboid { size }));
        assert_close(solid.distance(Vec3::ZERO), -1.0);
        assert_close(solid.distance(size * 0.5 + corner_gap), 13.0);
        let room = Shape::from(Node::Room(Room { size }));
        assert_close(room.distance(Vec3::new(0.5, 0.0, 0.0)), 0.5);
        assert_close(room.distance(size * 0.5 + corner_gap), -12.0);
        let sphere = Shape::from(Node::Sphere(Sphere { radius: 2.0 }));
        assert_close(sphere.distance(Vec3::new(0.0, 3.0, 4.0)), 3.0);
        let cylinder = Shape::from(Node::Cylinder(Cylinder { radius: 2.0 }));
        assert_close(cylinder.distance(Vec3::new(3.0, 100.0, 4.0)), 3.0);
    }

    /// Protects the direction of a rotation: the shape is rotated, not the point.
    #[test]
    fn a_turned_plane_faces_where_its_normal_was_turned() {
        // A quarter turn about z takes the plane's normal from +y to −x.
        let wall = Surface::new(Node::Plane(Plane))
            .at(Vec3::new(3.0, 0.0, 0.0))
            .turned(Quat::from_rotation_z(FRAC_PI_2));
        assert_close(wall.distance(Vec3::ZERO), 3.0);
        assert_close(wall.distance(Vec3::new(5.0, 7.0, 9.0)), -2.0);
    }

    /// Protects the numbers of objects: 0 is the listener, and surfaces are counted from 1.
    #[test]
    fn the_nearest_object_is_named() {
        let scene = Scene::new(
            "two balls",
            vec![
                Surface::new(Node::Sphere(Sphere { radius: 1.0 })).at(Vec3::X * 5.0),
                Surface::new(Node::Sphere(Sphere { radius: 1.0 })).at(Vec3::X * -5.0),
            ],
            Source::at(Vec3::Y * 9.0),
            Listener::at(Vec3::ZERO, 1.0),
        );
        let pair = scene.only_pair().unwrap();
        assert_eq!(pair.distance(Vec3::X * 3.5).object, 1);
        assert_eq!(pair.distance(Vec3::X * -3.5).object, 2);
        assert_eq!(pair.distance(Vec3::X * 1.5).object, 0);
        assert_eq!(scene.surface_distance(Vec3::X * 1.5).object, 1);
    }
}
