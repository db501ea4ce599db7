//! Input that is no scene and no setting.

use super::super::{Case, Check};
use super::build::builtin;
use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Node, Scene};
use crate::trace::Settings;
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
    ("a listener of radius 0", |s| s.listener.radius = 0.0),
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
        s.source.position.y = f32::NEG_INFINITY;
    }),
    ("a listener at NaN", |s| s.listener.position.z = f32::NAN),
    ("a listener turned by NaN", |s| s.listener.yaw = f32::NAN),
];

const SETTINGS: [Spoil<Settings>; 8] = [
    ("no waves", |s| s.waves = 0),
    ("no iterations", |s| s.iterations = 0),
    ("a minimum distance of 0", |s| s.min_distance = 0.0),
    ("a maximum distance of NaN", |s| s.max_distance = f32::NAN),
    ("an infinite start offset", |s| {
        s.start_offset = f32::INFINITY;
    }),
    ("a normals' step of 0", |s| s.normal_step = 0.0),
    ("a Lipschitz bound of 0", |s| s.lipschitz = 0.0),
    ("a NaN factor of the distance", |s| {
        s.distance_factor = f32::NAN;
    }),
];

pub fn cases() -> Vec<Case> {
    let corner = builtin("corner");
    let settings = Settings::hybrid().with_waves(64);
    let spoil_scene = |&(what, spoil): &Spoil<Scene>| {
        let mut scene = corner.clone();
        spoil(&mut scene);
        (what, scene, settings.clone())
    };
    let spoil_settings = |&(what, spoil): &Spoil<Settings>| {
        let mut settings = settings.clone();
        spoil(&mut settings);
        (what, corner.clone(), settings)
    };
    let refused = |name: &str, hard, inputs| Case {
        name: name.to_owned(),
        hard,
        exact: "refused before anything is traced".to_owned(),
        check: Check::Refused(inputs),
    };
    vec![
        refused(
            "zero-volume",
            "surfaces and listeners of no size",
            ZERO_VOLUME.iter().map(spoil_scene).collect(),
        ),
        refused(
            "not-finite",
            "places, sizes and turns that are no numbers",
            NOT_FINITE.iter().map(spoil_scene).collect(),
        ),
        refused(
            "senseless-settings",
            "constants that no march can end with",
            SETTINGS.iter().map(spoil_settings).collect(),
        ),
    ]
}
