//! The distance of a scene as the thesis' shaders compute it: in `f32`.
//!
//! Normals computed from its differences have the same `f32` rounding as theirs. Trees have the
//! scene's own value, rounded.

use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Nearest, Node, Scene, Shape, Surface};
use glam::{Vec2, Vec3};

/// Signed distance to the nearest surface or to the listener's sphere (figure 9).
pub(super) fn distance(scene: &Scene, point: Vec3) -> Nearest {
    let mut nearest = Nearest {
        distance: scene.listener.distance(point),
        object: 0,
    };
    for (surface, object) in scene.surfaces.iter().zip(1..) {
        let distance = of_surface(surface, point);
        if distance < nearest.distance {
            nearest = Nearest { distance, object };
        }
    }
    nearest
}

/// Signed distance to one surface, in metres.
pub(super) fn of_surface(surface: &Surface, point: Vec3) -> f32 {
    let offset = point - surface.position;
    let local = match surface.has_rotation() {
        true => surface.rotation.conjugate() * offset,
        false => offset,
    };
    of_shape(&surface.shape, local)
}

fn of_shape(shape: &Shape, p: Vec3) -> f32 {
    match shape.node {
        Node::Plane(_) => p.y,
        Node::Cuboid(Cuboid { size }) => {
            let beyond = p.abs() - size * 0.5;
            beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        Node::Room(Room { size }) => (size * 0.5 - p.abs()).min_element(),
        Node::Sphere(Sphere { radius }) => p.length() - radius,
        Node::Cylinder(Cylinder { radius }) => Vec2::new(p.x, p.z).length() - radius,
        _ => shape.distance(p),
    }
}
