//! Walls and gaps thinner than the thesis' constants.

use super::super::Case;
use super::build::{aims, block, hall, lattice, scene};
use echomarch::scene::{Listener, Surface};
use glam::Vec3;

pub fn cases() -> Vec<Case> {
    vec![
        thin_wall(0.05, "a wall thinner than the minimum distance (0.1 m)"),
        thin_wall(0.005, "a wall thinner than the normals' step (0.01 m)"),
        thin_wall(0.0001, "a wall of a tenth of a millimetre"),
        gap(
            0.05,
            "two walls closer than the minimum distance, with the source in the gap",
        ),
        gap(
            0.001,
            "two walls a millimetre apart, with the source in the gap",
        ),
        mouth(0.05),
    ]
}

/// A wall through the whole hall, from floor to ceiling, which no wave can pass.
fn thin_wall(thickness: f32, hard: &'static str) -> Case {
    let wall = block(thickness, 20.0, 30.0);
    let listener = Listener::at(Vec3::new(8.0, 0.0, 0.0), 2.0);
    let source = Vec3::new(-8.0, 1.0, 2.0);
    Case::spread(
        format!("thin-wall-{thickness}"),
        hard,
        "no wave is heard behind it",
        scene("divided hall", vec![hall(), wall], source, listener),
        lattice(1024),
        8,
    )
}

/// Two blocks with a slot between them.
fn blocks(width: f32) -> Vec<Surface> {
    let x = 1.0 + 0.5 * width;
    vec![
        hall(),
        block(2.0, 20.0, 10.0).at(Vec3::new(-x, 0.0, 0.0)),
        block(2.0, 20.0, 10.0).at(Vec3::new(x, 0.0, 0.0)),
    ]
}

fn gap(width: f32, hard: &'static str) -> Case {
    let directions = [0.1, 0.5, 1.0, 2.0, 5.0, 20.0]
        .into_iter()
        .flat_map(|z| [Vec3::new(1.0, 0.1, z), Vec3::new(-1.0, 0.2, -z)])
        .map(Vec3::normalize)
        .collect();
    let listener = Listener::at(Vec3::new(0.0, 0.0, 12.0), 1.0);
    Case::spread(
        format!("gap-{width}"),
        hard,
        "32 flights from wall to wall",
        scene("slot", blocks(width), Vec3::ZERO, listener),
        directions,
        32,
    )
}

fn mouth(width: f32) -> Case {
    let source = Vec3::new(0.3, 0.0, -12.0);
    let points: Vec<Vec3> = (0..64_u8)
        .map(|n| Vec3::new((f32::from(n) / 63.0 - 0.5) * width * 1.2, 0.0, -5.0))
        .collect();
    let listener = Listener::at(Vec3::new(0.0, 0.0, 12.0), 1.0);
    Case::spread(
        "mouth-of-a-gap",
        "rays into a gap narrower than the minimum distance",
        "most enter and are reflected back and forth",
        scene("slot", blocks(width), source, listener),
        aims(source, &points),
        32,
    )
}
