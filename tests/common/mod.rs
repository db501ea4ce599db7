//! Helpers shared by the integration tests. Without OpenGL the tests fail; no test is skipped.
#![allow(dead_code)] // Each test file uses only some of these.

pub mod field_files;
pub mod flights;
mod random;
pub mod rays;
mod shared;
pub mod sofa;
pub mod wav;

#[allow(unused_imports)] // Each test program uses only some of these.
pub use random::Random;
pub use shared::*;

use echomarch::Scene;
use glam::{Quat, Vec3};

/// Returns the scene with left and right exchanged.
pub fn mirrored(scene: &Scene) -> Scene {
    let mirror = |v: Vec3| v * Vec3::new(-1.0, 1.0, 1.0);
    let mut mirrored = scene.clone();
    mirrored.sources[0].position = mirror(scene.sources[0].position);
    mirrored.listeners[0].position = mirror(scene.listeners[0].position);
    mirrored.listeners[0].yaw = -scene.listeners[0].yaw;
    for surface in &mut mirrored.surfaces {
        surface.position = mirror(surface.position);
        let [x, y, z, w] = surface.rotation.to_array();
        surface.rotation = Quat::from_xyzw(x, -y, -z, w);
    }
    mirrored
}
