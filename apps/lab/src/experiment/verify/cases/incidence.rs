//! Walls that waves hit at normal and at grazing incidence.

use super::super::{Case, Planted};
use super::build::{hall, listener_outside, scene};
use echomarch::scene::shape::Plane;
use echomarch::scene::{Listener, Node, Surface};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

pub fn cases() -> Vec<Case> {
    let mut cases = vec![normal()];
    cases.extend([89.9, 89.99, 89.999].map(grazing));
    cases.push(grazing_in_a_room());
    cases
}

/// Waves that travel back and forth between two parallel walls.
fn normal() -> Case {
    let source = Vec3::new(-8.0, 1.0, -8.0);
    let directions = [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ];
    let half = DVec3::new(15.0, 10.0, 15.0);
    let start = source.as_dvec3();
    let answer = |direction: &Vec3| {
        let axis = direction.as_dvec3();
        // After an even number of flights, the wave is at the wall behind its start.
        let end = start * (DVec3::ONE - axis.abs()) - half * axis;
        Planted {
            objects: vec![1; 8],
            end,
        }
    };
    let answers = directions.iter().map(answer).collect();
    Case::spread(
        "normal-incidence",
        "the wave returns along its path: an offset along the path leads into the wall",
        "8 flights back and forth, at the wall behind the start",
        scene("hall", vec![hall()], source, listener_outside()),
        directions.into(),
        8,
    )
    .planted(1e-6, answers)
}

fn grazing(degrees: f64) -> Case {
    let source = Vec3::Y;
    let angle = degrees.to_radians();
    let direction = |n: u32| {
        let (sin, cos) = (f64::from(n) / 16.0 * TAU).sin_cos();
        let d = DVec3::new(cos * angle.sin(), -angle.cos(), sin * angle.sin());
        d.as_vec3()
    };
    let directions: Vec<Vec3> = (0..16).map(direction).collect();
    let answer = |direction: &Vec3| {
        let d = direction.as_dvec3().normalize();
        let end = DVec3::new(d.x / -d.y, 0.0, d.z / -d.y);
        Planted {
            objects: vec![1],
            end,
        }
    };
    let answers = directions.iter().map(answer).collect();
    let ground = Surface::new(Node::Plane(Plane));
    let listener = Listener::at(Vec3::Y * 3.0, 0.5);
    Case::spread(
        format!("grazing-{degrees}"),
        "the distance shrinks far more slowly than the wave advances: thousands of steps, or an early hit",
        format!("1 m of height is gone after {:.0} m", angle.tan()),
        scene("ground", vec![ground], source, listener),
        directions,
        1,
    )
    .planted(1e-6, answers)
}

/// Grazing incidence between walls that reflect the wave back.
fn grazing_in_a_room() -> Case {
    let source = Vec3::new(-14.0, -9.9, 1.0);
    let directions = [89.9, 89.99, 89.999]
        .into_iter()
        .flat_map(|degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [DVec3::new(sin, -cos, 0.0), DVec3::new(-cos, -sin, 0.0)]
        })
        .map(|d| d.as_vec3())
        .collect();
    Case::spread(
        "grazing-in-a-room",
        "the wave travels close along a wall and is reflected by the walls ahead",
        "16 flights between walls",
        scene("hall", vec![hall()], source, listener_outside()),
        directions,
        16,
    )
}
