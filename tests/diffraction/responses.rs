//! Diffracted paths of responses against the exact solution.

use crate::oracle::{Wedge, ball, cylinder};
use echomarch::gl::Context;
use echomarch::glam::DVec3;
use echomarch::response::{HeardPath, PathKind, Response, ResponseSettings};
use echomarch::{Scene, Settings, Tracer};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

pub const BANDS_HZ: [f64; 8] = [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3];
pub const SPEED: f64 = 343.0;

pub fn tracer() -> Tracer {
    let context = Context::headless(&Default::default()).expect("a context");
    Tracer::new(&context).expect("a tracer")
}

/// The paths of a shape between two places: their kinds, and the sum of their energies relative to the open, in dB.
fn heard(
    tracer: &mut Tracer,
    shape: &str,
    ends: [[f64; 3]; 2],
    diffraction: bool,
) -> (Vec<PathKind>, [f64; 8]) {
    heard_among(
        tracer,
        &format!("Surface(shape: {shape})"),
        ends,
        diffraction,
    )
}

/// The paths among surfaces.
fn heard_among(
    tracer: &mut Tracer,
    surfaces: &str,
    [source, listener]: [[f64; 3]; 2],
    diffraction: bool,
) -> (Vec<PathKind>, [f64; 8]) {
    let [[sx, sy, sz], [lx, ly, lz]] = [source, listener];
    let text = format!(
        "Scene(surfaces: [{surfaces}], source: Source(position: ({sx}, {sy}, {sz})), \
         listener: Listener(position: ({lx}, {ly}, {lz}), radius: 0.05))"
    );
    let scene = Scene::from_ron(&text, "test").expect("a scene");
    let settings = ResponseSettings::default()
        .with_seconds(0.1)
        .with_diffraction(diffraction)
        .with_trace(Settings::default().with_waves(16));
    let response = Response::trace(tracer, &scene, &settings).expect("a response");
    let apart: f64 = (0..3)
        .map(|axis| (source[axis] - listener[axis]).powi(2))
        .sum();
    let level = |band: usize| {
        let energy: f64 = response.paths.iter().map(|path| path.energy[band]).sum();
        10.0 * (energy * 4.0 * PI * apart).log10()
    };
    let kinds = response.paths.iter().map(|path| path.kind).collect();
    (kinds, std::array::from_fn(level))
}

/// Protects levels behind wedges of different angles: one diffracted path, within 0.1 dB of the exact solution at the
/// centre of each band.
#[test]
fn levels_behind_wedges_are_the_exact_ones() {
    let mut tracer = tracer();
    let cases = [
        (270.0, 2.0, 30.0, 3.0, 240.0, 0.0),
        (345.0, 1.0, 50.0, 2.5, 300.0, 1.5),
        (225.0, 0.7, 15.0, 4.0, 220.0, -2.0),
        (300.0, 4.0, 5.0, 0.9, 290.0, 0.5),
    ];
    for (air, source_m, source_angle, receiver_m, receiver_angle, along) in cases {
        let half = (360.0_f64 - air).to_radians() / 2.0;
        let (x, y) = (300.0 * half.sin(), -300.0 * half.cos());
        let shape = format!(
            "Prism(corners: [(0, 0), ({}, {y}), ({x}, {y})], depth: 600)",
            -x
        );
        let at = |metres: f64, degrees: f64, z: f64| {
            let angle = (degrees - 90.0_f64).to_radians() + half;
            [metres * angle.cos(), metres * angle.sin(), z]
        };
        let ends = [
            at(source_m, source_angle, 0.0),
            at(receiver_m, receiver_angle, along),
        ];
        let (kinds, levels) = heard(&mut tracer, &shape, ends, true);
        assert_eq!(kinds, [PathKind::Diffracted], "{air}°");
        let wedge = Wedge {
            exterior_angle: air.to_radians(),
        };
        for (level, hz) in levels.into_iter().zip(BANDS_HZ) {
            let exact = wedge.pressure(
                2.0 * PI * hz / SPEED,
                source_m,
                source_angle.to_radians(),
                receiver_m,
                receiver_angle.to_radians(),
                along,
            );
            let exact = 20.0 * exact.norm().log10();
            assert!(
                (level - exact).abs() < 0.1,
                "{air}°, {hz} Hz: {level} dB, exact {exact} dB"
            );
        }
    }
}

