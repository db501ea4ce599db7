//! What the integration tests share. A machine without GL fails them: nothing is skipped.
#![allow(dead_code)] // Every test file uses its own part of this.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(all(feature = "cli", feature = "demo"))]
pub mod drop;
pub mod flights;
mod random;
pub mod wav;
#[cfg(all(feature = "cli", feature = "demo"))]
pub mod window;

#[allow(unused_imports)] // Every test program uses its own part of this.
pub use random::Random;

use echomarch::gpu::{Api, Context, ContextOptions};
use echomarch::{Scene, Settings, Tracer};
use glam::{Quat, Vec3};

/// Runs `test` once on every API, each on a thread of its own.
pub fn for_each_api(test: impl Fn(&Context) + Sync) {
    for api in Api::ALL {
        let ended = std::thread::scope(|scope| {
            std::thread::Builder::new()
                .name(api.to_string())
                .spawn_scoped(scope, || test(&context(api)))
                .unwrap()
                .join()
        });
        assert!(ended.is_ok(), "failed with the API {api}");
    }
}

/// A context of the API on the first device that gives one.
pub fn context(api: Api) -> Context {
    Context::headless(&ContextOptions::new(api)).unwrap_or_else(|e| panic!("{e}"))
}

/// A tracer on a context of the preferred API.
pub fn tracer() -> Tracer {
    Tracer::new(&context(Api::Gl)).unwrap()
}

/// The thesis' settings with these counts.
pub fn thesis(waves: u32, iterations: u32) -> Settings {
    Settings::thesis()
        .with_waves(waves)
        .with_iterations(iterations)
}

/// The settings of a case of the quick sweep by its label: the worsened ways to march are to be
/// had from the experiments alone.
#[cfg(feature = "experiment")]
pub fn swept(label: &str) -> Settings {
    let mut cases = echomarch::experiment::accuracy::quick().into_iter();
    let case = cases.find(|case| case.label == label);
    case.unwrap_or_else(|| panic!("no case {label}")).settings
}

/// A scene that a test needs and that must be there.
pub fn builtin(name: &str) -> Scene {
    Scene::builtin(name).unwrap()
}

/// The scene in a mirror: left is right.
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
