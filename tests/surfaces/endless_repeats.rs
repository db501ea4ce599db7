//! Infinite repetitions in closed form: every copy is hit at any distance, and a listener far from the origin receives
//! the same waves.

use crate::common::{Random, flights, tracer};
use echomarch::geometry::ExactScene;
use echomarch::scene::Shape;
use echomarch::scene::shape::{Capsule, Cuboid, Prism, Room, Sphere};
use echomarch::tracer::Wave;
use echomarch::{Listener, Profile, Scene, Settings, Source, Surface};
use glam::{Quat, Vec2, Vec3};

fn ball(radius: f32) -> Shape {
    Sphere { radius }.into()
}

fn block(size: Vec3) -> Shape {
    Cuboid { size }.into()
}

fn degrees(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z).map(f32::to_radians)
}

/// A lattice of rotated boxes, in which some waves travel for kilometres between two layers.
fn turned_boxes() -> Scene {
    let turned = block(Vec3::new(1.0, 0.7, 1.3)).rotate(degrees(25.0, 35.0, 45.0));
    let all = turned.repeat(Vec3::new(3.0, 3.5, 4.0), [0; 3]);
    Scene::new(
        "turned boxes",
        vec![Surface::new(all)],
        Source::at(Vec3::new(1.5, 1.7, 1.9)),
        Listener::at(Vec3::new(-4.5, 5.25, -6.0), 0.6),
    )
}

/// Protects waves in an infinite lattice. A march would reach its step limit for 34 of these 4,096 waves. Each of them
/// hits a box, the last one after 170 km.
#[test]
fn no_wave_in_a_lattice_is_given_up() {
    let settings = Settings::hybrid().with_waves(4096).with_iterations(1);
    let frame = tracer()
        .frame(&turned_boxes(), &settings.with_seed(7))
        .unwrap();
    let counts = frame.counts;
    assert_eq!((counts.dead, counts.step_limit_reached), (0, 0));
}

fn repeated() -> Vec<(&'static str, Shape)> {
    let capsule = || {
        Shape::from(Capsule {
            radius: 0.3,
            height: 0.8,
        })
    };
    let corners = [
        Vec2::new(-0.5, -0.4),
        Vec2::new(0.6, -0.3),
        Vec2::new(0.1, 0.6),
    ];
    let prism = Shape::from(Prism {
        corners,
        depth: 0.9,
    });
    let pair = Shape::union([
        ball(0.3).translate(Vec3::new(0.5, 0.2, -0.1)),
        block(Vec3::new(0.4, 0.8, 0.3)).translate(Vec3::new(-0.4, 0.0, 0.3)),
    ]);
    let inner = ball(0.25).repeat(Vec3::new(0.0, 0.8, 0.0), [0; 3]);
    let few = ball(0.2).repeat(Vec3::new(0.6, 0.0, 0.6), [3, 0, 2]);
    vec![
        ("balls", ball(0.6).repeat(Vec3::new(2.0, 2.3, 2.6), [0; 3])),
        (
            "some along y, none along z",
            ball(0.7).repeat(Vec3::new(2.0, 1.6, 0.0), [0, 5, 0]),
        ),
        (
            "not in the middle of their cells",
            capsule()
                .translate(Vec3::new(0.3, -0.1, 0.2))
                .repeat(Vec3::new(1.9, 2.2, 1.7), [0, 0, 4]),
        ),
        (
            "prisms, turned and larger",
            prism
                .repeat(Vec3::new(2.0, 2.0, 2.0), [0; 3])
                .rotate(degrees(20.0, 40.0, 10.0))
                .scale(1.4)
                .translate(Vec3::new(0.3, 0.2, 0.1)),
        ),
        (
            "two in a cell",
            pair.repeat(Vec3::new(2.1, 1.9, 2.4), [0; 3]),
        ),
        (
            "in a cell without end",
            inner.repeat(Vec3::new(1.7, 0.0, 1.5), [0; 3]),
        ),
        (
            "in a cell with an end",
            few.repeat(Vec3::new(2.5, 1.3, 2.5), [0; 3]),
        ),
        (
            "boxes that touch",
            block(Vec3::new(1.5, 0.5, 0.8)).repeat(Vec3::new(1.5, 2.0, 2.0), [0; 3]),
        ),
        (
            "beside others",
            Shape::union([
                ball(0.5).repeat(Vec3::new(2.0, 0.0, 2.0), [0; 3]),
                block(Vec3::new(90.0, 1.0, 90.0)).translate(Vec3::Y * -4.0),
            ]),
        ),
        (
            "more than are walked without a limit",
            ball(0.5).repeat(Vec3::new(1.8, 2.2, 2.0), [9001, 4, 9000]),
        ),
    ]
}