/// Protects the bent path round the corner of a narrow corridor: its level is that behind a wedge without ends, because the
/// edge ends in the floor and in the ceiling.
#[test]
fn a_bent_path_leads_round_the_corner_of_a_narrow_corridor() {
    let mut tracer = tracer();
    let (width, apart): (f64, f64) = (2.0, 3.0);
    let half = 0.5 * width;
    let text = format!(
        "Scene(surfaces: [Surface(shape: Rooms(of: [(from: (-12, 0, -{width}), to: ({width}, 2.5, 0)), \
         (from: (0, 0, 0), to: ({width}, 2.5, 10))]))], source: Source(position: (-8, 1.5, -{half})), \
         listener: Listener(position: ({half}, 1.5, {apart}), radius: 0.05))"
    );
    let scene = Scene::from_ron(&text, "corridor").expect("a scene");
    let settings = ResponseSettings::default()
        .with_seconds(0.1)
        .with_order(0)
        .with_diffraction(true)
        .with_trace(Settings::default().with_waves(16));
    let response = Response::trace(&mut tracer, &scene, &settings).expect("a response");
    let (source_m, receiver_m) = (8_f64.hypot(half), half.hypot(apart));
    let length_m = source_m + receiver_m;
    let is_bent = |path: &&HeardPath| {
        path.kind == PathKind::Diffracted && (path.delay_s * SPEED - length_m).abs() < 0.01
    };
    let path = response.paths.iter().find(is_bent).expect("a bent path");
    let wedge = Wedge {
        exterior_angle: 1.5 * PI,
    };
    let direct = (8.0 + half).powi(2) + (half + apart).powi(2);
    for (band, hz) in BANDS_HZ.into_iter().enumerate() {
        let pressure = wedge.pressure(
            2.0 * PI * hz / SPEED,
            source_m,
            (half / 8.0).atan(),
            receiver_m,
            1.5 * PI - (half / apart).atan(),
            0.0,
        );
        let exact = 20.0 * pressure.norm().log10();
        let level = 10.0 * (path.energy[band] * 4.0 * PI * direct).log10();
        assert!(
            (level - exact).abs() < 0.15,
            "{hz} Hz: {level} dB, exact {exact} dB"
        );
    }
}

/// Protects pillars between a floor and a ceiling: behind them the unreflected sound is that behind an endless pillar.
#[test]
fn levels_behind_a_pillar_in_a_room_are_those_behind_an_endless_one() {
    let mut tracer = tracer();
    let mut levels = |room: &str, [source, listener]: [&str; 2], radius: f64| -> [f64; 8] {
        let text = format!(
            "Scene(surfaces: [{room}Surface(shape: Cylinder(radius: {radius}))], \
             source: Source(position: {source}), listener: Listener(position: {listener}, radius: 0.05))"
        );
        let paths = response(&mut tracer, &text, true).paths;
        let unreflected = || {
            let all = paths.iter();
            all.filter(|path| path.kind == PathKind::Diffracted && path.reflections.is_empty())
        };
        std::array::from_fn(|band| {
            10.0 * unreflected()
                .map(|path| path.energy[band])
                .sum::<f64>()
                .log10()
        })
    };
    let room = "Surface(shape: Room(size: (60, 2.6, 60))), ";
    let places = [
        (1.0, ["(1.63, -0.2, -1.95)", "(-1.86, -0.87, 1.33)"]),
        (1.0, ["(2.08, -0.63, -0.14)", "(-4.33, -0.37, 0.53)"]),
        (0.4, ["(0.75, 0.39, -0.78)", "(-1.63, -0.3, 3.01)"]),
    ];
    for (radius, ends) in places {
        let [inside, endless] = [room, ""].map(|room| levels(room, ends, radius));
        for (inside, endless) in inside.iter().zip(endless) {
            assert!(
                (inside - endless).abs() < 0.1,
                "{radius} m: {inside} dB, {endless} dB"
            );
        }
    }
}

