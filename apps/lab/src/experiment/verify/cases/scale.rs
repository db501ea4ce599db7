//! The thesis' scenes, scaled down, scaled up, or moved away from the origin.

use super::super::Case;
use super::build::{builtin, lattice};
use echomarch::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use echomarch::scene::{Node, Scene};
use glam::Vec3;

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for name in ["corner", "obstacles"] {
        for exponent in -3..=4 {
            cases.push(scaled(name, exponent));
        }
    }
    for name in ["corner", "obstacles"] {
        for exponent in 3..=5 {
            cases.push(moved(name, exponent));
        }
    }
    cases
}

fn scaled(name: &str, exponent: i32) -> Case {
    let factor = 10_f32.powi(exponent);
    let mut scene = builtin(name);
    scene.sources[0].position *= factor;
    scene.listeners[0].position *= factor;
    scene.listeners[0].radius *= factor;
    for surface in &mut scene.surfaces {
        surface.position *= factor;
        match &mut surface.shape.node {
            Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => *size *= factor,
            Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => {
                *radius *= factor
            }
            _ => {}
        }
    }
    let hard = "every length is scaled: no constant in metres fits all scenes";
    let exact = "the answer of the original scene, scaled";
    swarm(format!("{name}-times-1e{exponent}"), hard, exact, scene)
}

fn moved(name: &str, exponent: i32) -> Case {
    // The offsets are whole multiples of the largest unit in the last place, so that the scene stays exact.
    let by = Vec3::new(1.0, -1.0, 1.0) * 10_f32.powi(exponent);
    let mut scene = builtin(name);
    scene.sources[0].position += by;
    scene.listeners[0].position += by;
    for surface in &mut scene.surfaces {
        surface.position += by;
    }
    let hard = "far from the world's origin positions are coarse: 8 mm at 1e5 m";
    let exact = "the answer of the original scene, moved";
    swarm(format!("{name}-moved-1e{exponent}"), hard, exact, scene)
}

fn swarm(name: String, hard: &'static str, exact: &str, scene: Scene) -> Case {
    Case::spread(name, hard, exact, scene, lattice(2048), 8)
}
