//! Sets of head-related impulse responses compared with exact responses of a rigid sphere.

use super::{Hrir, HrirError, HrirSet, MeasuredHrir};
use crate::sampling::lattice;
use glam::DVec3;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Radius of the head in metres.
pub(crate) const RADIUS_M: f64 = 0.0875;
/// Speed of sound in metres per second.
pub(crate) const SPEED: f64 = 343.0;

/// Number of samples of a response.
pub(crate) const SAMPLES: usize = 256;
/// Rate of a response, in hertz.
pub(crate) const RATE_HZ: u32 = 48_000;
/// Number of samples before sound would pass the head's centre without the head.
pub(crate) const BEFORE: f64 = 64.0;

/// Sound pressure on a rigid sphere relative to the pressure at its centre without the sphere, for a plane wave.
/// `cosine` is the cosine of the angle between the direction towards the source and the point on the surface, and `ka`
/// is the wave number × radius. The formula is equation 4 of R. O. Duda and W. L. Martens, JASA 104, 1998, for a source
/// infinitely far away. Time dependence is exp(+iωt).
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
        // The Legendre polynomials may be 0, so a bound without them decides when the series ends.
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

/// The response of one ear, faded out above 20 kHz so that it decays within [`SAMPLES`].
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

/// Protects the sphere's formula: equal pressure everywhere at low frequencies, twice the pressure on the near side at
/// high frequencies, and the values that the authors print.
#[test]
fn the_sphere_is_that_of_the_literature() {
    for cosine in [-1.0, 0.0, 1.0] {
        assert!((pressure(1e-3, cosine).norm() - 1.0).abs() < 2e-3);
    }
    assert!((pressure(40.0, 1.0).norm() - 2.0).abs() < 0.02);
    // The bright spot behind is louder than the shadow around it.
    assert!(pressure(10.0, -1.0).norm() > 1.3 * pressure(10.0, -0.8).norm());
    // Low frequencies: the path is 3/2 times as long as in free air (Kuhn 1977).
    let phase = pressure(0.05, 1.0).arg();
    assert!((phase / 0.05 - 1.5).abs() < 0.01, "{phase}");
}

/// The transfer function of a response at the frequencies of [`transfer`], relative to time 0 of the
/// set.
fn spectrum(hrir: &Hrir, rate_hz: f64) -> Vec<Complex<f64>> {
    let value = |bin: usize| {
        let turns = TAU * bin as f64 * f64::from(RATE_HZ) / SAMPLES as f64;
        let samples = hrir.samples.iter().enumerate();
        let term = |(index, sample): (usize, &f32)| {
            let seconds = index as f64 / rate_hz + hrir.delay_s;
            Complex::from_polar(f64::from(*sample), -turns * seconds)
        };
        samples.map(term).sum::<Complex<f64>>()
    };
    (0..=SAMPLES / 2).map(value).collect()
}

/// The delay of a set's time 0 relative to the head's centre, in seconds: from the phase at low
/// frequencies of a measured direction.
fn offset_s(set: &HrirSet) -> f64 {
    const BIN: usize = 4;
    let from = set.directions()[0];
    let found = spectrum(&set.pair(from)[0], set.rate_hz().into())[BIN];
    let phase = (found * transfer(from, 0)[BIN].conj()).arg();
    -phase / (TAU * BIN as f64 * f64::from(RATE_HZ) / SAMPLES as f64)
}

/// The error of a set relative to the sphere, over all directions and both ears, as a share of the
/// amplitude (rms) in a band of frequencies.
fn error(set: &HrirSet, band_hz: std::ops::Range<f64>) -> f64 {
    let offset = offset_s(set);
    let (mut off, mut all) = (0.0, 0.0);
    for from in lattice(60) {
        for (ear, hrir) in set.pair(from).iter().enumerate() {
            let exact = transfer(from, ear);
            for (bin, found) in spectrum(hrir, set.rate_hz().into()).iter().enumerate() {
                let hertz = bin as f64 * f64::from(RATE_HZ) / SAMPLES as f64;
                if band_hz.contains(&hertz) {
                    let found = found * Complex::from_polar(1.0, TAU * hertz * offset);
                    off += (found - exact[bin]).norm_sqr();
                    all += exact[bin].norm_sqr();
                }
            }
        }
    }
    f64::sqrt(off / all)
}

/// Protects the interpolation and its figures in `docs/acoustics.md`, compared with an exact head at directions between
/// measured directions.
#[test]
fn interpolated_responses_are_near_the_truth() {
    for (step, limits) in [(10, [0.009, 0.03, 0.06]), (15, [0.02, 0.06, 0.11])] {
        let set = set(grid(step));
        let bands = [0.0..1.5e3, 1.5e3..4e3, 4e3..8e3];
        for (band, limit) in bands.into_iter().zip(limits) {
            let found = error(&set, band.clone());
            assert!(found < limit, "{step}° {band:?}: {found}");
        }
        // Time 0 is the time at which sound passes the head's centre.
        assert!(offset_s(&set).abs() < 15e-6, "{}", offset_s(&set));
    }
}

