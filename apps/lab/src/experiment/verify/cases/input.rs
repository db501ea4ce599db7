//! Invalid scenes and settings.

use super::super::{Case, Check};
use super::build::builtin;
use echomarch::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use echomarch::scene::{Node, Scene};
use echomarch::tracer::{Profile, Settings, ThesisOptions};
use glam::{Quat, Vec3};

type Spoil<T> = (&'static str, fn(&mut T));

const ZERO_VOLUME: [Spoil<Scene>; 5] = [
    ("a box of no height", |s| {
        let size = Vec3::new(1.0, 0.0, 1.0);
        s.surfaces[1].shape = Node::Cuboid(Cuboid { size }).into();
    }),
    ("a room of no size", |s| {
        s.surfaces[0].shape = Node::Room(Room { size: Vec3::ZERO }).into();
    }),
    ("a sphere of radius 0", |s| {
        s.surfaces[1].shape = Node::Sphere(Sphere { radius: 0.0 }).into();
    }),
    ("a cylinder of negative radius", |s| {
        s.surfaces[1].shape = Node::Cylinder(Cylinder { radius: -1.0 }).into();
    }),
    ("a listener of radius 0", |s| s.listeners[0].radius = 0.0),
];

const NOT_FINITE: [Spoil<Scene>; 6] = [
    ("a surface at NaN", |s| s.surfaces[1].position.x = f32::NAN),
    ("a box without an end", |s| {
        let size = Vec3::new(1.0, f32::INFINITY, 1.0);
        s.surfaces[1].shape = Node::Cuboid(Cuboid { size }).into();
    }),
    ("a rotation of NaN", |s| {
        s.surfaces[1].rotation = Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0);
    }),
    ("a source at infinity", |s| {
        s.sources[0].position.y = f32::NEG_INFINITY;
    }),
    ("a listener at NaN", |s| {
        s.listeners[0].position.z = f32::NAN
    }),
    ("a listener turned by NaN", |s| {
        s.listeners[0].yaw = f32::NAN
    }),
];

const SHARED: [Spoil<Settings>; 4] = [
    ("no waves", |s| s.waves = 0),
    ("no iterations", |s| s.iterations = 0),
    ("a maximum distance of NaN", |s| s.max_distance = f32::NAN),
    ("no iterations in a pass", |s| s.iterations_per_pass = 0),
];

const THESIS: [Spoil<ThesisOptions>; 3] = [
    ("a minimum distance of 0", |s| s.min_distance = 0.0),
    ("an infinite start offset", |s| {
        s.start_offset = f32::INFINITY;
    }),
    ("a normals' step of 0", |s| s.normal_step = 0.0),
];

type Input = (&'static str, Scene, Settings);

/// Invalid scenes, which every profile must reject.
fn of_scenes(spoils: &[Spoil<Scene>]) -> Vec<Input> {
    for_every_profile(spoils, |spoil, settings| {
        let mut scene = builtin("corner");
        spoil(&mut scene);
        (scene, settings)
    })
}

/// Invalid settings. Every profile must reject the common ones, and each profile must reject its own.
fn of_settings() -> Vec<Input> {
    let mut inputs = for_every_profile(&SHARED, |spoil, mut settings| {
        spoil(&mut settings);
        (builtin("corner"), settings)
    });
    inputs.extend(THESIS.iter().map(|(what, spoil)| {
        let mut options = ThesisOptions::default();
        spoil(&mut options);
        (
            *what,
            builtin("corner"),
            Settings::new(options).with_waves(64),
        )
    }));
    inputs
}

fn for_every_profile<T>(
    spoils: &[Spoil<T>],
    spoilt: impl Fn(fn(&mut T), Settings) -> (Scene, Settings),
) -> Vec<Input> {
    let mut inputs = Vec::new();
    for profile in Profile::ALL {
        for &(what, spoil) in spoils {
            let (scene, settings) = spoilt(spoil, Settings::new(profile).with_waves(64));
            inputs.push((what, scene, settings));
        }
    }
    inputs
}

pub fn cases() -> Vec<Case> {
    let refused = |name: &str, hard, inputs| Case {
        name: name.to_owned(),
        hard,
        exact: "refused before anything is traced".to_owned(),
        check: Check::Refused(inputs),
    };
    vec![
        refused(
            "zero-volume",
            "surfaces and listeners without a size",
            of_scenes(&ZERO_VOLUME),
        ),
        refused(
            "not-finite",
            "positions, sizes and rotations that are not finite",
            of_scenes(&NOT_FINITE),
        ),
        refused(
            "senseless-settings",
            "constants with which no march can end",
            of_settings(),
        ),
    ]
}