/// Protects reflections that bend within one body of rooms: a far object is not named as the obstacle, and faces absorb by
/// their own materials.
#[test]
fn bent_reflections_within_rooms_have_the_materials_of_their_faces() {
    let mut tracer = tracer();
    let mut paths = |materials: &str, object: &str| {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Rooms(of: [(from: (0, 0, 0), to: (6, 2.8, 3)), \
             (from: (0, 0, 3), to: (3, 2.8, 7))]), {materials}){object}], \
             materials: {{\"w\": Material(absorption: 0.4)}}, \
             source: Source(position: (4.5, 1.5, 1.4)), listener: Listener(position: (1.2, 1.6, 5.5), radius: 0.05))"
        );
        let paths = response(&mut tracer, &text, true).paths;
        let bent = paths
            .into_iter()
            .filter(|path| path.kind == PathKind::Diffracted);
        bent.map(|path| (path.path.surfaces.clone(), path.energy))
            .collect::<Vec<_>>()
    };
    let whole = paths("material: \"w\"", "");
    assert!(whole.len() > 1, "{whole:?}");
    assert_eq!(paths("faces: {\"1\": \"w\", \"2\": \"w\"}", ""), whole);
    let far = ", Surface(shape: Box(size: (0.3, 0.3, 0.3)), position: (5.5, 2.3, 0.4))";
    let names = |paths: &[(Vec<u32>, [f64; 8])]| -> Vec<Vec<u32>> {
        paths.iter().map(|(surfaces, _)| surfaces.clone()).collect()
    };
    assert_eq!(names(&paths("material: \"w\"", far)), names(&whole));
    let rigid = paths("material: \"concrete\"", "");
    let level = |paths: &[(Vec<u32>, [f64; 8])]| 10.0 * paths[1].1[4].log10();
    // The reflection alone takes 40 %: 2.2 dB.
    assert!(level(&rigid) > level(&whole) + 2.2, "{rigid:?} {whole:?}");
}

/// Places around a body: its radius in m, the distances of source and listener from its centre or axis in m, the angle
/// between them in degrees, and their distance along the axis in m.
type Around = (f64, f64, f64, f64, f64);

/// The errors in dB of the levels behind a body of a radius and an axis along z, where the exact level is above −35 dB.
fn errors_behind(
    tracer: &mut Tracer,
    shape: impl Fn(f64) -> String,
    exact: impl Fn(f64, f64, [f64; 3], [f64; 3]) -> Complex64,
    (places, highest_hz): (&[Around], f64),
) -> Vec<f64> {
    let mut errors = Vec::new();
    for &(radius, source_m, listener_m, between, along) in places {
        let (sine, cosine) = between.to_radians().sin_cos();
        let source = [source_m, 0.0, 0.0];
        let listener = [listener_m * cosine, listener_m * sine, along];
        let (kinds, levels) = heard(tracer, &shape(radius), [source, listener], true);
        assert!(!kinds.is_empty(), "{radius} m, {between}°");
        assert!(kinds.iter().all(|kind| *kind == PathKind::Diffracted));
        let bands = BANDS_HZ.into_iter().filter(|hz| *hz <= highest_hz);
        for (level, hz) in levels.into_iter().zip(bands) {
            let pressure = |hz: f64| exact(2.0 * PI * hz / SPEED, radius, source, listener);
            let exact = coarse_band_level_db(pressure, hz);
            if exact > -35.0 {
                errors.push(level - exact);
            }
        }
    }
    errors
}

/// Level of an octave band in dB, from nine frequencies: enough for two ways that differ by four wavelengths.
pub fn coarse_band_level_db(pressure: impl Fn(f64) -> Complex64, centre_hz: f64) -> f64 {
    let energy = |index: i32| pressure(centre_hz * 2_f64.powf(f64::from(index) / 9.0)).norm_sqr();
    10.0 * ((-4..=4).map(energy).sum::<f64>() / 9.0).log10()
}

