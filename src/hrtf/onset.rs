//! Finds the onset of head-related impulse responses, and moves them to a common onset.
//!
//! The onset is the delay at which a response is most similar to its own minimum-phase version (J. Nam, J. S. Abel and
//! J. O. Smith, *A Method for Estimating Interaural Time Difference for Binaural Synthesis*, AES 125, 2008). It is the
//! maximum of the cross-correlation of the two, interpolated between samples. Unlike an onset found by a threshold, it
//! does not jump from one peak to another in the head's shadow.

use super::{Hrir, MARGIN, MeasuredHrir};
use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Lower limit of magnitudes as a share of the largest, −100 dB: a logarithm needs a limit, and no
/// measurement has a larger dynamic range.
const FLOOR: f64 = 1e-5;

/// Ratio of the spectrum's length to the response's: large enough that the cepstrum hardly wraps
/// around.
const PADDING: usize = 4;

/// Number of points per sample at which the cross-correlation is evaluated; a parabola interpolates between the points.
const OVERSAMPLING: usize = 8;

type Forward = Arc<dyn RealToComplex<f64>>;
type Inverse = Arc<dyn ComplexToReal<f64>>;

/// Finds onsets of responses of a given length.
struct OnsetFinder {
    length: usize,
    forward: Forward,
    inverse: Inverse,
    fine: Inverse,
}

impl OnsetFinder {
    /// A finder for responses of `samples` samples.
    fn new(samples: usize) -> OnsetFinder {
        let length = (PADDING * samples).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        OnsetFinder {
            length,
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
            fine: planner.plan_fft_inverse(OVERSAMPLING * length),
        }
    }

    /// The onset in samples, which may be slightly before the first sample; `None` for silence.
    fn find(&self, samples: &[f32]) -> Option<f64> {
        let spectrum = transform(
            &self.forward,
            samples.iter().map(|sample| f64::from(*sample)),
        );
        let largest = spectrum
            .iter()
            .map(|value| value.norm())
            .fold(0.0, f64::max);
        if largest <= 0.0 {
            return None;
        }
        let minimum_phase = self.minimum_phase(&spectrum, FLOOR * largest);
        let mut cross = self.fine.make_input_vec();
        for ((cross, a), b) in cross.iter_mut().zip(&spectrum).zip(&minimum_phase) {
            *cross = a * b.conj();
        }
        // The bin of the highest frequency is in the middle of the longer spectrum, where it must be halved.
        cross[self.length / 2] *= 0.5;
        let mut correlation = self.fine.make_output_vec();
        transform_back(&self.fine, &mut cross, &mut correlation);
        Some(peak(&correlation) / OVERSAMPLING as f64)
    }

    /// The minimum-phase spectrum with the magnitudes of `spectrum`: its cepstrum is 0 before time 0 (A. V. Oppenheim
    /// and R. W. Schafer, *Discrete-Time Signal Processing*, chapter 13).
    fn minimum_phase(&self, spectrum: &[Complex<f64>], floor: f64) -> Vec<Complex<f64>> {
        let log = |value: &Complex<f64>| Complex::new(value.norm().max(floor).ln(), 0.0);
        let mut logarithm: Vec<Complex<f64>> = spectrum.iter().map(log).collect();
        let mut cepstrum = self.inverse.make_output_vec();
        transform_back(&self.inverse, &mut logarithm, &mut cepstrum);
        let (scale, half) = (1.0 / self.length as f64, self.length / 2);
        let folded = cepstrum.iter().enumerate().map(|(index, value)| {
            let share = match index {
                0 => 1.0,
                index if index < half => 2.0,
                index if index == half => 1.0,
                _ => 0.0,
            };
            share * scale * value
        });
        let mut spectrum = transform(&self.forward, folded);
        for value in &mut spectrum {
            *value = value.exp();
        }
        spectrum
    }
}

/// Shifts responses by any number of samples, integer or fractional. Below half the sampling rate the shift is exact.
struct Mover {
    samples: usize,
    length: usize,
    forward: Forward,
    inverse: Inverse,
}

impl Mover {
    /// Creates a mover for responses of `samples` samples.
    fn new(samples: usize) -> Mover {
        // Twice the length: after a shift by a fraction of a sample, the ends decay as 1/t and wrap around.
        let length = (2 * samples).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        Mover {
            samples,
            length,
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
        }
    }

    /// Returns the response delayed by `by` samples.
    fn later(&self, response: &[f32], by: f64) -> Vec<f32> {
        let response = response.iter().map(|sample| f64::from(*sample));
        let mut spectrum = transform(&self.forward, response);
        let scale = 1.0 / self.length as f64;
        for (index, value) in spectrum.iter_mut().enumerate() {
            let turn = -TAU * by * index as f64 / self.length as f64;
            *value *= Complex::from_polar(scale, turn);
        }
        let mut moved = self.inverse.make_output_vec();
        transform_back(&self.inverse, &mut spectrum, &mut moved);
        let kept = moved.iter().take(self.samples);
        kept.map(|sample| *sample as f32).collect()
    }
}

