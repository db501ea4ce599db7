//! Diffracted levels of fields: they depend on the solid alone, not on how it is described.

use crate::oracle::Wedge;
use crate::responses::{BANDS_HZ, SPEED, tracer};
use echomarch::glam::{DVec3, Vec3};
use echomarch::response::diffracted;
use echomarch::scene::UserField;
use echomarch::scene::shape::User;
use echomarch::tracer::FieldTrial;
use echomarch::{Scene, Settings, Shape, Surface};
use std::f64::consts::PI;
use std::sync::Arc;

/// Level in dB below which no level is compared.
const LOWEST_DB: f64 = -35.0;

/// Places of a source and a listener that a ball with a radius of 1 m at the origin hides from each other, in metres.
const AROUND_A_BALL: [[[f64; 3]; 2]; 4] = [
    [[-3.0, 0.2, 0.1], [3.0, -0.1, 0.3]],
    [[-2.0, 0.0, 0.5], [1.6, 0.9, 0.0]],
    [[-1.5, -0.4, 0.0], [4.0, 0.5, 1.5]],
    [[0.3, 2.2, -0.4], [-0.2, -1.4, -1.0]],
];

fn scene(surfaces: &str, [source, listener]: [[f64; 3]; 2]) -> Scene {
    let place = |[x, y, z]: [f64; 3]| format!("({x}, {y}, {z})");
    let text = format!(
        "Scene(surfaces: [{surfaces}], source: Source(position: {}), \
         listener: Listener(position: {}, radius: 0.01))",
        place(source),
        place(listener)
    );
    Scene::from_ron(&text, "test").expect("a scene")
}

fn of_shape(shape: &str, ends: [[f64; 3]; 2]) -> Scene {
    scene(&format!("Surface(shape: {shape})"), ends)
}

/// Levels of the direct sound in dB relative to the open, along the paths around a body if it hides the source.
fn levels(scene: &Scene) -> [f64; 8] {
    let (paths, beside) = diffracted(scene).expect("a pair");
    let apart = scene.sources[0]
        .position
        .as_dvec3()
        .distance(scene.listeners[0].position.as_dvec3());
    std::array::from_fn(|band| {
        let around: f64 = paths.iter().map(|path| path.energy[band]).sum();
        let energy = match paths.is_empty() {
            true => beside[band],
            false => around * 4.0 * PI * apart * apart,
        };
        10.0 * energy.log10()
    })
}

fn assert_near(found: [f64; 8], expected: [f64; 8], error_db: f64, name: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        let is_near = (found - expected).abs() < error_db || expected < LOWEST_DB;
        assert!(is_near, "{name}: {found} dB, expected {expected} dB");
    }
}

/// Protects levels behind balls that are described in other ways: blends of balls, an ellipsoid, a rounded box and a
/// capsule, within 1 dB of the levels behind a ball.
#[test]
fn fields_of_a_ball_sound_as_a_ball() {
    let fields = [
        "Ellipsoid(radii: (1, 1, 1))",
        "SmoothUnion(of: [Sphere(radius: 0.9), Sphere(radius: 0.9)], radius: 0.4)",
        "SmoothUnion(of: [Translate(of: Sphere(radius: 0.75), by: (0.005, 0, 0)), Sphere(radius: 0.75)], radius: 1)",
        "RoundedBox(size: (2, 2, 2), rounding: 0.999)",
        "Capsule(radius: 1, height: 0.001)",
    ];
    for ends in AROUND_A_BALL {
        let expected = levels(&of_shape("Sphere(radius: 1)", ends));
        assert!(expected[4] < 0.0, "hidden: {expected:?}");
        for field in fields {
            assert_near(levels(&of_shape(field, ends)), expected, 1.0, field);
        }
    }
}

/// Protects levels behind a user's ball, which the CPU knows from samples: within 1 dB of the levels behind a ball.
#[test]
fn a_users_ball_sounds_as_a_ball() {
    FieldTrial::InThisProcess.set();
    let mut tracer = tracer();
    let text = "float field(vec3 p) { return length(p) - 1.0; }";
    for ends in AROUND_A_BALL {
        let mut scene = of_shape("Sphere(radius: 1)", ends);
        let expected = levels(&scene);
        let field = UserField::new("ball.glsl", text.to_owned(), Vec3::splat(2.2), 1.0);
        let field = User {
            field: Arc::new(field),
        };
        scene.surfaces[0] = Surface::new(Shape::from(field));
        // The first frame samples the field.
        let few = Settings::default().with_waves(64);
        tracer.frame(&scene, &few).expect("a frame");
        assert_near(levels(&scene), expected, 1.0, "a user's ball");
    }
}