fn assert_within(errors: &[f64], rms_db: f64, worst_db: f64) {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let rms = (squares / errors.len() as f64).sqrt();
    let worst = errors
        .iter()
        .fold(0.0_f64, |worst, error| worst.max(error.abs()));
    assert!(
        rms < rms_db && worst < worst_db,
        "{rms} dB, at most {worst} dB"
    );
}

/// Protects levels behind balls, near the axis, where all ways around have the same length, and beside it.
#[test]
fn levels_behind_balls_are_the_exact_ones() {
    let places = [
        (1.0, 3.0, 3.0, 180.0, 0.0),
        (1.0, 3.0, 3.0, 160.0, 0.0),
        (0.4, 2.0, 1.5, 170.0, 0.0),
        (2.1, 3.2, 4.5, 150.0, 0.0),
        (1.5, 2.2, 5.0, 135.0, 0.0),
    ];
    let shape = |radius: f64| format!("Sphere(radius: {radius})");
    let errors = errors_behind(&mut tracer(), shape, ball, (&places, 8e3));
    assert_within(&errors, 0.8, 2.5);
}

/// Protects levels behind cylinders up to 1 kHz (the exact solution takes long above): creeping waves, and the interference
/// of the ways on both sides.
#[test]
fn levels_behind_cylinders_are_the_exact_ones() {
    let places = [(0.5, 2.0, 2.5, 175.0, 0.0), (1.0, 2.5, 3.0, 150.0, 1.2)];
    let shape = |radius: f64| format!("Cylinder(radius: {radius}, height: 500, axis: (0, 0, 1))");
    let errors = errors_behind(&mut tracer(), shape, cylinder, (&places, 1e3));
    assert_within(&errors, 0.8, 2.0);
}

/// Protects the boundary of the shadow of a corner: steps of 1 cm change no band by more than 0.7 dB, and source and
/// listener may change places.
#[test]
fn levels_are_continuous_across_the_shadow_of_a_corner() {
    let mut tracer = tracer();
    let shape = "Prism(corners: [(0, 0), (-200, -200), (200, -200)], depth: 600)";
    let source = [-2.0, -1.0, 0.0];
    let mut last: Option<[f64; 8]> = None;
    for step in 0..40 {
        let listener = [2.5, 1.45 - 0.01 * f64::from(step), 0.4];
        let (kinds, levels) = heard(&mut tracer, shape, [source, listener], true);
        assert!(matches!(
            kinds[..],
            [PathKind::Direct | PathKind::Diffracted, ..]
        ));
        if let Some(last) = last {
            let steps = levels
                .iter()
                .zip(last)
                .map(|(level, last)| (level - last).abs());
            let most = steps.fold(0.0, f64::max);
            assert!(most < 0.7, "{most} dB at {listener:?}");
        }
        last = Some(levels);
    }
    let listener = [2.5, 0.6, 0.4];
    let (_, there) = heard(&mut tracer, shape, [source, listener], true);
    let (_, back) = heard(&mut tracer, shape, [listener, source], true);
    for (there, back) in there.into_iter().zip(back) {
        assert!((there - back).abs() < 0.1, "{there} and {back} dB");
    }
}

/// Protects the boundaries of the shadows of round bodies, at which the exact levels change by less than 0.1 dB in a step
/// of 1 cm: steps change no band by more than 1.2 dB behind a ball, and 0.5 dB behind an endless cylinder.
#[test]
fn levels_are_continuous_across_the_shadows_of_round_bodies() {
    let ball = "Sphere(radius: 1)";
    let cylinder = "Cylinder(radius: 0.5, height: 500, axis: (0, 0, 1))";
    let mut tracer = tracer();
    for (shape, from, most_db) in [(ball, 1.98, 1.2), (cylinder, -0.86, 0.5)] {
        let mut last: Option<[f64; 8]> = None;
        let mut all_kinds = Vec::new();
        for step in 0..14 {
            let listener = [2.5, from - 0.01 * f64::from(step), 0.3];
            let ends = [[-3.0, 0.0, 0.0], listener];
            let (kinds, levels) = heard(&mut tracer, shape, ends, true);
            all_kinds.extend(kinds);
            for (level, last) in levels.iter().zip(last.unwrap_or(levels)) {
                let step_db = (level - last).abs();
                assert!(step_db < most_db, "{shape}: {step_db} dB at {listener:?}");
            }
            last = Some(levels);
        }
        assert!(all_kinds.contains(&PathKind::Direct), "{shape}");
        assert!(all_kinds.contains(&PathKind::Diffracted), "{shape}");
    }
}

