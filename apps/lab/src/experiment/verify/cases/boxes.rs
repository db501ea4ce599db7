//! Touching boxes that are rotated together in a closed room, and surfaces in cells. Each is tested near the listener
//! and far away.

use super::super::Case;
use super::build::{block, lattice, room, scene};
use echomarch::scene::shape::{Cuboid, Sphere};
use echomarch::scene::{Listener, Node, Surface};
use glam::{EulerRot, Quat, Vec3};

pub fn cases() -> Vec<Case> {
    let cube = || block(2.0, 2.0, 2.0);
    let slab = || block(2.0, 1.0, 2.0);
    let ball = || Node::Sphere(Sphere { radius: 0.3 });
    let size = Vec3::splat(0.5);
    let two = vec![cube(), slab().at(1.5 * Vec3::Y)];
    let three = vec![slab().at(-Vec3::Y), slab(), slab().at(Vec3::Y)];
    let corner = vec![cube(), cube().at(2.0 * Vec3::X), slab().at(1.5 * Vec3::Y)];
    vec![
        touching("boxes-two", two.clone(), 0.0),
        touching("boxes-two-far", two, 1000.0),
        touching("boxes-three", three.clone(), 0.0),
        touching("boxes-three-far", three, 1000.0),
        touching("boxes-corner", corner, 0.0),
        touching("boxes-bricks", bricks(), 0.0),
        touching("boxes-bricks-far", bricks(), 1000.0),
        cells("cells-balls", ball(), 0.0),
        cells("cells-balls-far", ball(), 1000.0),
        cells("cells-boxes", Node::Cuboid(Cuboid { size }), 0.0),
    ]
}

/// Enough boxes to be put into cells.
fn bricks() -> Vec<Surface> {
    let size = Vec3::new(1.0, 0.5, 0.75);
    let place = |i: i32| Vec3::new((i % 4 - 2) as f32, (i / 4 % 4 - 2) as f32, (i / 16) as f32);
    let brick = |i| block(size.x, size.y, size.z).at(size * place(i));
    (0..32).map(brick).collect()
}

/// A case of boxes that share faces, rotated as a whole.
fn touching(name: &str, blocks: Vec<Surface>, away: f32) -> Case {
    let turn = Quat::from_euler(EulerRot::XYZEx, 0.62, -1.13, 0.37);
    let turned = blocks.into_iter().map(|block| {
        let position = turn * block.position;
        block.at(position).turned(turn)
    });
    in_a_room(
        name,
        "faces of several boxes are in one plane, within rounding errors",
        turned.collect(),
        away,
    )
}

/// A case of forty copies of one shape on a spiral. The copies do not touch.
fn cells(name: &str, shape: Node, away: f32) -> Case {
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    let surface = |i: usize| {
        let (sin, cos) = (GOLDEN_ANGLE * i as f32).sin_cos();
        let place = Vec3::new(4.0 * cos, 0.2 * i as f32 - 4.0, 4.0 * sin);
        Surface::new(shape.clone()).at(place)
    };
    in_a_room(
        name,
        "lists of surfaces in cells replace the list of all surfaces",
        (0..40).map(surface).collect(),
        away,
    )
}

fn in_a_room(name: &str, hard: &'static str, surfaces: Vec<Surface>, away: f32) -> Case {
    let walls = room(22.0 + 2.0 * away, 12.0, 18.0);
    let listener = Listener::at(Vec3::new(7.0 + away, -1.0, 5.0), 1.7);
    let surfaces = std::iter::once(walls).chain(surfaces).collect();
    Case::spread(
        name,
        hard,
        "no wave is lost, and none passes through a surface",
        scene(name, surfaces, Vec3::new(-8.0, 1.0, -6.0), listener),
        lattice(4096),
        3,
    )
}
