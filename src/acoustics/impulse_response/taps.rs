//! Taps at times between samples: windowed sinc functions.

use std::f64::consts::PI;

/// Number of samples that a tap extends to both sides. With this window it is flat up to 0.45 of
/// the sampling rate: 21.6 kHz at 48 kHz.
const REACH: i64 = 32;

/// The furthest position of an impulse, in samples: 165 years at 192 kHz, after the end of every response. Positions
/// beyond would not fit into 64 bits.
const FURTHEST: f64 = 1e15;

/// An impulse at a time in samples, not necessarily a whole number: a sinc function with a Blackman
/// window (R. B. Blackman and J. W. Tukey, 1958). Returns the index of its first sample, and its
/// samples.
pub(super) fn impulse(place: f64) -> (i64, impl Iterator<Item = f64>) {
    let place = place.clamp(-FURTHEST, FURTHEST);
    let nearest = place.round() as i64;
    let samples =
        (-REACH..=REACH).map(move |offset| windowed_sinc((nearest + offset) as f64 - place));
    (nearest - REACH, samples)
}

/// Adds an impulse of this amplitude at a time in samples.
///
/// Samples before the first or after the last are lost.
pub(super) fn add(samples: &mut [f64], place: f64, amplitude: f64) {
    let (first, impulse) = impulse(place);
    for (index, value) in (first..).zip(impulse) {
        let sample = usize::try_from(index)
            .ok()
            .and_then(|index| samples.get_mut(index));
        if let Some(sample) = sample {
            *sample += amplitude * value;
        }
    }
}

fn windowed_sinc(offset: f64) -> f64 {
    let turn = PI * offset;
    let edge = PI * offset / (REACH as f64 + 0.5);
    let window = 0.42 + 0.5 * edge.cos() + 0.08 * (2.0 * edge).cos();
    if turn == 0.0 {
        1.0
    } else {
        window * turn.sin() / turn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects a tap at a whole sample from being smeared: it is that sample alone.
    #[test]
    fn a_tap_at_a_sample_is_one_sample() {
        let mut samples = vec![0.0; 128];
        add(&mut samples, 50.0, 0.5);
        for (index, sample) in samples.iter().enumerate() {
            let expected = if index == 50 { 0.5 } else { 0.0 };
            assert!((sample - expected).abs() < 1e-15);
        }
    }

    /// Protects phase and amplitude of a tap between samples, up to 0.4 of the sampling rate: its
    /// spectrum is that of a pure delay.
    #[test]
    fn a_tap_between_samples_is_a_pure_delay() {
        let place = 60.37;
        let mut samples = vec![0.0; 128];
        add(&mut samples, place, 1.0);
        for step in 0..=40 {
            let turns = f64::from(step) * 0.01;
            let at = |(index, sample): (usize, &f64)| {
                let (sin, cos) = (2.0 * PI * turns * (index as f64 - place)).sin_cos();
                (sample * cos, sample * sin)
            };
            let sums = samples.iter().enumerate().map(at);
            let (real, imaginary) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            // Blackman's window ripples by at most 2 in 10,000.
            assert!((real - 1.0).abs() < 3e-4, "{turns}: {real}");
            assert!(imaginary.abs() < 3e-4, "{turns}: {imaginary}");
        }
    }

    /// Protects the ends of the response.
    #[test]
    fn what_lies_outside_is_lost() {
        let mut samples = vec![0.0; 8];
        add(&mut samples, -100.0, 1.0);
        add(&mut samples, 1e9, 1.0);
        add(&mut samples, 1e300, 1.0);
        assert_eq!(samples, vec![0.0; 8]);
    }
}