/// The spectrum of the samples, padded with zeros.
fn transform(plan: &Forward, samples: impl Iterator<Item = f64>) -> Vec<Complex<f64>> {
    let mut padded = plan.make_input_vec();
    for (padded, sample) in padded.iter_mut().zip(samples) {
        *padded = sample;
    }
    let mut spectrum = plan.make_output_vec();
    let done = plan.process(&mut padded, &mut spectrum);
    debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
    spectrum
}

/// The inverse transform. The spectrum of a real signal is real at both ends.
fn transform_back(plan: &Inverse, spectrum: &mut [Complex<f64>], out: &mut [f64]) {
    for end in [0, spectrum.len() - 1] {
        spectrum[end].im = 0.0;
    }
    let done = plan.process(spectrum, out);
    debug_assert!(done.is_ok(), "the spectrum is that of a real signal");
}

/// Position of a periodic function's maximum, interpolated between samples by a parabola. Positions in the second half
/// of the period count as negative.
fn peak(values: &[f64]) -> f64 {
    let count = values.len();
    let greatest = (0..count).max_by(|a, b| values[*a].total_cmp(&values[*b]));
    let at = greatest.unwrap_or(0);
    let (before, here, after) = (
        values[(at + count - 1) % count],
        values[at],
        values[(at + 1) % count],
    );
    let bend = before - 2.0 * here + after;
    let offset = if bend < 0.0 {
        0.5 * (before - after) / bend
    } else {
        0.0
    };
    let place = at as f64 + offset;
    if at > count / 2 {
        place - count as f64
    } else {
        place
    }
}

/// Responses with a common onset.
pub(super) struct Aligned {
    /// The responses of the left and of the right ear.
    pub(super) pairs: Vec<[Hrir; 2]>,
    /// The common onset, in seconds after the first sample of the responses.
    pub(super) onset_s: f64,
}

/// Removes the onsets: afterwards all responses begin at the same sample, and every sample of a measurement is kept.
/// `None` if all responses are silent.
pub(super) fn aligned(measured: &[&MeasuredHrir], samples: usize, rate_hz: u32) -> Option<Aligned> {
    let finder = OnsetFinder::new(samples);
    // An onset lies within the response. A result beyond its ends is a rounding error.
    let onset = |ear: &Vec<f32>| Some(finder.find(ear)?.clamp(0.0, samples as f64));
    let found: Vec<[Option<f64>; 2]> = measured
        .par_iter()
        .map(|measured| measured.ears.each_ref().map(onset))
        .collect();
    let known = || found.iter().flatten().flatten().copied();
    let (earliest, latest) = (known().reduce(f64::min)?, known().reduce(f64::max)?);
    // Silence has no onset. It gets the mean of the other onsets, which does not disturb the delays of neighbouring
    // directions.
    let middle = known().sum::<f64>() / known().count() as f64;
    let mover = Mover::new(samples + (latest - earliest).ceil() as usize + 2 * MARGIN);
    let (rate, place) = (f64::from(rate_hz), MARGIN as f64 + latest);
    let pair = |(measured, found): (&&MeasuredHrir, &[Option<f64>; 2])| {
        std::array::from_fn(|ear| {
            let later = place - found[ear].unwrap_or(middle);
            Hrir {
                samples: mover.later(&measured.ears[ear], later),
                delay_s: measured.delays_s[ear] - later / rate,
            }
        })
    };
    Some(Aligned {
        pairs: measured.par_iter().zip(&found).map(pair).collect(),
        onset_s: place / rate,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minimum-phase response with two poles and a zero, `delay` samples late.
    fn late(delay: usize) -> Vec<f32> {
        let mut samples = vec![0.0_f32; 256];
        samples[delay] = 1.0;
        samples[delay + 1] = -0.4;
        for index in delay + 1..256 {
            let before = samples[index - 1];
            let earlier = index.checked_sub(2).map_or(0.0, |at| samples[at]);
            samples[index] += 1.1 * before - 0.5 * earlier;
        }
        samples
    }

    /// Protects the onset: for a delayed minimum-phase response it equals the delay, also between samples and at any
    /// level.
    #[test]
    fn the_onset_is_the_delay() {
        let finder = OnsetFinder::new(256);
        for delay in [0, 1, 17, 90] {
            let found = finder.find(&late(delay)).expect("not silent");
            assert!((found - delay as f64).abs() < 0.02, "{delay}: {found}");
        }
        let mover = Mover::new(256);
        let moved: Vec<f32> = mover
            .later(&late(20), 3.37)
            .iter()
            .map(|sample| sample * 1e-4)
            .collect();
        let found = finder.find(&moved).expect("not silent");
        assert!((found - 23.37).abs() < 0.05, "{found}");
        assert_eq!(finder.find(&[0.0; 256]), None);
    }

    /// Protects shifts: shifting back restores the response, and shifts by whole samples are exact.
    #[test]
    fn a_move_can_be_undone() {
        let mover = Mover::new(400);
        let response = late(60);
        let moved = mover.later(&mover.later(&response, 7.0), -7.0);
        for (index, sample) in response.iter().enumerate() {
            assert!((sample - moved[index]).abs() < 1e-6);
        }
        let later = mover.later(&response, 5.0);
        assert!((later[65] - 1.0).abs() < 1e-6 && later[60].abs() < 1e-6);
    }
}
