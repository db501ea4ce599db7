//! The signed distance of a scene on the CPU.
//!
//! Computed in `f64` and written independently of the shaders, so that the two can disagree; a test
//! compares both at the same points. It is negative in the solid.

use super::{Listener, Scene, Shape, Surface};
use glam::Vec3;

/// Result of a distance function at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearest {
    /// Signed distance in metres, negative in a solid.
    pub distance: f32,
    /// The nearest object: 0 is the listener, n the n-th surface from 1.
    pub object: u32,
}

impl Scene {
    /// Signed distance to the nearest surface, ignoring the listener.
    pub fn surface_distance(&self, point: Vec3) -> Nearest {
        let nothing = Nearest {
            distance: f32::INFINITY,
            object: 0,
        };
        self.nearest_surface(point, nothing)
    }

    /// Signed distance to the nearest surface or to the listener's sphere: the function that the
    /// march in the thesis evaluates (figure 9).
    pub fn distance(&self, point: Vec3) -> Nearest {
        let listener = Nearest {
            distance: self.listener.distance(point),
            object: 0,
        };
        self.nearest_surface(point, listener)
    }

    fn nearest_surface(&self, point: Vec3, mut nearest: Nearest) -> Nearest {
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
    /// Signed distance from a world point in metres.
    pub fn distance(&self, point: Vec3) -> f32 {
        let offset = point - self.position;
        if !self.has_rotation() {
            return self.shape.distance(offset);
        }
        self.shape.distance(self.rotation.conjugate() * offset)
    }
}

impl Listener {
    /// Signed distance to the listener's sphere in metres.
    pub fn distance(&self, point: Vec3) -> f32 {
        (point - self.position).length() - self.radius
    }
}

impl Shape {
    /// Lower bound of the signed distance in metres at a point in the tree's own axes (metres): the
    /// value, divided by its Lipschitz constant.
    pub fn distance(&self, p: Vec3) -> f32 {
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

    /// Protects sign and size of each shape's distance at hand-computed points.
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

    /// Protects the direction of a rotation: it turns the shape, not the point.
    #[test]
    fn a_turned_plane_faces_where_its_normal_was_turned() {
        // A quarter turn about z takes the plane's normal from +y to −x.
        let wall = Surface::new(Node::Plane(Plane))
            .at(Vec3::new(3.0, 0.0, 0.0))
            .turned(Quat::from_rotation_z(FRAC_PI_2));
        assert_close(wall.distance(Vec3::ZERO), 3.0);
        assert_close(wall.distance(Vec3::new(5.0, 7.0, 9.0)), -2.0);
    }

    /// Protects the numbering: 0 is the listener, surfaces count from 1.
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
        assert_eq!(scene.distance(Vec3::X * 3.5).object, 1);
        assert_eq!(scene.distance(Vec3::X * -3.5).object, 2);
        assert_eq!(scene.distance(Vec3::X * 1.5).object, 0);
        assert_eq!(scene.surface_distance(Vec3::X * 1.5).object, 1);
    }
}
