//! What the integration tests share. A machine without GL fails them: nothing is skipped.
#![allow(dead_code)] // Every test file uses its own part of this.

pub mod flights;

use echomarch::gpu::{Api, Context, ContextOptions};
use echomarch::{Scene, Settings, Tracer};
use glam::{DVec3, Quat, Vec3};
use std::f64::consts::TAU;

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

/// SplitMix64 (Steele et al. 2014): the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    /// Uniform in 0 … 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) >> 11) as f64 * (-53f64).exp2()
    }

    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform over the unit sphere (Archimedes: its height is uniform).
    pub fn direction(&mut self) -> DVec3 {
        let height = self.signed();
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin)
    }

    pub fn directions(&mut self, count: usize) -> Vec<Vec3> {
        (0..count).map(|_| self.direction().as_vec3()).collect()
    }

    /// Uniform in the logarithm, from 10⁻³ to 10⁴.
    pub fn scale(&mut self) -> f64 {
        10f64.powf(7.0 * self.unit() - 3.0)
    }
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
