//! Cases with many reflections.

use super::super::Case;
use super::build::{builtin, hall, lattice, scene};
use echomarch::scene::shape::Cylinder;
use echomarch::scene::{Listener, Node, Surface};
use glam::Vec3;

pub fn cases() -> Vec<Case> {
    vec![shoebox(), sinai(), sinai_at_length(), stadium()]
}

fn shoebox() -> Case {
    let mut scene = builtin("shoebox");
    scene.listeners = vec![Listener::at(Vec3::new(5.9, 2.9, 7.9), 0.05)];
    Case::spread(
        "shoebox-200",
        "200 reflections: direction lengths and end points may drift",
        "at a wall after about 1500 m, direction of length 1",
        scene,
        lattice(1024),
        200,
    )
}

/// A pillar in a hall. Every reflection at the pillar multiplies errors by about 10.
fn pillar() -> echomarch::Scene {
    let pillar = Surface::new(Node::Cylinder(Cylinder { radius: 3.0 }));
    let surfaces = vec![hall(), pillar];
    let listener = Listener::at(Vec3::new(14.0, 9.0, 14.0), 0.5);
    scene(
        "Sinai billiard",
        surfaces,
        Vec3::new(-8.0, 1.0, 2.0),
        listener,
    )
}

fn sinai() -> Case {
    Case::spread(
        "sinai-billiard",
        "reflections at a pillar multiply errors: by thousands after a few",
        "8 flights, within the spread",
        pillar(),
        lattice(2048),
        8,
    )
}

/// 200 flights go far beyond the horizon, so the end point of a wave cannot be judged. No wave may be lost, however.
fn sinai_at_length() -> Case {
    Case::spread(
        "sinai-billiard-200",
        "200 flights, far beyond the horizon of prediction",
        "every end is accepted; no wave in the pillar, directions of length 1",
        pillar(),
        lattice(1024),
        200,
    )
    .but_for(1.0)
}

/// Two rows of pillars, between which waves are reflected many times.
fn stadium() -> Case {
    let mut surfaces = vec![hall()];
    for x in [-10.0, -5.0, 0.0, 5.0, 10.0] {
        for z in [-4.0, 4.0] {
            let pillar = Surface::new(Node::Cylinder(Cylinder { radius: 2.0 }));
            surfaces.push(pillar.at(Vec3::new(x, 0.0, z)));
        }
    }
    let listener = Listener::at(Vec3::new(13.5, 0.0, 13.0), 1.0);
    Case::spread(
        "pillar-rows",
        "a passage between pillars 1 m apart: chaos within four reflections",
        "every end is accepted; no wave in a pillar, directions of length 1",
        scene("pillars", surfaces, Vec3::new(-12.5, 1.0, 0.5), listener),
        lattice(1024),
        50,
    )
    .but_for(1.0)
}
