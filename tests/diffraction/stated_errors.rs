//! The errors that diffracted paths state, against exact solutions at places drawn at random.

use crate::oracle::{Wedge, ball};
use crate::responses::{BANDS_HZ, SPEED, coarse_band_level_db};
use echomarch::Scene;
use echomarch::response::{HeardPath, diffracted};
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Level in dB, relative to the open, above which levels count.
const AUDIBLE_DB: f64 = -35.0;

/// Places of each kind of body.
const PLACES: usize = 60;

/// Numbers drawn by a linear congruential generator (Knuth's constants).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Whether the level of each audible band lies within the stated error of the exact one: `exact` is the pressure relative to
/// the open for a wave number.
fn hold(shape: &str, ends: [[f64; 3]; 2], exact: impl Fn(f64) -> Complex64) -> Vec<bool> {
    let [[sx, sy, sz], [lx, ly, lz]] = ends;
    let text = format!(
        "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: ({sx}, {sy}, {sz})), \
         listener: Listener(position: ({lx}, {ly}, {lz}), radius: 0.05))"
    );
    let scene = Scene::from_ron(&text, "place").expect("a scene");
    let (paths, _) = diffracted(&scene).expect("a valid scene");
    assert!(!paths.is_empty(), "{text}");
    let squared: f64 = (0..3)
        .map(|axis| (ends[0][axis] - ends[1][axis]).powi(2))
        .sum();
    let is_held = |band: usize| {
        let exact_db = coarse_band_level_db(|hz| exact(TAU * hz / SPEED), BANDS_HZ[band]);
        let energy: f64 = paths.iter().map(|path| path.energy[band]).sum();
        let level_db = 10.0 * (energy * 4.0 * PI * squared).log10();
        let stated = |path: &HeardPath| path.errors_db[band];
        let stated_db = paths.iter().map(stated).fold(0.0, f64::max);
        (exact_db > AUDIBLE_DB).then_some((level_db - exact_db).abs() <= stated_db)
    };
    (0..BANDS_HZ.len()).filter_map(is_held).collect()
}

fn assert_held(held: &[bool]) {
    let share = held.iter().filter(|is_held| **is_held).count() as f64 / held.len() as f64;
    assert!(share >= 0.95, "{share} of {} levels", held.len());
}

/// Protects the errors that paths behind wedges of 200° to 355° state: they contain 95 % of the true ones.
#[test]
fn stated_errors_behind_wedges_hold_the_exact_levels() {
    let mut random = Random(7);
    let mut held = Vec::new();
    for _ in 0..PLACES {
        let air = random.between(200.0, 355.0);
        let angles = [random.between(5.0, air - 190.0)];
        let angles = [angles[0], random.between(angles[0] + 182.0, air - 5.0)];
        let metres = [random.between(0.5, 4.0), random.between(0.5, 4.0)];
        let along = random.between(-2.0, 2.0);
        let half = (360.0 - air).to_radians() / 2.0;
        let (x, y) = (300.0 * half.sin(), -300.0 * half.cos());
        let shape = format!(
            "Prism(corners: [(0, 0), ({}, {y}), ({x}, {y})], depth: 600)",
            -x
        );
        let at = |end: usize, z: f64| {
            let angle = (angles[end] - 90.0).to_radians() + half;
            [metres[end] * angle.cos(), metres[end] * angle.sin(), z]
        };
        let wedge = Wedge {
            exterior_angle: air.to_radians(),
        };
        let [source, receiver] = angles.map(f64::to_radians);
        let exact = |k: f64| wedge.pressure(k, metres[0], source, metres[1], receiver, along);
        held.extend(hold(&shape, [at(0, 0.0), at(1, along)], exact));
    }
    assert_held(&held);
}

/// Protects the errors that paths behind balls of 0.3 to 2.5 m state.
#[test]
fn stated_errors_behind_balls_hold_the_exact_levels() {
    let mut random = Random(11);
    let mut held = Vec::new();
    for _ in 0..PLACES {
        let radius = random.between(0.3, 2.5);
        let metres = [(); 2].map(|()| 0.3 + radius * random.between(1.3, 4.0));
        // Beyond the boundary of the shadow.
        let boundary: f64 = metres.iter().map(|metres| (radius / metres).acos()).sum();
        let (sine, cosine) = random.between(boundary + 0.05, PI).sin_cos();
        let ends = [
            [metres[0], 0.0, 0.0],
            [metres[1] * cosine, metres[1] * sine, 0.0],
        ];
        let exact = |k: f64| ball(k, radius, ends[0], ends[1]);
        held.extend(hold(&format!("Sphere(radius: {radius})"), ends, exact));
    }
    assert_held(&held);
}
