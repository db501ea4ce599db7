//! A head without ears: a rigid sphere, computed exactly.

use crate::acoustics::hrir::{HrirSet, MeasuredHrir};
use glam::DVec3;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Radius of the head in metres, and speed of sound in metres a second.
pub(crate) const RADIUS_M: f64 = 0.0875;
pub(crate) const SPEED: f64 = 343.0;

/// Samples of a response, its rate in hertz, and samples before sound would pass the centre.
pub(crate) const SAMPLES: usize = 256;
pub(crate) const RATE_HZ: u32 = 48_000;
pub(crate) const BEFORE: f64 = 64.0;

/// Sound pressure on a rigid sphere relative to that at its centre without it, for a plane wave
/// whose direction is at an angle with this cosine from the point on the surface (R. O. Duda and W.
/// L. Martens, JASA 104, 1998, equation 4 for a source infinitely far away): `ka` is the wave
/// number × radius. Time dependence is exp(+iωt).
fn pressure(ka: f64, cosine: f64) -> Complex<f64> {
    if ka == 0.0 {
        return Complex::new(1.0, 0.0);
    }
    // Spherical Hankel functions of the first kind by upward recurrence, which is stable.
    let i = Complex::<f64>::i();
    let (sin, cos) = ka.sin_cos();
    let mut before = Complex::new(sin / ka, -cos / ka);
    let mut here = Complex::new(sin / (ka * ka) - cos / ka, -cos / (ka * ka) - sin / ka);
    let (mut legendre_before, mut legendre) = (1.0, cosine);
    // The derivative of order 0 is −h₁. Orders have the factor (−i)^(m − 1).
    let mut sum: Complex<f64> = i / (-here);
    let mut turn = Complex::new(1.0, 0.0);
    let mut order = 1.0;
    loop {
        let derivative = before - here * ((order + 1.0) / ka);
        let term = turn * ((2.0 * order + 1.0) * legendre) / derivative;
        sum += term;
        // Legendre polynomials may be 0: the bound without them ends the series.
        if (2.0 * order + 1.0) / derivative.norm() < 1e-9 && order > ka {
            return (sum / (ka * ka)).conj();
        }
        (before, here) = (here, here * ((2.0 * order + 1.0) / ka) - before);
        (legendre_before, legendre) = (
            legendre,
            ((2.0 * order + 1.0) * cosine * legendre - order * legendre_before) / (order + 1.0),
        );
        turn *= -i;
        order += 1.0;
    }
}

/// The transfer function to the left (0) or right (1) ear of sound from a direction, at each
/// frequency of a transform of [`SAMPLES`]; without the delay [`BEFORE`].
pub(crate) fn transfer(from: DVec3, ear: usize) -> Vec<Complex<f64>> {
    let towards = [DVec3::Y, DVec3::NEG_Y][ear];
    let cosine = from.normalize().dot(towards);
    let value = |bin: usize| {
        let frequency = bin as f64 * f64::from(RATE_HZ) / SAMPLES as f64;
        pressure(TAU * frequency * RADIUS_M / SPEED, cosine)
    };
    (0..=SAMPLES / 2).map(value).collect()
}

/// The response of one ear: faded out above 20 kHz, so that it is finite.
fn response(from: DVec3, ear: usize) -> Vec<f32> {
    let mut spectrum = transfer(from, ear);
    let count = spectrum.len();
    for (bin, value) in spectrum.iter_mut().enumerate() {
        let turn = -TAU * bin as f64 * BEFORE / SAMPLES as f64;
        *value *= Complex::from_polar(fade(bin, count) / SAMPLES as f64, turn);
    }
    for end in [0, count - 1] {
        spectrum[end].im = 0.0;
    }
    let inverse = RealFftPlanner::new().plan_fft_inverse(SAMPLES);
    let mut samples = inverse.make_output_vec();
    inverse
        .process(&mut spectrum, &mut samples)
        .expect("a real signal");
    samples.into_iter().map(|sample| sample as f32).collect()
}

/// The gain at a frequency of the spectrum: 1 up to 20 kHz, 0 at 24 kHz.
pub(crate) fn fade(bin: usize, count: usize) -> f64 {
    let place = (bin as f64 / (count - 1) as f64 * 24.0 - 20.0) / 4.0;
    0.5 + 0.5 * (std::f64::consts::PI * place.clamp(0.0, 1.0)).cos()
}

pub(crate) fn measured(from: DVec3) -> MeasuredHrir {
    MeasuredHrir {
        from,
        ears: [response(from, 0), response(from, 1)],
        delays_s: [0.0; 2],
    }
}

/// A set with these directions.
pub(crate) fn set(directions: impl IntoIterator<Item = DVec3>) -> HrirSet {
    let all = directions.into_iter().map(measured).collect();
    HrirSet::new(RATE_HZ, all).expect("good measurements")
}

/// Directions every `step_deg` degrees of azimuth and elevation.
pub(crate) fn grid(step_deg: usize) -> Vec<DVec3> {
    let mut all = vec![DVec3::Z, DVec3::NEG_Z];
    for elevation in (step_deg..180).step_by(step_deg) {
        for azimuth in (0..360).step_by(step_deg) {
            let (flat, up) = (elevation as f64).to_radians().sin_cos();
            let (left, ahead) = (azimuth as f64).to_radians().sin_cos();
            all.push(DVec3::new(flat * ahead, flat * left, up));
        }
    }
    all
}

/// Protects the sphere: equal pressure everywhere at low frequencies, twice the pressure on the
/// near side at high ones, and the values that the authors print.
#[test]
fn the_sphere_is_that_of_the_literature() {
    for cosine in [-1.0, 0.0, 1.0] {
        assert!((pressure(1e-3, cosine).norm() - 1.0).abs() < 2e-3);
    }
    assert!((pressure(40.0, 1.0).norm() - 2.0).abs() < 0.02);
    // The bright spot behind is louder than the shadow around it.
    assert!(pressure(10.0, -1.0).norm() > 1.3 * pressure(10.0, -0.8).norm());
    // Low frequencies: 3/2 times as far as in free air (Kuhn 1977).
    let phase = pressure(0.05, 1.0).arg();
    assert!((phase / 0.05 - 1.5).abs() < 0.01, "{phase}");
}
