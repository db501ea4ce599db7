//! Sources at invalid or critical positions.

use super::super::{Case, Planted};
use super::build::{block, hall, lattice, scene};
use echomarch::scene::shape::Sphere;
use echomarch::scene::{Listener, Node, Scene, Surface};
use glam::Vec3;

/// Number of waves of each case.
const WAVES: u32 = 256;

pub fn cases() -> Vec<Case> {
    vec![
        case(
            "source-on-wall",
            "the source is exactly on a wall of the room",
            "waves into the wall are reflected after 0 m, all others leave",
            in_hall(Vec3::new(-15.0, 0.0, 3.0)),
        ),
        case(
            "source-on-block",
            "the source is exactly on the face of a block",
            "waves into the block are reflected after 0 m, all others leave",
            in_hall(Vec3::new(1.0, 0.5, 0.5)),
        ),
        case(
            "source-on-ball",
            "the source is on a ball, as exactly as f32 allows",
            "waves into the ball are reflected after 0 m, all others leave",
            in_hall(Vec3::new(-6.0, 0.0, -4.0)),
        ),
        case(
            "source-in-wall",
            "the source is 0.5 m inside a solid block",
            "no sound leaves a solid: all waves are dead",
            in_hall(Vec3::new(0.5, 0.0, 0.0)),
        )
        .planted(1e-6, at_source(&[], Vec3::new(0.5, 0.0, 0.0))),
        case(
            "source-outside",
            "the source is outside the room",
            "no sound leaves a solid: all waves are dead",
            in_hall(Vec3::new(-15.5, 0.0, 0.0)),
        )
        .planted(1e-6, at_source(&[], Vec3::new(-15.5, 0.0, 0.0))),
        case(
            "source-near-wall",
            "the source is within the minimum distance of a wall (0.05 of 0.1 m)",
            "waves leave from the source's position",
            in_hall(Vec3::new(-14.95, 0.0, 3.0)),
        ),
        case(
            "source-in-listener",
            "the source is inside the listener's sphere",
            "every wave arrives after 0 m, at the source",
            in_hall(Vec3::new(10.0, 0.5, 8.5)),
        )
        .planted(1e-6, at_source(&[0], Vec3::new(10.0, 0.5, 8.5))),
    ]
}

/// The answers for waves that hit these objects at the source itself.
fn at_source(objects: &[u32], source: Vec3) -> Vec<Planted> {
    let answer = Planted {
        objects: objects.into(),
        end: source.as_dvec3(),
    };
    vec![answer; WAVES as usize]
}

fn case(name: &str, hard: &'static str, exact: &str, scene: Scene) -> Case {
    Case::spread(name, hard, exact, scene, lattice(WAVES), 4)
}

/// A hall with a block around the origin, a ball and a listener.
fn in_hall(source: Vec3) -> Scene {
    let ball = Surface::new(Node::Sphere(Sphere { radius: 2.0 })).at(Vec3::new(-6.0, 0.0, -6.0));
    let surfaces = vec![hall(), block(2.0, 4.0, 6.0), ball];
    let listener = Listener::at(Vec3::new(10.0, 0.0, 8.0), 2.0);
    scene("furnished hall", surfaces, source, listener)
}
