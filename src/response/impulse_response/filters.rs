//! Signals of impulse responses: octave-band filters, taps at fractional sample positions, and Gaussian noise shaped by
//! an echogram.

use super::{AmbisonicOrder, Encoding, MOST_CHANNELS, Noise, Sound, amplitude};
use crate::bands::BAND_COUNT;
use crate::sampling::{hash, unit_interval};
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The exact centre of the reference band, and the band's index in [`BANDS_HZ`](crate::bands::BANDS_HZ): the octaves of
/// IEC 61260 are 1000 Hz × 2ⁿ.
const REFERENCE_HZ: f64 = 1000.0;
const REFERENCE_BAND: f64 = 4.0;

/// Width of the transition between two bands, in octaves about the edge between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Crossing {
    /// From centre to centre, by amplitude: cos² and sin², whose sum is 1. Used for taps: a tap with equal energies in
    /// all bands stays unchanged, and the filters are as short as possible.
    Amplitude,
    /// Over a third of an octave, by power: cos and sin, whose squares add up to 1. Used for noise: the noise of each
    /// band stays within the band.
    Power,
}

impl Crossing {
    fn octaves(self) -> f64 {
        match self {
            Crossing::Amplitude => 1.0,
            Crossing::Power => 1.0 / 3.0,
        }
    }

    /// The gain of a band's filter at a frequency. Below the lowest and above the highest centre frequency, only the
    /// nearest band has gain.
    #[cfg(any(test, feature = "audio"))]
    pub(super) fn gain(self, band: usize, frequency_hz: f64) -> f64 {
        self.gain_at(band, octave(frequency_hz))
    }

    /// The gain of a band's filter at an [`octave`].
    fn gain_at(self, band: usize, octave: f64) -> f64 {
        // Octaves beyond the edge to the next band, which is half an octave from the centre.
        let beyond_edge = (octave - band as f64).abs() - 0.5;
        let share = beyond_edge / self.octaves() + 0.5;
        // Most frequencies are outside of the two transitions.
        if share <= 0.0 {
            return 1.0;
        }
        if share >= 1.0 {
            return 0.0;
        }
        let gain = (share * FRAC_PI_2).cos();
        match self {
            Crossing::Amplitude => gain * gain,
            Crossing::Power => gain,
        }
    }
}

/// A frequency in octaves above the centre of the lowest band, limited to the range of the bands' centres.
fn octave(frequency_hz: f64) -> f64 {
    let octave = (frequency_hz / REFERENCE_HZ).log2() + REFERENCE_BAND;
    octave.clamp(0.0, (BAND_COUNT - 1) as f64)
}

/// Sums of the spectra of several channels.
pub(super) struct Spectra {
    /// The [`octave`] of each frequency.
    octaves: Vec<f64>,
    /// Number of samples, including silence at the end for the wrap-around of the filters.
    length: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    sums: Vec<Vec<Complex<f64>>>,
    spectrum: Vec<Complex<f64>>,
}

/// Time in seconds after which the longest filters, those between 63 Hz and 125 Hz, have fallen by 60 dB. Filters are
/// zero-phase, and extend in both directions.
const FILTER_REACH_S: f64 = 0.25;

