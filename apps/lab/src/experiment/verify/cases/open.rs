//! Open scenes, which waves can leave.

use super::super::Case;
use super::build::{builtin, lattice, scene};
use echomarch::scene::shape::{Plane, Sphere};
use echomarch::scene::{Listener, Node, Surface};
use glam::Vec3;

pub fn cases() -> Vec<Case> {
    vec![field(), pillars(), horizon()]
}

fn field() -> Case {
    Case::spread(
        "open-field",
        "nothing above the ground: half of the waves never hit anything",
        "dead, and stays dead",
        builtin("open-field"),
        lattice(1024),
        8,
    )
}

fn pillars() -> Case {
    Case::spread(
        "open-pillars",
        "pillars, a rotated wall and a ball under the open sky",
        "dead after a few reflections, or heard",
        builtin("open-pillars"),
        lattice(2048),
        8,
    )
}

/// Waves along the ground and straight up. The world's origin is inside the listener's sphere, because the thesis'
/// algorithm moves dead waves to the origin.
fn horizon() -> Case {
    let ground = Surface::new(Node::Plane(Plane)).at(Vec3::Y * -3.0);
    let ball = Surface::new(Node::Sphere(Sphere { radius: 1.0 })).at(Vec3::new(6.0, -2.0, 0.0));
    let listener = Listener::at(Vec3::ZERO, 1.0);
    let directions = vec![
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::new(1.0, 1e-6, 0.0).normalize(),
        Vec3::new(0.0, 1e-6, 1.0).normalize(),
        Vec3::new(0.0, 1.0, 1e-20).normalize(),
    ];
    let source = Vec3::new(3.0, 0.0, 5.0);
    Case::spread(
        "horizon",
        "waves along the ground and straight up; the world's origin in the listener's sphere",
        "dead, and stays dead",
        scene("meadow", vec![ground, ball], source, listener),
        directions,
        4,
    )
}
