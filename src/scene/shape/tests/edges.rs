//! Trees that may have hollow edges.

use crate::scene::Shape;
use crate::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
use glam::Vec3;

fn cube() -> Shape {
    Shape::from(Cuboid { size: Vec3::ONE })
}

/// Protects waves that start in an edge of a field: where sheets may meet with less than half of space in the air,
/// the shader evaluates each.
#[test]
fn edges_of_hollows_and_between_solids_that_touch_are_hollow() {
    let room = Shape::from(Room { size: Vec3::ONE });
    let turned = cube().rotate(Vec3::new(0.0, 0.785, 0.0));
    let diagonal = 2f32.sqrt();
    let hollow = [
        room,
        cube().complement(),
        cube().complement().translate(Vec3::X),
        Shape::union([cube(), cube().translate(Vec3::new(1.0, 0.5, 0.0))]),
        Shape::union([Shape::from(Plane), Shape::from(Sphere { radius: 1.0 })]),
        turned.clone().repeat(Vec3::X * diagonal, [3, 1, 1]),
        turned.translate(Vec3::X * 0.5).mirror([true, false, false]),
        cube().complement().repeat(Vec3::X * 4.0, [0, 1, 1]),
        cube().shell(0.1),
    ];
    for shape in hollow {
        assert!(shape.may_have_hollow_edges(), "{shape:?}");
    }
}

/// Protects the speed of fields whose solids stand apart: none of their edges is hollow.
#[test]
fn edges_of_convex_solids_apart_are_not_hollow() {
    let pillar = Shape::from(Cylinder { radius: 0.5 });
    let two = Shape::union([cube(), cube().translate(Vec3::X * 1.001)]);
    let none = [
        cube(),
        two.clone(),
        two.scale(2.0).rotate(Vec3::Y),
        pillar.repeat(Vec3::new(4.0, 0.0, 4.0), [100, 1, 100]),
        cube().repeat(Vec3::splat(1.001), [0; 3]),
        cube().translate(Vec3::X).mirror([true, true, false]),
        Shape::from(Sphere { radius: 1.0 }).complement(),
    ];
    for shape in none {
        assert!(!shape.may_have_hollow_edges(), "{shape:?}");
    }
}
