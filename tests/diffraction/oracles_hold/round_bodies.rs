//! Ball and cylinder against limits, and against what holds for every rigid body.

use super::super::oracle::{
    SPEED_OF_SOUND, ball, cylinder, cylinder_line_source, level_db, wave_number,
};
use rustfft::num_complex::Complex64;

/// Wave numbers in 1/m of the lowest, a middle and the highest octave band.
fn wave_numbers() -> [f64; 3] {
    [63.0, 1000.0, 4000.0].map(|frequency| wave_number(frequency, SPEED_OF_SOUND))
}

#[track_caller]
fn assert_near(found: Complex64, expected: Complex64, tolerance: f64) {
    assert!(
        (found - expected).norm() <= tolerance,
        "{found} for {expected}"
    );
}

/// Direct and mirrored field above the plane z = 0, relative to the direct one.
fn above_plane(k: f64, source: [f64; 3], receiver: [f64; 3]) -> Complex64 {
    let across = (source[0] - receiver[0]).hypot(source[1] - receiver[1]);
    let (direct, mirrored) = (
        across.hypot(source[2] - receiver[2]),
        across.hypot(source[2] + receiver[2]),
    );
    1.0 + Complex64::from_polar(direct / mirrored, k * (mirrored - direct))
}

/// Free field of a point source, e^{ikR}/R.
fn free(k: f64, source: [f64; 3], receiver: [f64; 3]) -> Complex64 {
    let away = (receiver[0] - source[0])
        .hypot(receiver[1] - source[1])
        .hypot(receiver[2] - source[2]);
    Complex64::from_polar(1.0 / away, k * away)
}

/// Derivative of `pressure` with respect to k times the height above the surface, on the surface.
fn normal_derivative(k: f64, pressure: impl Fn(f64) -> Complex64) -> f64 {
    /// k times the step: the error of the one-sided difference of second order is some 1e-6 where the body is as large
    /// as the wavelength.
    const STEP: f64 = 1e-3;
    let values = [0.0, 1.0, 2.0].map(|steps| pressure(steps * STEP / k));
    ((-3.0 * values[0] + 4.0 * values[1] - values[2]) / (2.0 * STEP)).norm()
}

/// No air moves through a rigid surface, in the light and in the shadow.
#[test]
fn the_normal_derivative_is_zero_on_the_surface() {
    let source = [2.5, 0.0, 0.3];
    for k in wave_numbers() {
        for degrees in [10.0f64, 170.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let on_ball = normal_derivative(k, |height| {
                let receiver = [(1.0 + height) * cos, (1.0 + height) * sin, 0.0];
                ball(k, 1.0, source, receiver) * free(k, source, receiver)
            });
            let on_cylinder = normal_derivative(k, |height| {
                let receiver = [(1.0 + height) * cos, (1.0 + height) * sin, 1.0];
                cylinder(k, 1.0, source, receiver) * free(k, source, receiver)
            });
            assert!(on_ball < 1e-5, "{on_ball} on the ball, {degrees}°, k = {k}");
            assert!(
                on_cylinder < 1e-5,
                "{on_cylinder} on the cylinder, {degrees}°, k = {k}"
            );
        }
    }
}

/// Source and receiver may change places.
#[test]
fn round_bodies_are_reciprocal() {
    let (a, b) = ([2.5, 0.2, 0.3], [-1.4, 0.7, 1.9]);
    for k in wave_numbers() {
        assert_near(ball(k, 1.0, a, b), ball(k, 1.0, b, a), 1e-12);
        assert_near(cylinder(k, 1.0, a, b), cylinder(k, 1.0, b, a), 1e-12);
    }
}

/// A body much smaller than the wavelength is not there.
#[test]
fn thin_bodies_leave_the_free_field() {
    let (source, receiver) = ([2.0, 0.5, 0.3], [-2.0, 0.3, 1.0]);
    for k in wave_numbers() {
        assert_near(ball(k, 1e-4, source, receiver), Complex64::ONE, 1e-9);
        assert_near(cylinder(k, 1e-4, source, receiver), Complex64::ONE, 1e-5);
    }
}

/// Close to a round body much larger than the distances, the field is that above a plane, except for a term that falls
/// as one over the radius.
#[test]
fn large_bodies_are_planes() {
    const RADIUS: f64 = 20.0;
    let (source, receiver) = ([0.0, 0.0, 1.0], [0.4, 0.3, 1.7]);
    let k = wave_number(250.0, SPEED_OF_SOUND);
    let plane = above_plane(k, source, receiver);
    let above = |[x, y, z]: [f64; 3], a: f64| [x, y, z + a];
    let beside = |[x, y, z]: [f64; 3], a: f64| [z + a, x, y];
    let of_ball = |a: f64| ball(k, a, above(source, a), above(receiver, a));
    let of_cylinder = |a: f64| cylinder(k, a, beside(source, a), beside(receiver, a));
    for pressure in [&of_ball as &dyn Fn(f64) -> Complex64, &of_cylinder] {
        let (near, far) = (pressure(RADIUS), pressure(2.0 * RADIUS));
        assert_near(far, plane, 0.02);
        assert_near(2.0 * far - near, plane, 1e-3);
    }
}

/// Many wavelengths away the waves of a point source meet a cylinder as those of a line source do, in the shadow and
/// beside it.
#[test]
fn a_distant_point_source_at_a_cylinder_is_a_line_source() {
    const DISTANCE: f64 = 30.0;
    for k in wave_numbers() {
        for y in [0.0, 1.0, 3.0] {
            let point = level_db(cylinder(k, 0.5, [DISTANCE, 0.0, 0.0], [-DISTANCE, y, 0.0]));
            let line = level_db(cylinder_line_source(
                k,
                0.5,
                [DISTANCE, 0.0],
                [-DISTANCE, y],
            ));
            assert!(
                (point - line).abs() < 0.01,
                "{point} dB, line source {line} dB, k = {k}"
            );
        }
    }
}
