//! Lines that just touch or just miss round shapes.

use super::super::Case;
use super::build::{hall, listener_outside, scene};
use echomarch::scene::shape::{Cylinder, Sphere};
use echomarch::scene::{Node, Surface};
use glam::{DVec3, Vec3};

pub fn cases() -> Vec<Case> {
    let ball = Node::Sphere(Sphere { radius: 2.0 });
    let pillar = Node::Cylinder(Cylinder { radius: 2.0 });
    vec![
        tangents("tangent-sphere", ball),
        tangents("tangent-cylinder", pillar),
    ]
}

/// Lines at a distance equal to the shape's radius, and at slightly smaller and larger distances.
fn tangents(name: &str, shape: Node) -> Case {
    let source = Vec3::new(-12.0, 0.0, 0.0);
    let aside = |share: f64| {
        let distance: f64 = 12.0;
        let sin = 2.0 * (1.0 + share) / distance;
        let cos = (1.0 - sin * sin).sqrt();
        [
            DVec3::new(cos, 0.0, sin),
            DVec3::new(cos, 0.0, -sin),
            DVec3::new(cos, 0.05, sin).normalize(),
            DVec3::new(cos, sin, 0.0),
        ]
    };
    let shares = [
        0.0, 1e-7, -1e-7, 1e-6, -1e-6, 1e-5, -1e-5, 1e-4, -1e-4, 1e-2, -1e-2,
    ];
    let directions = shares
        .into_iter()
        .flat_map(aside)
        .map(|d| d.as_vec3())
        .collect();
    Case::spread(
        name,
        "a tangent line: the square root in the solution is 0",
        "passes, or is reflected at a tiny angle",
        scene(
            "hall",
            vec![hall(), Surface::new(shape)],
            source,
            listener_outside(),
        ),
        directions,
        2,
    )
}