impl Spectra {
    /// Creates empty sums for the given numbers of channels and samples.
    pub(super) fn new(channels: usize, samples: usize, rate_hz: f64) -> Spectra {
        let silence = (FILTER_REACH_S * rate_hz).ceil() as usize;
        let length = (samples + silence).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        let forward = planner.plan_fft_forward(length);
        let frequency_hz = |bin: usize| bin as f64 * rate_hz / length as f64;
        Spectra {
            octaves: (0..=length / 2)
                .map(|bin| octave(frequency_hz(bin)))
                .collect(),
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

    /// Filters a channel's samples with a band's filter, adds them, and overwrites them with silence.
    pub(super) fn add(&mut self, channels: &mut [Vec<f64>], crossing: Crossing, band: usize) {
        let octaves = self.octaves.iter();
        let gains: Vec<f64> = octaves.map(|at| crossing.gain_at(band, *at)).collect();
        for (samples, sums) in channels.iter_mut().zip(&mut self.sums) {
            let done = self.forward.process(samples, &mut self.spectrum);
            debug_assert!(done.is_ok(), "the buffers are as long as the plan's");
            for ((sum, value), gain) in sums.iter_mut().zip(&self.spectrum).zip(&gains) {
                *sum += value * gain;
            }
            samples.fill(0.0);
        }
    }

    /// Filters the single channel of `other` by each of `filters`, and adds each result to one channel of `self`.
    /// Filters have the length of [`silence`](Self::silence). The channel of `other` is set to zero.
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

    /// The samples of each channel.
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

/// Number of samples that a tap extends to both sides. With this window a tap's spectrum is flat up to 0.45 of the
/// sampling rate: 21.6 kHz at 48 kHz.
const REACH: usize = 32;

/// The samples of an [`impulse`].
pub(super) type Impulse = [f64; 2 * REACH + 1];

/// Maximum position of an impulse in samples: 165 years at 192 kHz, after the end of every response. Larger positions
/// would not fit into 64 bits.
const FURTHEST: f64 = 1e15;

/// An impulse at a possibly fractional sample position: a sinc function with a Blackman window (R. B. Blackman and J.
/// W. Tukey, 1958). Returns the index of its first sample, and its samples.
pub(super) fn impulse(place: f64) -> (i64, Impulse) {
    let place = place.clamp(-FURTHEST, FURTHEST);
    let first = place.round() as i64 - REACH as i64;
    let samples = std::array::from_fn(|index| windowed_sinc((first + index as i64) as f64 - place));
    (first, samples)
}

/// Adds values from an index on. Values before the first sample or after the last sample are dropped.
pub(super) fn add_from(samples: &mut [f64], first: i64, values: impl IntoIterator<Item = f64>) {
    for (index, value) in (first..).zip(values) {
        let index = usize::try_from(index).ok();
        if let Some(sample) = index.and_then(|index| samples.get_mut(index)) {
            *sample += value;
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

/// Generates Gaussian numbers with mean 0 and variance 1, from a seed and a stream.
pub(super) struct Gauss {
    key: u64,
    index: u64,
    spare: Option<f64>,
}

impl Gauss {
    pub(super) fn new(seed: u64, stream: u64) -> Gauss {
        Gauss {
            key: hash(hash(seed) ^ stream),
            index: 0,
            spare: None,
        }
    }

    /// The next number (G. E. P. Box and M. E. Muller, Annals of Mathematical Statistics 29, 1958).
    pub(super) fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let mut uniform = || {
            let bits = hash(self.key.wrapping_add(self.index));
            self.index += 1;
            unit_interval(bits)
        };
        // 1 − u is never 0, so the logarithm is finite.
        let radius = (-2.0 * (1.0 - uniform()).ln()).sqrt();
        let (sin, cos) = (TAU * uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}

/// The noise generators of one band: one generator common to all channels, and one for each channel.
struct Noises {
    common: Gauss,
    own: [Gauss; MOST_CHANNELS],
}

impl Noises {
    fn new(seed: u64, band: usize) -> Noises {
        // The streams of a band: the channels of the first order, then the common noise. Those of higher orders follow
        // all bands.
        const FIRST: usize = AmbisonicOrder::FIRST.channels();
        let of_band = |number: usize| (band * (FIRST + 1) + number) as u64;
        let own = |channel: usize| match channel < FIRST {
            true => of_band(channel),
            false => (BAND_COUNT * (FIRST + 1) + band * MOST_CHANNELS + channel) as u64,
        };
        Noises {
            common: Gauss::new(seed, of_band(FIRST)),
            own: std::array::from_fn(|channel| Gauss::new(seed, own(channel))),
        }
    }

    /// Adds one sample of noise to each channel.
    fn add(&mut self, channels: &mut [Vec<f64>], sample: usize, amplitude: f64, noise: &Noise) {
        let common = self.common.next();
        for (channel, samples) in channels.iter_mut().enumerate() {
            let own = noise.own[channel] * self.own[channel].next();
            samples[sample] += amplitude * (noise.common[channel] * common + own);
        }
    }
}

/// Adds the unfiltered noise of a band to the samples of each channel. Its energy in each bin is that of the echogram,
/// spread over half the sampling rate.
pub(super) fn add_noise(channels: &mut [Vec<f64>], sound: &Sound, band: usize, encoding: Encoding) {
    let echogram = sound.echogram;
    let mut noises = Noises::new(sound.seed, band);
    for bin in 0..echogram.bins() {
        let energy = echogram.energy(bin)[band];
        if energy <= 0.0 {
            continue;
        }
        let mean = -echogram.flow(bin)[band] / energy;
        let noise = encoding.noise(sound.axes, mean);
        for (sample, share) in samples_of(sound, bin) {
            noises.add(channels, sample, amplitude(energy * share), &noise);
        }
    }
}

/// The samples of a response within a bin, and the share of the bin in each sample. A sample covers half its distance
/// to the next sample on both sides; the first also covers all earlier time.
pub(super) fn samples_of(sound: &Sound, bin: usize) -> impl Iterator<Item = (usize, f64)> {
    let edge = |bin: usize| (sound.echogram.edge_s(bin) * sound.rate_hz + 0.5).max(0.0);
    let (begins, ends) = (edge(bin), edge(bin + 1));
    let end = (ends.ceil() as usize).min(sound.samples);
    (begins as usize..end).map(move |sample| {
        let inside = ends.min(sample as f64 + 1.0) - begins.max(sample as f64);
        (sample, inside / (ends - begins))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BANDS_HZ;

    fn add_tap(samples: &mut [f64], place: f64, amplitude: f64) {
        let (first, impulse) = impulse(place);
        add_from(samples, first, impulse.map(|value| amplitude * value));
    }

    /// Protects energy: the gains of the filters for taps add up to 1, and the squared gains of the filters for noise
    /// add up to 1.
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

    /// Protects the bands' centre frequencies and the ends of the frequency range.
    #[test]
    fn a_band_is_alone_at_its_centre() {
        for (band, centre_hz) in BANDS_HZ.into_iter().enumerate() {
            // The exact frequency of the nominal 63 Hz is 62.5 Hz.
            assert!(Crossing::Amplitude.gain(band, centre_hz) > 0.999);
            assert_eq!(Crossing::Power.gain(band, centre_hz), 1.0);
        }
        for crossing in [Crossing::Amplitude, Crossing::Power] {
            assert_eq!(crossing.gain(0, 0.0), 1.0);
            assert_eq!(crossing.gain(7, 20e3), 1.0);
        }
    }

    /// Protects a tap at an integer sample position from being smeared: it is that sample alone.
    #[test]
    fn a_tap_at_a_sample_is_one_sample() {
        let mut samples = vec![0.0; 128];
        add_tap(&mut samples, 50.0, 0.5);
        for (index, sample) in samples.iter().enumerate() {
            let expected = if index == 50 { 0.5 } else { 0.0 };
            assert!((sample - expected).abs() < 1e-15);
        }
    }

    /// Protects phase and amplitude of a tap between samples, up to 0.4 of the sampling rate: its spectrum equals that
    /// of a pure delay.
    #[test]
    fn a_tap_between_samples_is_a_pure_delay() {
        let place = 60.37;
        let mut samples = vec![0.0; 128];
        add_tap(&mut samples, place, 1.0);
        for step in 0..=40 {
            let turns = f64::from(step) * 0.01;
            let at = |(index, sample): (usize, &f64)| {
                let (sin, cos) = (2.0 * PI * turns * (index as f64 - place)).sin_cos();
                (sample * cos, sample * sin)
            };
            let sums = samples.iter().enumerate().map(at);
            let (real, imaginary) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            // Blackman's window has a ripple of at most 2 in 10,000.
            assert!((real - 1.0).abs() < 3e-4, "{turns}: {real}");
            assert!(imaginary.abs() < 3e-4, "{turns}: {imaginary}");
        }
    }

    /// Protects the ends of the response.
    #[test]
    fn what_lies_outside_is_lost() {
        let mut samples = vec![0.0; 8];
        add_tap(&mut samples, -100.0, 1.0);
        add_tap(&mut samples, 1e9, 1.0);
        add_tap(&mut samples, 1e300, 1.0);
        assert_eq!(samples, vec![0.0; 8]);
    }
}
