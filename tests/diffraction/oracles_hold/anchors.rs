//! Known values.

use super::super::oracle::{SPEED_OF_SOUND, Wedge, ball, level_db, wave_number};
use rustfft::num_complex::Complex64;

/// Octave band centres from 63 Hz to 8 kHz as single frequencies.
const OCTAVES: [f64; 8] = [63.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];

/// Compares each level in dB with `pressure` at its frequency, to half the last of `digits` decimals.
#[track_caller]
fn check(levels: &[f64], frequencies: &[f64], digits: i32, pressure: impl Fn(f64) -> Complex64) {
    assert_eq!(levels.len(), frequencies.len());
    for (&level, &frequency) in levels.iter().zip(frequencies) {
        let found = level_db(pressure(wave_number(frequency, SPEED_OF_SOUND)));
        let half_digit = 0.5 * 10f64.powi(-digits);
        assert!(
            (found - level).abs() <= half_digit,
            "{found} dB for {level} dB at {frequency} Hz"
        );
    }
}

/// A right-angled corner of a building, source and receiver out of sight of each other.
#[test]
fn right_angled_wedge() {
    let levels = [
        -2.664, -4.387, -6.474, -8.856, -11.503, -14.347, -17.299, -20.293,
    ];
    let wedge = Wedge {
        exterior_angle: 270f64.to_radians(),
    };
    let (theta_s, theta_r) = (30f64.to_radians(), 240f64.to_radians());
    check(&levels, &OCTAVES, 3, |k| {
        wedge.pressure(k, 2.0, theta_s, 3.0, theta_r, 0.0)
    });
}

/// A thin screen, source and receiver apart along the edge.
#[test]
fn half_plane() {
    let levels = [
        -6.043, -7.587, -9.437, -11.621, -14.146, -16.933, -19.865, -22.852,
    ];
    let wedge = Wedge {
        exterior_angle: 360f64.to_radians(),
    };
    let (theta_s, theta_r) = (60f64.to_radians(), 270f64.to_radians());
    check(&levels, &OCTAVES, 3, |k| {
        wedge.pressure(k, 2.0, theta_s, 3.0, theta_r, 1.0)
    });
}

/// The example of P. Calamia's thesis: the diffracted field alone, relative to the free field at 1 m.
#[test]
fn sharp_wedge() {
    let levels = [-19.0206, -23.8928, -32.6463];
    let wedge = Wedge {
        exterior_angle: 315f64.to_radians(),
    };
    let (theta_s, theta_r) = (45f64.to_radians(), 270f64.to_radians());
    let direct = (29.0 - 20.0 * (theta_s - theta_r).cos()).sqrt();
    check(&levels, &[10.0, 100.0, 1000.0], 4, |k| {
        wedge.diffracted(k, 2.0, theta_s, 5.0, theta_r, 0.0) / direct
    });
}

/// A ball, off the axis and on it, where the waves round it meet in phase (bright spot).
#[test]
fn rigid_ball() {
    let frequencies = &OCTAVES[1..7];
    let at = |degrees: f64| {
        [
            3.0 * degrees.to_radians().cos(),
            3.0 * degrees.to_radians().sin(),
            0.0,
        ]
    };
    let off = [-0.44, -4.83, -4.38, -6.31, -8.80, -12.02];
    check(&off, frequencies, 2, |k| {
        ball(k, 1.0, [3.0, 0.0, 0.0], at(160.0))
    });
    let on = [1.07, 1.66, 1.99, 1.90, 1.26, -0.10];
    check(&on, frequencies, 2, |k| {
        ball(k, 1.0, [3.0, 0.0, 0.0], at(180.0))
    });
}