/// Protects walks past walls: steps of 1 cm across the boundary of the shadow of an end, a corner and the top of a wall of
/// 4 × 3 × 0.2 m, where the exact level changes slowly, change no band by more than 1.1 dB.
#[test]
fn levels_are_continuous_across_the_shadow_of_a_wall() {
    let wall = "Box(size: (4, 3, 0.2))";
    let mut tracer = tracer();
    let walks = [
        ([-1.5, -0.3, -3.0], [-2.6, -0.3, 3.0], [0.01, 0.0, 0.0]),
        ([-1.5, 1.0, -3.0], [-2.6, 1.61, 3.0], [0.01, 0.0, 0.0]),
        ([-0.5, 0.7, -3.0], [-0.1, 2.42, 3.0], [0.0, -0.01, 0.0]),
    ];
    for (source, from, by) in walks {
        let mut last: Option<[f64; 8]> = None;
        let mut all_kinds = Vec::new();
        for step in 0..14 {
            let listener = [0, 1, 2].map(|axis| from[axis] + by[axis] * f64::from(step));
            let (kinds, levels) = heard(&mut tracer, wall, [source, listener], true);
            all_kinds.extend(kinds);
            for (level, last) in levels.iter().zip(last.unwrap_or(levels)) {
                let step_db = (level - last).abs();
                assert!(step_db < 1.1, "{step_db} dB at {listener:?}");
            }
            last = Some(levels);
        }
        assert!(all_kinds.contains(&PathKind::Direct), "{from:?}");
        assert!(all_kinds.contains(&PathKind::Diffracted), "{from:?}");
    }
}

/// Protects walks past both jambs of a doorway with a lintel, and past the end of a wall on the ground, where the exact
/// levels change slowly: steps of 1 cm across the boundary of the shadow change the bands from 63 to 500 Hz by less than
/// 3.2 dB at the doorway, and 0.8 dB at the end of the wall.
#[test]
fn levels_are_continuous_across_the_shadows_of_a_doorway_and_on_the_ground() {
    let doorway = "Surface(shape: Box(size: (10, 3, 0.3)), position: (-5.45, 1.5, 0)), \
                   Surface(shape: Box(size: (10, 3, 0.3)), position: (5.45, 1.5, 0)), \
                   Surface(shape: Box(size: (0.9, 1, 0.3)), position: (0, 2.5, 0))";
    let wall =
        "Surface(shape: Plane), Surface(shape: Box(size: (4, 3, 0.2)), position: (2, 1.5, 0))";
    let walks = [
        (doorway, [1.2, 1.2, -2.0], [-1.88, 1.3, 2.0], 3.2),
        (doorway, [1.2, 1.2, -2.0], [-0.45, 1.3, 2.0], 3.2),
        (wall, [0.5, 1.2, -3.0], [-0.56, 1.2, 3.0], 0.8),
    ];
    let mut tracer = tracer();
    for (surfaces, source, [x, y, z], most_db) in walks {
        let mut last: Option<[f64; 8]> = None;
        let mut all_kinds = Vec::new();
        for step in 0..5 {
            let listener = [x + 0.01 * f64::from(step), y, z];
            let (kinds, levels) = heard_among(&mut tracer, surfaces, [source, listener], true);
            all_kinds.extend(kinds);
            for (level, last) in levels.iter().zip(last.unwrap_or(levels)).take(4) {
                let step_db = (level - last).abs();
                assert!(step_db < most_db, "{step_db} dB at {listener:?}");
            }
            last = Some(levels);
        }
        assert!(all_kinds.contains(&PathKind::Direct), "{x}");
        assert!(all_kinds.contains(&PathKind::Diffracted), "{x}");
    }
}

