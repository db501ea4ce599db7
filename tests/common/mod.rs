//! What the integration tests share. A machine without GL fails them: nothing is skipped.
#![allow(dead_code)] // Every test file uses its own part of this.

pub mod flights;
mod shared;

pub use shared::*;

use echomarch::gpu::Api;
use echomarch::{Scene, Settings, Tracer};
use glam::{Quat, Vec3};

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

#[cfg(all(feature = "cli", feature = "demo"))]
pub mod drop;
#[cfg(all(feature = "cli", feature = "demo"))]
pub mod window;

/// The program as a person starts it.
#[cfg(feature = "cli")]
pub mod cli {
    use std::path::Path;
    use std::process::{Command, Output};

    /// The program, to be given arguments.
    pub fn command() -> Command {
        Command::new(env!("CARGO_BIN_EXE_echomarch"))
    }

    /// Runs the program, neither of whose outputs is a terminal.
    pub fn echomarch(arguments: &[&str]) -> Output {
        command().args(arguments).output().unwrap()
    }

    /// Runs it and demands exit code 0.
    pub fn succeed(arguments: &[&str]) -> Output {
        let output = echomarch(arguments);
        let errors = stderr(&output);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        output
    }

    /// Runs it with `--json`, demands exit code 0, and reads what it printed.
    pub fn json(arguments: &[&str]) -> serde_json::Value {
        let output = succeed(&[arguments, &["--json"]].concat());
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Runs it and demands that it is refused as bad input, in one sentence that holds `told`.
    pub fn refuse(arguments: &[&str], told: &str) {
        let output = echomarch(arguments);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(told), "{arguments:?}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "one sentence: {said}");
        assert!(output.stdout.is_empty());
    }

    pub fn stdout(output: &Output) -> &str {
        std::str::from_utf8(&output.stdout).unwrap()
    }

    pub fn stderr(output: &Output) -> &str {
        std::str::from_utf8(&output.stderr).unwrap()
    }

    /// A path as an argument.
    pub fn argument(path: &Path) -> &str {
        path.to_str().unwrap()
    }
}
