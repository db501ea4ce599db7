//! Marched fields: solids behind surfaces that waves graze, steep ground, distant listeners.

use super::super::Case;
use super::build::{lattice, scene};
use echomarch::scene::shape::{Capsule, HeightField, RoundedBox, Torus};
use echomarch::scene::{HeightImage, Listener, Node, Scene, Shape, Surface};
use glam::{UVec2, Vec3};
use std::sync::Arc;

/// Number of flights. Only one end is compared, because the direction of reflection at a crease depends on rounding.
const ITERATIONS: u32 = 1;

pub fn cases() -> Vec<Case> {
    let torus = || {
        Shape::from(Node::Torus(Torus {
            ring: 2.0,
            tube: 0.8,
        }))
    };
    let capsule = || {
        Shape::from(Node::Capsule(Capsule {
            radius: 0.6,
            height: 2.5,
        }))
    };
    let near = Vec3::new(0.0, 0.0, 30.0);
    let far = Vec3::new(900.0, 0.0, 400.0);
    let blend = || {
        Shape::smooth_union(
            0.3,
            [torus(), capsule().translate(Vec3::new(0.7, 0.2, -0.4))],
        )
    };
    vec![
        before_a_slab("torus-slab", torus(), near),
        before_a_slab("torus-slab-far", torus(), far),
        before_a_slab("shell-slab", torus().shell(0.02), near),
        before_a_slab("blend-slab", blend(), near),
        before_a_slab("blend-slab-far", blend(), far),
        over_ground("ground", Vec3::new(200.0, 24.0, 200.0), 0.0),
        over_ground("ground-steep", Vec3::new(6.0, 12.0, 5.0), 0.0),
        over_ground("ground-far", Vec3::new(6.0, 5.0, 5.0), 300.0),
    ]
}

fn before_a_slab(name: &str, field: Shape, listener: Vec3) -> Case {
    spread(
        name,
        "a march step at a grazed surface may exceed the distance to the slab behind it",
        "no wave passes through the slab",
        slab_behind(name, field, listener),
    )
}

/// A field that rays from the source graze, 14 m in front of a wide slab.
pub(super) fn slab_behind(name: &str, field: Shape, listener: Vec3) -> Scene {
    let slab = Shape::from(Node::RoundedBox(RoundedBox {
        size: Vec3::new(200.0, 200.0, 0.5),
        rounding: 0.1,
    }));
    let surfaces = vec![
        Surface::new(field.rotate(Vec3::X * std::f32::consts::FRAC_PI_2))
            .at(Vec3::new(0.0, 0.0, -6.0)),
        Surface::new(slab).at(Vec3::new(0.0, 0.0, -20.0)),
    ];
    scene(name, surfaces, Vec3::ZERO, Listener::at(listener, 1.0))
}

/// A case of ground from a height image, with the listener beside the ground.
fn over_ground(name: &str, size: Vec3, far: f32) -> Case {
    const SIDE: u32 = 24;
    let height = |index: u32| {
        let (x, z) = (index % SIDE, index / SIDE);
        ((x * 7 + z * 13 + x * z * 3) % 17) as f32 / 16.0
    };
    let heights = (0..SIDE * SIDE).map(height).collect();
    let image = match HeightImage::new("steps", UVec2::splat(SIDE), heights) {
        Ok(image) => Arc::new(image),
        // A test builds every case, so this call cannot fail.
        Err(error) => unreachable!("{error}"),
    };
    let ground = Surface::new(Shape::from(Node::HeightField(HeightField { image, size })));
    let source = size * Vec3::new(-0.2, 0.62, -0.15);
    let listener = Listener::at(Vec3::new(far, 0.9 * size.y + 0.1 * far, 0.0), 0.02 * size.x);
    spread(
        name,
        "over steep ground the field's value is a poor estimate of the distance",
        "no wave passes through the ground",
        scene(name, vec![ground], source, listener),
    )
}

fn spread(name: &str, hard: &'static str, exact: &str, scene: Scene) -> Case {
    Case::spread(name, hard, exact, scene, lattice(4096), ITERATIONS)
}