/// Protects results without diffraction: it is off by default.
#[test]
fn sound_does_not_bend_unless_it_is_asked_for() {
    assert!(!ResponseSettings::default().diffraction);
    let ends = [[-2.0, -0.5, 0.0], [2.0, -0.5, 0.0]];
    let shape = "Box(size: (0.1, 4, 40))";
    let (kinds, _) = heard(&mut tracer(), shape, ends, false);
    assert_eq!(kinds, []);
    let (kinds, _) = heard(&mut tracer(), shape, ends, true);
    assert!(kinds.contains(&PathKind::Diffracted), "{kinds:?}");
}

/// Protects the time that a response states for its diffraction: callers that limit the time for waves subtract it.
#[test]
fn responses_state_the_time_of_their_diffraction() {
    let text = "Scene(surfaces: [Surface(shape: Box(size: (0.1, 4, 40)))], \
                source: Source(position: (-2, -0.5, 0)), listener: Listener(position: (2, -0.5, 0), radius: 0.05))";
    let [without, with] =
        [false, true].map(|diffraction| response(&mut tracer(), text, diffraction));
    assert_eq!(without.diffraction_milliseconds, 0.0);
    assert!(with.diffraction_milliseconds > 0.0);
    assert!(with.diffraction_milliseconds < with.milliseconds);
}

/// The response of a scene.
pub fn response(tracer: &mut Tracer, text: &str, diffraction: bool) -> Response {
    let scene = Scene::from_ron(text, "test").expect("a scene");
    let settings = ResponseSettings::default()
        .with_seconds(0.4)
        .with_diffraction(diffraction)
        .with_trace(Settings::default().with_waves(4096));
    Response::trace(tracer, &scene, &settings).expect("a response")
}

/// Protects the four ways over a wall on the ground: without a reflection, with one on either side, and with both. Each
/// reflection costs the share that the ground absorbs.
#[test]
fn reflections_bend_over_a_wall_on_the_ground() {
    let scene = |absorption: f64| {
        format!(
            "Scene(materials: {{\"ground\": Material(absorption: {absorption})}}, \
             surfaces: [Surface(shape: Plane, material: \"ground\"), \
             Surface(shape: Box(size: (0.2, 3, 400)), position: (0, 1.5, 0))], \
             source: Source(position: (-5, 1, 0)), listener: Listener(position: (6, 1.5, 1), radius: 0.2))"
        )
    };
    let mut tracer = tracer();
    let [rigid, soft] = [0.0, 0.75].map(|share| response(&mut tracer, &scene(share), true).paths);
    let reflections = |path: &HeardPath| -> Vec<u32> {
        let surface = |point: &usize| path.path.surfaces[*point];
        path.reflections.iter().map(surface).collect()
    };
    let all: Vec<Vec<u32>> = rigid.iter().map(reflections).collect();
    assert_eq!(all, [vec![], vec![1], vec![1], vec![1, 1]]);
    for (rigid, soft) in rigid.iter().zip(&soft) {
        assert_eq!(rigid.kind, PathKind::Diffracted);
        let points = [&[DVec3::new(-5.0, 1.0, 0.0)], &rigid.path.points[..]].concat();
        let departure = (points[1] - points[0]).normalize();
        assert!(departure.distance(rigid.path.departure) < 1e-2, "{rigid:?}");
        let lost_db = 10.0 * (soft.energy[3] / rigid.energy[3]).log10();
        let expected_db = rigid.reflections.len() as f64 * 10.0 * 0.25_f64.log10();
        assert!((lost_db - expected_db).abs() < 1e-6, "{lost_db} dB");
    }
}

