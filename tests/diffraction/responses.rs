//! Diffracted paths of responses against the exact solution.

use crate::oracle::Wedge;
use echomarch::gl::Context;
use echomarch::response::{PathKind, Response, ResponseSettings};
use echomarch::{Scene, Settings, Tracer};
use std::f64::consts::PI;

const BANDS_HZ: [f64; 8] = [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3];
const SPEED: f64 = 343.0;

fn tracer() -> Tracer {
    let context = Context::headless(&Default::default()).expect("a context");
    Tracer::new(&context).expect("a tracer")
}

/// The paths of a shape between two places: their kinds, and the sum of their energies relative to the open, in dB.
fn heard(
    tracer: &mut Tracer,
    shape: &str,
    [source, listener]: [[f64; 3]; 2],
    diffraction: bool,
) -> (Vec<PathKind>, [f64; 8]) {
    let [[sx, sy, sz], [lx, ly, lz]] = [source, listener];
    let text = format!(
        "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: ({sx}, {sy}, {sz})), \
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

/// Protects what the method does not know: a round body has no edge, so that it gives no path of a wrong level.
#[test]
fn round_bodies_give_no_diffracted_path() {
    let ends = [[-3.0, 0.1, 0.2], [2.5, -0.1, 0.0]];
    let (kinds, _) = heard(&mut tracer(), "Sphere(radius: 1)", ends, true);
    assert_eq!(kinds, []);
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