/// Protects measured directions: their responses are returned unchanged.
#[test]
fn measured_directions_are_exact() {
    let set = set(lattice(40));
    let offset = offset_s(&set);
    for from in lattice(40) {
        for (ear, hrir) in set.pair(from).iter().enumerate() {
            let exact = transfer(from, ear);
            for (bin, found) in spectrum(hrir, RATE_HZ.into()).iter().enumerate() {
                let turn = TAU * bin as f64 * f64::from(RATE_HZ) / SAMPLES as f64 * offset;
                let exact = exact[bin] * fade(bin, exact.len());
                let off = (found * Complex::from_polar(1.0, turn) - exact).norm();
                // The offset is measured at one frequency: 0.1 µs corresponds to 1 % at 16 kHz.
                assert!(off < 0.02, "{from} {ear} {bin}: {off}");
            }
        }
    }
}

/// Protects conversion to other rates: levels and delays are unchanged.
#[test]
fn another_rate_changes_nothing_below_half_of_it() {
    let set = set(grid(30));
    for rate_hz in [44_100, 96_000] {
        let resampled = set.at_rate(rate_hz).expect("a good rate");
        assert_eq!(resampled.rate_hz(), rate_hz);
        for from in lattice(12) {
            let (before, after) = (set.pair(from), resampled.pair(from));
            for (before, after) in before.iter().zip(&after) {
                let (before, after) = (
                    spectrum(before, RATE_HZ.into()),
                    spectrum(after, rate_hz.into()),
                );
                for bin in 0..=SAMPLES * 18 / 48 {
                    let off = (before[bin] - after[bin]).norm();
                    assert!(off < 0.01 * before[bin].norm().max(0.1), "{bin}: {off}");
                }
            }
        }
    }
    assert_eq!(set.at_rate(100), Err(HrirError::BadRate { rate_hz: 100 }));
}

/// Protects the reuse of a pair, and vectors without a direction.
#[test]
fn a_pair_can_be_filled_again() {
    let set = set(lattice(20));
    let mut pair = <[Hrir; 2]>::default();
    for from in lattice(7) {
        set.pair_into(from * 3.0, &mut pair);
        assert!(pair == set.pair(from * 3.0));
    }
    assert!(set.pair(DVec3::ZERO) == set.pair(DVec3::X));
}

/// Protects delays in addition to samples, and a silent ear.
#[test]
fn delays_and_silent_ears_are_kept() {
    let click = |level: f32| {
        let mut samples = vec![0.0; 32];
        samples[8] = level;
        samples
    };
    let one = |from: DVec3, ears: [Vec<f32>; 2]| MeasuredHrir {
        from,
        ears,
        delays_s: [1e-3, 1.25e-3],
    };
    let all = vec![
        one(DVec3::Y, [click(1.0), click(0.0)]),
        one(DVec3::NEG_Y, [click(0.5), click(0.5)]),
    ];
    let set = HrirSet::new(48_000, all).expect("good measurements");
    let [left, right] = set.pair(DVec3::NEG_Y);
    assert!((right.delay_s - left.delay_s - 0.25e-3).abs() < 1e-12);
    let [left, right] = set.pair(DVec3::Y);
    assert!(right.samples.iter().all(|sample| *sample == 0.0));
    assert!((left.samples.iter().sum::<f32>() - 1.0).abs() < 1e-3);
    assert!(right.delay_s.is_finite());
}

/// Protects the refusal of measurements that are not a valid set.
#[test]
fn bad_measurements_are_refused() {
    let good = |from: DVec3| MeasuredHrir {
        from,
        ears: [vec![1.0; 4], vec![1.0; 4]],
        delays_s: [0.0; 2],
    };
    let refused = |change: &dyn Fn(&mut MeasuredHrir)| {
        let mut all = vec![good(DVec3::X), good(DVec3::Y)];
        change(&mut all[1]);
        HrirSet::new(48_000, all).expect_err("bad measurements")
    };
    assert_eq!(
        refused(&|m| m.ears[1].push(0.0)),
        HrirError::UnevenLength {
            index: 1,
            samples: 5,
            expected: 4
        }
    );
    let is_direction = |error| matches!(error, HrirError::BadDirection { index: 1, .. });
    assert!(is_direction(refused(&|m| m.from = DVec3::ZERO)));
    assert!(is_direction(refused(&|m| m.from.x = f64::NAN)));
    let is_sample = |error| matches!(error, HrirError::BadSample { index: 1, .. });
    assert!(is_sample(refused(&|m| m.ears[0][2] = f32::INFINITY)));
    assert!(is_sample(refused(&|m| m.ears[0][2] = -2e6)));
    let is_delay = |error| matches!(error, HrirError::BadDelay { index: 1, .. });
    assert!(is_delay(refused(&|m| m.delays_s[0] = f64::NAN)));
    assert!(is_delay(refused(&|m| m.delays_s[1] = -0.2)));
    assert_eq!(
        HrirSet::new(48_000, Vec::new()),
        Err(HrirError::BadCount { count: 0 })
    );
    let rate_hz = 1_000_000;
    assert_eq!(
        HrirSet::new(rate_hz, vec![good(DVec3::X)]),
        Err(HrirError::BadRate { rate_hz })
    );
    let mut silent = good(DVec3::X);
    silent.ears = [vec![0.0; 4], vec![0.0; 4]];
    assert_eq!(HrirSet::new(48_000, vec![silent]), Err(HrirError::Silent));
}
