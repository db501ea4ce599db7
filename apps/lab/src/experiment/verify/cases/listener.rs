//! Listeners that overlap walls or are hidden behind walls.

use super::super::Case;
use super::build::{block, hall, lattice, room, scene};
use echomarch::scene::Listener;
use glam::Vec3;

pub fn cases() -> Vec<Case> {
    vec![in_wall(), behind_a_screen(), in_corridor()]
}

fn in_wall() -> Case {
    let listener = Listener::at(Vec3::new(14.5, 0.0, 4.0), 2.0);
    let source = Vec3::new(-8.0, 1.0, 2.0);
    Case::spread(
        "listener-in-wall",
        "the listener's sphere extends through a wall",
        "heard by the part of the sphere inside the room",
        scene("hall", vec![hall()], source, listener),
        lattice(4096),
        6,
    )
}

/// A free-standing wall very close to the listener's sphere.
fn behind_a_screen() -> Case {
    let listener = Listener::at(Vec3::new(6.0, 0.0, 2.0), 1.0);
    let screen = block(0.02, 8.0, 8.0).at(Vec3::new(4.95, 0.0, 2.0));
    let source = Vec3::new(-8.0, 1.0, 2.0);
    Case::spread(
        "listener-behind-screen",
        "a screen of 2 cm is 4 cm in front of the listener's sphere",
        "heard only over the walls",
        scene("screen", vec![hall(), screen], source, listener),
        lattice(4096),
        6,
    )
}

fn in_corridor() -> Case {
    let listener = Listener::at(Vec3::new(15.0, 0.0, 0.0), 1.5);
    let source = Vec3::new(-18.0, 0.2, 0.1);
    Case::spread(
        "listener-fills-corridor",
        "the listener's sphere is wider than its corridor",
        "every wave that travels along the corridor is heard",
        scene("corridor", vec![room(40.0, 2.0, 2.0)], source, listener),
        lattice(1024),
        64,
    )
}
