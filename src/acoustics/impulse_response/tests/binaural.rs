//! Compares binaural responses with a head that is known exactly.

use super::*;
use crate::acoustics::hrir::tests::rigid_sphere::{self, grid, set, transfer};
use crate::sphere_directions::lattice;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Converts a direction from listener to world axes: the listener looks along −z, y is up.
fn world(listener: DVec3) -> DVec3 {
    DVec3::new(-listener.y, listener.z, -listener.x)
}

fn heard(taps: &[Tap], echogram: &Echogram, seed: u64) -> ImpulseResponse {
    let format = Format::Binaural(Arc::new(set(grid(30))));
    response(taps, echogram, format, seed)
}

/// The spectrum at a frequency, with time 0 at `seconds`.
fn spectrum(samples: &[f32], hertz: f64, seconds: f64) -> Complex<f64> {
    let term = |(index, sample): (usize, &f32)| {
        let turn = -TAU * hertz * (index as f64 / RATE_HZ - seconds);
        Complex::from_polar(f64::from(*sample), turn)
    };
    samples.iter().enumerate().map(term).sum()
}

/// Protects taps: the transfer function of each ear for a measured direction, at the tap's time and
/// level, with left and right not swapped.
#[test]
fn a_tap_goes_through_the_head() {
    for from in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::Z] {
        let seconds = 0.020_007;
        let made = heard(&[tap(seconds, ONE, world(from))], &empty(), 0);
        assert_eq!(made.channels().len(), 2);
        for (ear, samples) in made.channels().iter().enumerate() {
            let exact = transfer(from, ear);
            for bin in [1, 4, 10, 30, 60] {
                let hertz = bin as f64 * RATE_HZ / rigid_sphere::SAMPLES as f64;
                let found = spectrum(samples, hertz, seconds);
                let level = found.norm() / exact[bin].norm();
                assert!((level - 1.0).abs() < 0.01, "{from} {ear} {hertz}: {level}");
                // Time 0 of the set is 6 µs off the head's centre.
                let late = (exact[bin] / found).arg() / (TAU * hertz);
                let limit = if bin <= 10 { 15e-6 } else { f64::INFINITY };
                assert!(late.abs() < limit, "{from} {ear} {hertz}: {late}");
            }
        }
    }
}

/// Protects a set whose rate differs from the response's: level and time are unchanged.
#[test]
fn a_set_at_another_rate_is_resampled() {
    let resampled = set(grid(30)).at_rate(44_100).expect("a good rate");
    let arrival = [tap(0.02, ONE, world(DVec3::Y))];
    let other = response(&arrival, &empty(), Format::Binaural(Arc::new(resampled)), 0);
    let same = heard(&arrival, &empty(), 0);
    for (a, b) in other.channels().iter().zip(same.channels()) {
        for hertz in [500.0, 2e3, 8e3] {
            let off = spectrum(a, hertz, 0.02) / spectrum(b, hertz, 0.02) - 1.0;
            assert!(off.norm() < 0.01, "{hertz}: {off}");
        }
    }
}

/// Constant energy for a second, in equal parts from all of `from` (listener axes).
fn steady(from: &[DVec3]) -> Echogram {
    let mut echogram = empty();
    let energy = 1e-3 / from.len() as f64;
    for bin in 0..1000 {
        for direction in from {
            let seconds = (f64::from(bin) + 0.5) * 1e-3;
            let towards = -world(direction.normalize());
            echogram
                .add(0, seconds, &[energy; BAND_COUNT], towards)
                .unwrap();
        }
    }
    echogram
}

/// Energies of both ears and their product in an octave, for these directions: of the exact head.
fn expected(from: &[DVec3], band: usize) -> [f64; 3] {
    let centre = 62.5 * 2_f64.powi(band as i32);
    let bins = 1..rigid_sphere::SAMPLES / 2;
    let bins: Vec<usize> = bins
        .filter(|bin| {
            let hertz = *bin as f64 * RATE_HZ / rigid_sphere::SAMPLES as f64;
            (hertz / centre).log2().abs() < 0.5
        })
        .collect();
    let mut sums = [0.0; 3];
    for direction in from {
        let (left, right) = (transfer(*direction, 0), transfer(*direction, 1));
        for bin in &bins {
            sums[0] += left[*bin].norm_sqr();
            sums[1] += right[*bin].norm_sqr();
            sums[2] += (left[*bin] * right[*bin].conj()).re;
        }
    }
    sums.map(|sum| sum / (from.len() * bins.len()) as f64)
}

/// Protects the late part's levels at both ears and their coherence: from all around, and from one
/// side. An octave of 1 kHz has about 700 independent values in a second: its energy is within 4 %,
/// and four times that is allowed; from one side 1.6 dB are allowed, because three directions
/// represent it, and these differ in the head's shadow.
#[test]
fn noise_goes_through_the_head() {
    let around: Vec<DVec3> = lattice(200).collect();
    // Not exactly at the side: sound diffracted around a sphere meets behind it, in a spot that is
    // smaller than the distance between the noise's directions.
    let side = vec![DVec3::new(0.6, 0.7, 0.4)];
    for (from, limit, is_diffuse) in [(around, 0.16, true), (side, 0.45, false)] {
        let made = heard(&[], &steady(&from), 6);
        for band in [4, 5, 6, 7] {
            let ears: Vec<Vec<f64>> = made
                .channels()
                .iter()
                .map(|samples| filtered(samples, band, 0.5))
                .collect();
            let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let width_hz = 62.5 * 2_f64.powi(band as i32) * 0.5_f64.sqrt();
            // 1 s of 1 1/m² in total, at half the sampling rate.
            let unit = 4.0 * PI * width_hz / (RATE_HZ / 2.0);
            let [left, right, both] = expected(&from, band);
            for (found, expected) in [
                (sum(&ears[0], &ears[0]) / unit, left),
                (sum(&ears[1], &ears[1]) / unit, right),
            ] {
                let ratio = found / expected;
                assert!((ratio - 1.0).abs() < limit, "{band}: {ratio}");
            }
            // From one side the product's phase changes with the frequency, and with each of three
            // directions.
            if !is_diffuse {
                continue;
            }
            let level = (left * right).sqrt();
            let found = sum(&ears[0], &ears[1])
                / (sum(&ears[0], &ears[0]) * sum(&ears[1], &ears[1])).sqrt();
            assert!((found - both / level).abs() < limit, "{band}: {found}");
        }
    }
}

/// Protects that the seed determines the noise, reproducibly.
#[test]
fn the_seed_chooses_the_binaural_noise() {
    let echogram = steady(&[DVec3::X]);
    let made = |seed| heard(&[], &echogram, seed);
    assert!(made(1) == made(1));
    assert!(made(1) != made(2));
}
