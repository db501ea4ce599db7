//! Hits lie on the surface, and closed rooms lose no wave. Each test protects a statement of the shaders that no other
//! test covers.

use crate::common::tracer;
use echomarch::glam::{Quat, Vec3};
use echomarch::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
use echomarch::{Listener, Node, Profile, Scene, Settings, Source, Surface};

/// Distance from the source to its target in metres. It is so large that the rounding error of the path length is a
/// thousand times that of a position.
const FAR: f32 = 2000.0;

/// Maximum distance in metres between a hit on a surface near the origin and this surface due to rounding: some units
/// in the last place of coordinates of up to 4 m.
const ON_IT: f32 = 4.0 * 4.0 * f32::EPSILON;

fn listener() -> Listener {
    Listener::at(Vec3::new(0.0, 4.0, 0.0), 0.1)
}

/// Returns directions from `source` to points around the origin. Most of them hit a solid there.
fn aimed(source: Vec3) -> Vec<Vec3> {
    let place = |index: u32| {
        let (x, y, z) = (index % 8, index / 8 % 8, index / 64);
        0.25 * (Vec3::new(x as f32, y as f32, z as f32) - 3.5) - source
    };
    (0..512).map(place).collect()
}

/// Protects the projection onto every kind of basic shape. From a distance of 2 km, the path length determines a hit
/// only to a millimetre, and the next flight starts from this hit.
#[test]
fn a_point_that_is_met_lies_on_the_surface() {
    let mut tracer = tracer();
    let turned = Quat::from_euler(echomarch::glam::EulerRot::YXZ, 0.4, 0.3, 0.2);
    let cuboid = || {
        Surface::new(Cuboid {
            size: Vec3::new(2.0, 3.0, 1.5),
        })
    };
    let solids = [
        Surface::new(Sphere { radius: 1.5 }),
        Surface::new(Cylinder { radius: 1.2 }),
        Surface::new(Cylinder { radius: 1.2 }).turned(turned),
        cuboid(),
        cuboid().turned(turned),
        Surface::new(Node::Plane(Plane)),
        Surface::new(Node::Plane(Plane)).turned(turned),
    ];
    let source = Vec3::new(0.3, 0.6, 0.74).normalize() * FAR;
    for solid in solids {
        for profile in [Profile::Hybrid, Profile::March] {
            let what = format!("{} {:?}, {profile}", solid.shape.name(), solid.rotation);
            let scene = Scene::new("far", vec![solid.clone()], Source::at(source), listener());
            let settings = Settings::new(profile).with_iterations(1);
            let states = tracer
                .trace_directions(&scene, &settings, &aimed(source))
                .unwrap();
            let met = states[1].iter().filter(|wave| wave.status == 1.0);
            let mut count = 0;
            for wave in met {
                let off = scene.surface_distance(wave.position).distance.abs();
                let places = wave.position.abs().max_element().max(4.0);
                assert!(
                    off <= ON_IT * places / 4.0,
                    "{what}: {off} m off at {}",
                    wave.position
                );
                count += 1;
            }
            assert!(count > 100, "{what}: {count} hits");
        }
    }
}

/// Protects waves that rounding has moved slightly beyond the wall ahead of them. Where positions have a resolution of
/// a millimetre, this happens in every corner. Such a wave hits the wall at once.
#[test]
fn a_closed_room_far_from_the_listener_loses_no_wave() {
    let mut tracer = tracer();
    let middle = Vec3::new(9000.0, 4000.0, -7000.0);
    let room = Surface::new(Room {
        size: Vec3::new(3.1, 2.3, 4.7),
    })
    .at(middle);
    let pillar = Surface::new(Cylinder { radius: 0.2 }).at(middle + Vec3::new(0.7, 0.0, 0.4));
    let scene = Scene::new(
        "far room",
        vec![room, pillar],
        Source::at(middle + Vec3::new(-0.4, 0.3, 0.2)),
        Listener::at(Vec3::ZERO, 0.1),
    );
    for profile in [Profile::Hybrid, Profile::March] {
        let settings = Settings::new(profile)
            .with_waves(20_000)
            .with_iterations(60);
        let (frame, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
        assert_eq!(frame.counts.dead, 0, "{profile}");
        let outside = waves.iter().filter(|wave| {
            let from_middle = (wave.position - middle).abs();
            (from_middle - Vec3::new(1.55, 1.15, 2.35)).max_element() > 0.01
        });
        assert_eq!(outside.count(), 0, "{profile}");
    }
}

/// Protects a wave that travels along a wall, exactly in its plane. It continues to the wall ahead, and is not moved to
/// another wall.
#[test]
fn a_wave_in_the_plane_of_a_wall_flies_on() {
    let mut tracer = tracer();
    let scene = Scene::new(
        "along a wall",
        vec![Surface::new(Room {
            size: Vec3::new(4.0, 6.0, 8.0),
        })],
        Source::at(Vec3::new(2.0, 0.5, 0.0)),
        Listener::at(Vec3::new(-1.0, -2.0, -3.0), 0.1),
    );
    let settings = Settings::hybrid().with_iterations(3);
    let states = tracer
        .trace_directions(&scene, &settings, &[Vec3::Z, Vec3::NEG_Z])
        .unwrap();
    for (wave, way) in [(0, 1.0), (1, -1.0)] {
        let reached = states.iter().map(|state| state[wave].position);
        let to_the_wall = Vec3::new(2.0, 0.5, 4.0 * way);
        assert!(
            reached
                .clone()
                .any(|place| place.distance(to_the_wall) < 1e-5)
        );
        // The wave stays in the plane of the wall along which it travels.
        reached.for_each(|place| assert!((place.x - 2.0).abs() < 1e-5, "{place}"));
    }
}
