//! Helpers shared by the integration tests. Without GL the tests fail: they are never skipped.
#![allow(dead_code)] // Every test file uses its own part of this.

pub mod field_files;
pub mod flights;
mod random;
pub mod rays;
mod shared;
pub mod sofa;
pub mod wav;

#[allow(unused_imports)] // Every test program uses its own part of this.
pub use random::Random;
pub use shared::*;

use echomarch::tracer::{Algorithm, MarchVariant};
use echomarch::{Scene, Settings};
use glam::{Quat, Vec3};

/// March with a degraded variant, which only the experiments use.
pub fn marched(change: impl FnOnce(&mut MarchVariant)) -> Settings {
    let mut settings = Settings::march();
    if let Algorithm::March(options) = &mut settings.algorithm {
        change(&mut options.variant);
    }
    settings
}

/// The scene mirrored left to right.
pub fn mirrored(scene: &Scene) -> Scene {
    let mirror = |v: Vec3| v * Vec3::new(-1.0, 1.0, 1.0);
    let mut mirrored = scene.clone();
    mirrored.source.position = mirror(scene.source.position);
    mirrored.listener.position = mirror(scene.listener.position);
    mirrored.listener.yaw = -scene.listener.yaw;
    for surface in &mut mirrored.surfaces {
        surface.position = mirror(surface.position);
        let [x, y, z, w] = surface.rotation.to_array();
        surface.rotation = Quat::from_xyzw(x, -y, -z, w);
    }
    mirrored
}
