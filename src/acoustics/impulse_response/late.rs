//! The late part: Gaussian noise, shaped by the echogram.

use super::format::{Encoding, MOST_CHANNELS, Noise};
use super::{Sound, amplitude};
use crate::acoustics::Echogram;
use crate::rng::{hash, unit_interval};
use std::f64::consts::TAU;

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
        // 1 − u is in 0 … 1 without 0, whose logarithm is infinite.
        let radius = (-2.0 * (1.0 - uniform()).ln()).sqrt();
        let (sin, cos) = (TAU * uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}

/// The noises of one band: one common to all channels, and one for each.
struct Noises {
    common: Gauss,
    own: [Gauss; MOST_CHANNELS],
}

impl Noises {
    fn new(seed: u64, band: usize) -> Noises {
        let stream = |number: usize| Gauss::new(seed, (band * (MOST_CHANNELS + 1) + number) as u64);
        Noises {
            common: stream(MOST_CHANNELS),
            own: std::array::from_fn(stream),
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

/// Adds the unfiltered noise of a band to the first `samples` of each channel: in each bin with the
/// energy of the echogram, at a bandwidth of half the sampling rate.
pub(super) fn add(
    channels: &mut [Vec<f64>],
    samples: usize,
    echogram: &Echogram,
    band: usize,
    encoding: Encoding,
    sound: &Sound,
) {
    let mut noises = Noises::new(sound.seed, band);
    for bin in 0..echogram.bins() {
        let energy = echogram.energy(bin)[band];
        if energy <= 0.0 {
            continue;
        }
        let mean = -echogram.flow(bin)[band] / energy;
        let noise = encoding.noise(&sound.axes, mean);
        for (sample, share) in samples_of(echogram, bin, sound.rate_hz) {
            if sample < samples {
                noises.add(channels, sample, amplitude(energy * share), &noise);
            }
        }
    }
}

/// The samples that a bin covers, and the share of the bin in each. A sample covers half its
/// distance to the next on both sides; the first also covers everything before it.
pub(super) fn samples_of(
    echogram: &Echogram,
    bin: usize,
    rate_hz: f64,
) -> impl Iterator<Item = (usize, f64)> {
    let edge = |bin: usize| {
        let edge_s = echogram.first_s() + bin as f64 * echogram.bin_s();
        (edge_s * rate_hz + 0.5).max(0.0)
    };
    let (begins, ends) = (edge(bin), edge(bin + 1));
    (begins as usize..ends.ceil() as usize).map(move |sample| {
        let inside = ends.min(sample as f64 + 1.0) - begins.max(sample as f64);
        (sample, inside / (ends - begins))
    })
}
