//! Helpers shared by the integration tests. Without GL the tests fail: they are never skipped.
#![allow(dead_code)] // Every test file uses its own part of this.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(all(feature = "cli", feature = "demo"))]
pub mod drop;
pub mod flights;
mod random;
pub mod rays;
#[cfg(feature = "experiment")]
pub mod shard;
mod shared;
#[cfg(feature = "sofa")]
pub mod sofa;
pub mod wav;
#[cfg(all(feature = "cli", feature = "demo"))]
pub mod window;

#[allow(unused_imports)] // Every test program uses its own part of this.
pub use random::Random;
pub use shared::*;

use echomarch::Scene;
#[cfg(feature = "experiment")]
use echomarch::Settings;
use glam::{Quat, Vec3};

/// The settings of a case of the quick sweep by its label: only the experiments can create the
/// degraded march modes.
#[cfg(feature = "experiment")]
pub fn swept(label: &str) -> Settings {
    let mut cases = echomarch::experiment::accuracy::quick().into_iter();
    let case = cases.find(|case| case.label == label);
    case.unwrap_or_else(|| panic!("no case {label}")).settings
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
