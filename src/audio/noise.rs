//! White noise that can be repeated.

/// The peak of the noise, of full scale 1: −6.02 dBFS, at a level of −10.8 dBFS (RMS).
pub const NOISE_AMPLITUDE: f32 = 0.5;

/// White noise, evenly distributed; a sample depends on its index and the seed alone.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    seed: u64,
    index: u64,
}

impl Noise {
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, index: 0 }
    }

    pub(super) fn fill(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = noise_at(self.seed, self.index);
            self.index = self.index.wrapping_add(1);
        }
    }

    /// Makes the sample with this number the next one.
    pub(super) fn seek(&mut self, index: u64) {
        self.index = index;
    }
}

/// The noise at one index. The seed is hashed first, so that near seeds give unlike noises.
fn noise_at(seed: u64, index: u64) -> f32 {
    let bits = hash(hash(seed).wrapping_add(index));
    let signed = (bits >> 40) as i32 - (1 << 23); // 24 bits: exact in f32
    NOISE_AMPLITUDE * signed as f32 / (1 << 23) as f32
}

/// SplitMix64 (Steele, Lea and Flood, 2014): one counter in, 64 well mixed bits out.
pub(super) fn hash(counter: u64) -> u64 {
    let mut z = counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