/// Protects the energy of a reflection that bends: its path replaces the waves that pass the obstacle and reach a part of
/// the listener's sphere. They are not in the echogram too.
#[test]
fn waves_of_a_reflection_that_bends_are_not_counted_twice() {
    // The reflection at the ground would pass the wall at a height of 0.1 m, and the highest of its waves 0.3 m higher.
    let text = "Scene(surfaces: [Surface(shape: Plane), \
                Surface(shape: Box(size: (0.01, 0.16, 400)), position: (0, 0.08, 0))], \
                source: Source(position: (-1.5, 1, 0)), listener: Listener(position: (1.5, 1.2, 0), radius: 0.6))";
    let mut tracer = tracer();
    let [without, with] = [false, true].map(|diffraction| response(&mut tracer, text, diffraction));
    let is_reflected = |path: &&HeardPath| path.reflections.len() == 1;
    assert_eq!(without.paths.iter().filter(is_reflected).count(), 0);
    assert!(without.echogram.total()[3] > 0.0);
    let mut bent = with.paths.iter().filter(is_reflected);
    assert!(bent.any(|path| path.kind == PathKind::Diffracted));
    assert_eq!(with.echogram.total(), [0.0; 8]);
}

/// Protects the time of responses in scenes with many faces: of 40 reflections that a ball hides, the 32 with the
/// shortest ways bend.
#[test]
fn the_shortest_hidden_reflections_bend() {
    const PANELS: u32 = 40;
    const BENT: u32 = 32;
    // Panels around the line from the source to the listener, each 2 cm farther from it than the one before.
    let panel = |index: u32| {
        let angle = f64::from(index) * 2.0 * PI / f64::from(PANELS);
        let distance = 5.05 + 0.02 * f64::from(index);
        let (y, z) = (distance * angle.cos(), distance * angle.sin());
        let degrees = angle.to_degrees();
        format!(
            "Surface(shape: Box(size: (2, 0.1, 0.6)), position: (0, {y}, {z}), rotation: ({degrees}, 0, 0))"
        )
    };
    let panels: Vec<String> = (0..PANELS).map(panel).collect();
    let text = format!(
        "Scene(surfaces: [Surface(shape: Sphere(radius: 1.58), position: (1.3, 0, 0)), {}], \
         source: Source(position: (-3, 0, 0)), listener: Listener(position: (3, 0, 0), radius: 0.05))",
        panels.join(", ")
    );
    let paths = response(&mut tracer(), &text, true).paths;
    let mut reflecting: Vec<u32> = paths
        .iter()
        .flat_map(|path| {
            path.reflections
                .iter()
                .map(|point| path.path.surfaces[*point])
        })
        .collect();
    reflecting.sort_unstable();
    reflecting.dedup();
    // The ball has the number 1.
    let nearest: Vec<u32> = (2..2 + BENT).collect();
    assert_eq!(reflecting, nearest);
}

/// Protects G outdoors with diffraction, beside the end of a wall and behind it: its error contains those of the edges. The
/// waves do not bend, and their difference from the bent paths must not count.
#[test]
fn strength_is_stated_beside_and_behind_the_end_of_a_wall() {
    let mut tracer = tracer();
    for (x, least_db, most_db) in [(2.0, 0.1, 1.0), (-2.5, 1.0, 2.5)] {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Plane), \
             Surface(shape: Box(size: (6, 2.5, 0.2)), position: (-3, 1.25, 0))], \
             source: Source(position: (0.8, 1.2, -4)), listener: Listener(position: ({x}, 1.5, 3), radius: 0.2))"
        );
        let scene = Scene::from_ron(&text, "wall").expect("a scene");
        let settings = ResponseSettings::default()
            .with_diffraction(true)
            .with_trace(Settings::default().with_waves(16_384));
        let response = Response::trace(&mut tracer, &scene, &settings).expect("a response");
        let figures = &response.figures;
        for (band, of_band) in figures.bands.iter().enumerate() {
            assert!(of_band.g_db.is_some(), "x = {x} m, band {band}");
        }
        let error_db = figures.errors[0].g_db.expect("an error");
        assert!(
            (least_db..most_db).contains(&error_db),
            "x = {x} m: {error_db} dB"
        );
    }
}