/// Protects levels behind small roundings of an edge: with a radius of 1 mm within 0.3 dB of the edge's, and of 1 cm within
/// 1 dB. The rounding turns the way by 3° to 109°.
#[test]
fn small_roundings_sound_as_edges() {
    // Angle of the air in degrees, and distance in metres and angle in degrees of source and listener, and their distance
    // along the edge.
    let cases = [
        (333.5, 2.64, 33.7, 0.96, 322.4, 1.59),
        (319.0, 2.99, 120.6, 1.58, 305.5, -1.36),
        (245.5, 1.42, 31.3, 2.23, 214.6, -1.87),
        (279.1, 3.39, 79.3, 2.49, 263.6, -1.96),
        (273.6, 1.16, 27.1, 3.08, 263.4, 1.0),
    ];
    for (air, source_m, source_angle, listener_m, listener_angle, along) in cases {
        let half = (360.0_f64 - air).to_radians() / 2.0;
        let (x, y) = (300.0 * half.sin(), -300.0 * half.cos());
        let at = |metres: f64, degrees: f64, z: f64| {
            let angle = (degrees - 90.0_f64).to_radians() + half;
            [metres * angle.cos(), metres * angle.sin(), z]
        };
        let ends = [
            at(source_m, source_angle, 0.0),
            at(listener_m, listener_angle, along),
        ];
        let wedge = Wedge {
            exterior_angle: air.to_radians(),
        };
        let exact = BANDS_HZ.map(|hz| {
            let (source, listener) = (source_angle.to_radians(), listener_angle.to_radians());
            let k = 2.0 * PI * hz / SPEED;
            let pressure = wedge.pressure(k, source_m, source, listener_m, listener, along);
            20.0 * pressure.norm().log10()
        });
        let prism = format!(
            "Prism(corners: [(0, 0), ({}, {y}), ({x}, {y})], depth: 600)",
            -x
        );
        // Two equal fields blended over a radius grow by a quarter of it.
        for (radius, error_db) in [(0.004, 0.3), (0.04, 1.0)] {
            let field = format!("SmoothUnion(of: [{prism}, {prism}], radius: {radius})");
            let name = format!("{air}°, blended over {radius} m");
            assert_near(levels(&of_shape(&field, ends)), exact, error_db, &name);
        }
    }
}

/// Scenes of one to three bodies, with a source and a listener that they hide from each other; lengths times `scale`.
fn bodies(scale: f64) -> Vec<Scene> {
    let s = |metres: f64| metres * scale;
    let text = |bodies: &[(&str, [f64; 3])]| {
        let surfaces = bodies.iter().map(|(shape, [x, y, z])| {
            let place = format!("({}, {}, {})", s(*x), s(*y), s(*z));
            format!("Surface(shape: {shape}, position: {place})")
        });
        surfaces.collect::<Vec<_>>().join(", ")
    };
    let ball = |radius: f64| format!("Sphere(radius: {})", s(radius));
    let cuboid = |x: f64, y: f64, z: f64| format!("Box(size: ({}, {}, {}))", s(x), s(y), s(z));
    let torus = format!("Torus(ring: {}, tube: {})", s(1.0), s(0.4));
    let (large, small) = (ball(1.25), ball(0.5));
    let (block, wall) = (cuboid(1.0, 2.0, 3.0), cuboid(0.5, 4.0, 3.0));
    let ends = [[-3.0, 0.25, 0.125], [3.0, -0.125, 0.25]].map(|place| place.map(s));
    let all: [&[(&str, [f64; 3])]; 6] = [
        &[(&large, [0.0; 3])],
        &[(&block, [0.0; 3])],
        &[(&torus, [0.0; 3])],
        &[(&large, [-0.5, -0.5, 0.0]), (&small, [1.5, 0.0, 0.25])],
        &[(&wall, [-1.0, 0.5, 0.0]), (&block, [1.0, 0.0, 0.5])],
        &[
            (&wall, [-1.0, 0.5, 0.0]),
            (&small, [0.5, 0.0, 0.0]),
            (&block, [1.75, 0.0, 0.5]),
        ],
    ];
    all.iter()
        .map(|bodies| scene(&text(bodies), ends))
        .collect()
}

/// Protects reciprocity: if source and listener change places, levels stay and paths are reversed.
#[test]
fn source_and_listener_may_change_places() {
    for scene in bodies(1.0) {
        let mut swapped = scene.clone();
        swapped.sources[0].position = scene.listeners[0].position;
        swapped.listeners[0].position = scene.sources[0].position;
        let name = format!("{:?}", scene.surfaces);
        assert_near(levels(&swapped), levels(&scene), 1e-6, &name);
        let points = |scene: &Scene| -> Vec<Vec<DVec3>> {
            let (paths, _) = diffracted(scene).expect("a pair");
            paths.into_iter().map(|path| path.path.points).collect()
        };
        let mut back = points(&swapped);
        back.iter_mut().for_each(|points| points.reverse());
        assert_eq!(back, points(&scene), "{name}");
    }
}

/// Protects the independence of units: lengths twice as large and frequencies half as high give the same levels.
#[test]
fn twice_the_lengths_at_half_the_frequencies_sound_the_same() {
    for (scene, large) in bodies(1.0).iter().zip(bodies(2.0)) {
        let (small, large) = (levels(scene), levels(&large));
        // From 250 Hz on the centres of the bands double exactly.
        for band in 2..7 {
            let (low, high) = (large[band], small[band + 1]);
            let is_near = (low - high).abs() < 0.1 || high < LOWEST_DB;
            assert!(is_near, "{low} and {high} dB, {:?}", scene.surfaces);
        }
    }
}
