//! The wedge against Macdonald's half plane and against its own symmetries.

use super::super::oracle::{
    SPEED_OF_SOUND, Wedge, band_level_db, half_plane, level_db, wave_number,
};
use rustfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Wave numbers in 1/m of the lowest, a middle and the highest octave band.
fn wave_numbers() -> [f64; 3] {
    [63.0, 1000.0, 8000.0].map(|frequency| wave_number(frequency, SPEED_OF_SOUND))
}

#[track_caller]
fn assert_near(found: Complex64, expected: Complex64, tolerance: f64) {
    assert!(
        (found - expected).norm() <= tolerance,
        "{found} for {expected}"
    );
}

/// Both solutions of the half plane share only the quadrature: lit, mirrored, shadowed, and on both sides of the two
/// shadow boundaries.
#[test]
fn a_wedge_of_360_degrees_is_macdonalds_half_plane() {
    let wedge = Wedge {
        exterior_angle: TAU,
    };
    for k in wave_numbers() {
        for theta_s in [0.0f64, 60.0, 150.0] {
            for theta_r in [0.0f64, 20.0, 119.0, 121.0, 239.0, 241.0, 300.0, 360.0] {
                let (theta_s, theta_r) = (theta_s.to_radians(), theta_r.to_radians());
                for z in [0.0, 1.5] {
                    let found = wedge.pressure(k, 2.0, theta_s, 3.1, theta_r, z);
                    assert_near(
                        found,
                        half_plane::pressure(k, 2.0, theta_s, 3.1, theta_r, z),
                        1e-11,
                    );
                }
            }
        }
    }
}

/// The jumps of the geometric and the diffracted field at a shadow boundary cancel.
#[test]
fn the_field_is_continuous_at_shadow_boundaries() {
    /// Angle in radians to the boundary, both ways.
    const ASIDE: f64 = 1e-8;
    for degrees in [200.0f64, 270.0, 330.0, 360.0] {
        let wedge = Wedge {
            exterior_angle: degrees.to_radians(),
        };
        let theta_s = 15f64.to_radians();
        for boundary in [PI - theta_s, PI + theta_s] {
            for k in wave_numbers() {
                let at = |theta_r| wedge.pressure(k, 2.0, theta_s, 3.0, theta_r, 0.7);
                let jump = wedge.geometric(k, 2.0, theta_s, 3.0, boundary - ASIDE, 0.7)
                    - wedge.geometric(k, 2.0, theta_s, 3.0, boundary + ASIDE, 0.7);
                assert!(
                    jump.norm() > 0.5,
                    "no shadow boundary at {boundary} rad of {degrees}°"
                );
                assert_near(at(boundary - ASIDE), at(boundary + ASIDE), 1e-5);
                assert_near(at(boundary), at(boundary + ASIDE), 1e-5);
            }
        }
    }
}

/// Source and receiver may change places, and so may the faces.
#[test]
fn the_wedge_is_reciprocal_and_symmetric() {
    let exterior_angle = 285f64.to_radians();
    let wedge = Wedge { exterior_angle };
    for k in wave_numbers() {
        for (theta_s, theta_r) in [(0.4, 1.1), (0.4, 3.3), (0.4, 4.9), (2.0, 4.9)] {
            let forth = wedge.pressure(k, 2.0, theta_s, 5.0, theta_r, 1.0);
            assert_near(
                wedge.pressure(k, 5.0, theta_r, 2.0, theta_s, -1.0),
                forth,
                1e-12,
            );
            let turned = wedge.pressure(
                k,
                2.0,
                exterior_angle - theta_s,
                5.0,
                exterior_angle - theta_r,
                1.0,
            );
            assert_near(turned, forth, 1e-12);
        }
    }
}

/// No edge: above a plane the field is the direct one and its mirror image's, and the diffracted field is 0.
#[test]
fn a_wedge_of_180_degrees_is_a_plane() {
    let wedge = Wedge { exterior_angle: PI };
    let (r_s, theta_s, r_r, theta_r, z) = (2.0, 0.5, 3.0, 2.2, 0.4);
    let way =
        |angle: f64| f64::sqrt(r_s * r_s + r_r * r_r + z * z - 2.0 * r_s * r_r * f64::cos(angle));
    let (direct, mirrored) = (way(theta_s - theta_r), way(theta_s + theta_r));
    for k in wave_numbers() {
        assert_near(
            wedge.diffracted(k, r_s, theta_s, r_r, theta_r, z),
            Complex64::ZERO,
            1e-15,
        );
        let expected = 1.0 + Complex64::from_polar(direct / mirrored, k * (mirrored - direct));
        assert_near(
            wedge.pressure(k, r_s, theta_s, r_r, theta_r, z),
            expected,
            1e-12,
        );
    }
}

/// In a right-angled corner of two walls three mirror images add, with no diffraction.
#[test]
fn a_wedge_of_90_degrees_has_three_mirror_images() {
    let wedge = Wedge {
        exterior_angle: PI / 2.0,
    };
    let (source, receiver) = ([2.0f64, 0.7f64], [0.9f64, 1.6f64]);
    let way = |x: f64, y: f64| (x * source[0] - receiver[0]).hypot(y * source[1] - receiver[1]);
    let (r_s, theta_s) = (source[0].hypot(source[1]), source[1].atan2(source[0]));
    let (r_r, theta_r) = (
        receiver[0].hypot(receiver[1]),
        receiver[1].atan2(receiver[0]),
    );
    let direct = way(1.0, 1.0);
    for k in wave_numbers() {
        let expected: Complex64 = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
            .iter()
            .map(|&(x, y)| way(x, y))
            .map(|length| Complex64::from_polar(direct / length, k * (length - direct)))
            .sum();
        assert_near(
            wedge.pressure(k, r_s, theta_s, r_r, theta_r, 0.0),
            expected,
            1e-11,
        );
    }
}

/// Levels of bands are means of energies over the logarithm of the frequency.
#[test]
fn the_level_of_a_band_is_the_mean_of_its_energies() {
    assert!(band_level_db(|_| Complex64::ONE, 1000.0).abs() < 1e-12);
    // The mean of (f/f₀)⁴ over the logarithm of the frequency from f₀/√2 to f₀√2 is (4 − 1/4)/(4 ln 2).
    let expected = 10.0 * (3.75 / 4f64.ln() / 2.0).log10();
    let found = band_level_db(
        |frequency| Complex64::from((frequency / 500.0).powi(2)),
        500.0,
    );
    assert!(
        (found - expected).abs() < 1e-12,
        "{found} dB for {expected} dB"
    );
    // Direct and mirrored field with fringes much narrower than the band: the sum of two energies.
    let two_ways =
        |frequency: f64| 1.0 + Complex64::from_polar(1.0, TAU * frequency * 2.0 / SPEED_OF_SOUND);
    assert!((band_level_db(two_ways, 2000.0) - level_db(2f64.sqrt().into())).abs() < 0.3);
}
