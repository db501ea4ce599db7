//! Infinite repetitions of a shape.

use super::super::Case;
use super::build::{lattice, room, scene};
use echomarch::scene::shape::{Cuboid, Sphere};
use echomarch::scene::{Listener, Shape, Surface};
use glam::Vec3;

/// Number of flights of each wave. The number is small, because reflections at balls multiply errors.
const ITERATIONS: u32 = 2;

/// Number of waves in a case. The number is small, because the exact march past copies takes long.
const WAVES: u32 = 128;

pub fn cases() -> Vec<Case> {
    let turned = Shape::from(Cuboid {
        size: Vec3::new(0.9, 0.5, 0.7),
    })
    .rotate(Vec3::new(0.4, 0.6, 0.8));
    let ball = Shape::from(Sphere { radius: 0.5 });
    vec![
        in_a_room(
            "endless-boxes",
            "an infinite grid of rotated boxes, which a wave passes up to a wall",
            turned.repeat(Vec3::new(2.0, 2.25, 2.5), [0; 3]),
            Vec3::ZERO,
        ),
        in_a_room(
            "endless-balls-far",
            "an infinite grid of balls whose origin is 300 km from the listener",
            ball.repeat(Vec3::new(2.0, 0.0, 2.0), [0; 3]),
            Vec3::new(3e5, 0.0, -2e5),
        ),
    ]
}

/// A repetition about the origin, with a room, a source and a listener around the position `place`.
fn in_a_room(name: &str, hard: &'static str, field: Shape, place: Vec3) -> Case {
    let surfaces = vec![Surface::new(field), room(30.0, 16.0, 30.0).at(place)];
    let listener = Listener::at(place + Vec3::new(-5.0, 1.0, 5.0), 0.5);
    let source = place + Vec3::new(1.0, 1.0, 1.25);
    Case::spread(
        name,
        hard,
        "the nearest copy, or the wall",
        scene(name, surfaces, source, listener),
        lattice(WAVES),
        ITERATIONS,
    )
}
