//! Octave bands as filters: sums of spectra, each weighted by its band.

use crate::bands::BAND_COUNT;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// The exact centre of the band that `LOWEST_BAND` counts from, and its index in
/// [`BANDS_HZ`](crate::bands::BANDS_HZ): the octaves of IEC 61260 are 1000 Hz × 2ⁿ.
const REFERENCE_HZ: f64 = 1000.0;
const REFERENCE_BAND: f64 = 4.0;

/// Width of the transition between two bands, in octaves about the edge between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Crossing {
    /// From centre to centre, by amplitude: cos² and sin², whose sum is 1. Equal bands leave a
    /// sound unchanged, and the filters are as short as possible. For taps.
    Amplitude,
    /// Over a third of an octave, by power: cos and sin, whose squares add up to 1. The noise of
    /// each band stays within it. For noise.
    Power,
}

impl Crossing {
    fn octaves(self) -> f64 {
        match self {
            Crossing::Amplitude => 1.0,
            Crossing::Power => 1.0 / 3.0,
        }
    }

    /// The gain of a band's filter at a frequency. Below the lowest centre and above the highest
    /// only that band has gain.
    pub(super) fn gain(self, band: usize, frequency_hz: f64) -> f64 {
        let place = (frequency_hz / REFERENCE_HZ).log2() + REFERENCE_BAND;
        let place = place.clamp(0.0, (BAND_COUNT - 1) as f64);
        // Octaves from the edge to the next band, which is half an octave from the centre.
        let beyond_edge = (place - band as f64).abs() - 0.5;
        let turn = (beyond_edge / self.octaves() + 0.5).clamp(0.0, 1.0) * FRAC_PI_2;
        match self {
            Crossing::Amplitude => turn.cos().powi(2),
            Crossing::Power => turn.cos(),
        }
    }
}

/// The filter of one band at each frequency of a spectrum.
fn gains(crossing: Crossing, band: usize, rate_hz: f64, length: usize) -> Vec<f64> {
    let frequency = |bin: usize| bin as f64 * rate_hz / length as f64;
    let gain = |bin| crossing.gain(band, frequency(bin));
    (0..=length / 2).map(gain).collect()
}

/// Sums of the spectra of several channels.
pub(super) struct Spectra {
    rate_hz: f64,
    /// Number of samples, including silence at the end into which the filters may wrap around.
    length: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    sums: Vec<Vec<Complex<f64>>>,
    spectrum: Vec<Complex<f64>>,
}

/// Seconds after which the longest filters, those between 63 Hz and 125 Hz, have fallen by 60 dB.
/// Filters are zero-phase, and extend in both directions.
const FILTER_REACH_S: f64 = 0.25;

impl Spectra {
    /// Empty sums for the given numbers of channels and samples.
    pub(super) fn new(channels: usize, samples: usize, rate_hz: f64) -> Spectra {
        let silence = (FILTER_REACH_S * rate_hz).ceil() as usize;
        let length = (samples + silence).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(length);
        Spectra {
            rate_hz,
            length,
            inverse: planner.plan_fft_inverse(length),
            sums: vec![forward.make_output_vec(); channels],
            spectrum: forward.make_output_vec(),
            forward,
        }
    }

    /// A silent channel of the transform's length.
    pub(super) fn silence(&self) -> Vec<f64> {
        vec![0.0; self.length]
    }

    /// Adds a channel's samples through a band's filter, and overwrites them with silence.
    pub(super) fn add(&mut self, channels: &mut [Vec<f64>], crossing: Crossing, band: usize) {
        let gains = gains(crossing, band, self.rate_hz, self.length);
        for (samples, sums) in channels.iter_mut().zip(&mut self.sums) {
            let done = self.forward.process(samples, &mut self.spectrum);
            debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
            for ((sum, value), gain) in sums.iter_mut().zip(&self.spectrum).zip(&gains) {
                *sum += value * gain;
            }
            samples.fill(0.0);
        }
    }

    /// Adds the single channel of `other` to each of these, through filters of the transform's
    /// length ([`silence`](Self::silence)), and overwrites it with silence.
    pub(super) fn add_filtered(&mut self, other: &mut Spectra, mut filters: Vec<Vec<f64>>) {
        for (filter, sums) in filters.iter_mut().zip(&mut self.sums) {
            let done = self.forward.process(filter, &mut self.spectrum);
            debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
            for ((sum, gain), value) in sums.iter_mut().zip(&self.spectrum).zip(&other.sums[0]) {
                *sum += value * gain;
            }
        }
        for sum in &mut other.sums {
            sum.fill(Complex::default());
        }
    }

    /// The first `samples` of each channel.
    pub(super) fn into_channels(mut self, samples: usize) -> Vec<Vec<f32>> {
        let scale = 1.0 / self.length as f64;
        let mut out = self.inverse.make_output_vec();
        let mut channels = Vec::with_capacity(self.sums.len());
        for sum in &mut self.sums {
            let done = self.inverse.process(sum, &mut out);
            debug_assert!(done.is_ok(), "the spectrum is that of a real signal");
            let kept = out.iter().take(samples);
            channels.push(kept.map(|sample| (sample * scale) as f32).collect());
        }
        channels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BANDS_HZ;

    /// Protects energy: the gains of the filters for taps add up to 1, those for noise by their
    /// squares.
    #[test]
    fn filters_are_complementary() {
        for step in 0..2000 {
            let frequency_hz = f64::from(step) * 12.0;
            let gains = |crossing: Crossing| {
                (0..BAND_COUNT).map(move |band| crossing.gain(band, frequency_hz))
            };
            let amplitude: f64 = gains(Crossing::Amplitude).sum();
            let power: f64 = gains(Crossing::Power).map(|gain| gain * gain).sum();
            assert!((amplitude - 1.0).abs() < 1e-12 && (power - 1.0).abs() < 1e-12);
        }
    }

    /// Protects the centres of the bands, and the ends.
    #[test]
    fn a_band_is_alone_at_its_centre() {
        for (band, centre_hz) in BANDS_HZ.into_iter().enumerate() {
            // The nominal 63 Hz are exactly 62.5 Hz.
            assert!(Crossing::Amplitude.gain(band, centre_hz) > 0.999);
            assert_eq!(Crossing::Power.gain(band, centre_hz), 1.0);
        }
        for crossing in [Crossing::Amplitude, Crossing::Power] {
            assert_eq!(crossing.gain(0, 0.0), 1.0);
            assert_eq!(crossing.gain(7, 20e3), 1.0);
        }
    }
}
