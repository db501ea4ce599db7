//! Intersections of lines and shapes, compared with points worked out by hand.

use super::*;
use crate::scene::shape::Plane;
use glam::{Quat, Vec3};

const ERROR_BOUND: f64 = 1e-12;

fn intersect(shape: Node, origin: DVec3, towards: DVec3) -> Option<(f64, DVec3, DVec3)> {
    let placed = Placed::new(&Surface::new(shape));
    let direction = towards.normalize();
    let intersection = placed.intersect(origin, direction, None, ERROR_BOUND, f64::INFINITY)?;
    let (point, normal) = placed.project(origin, direction, intersection);
    Some((intersection.t, point, normal))
}

/// Protects each shape's nearest hit, compared with points worked out by hand.
#[test]
fn lines_intersect_shapes_where_they_should() {
    let size = Vec3::new(2.0, 4.0, 6.0);
    let cases = [
        (
            Node::Plane(Plane),
            DVec3::Y * 2.0,
            DVec3::NEG_Y,
            2.0,
            DVec3::Y,
        ),
        (
            Node::Cuboid(Cuboid { size }),
            DVec3::X * 5.0,
            DVec3::NEG_X,
            4.0,
            DVec3::X,
        ),
        (
            Node::Room(Room { size }),
            DVec3::Z,
            DVec3::Z,
            2.0,
            DVec3::NEG_Z,
        ),
        (
            Node::Sphere(Sphere { radius: 2.0 }),
            DVec3::X * -5.0,
            DVec3::X,
            3.0,
            DVec3::NEG_X,
        ),
        (
            Node::Cylinder(Cylinder { radius: 0.5 }),
            DVec3::new(0.0, 9.0, 2.0),
            DVec3::NEG_Z,
            1.5,
            DVec3::Z,
        ),
    ];
    for (shape, origin, towards, t, normal) in cases {
        let met = intersect(shape.clone(), origin, towards);
        assert_eq!(met, Some((t, origin + towards * t, normal)), "{shape:?}");
    }
}

/// Protects against hits behind the start and beside the shape.
#[test]
fn lines_pass_shapes_that_are_behind_or_beside() {
    let shapes = [
        Node::Plane(Plane),
        Node::Cuboid(Cuboid {
            size: Vec3::splat(2.0),
        }),
        Node::Sphere(Sphere { radius: 1.0 }),
        Node::Cylinder(Cylinder { radius: 1.0 }),
    ];
    let origin = DVec3::new(3.0, 3.0, 3.0);
    for shape in shapes {
        assert_eq!(
            intersect(shape.clone(), origin, origin),
            None,
            "{shape:?} behind"
        );
        let beside = DVec3::new(-1.0, 0.0, 1.0);
        assert_eq!(
            intersect(shape.clone(), origin, beside),
            None,
            "{shape:?} beside"
        );
    }
    let along_the_axis = intersect(
        Node::Cylinder(Cylinder { radius: 1.0 }),
        origin,
        DVec3::NEG_Y,
    );
    assert_eq!(along_the_axis, None);
}

/// Protects waves that are slightly within a solid by rounding: they are mirrored on their way in
/// and not stopped on their way out.
#[test]
fn a_start_just_inside_a_box_counts_as_its_surface() {
    let size = Vec3::splat(2.0);
    let origin = DVec3::new(1.0 - 1e-15, 0.2, 0.0);
    let inwards = intersect(
        Node::Cuboid(Cuboid { size }),
        origin,
        DVec3::new(-1.0, 0.5, 0.0),
    );
    assert_eq!(
        inwards.map(|(t, _, normal)| (t, normal)),
        Some((0.0, DVec3::X))
    );
    let outwards = intersect(
        Node::Cuboid(Cuboid { size }),
        origin,
        DVec3::new(1.0, 0.5, 0.0),
    );
    assert_eq!(outwards, None);
}

/// Protects rotations whose `f32` quaternion is not exactly of length 1.
#[test]
fn a_turned_shape_keeps_its_size() {
    let turn = Quat::from_xyzw(0.1, 0.2, 0.3, 0.9273618) * 1.00005;
    let room = Node::Room(Room {
        size: Vec3::splat(2.0),
    });
    let placed = Placed::new(&Surface::new(room).turned(turn));
    let (to_world, _) = placed.turn.expect("turned");
    let intersection = placed.intersect(
        DVec3::ZERO,
        to_world.x_axis,
        None,
        ERROR_BOUND,
        f64::INFINITY,
    );
    assert!((intersection.expect("met").t - 1.0).abs() < 1e-15);
}
