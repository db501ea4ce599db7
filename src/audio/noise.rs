//! Reproducible white noise.

use super::Signal;
use crate::rng::hash;

/// The peak of the noise, relative to full scale 1: −6.02 dBFS, at a level of −10.8 dBFS (RMS).
pub const NOISE_AMPLITUDE: f32 = 0.5;

/// White noise, uniformly distributed; a sample depends only on its index and the seed.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    seed: u64,
    index: u64,
}

impl Noise {
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, index: 0 }
    }
}

impl Signal for Noise {
    fn fill(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = noise_at(self.seed, self.index);
            self.index = self.index.wrapping_add(1);
        }
    }

    /// Makes the sample with this number the next one.
    fn seek(&mut self, index: u64) {
        self.index = index;
    }
}

/// The noise at one index. The seed is hashed first, so that similar seeds give different noises.
fn noise_at(seed: u64, index: u64) -> f32 {
    let bits = hash(hash(seed).wrapping_add(index));
    let signed = (bits >> 40) as i32 - (1 << 23); // 24 bits: exact in f32
    NOISE_AMPLITUDE * signed as f32 / (1 << 23) as f32
}