/// Protects waves from passing a copy, and from hitting a copy that does not exist. The exact reference is compared for
/// starts in the air and on copies, with rotated and moved surfaces.
#[test]
fn waves_meet_what_the_exact_reference_meets() {
    let mut random = Random(11);
    for (name, field) in repeated() {
        let surface = Surface::new(field)
            .at(Vec3::new(0.4, -0.3, 0.7))
            .turned(Quat::from_rotation_y(0.4));
        let mut scene = Scene::new(
            name,
            vec![surface],
            Source::at(Vec3::ZERO),
            Listener::at(Vec3::new(3.0, 1.0, -2.0), 0.3),
        );
        let exact = ExactScene::new(&scene).unwrap();
        let mut tried = 0;
        while tried < 4 {
            let place = (4.0 * random.unit() * random.direction()).as_vec3();
            let free = exact.surface_distance(place.as_dvec3());
            if free < 0.05 || place.distance(scene.listeners[0].position) < 0.4 {
                continue;
            }
            tried += 1;
            scene.sources[0].position = place;
            flights::compare(&scene, &random.directions(500), &[Profile::Hybrid]);
        }
    }
}

/// Protects reflections among copies: a wave does not hit the copy that it leaves, and no wave enters a solid.
#[test]
fn no_wave_gets_into_a_copy() {
    for (name, field) in repeated() {
        let scene = Scene::new(
            name,
            vec![Surface::new(field)],
            Source::at(Vec3::new(1.05, 1.1, 1.2)),
            Listener::at(Vec3::new(300.0, 1.0, -2.0), 0.3),
        );
        let exact = ExactScene::new(&scene).unwrap();
        assert!(
            exact.surface_distance(scene.sources[0].position.as_dvec3()) > 0.0,
            "{name}"
        );
        let settings = Settings::hybrid().with_waves(2000).with_iterations(8);
        let (frame, waves) = tracer().frame_with_waves(&scene, &settings).unwrap();
        assert_eq!(frame.counts.step_limit_reached, 0, "{name}");
        for wave in waves.iter().filter(|wave| wave.status > 0.0) {
            let place = wave.position.as_dvec3();
            let from = (place - scene.listeners[0].position.as_dvec3())
                .abs()
                .max_element();
            let rounding = 16.0 * f64::from(f32::EPSILON) * from.max(300.0);
            let distance = exact.surface_distance(place);
            assert!(distance.abs() < rounding, "{name}: {distance} for {wave:?}");
        }
    }
}

fn relative(waves: &[Wave]) -> Vec<[u32; 4]> {
    let of = |wave: &Wave| {
        let [x, y, z] = wave.direction.to_array().map(f32::to_bits);
        [wave.status.to_bits(), x, y, z]
    };
    waves.iter().map(of).collect()
}

/// Protects precision far from the origin: if source and listener are moved by a million periods, the waves are
/// bit-identical. This also holds if the repetition is inside other operators.
#[test]
fn a_million_periods_away_it_sounds_the_same() {
    let lattice = ball(0.6).repeat(Vec3::new(2.0, 3.0, 4.0), [0; 3]);
    let quarter = degrees(0.0, 90.0, 0.0);
    for (name, field, by) in [
        ("plain", lattice.clone(), Vec3::new(2e6, -3e6, 4e6)),
        (
            "moved and larger",
            lattice
                .clone()
                .scale(2.0)
                .translate(Vec3::new(0.5, 0.25, 0.0)),
            Vec3::new(4e6, -3e6, 0.0),
        ),
        (
            "along an axis alone",
            ball(0.6).repeat(Vec3::new(2.0, 3.0, 4.0), [0, 3, 5]),
            Vec3::new(2e6, 0.0, 0.0),
        ),
        ("turned", lattice.rotate(quarter), Vec3::new(0.0, 3e6, 0.0)),
    ] {
        let at = |by: Vec3| {
            let source = Source::at(Vec3::new(1.0, 1.5, 2.0) + by);
            // This position is not halfway between two copies, where either copy may count as the nearest.
            let listener = Listener::at(Vec3::new(-0.75, 1.25, -1.75) + by, 0.5);
            Scene::new(name, vec![Surface::new(field.clone())], source, listener)
        };
        let settings = Settings::hybrid().with_waves(2000).with_iterations(3);
        let mut tracer = tracer();
        let (_, here) = tracer.frame_with_waves(&at(Vec3::ZERO), &settings).unwrap();
        let (_, there) = tracer.frame_with_waves(&at(by), &settings).unwrap();
        assert!(relative(&here) == relative(&there), "{name}");
    }
}

/// Protects waves that still reach the step limit. They are counted, and a nearer surface is hit, regardless of what is
/// behind it.
#[test]
fn a_step_limit_counts_only_where_nothing_nearer_is_met() {
    // Spheres that are so small that most waves need more steps than the limit.
    let sparse = ball(4e-4).repeat(Vec3::splat(1.0), [0; 3]);
    let mut scene = Scene::new(
        "sparse",
        vec![Surface::new(sparse)],
        Source::at(Vec3::splat(0.5)),
        Listener::at(Vec3::splat(-3.5), 0.2),
    );
    let settings = Settings::hybrid().with_waves(64).with_iterations(1);
    let counts = tracer().frame(&scene, &settings).unwrap().counts;
    assert!(counts.step_limit_reached > 0);
    assert_eq!(counts.step_limit_reached, counts.dead);
    let room = Room {
        size: Vec3::splat(40.0),
    };
    scene.surfaces.push(Surface::new(room));
    let counts = tracer().frame(&scene, &settings).unwrap().counts;
    assert_eq!((counts.step_limit_reached, counts.dead), (0, 0));
}
