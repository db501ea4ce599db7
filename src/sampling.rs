//! Reproducible samples, the same on every machine: random numbers by SplitMix64, hashes by FNV-1a, and directions on a
//! lattice.
//!
//! G. L. Steele, D. Lea and C. H. Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014: a counter
//! advances by a fixed odd number, and each of its values is mixed. So a number can also be computed from its index,
//! without the previous ones.
//!
//! G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, *The FNV Non-Cryptographic Hash Algorithm*, IETF draft. The standard
//! algorithm takes bytes; here whole numbers are accepted as well.

use glam::DVec3;
use std::f64::consts::TAU;

/// The odd integer next to 2^64 ÷ the golden ratio, the step of the counter.
pub const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The number with this index, from 0, of the sequence of seed 0: 64 well mixed bits.
pub fn hash(index: u64) -> u64 {
    mix(index.wrapping_add(1).wrapping_mul(GOLDEN_GAMMA))
}

/// Uniform in 0 … 1, excluding 1, from the upper 53 bits, the precision of an `f64`.
pub fn unit_interval(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

fn mix(counter: u64) -> u64 {
    let bits = (counter ^ (counter >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A sequence of random numbers: for resampling and for the order of trials, never for waves.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates the sequence of a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN_GAMMA);
        mix(self.0)
    }

    /// Uniform in 0 … `count` − 1; 0 if `count` is 0. The high half of a product, whose bias is
    /// below `count` ÷ 2^64.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    /// Shuffles the items into an order that depends only on the seed and their number (Fisher and
    /// Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for end in (1..items.len()).rev() {
            items.swap(end, self.below(end + 1));
        }
    }
}

/// The hash of an empty sequence.
pub const FNV_EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

/// The hash with one more number appended.
pub fn fnv_with(hash: u64, number: u64) -> u64 {
    (hash ^ number).wrapping_mul(0x0000_0100_0000_01b3)
}

/// The hash of these bytes.
pub fn fnv_of_bytes(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(FNV_EMPTY, |hash, byte| fnv_with(hash, u64::from(*byte)))
}

/// A spherical Fibonacci lattice of `count` unit vectors (Swinbank and Purser, *Fibonacci grids*,
/// QJRMS 132, 2006): heights in equal steps, azimuths by the golden ratio.
pub fn lattice(count: u64) -> impl Iterator<Item = DVec3> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    (0..count).map(move |index| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sin, cos) = (TAU * (index as f64 * golden).fract()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects every seed's results: the first numbers of the published generator.
    #[test]
    fn numbers_are_those_of_splitmix64() {
        assert_eq!(hash(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(hash(1), 0x6e78_9e6a_a1b9_65f4);
        assert_eq!(hash(u64::MAX), 0);
    }

    /// Protects the interval's ends: it includes 0 and excludes 1.
    #[test]
    fn the_unit_interval_lacks_its_upper_end() {
        assert_eq!(unit_interval(0), 0.0);
        assert_eq!(unit_interval(1 << 63), 0.5);
        assert_eq!(unit_interval(u64::MAX), 1.0 - f64::EPSILON / 2.0);
    }

    /// Protects sequences from those of other seeds: the first numbers of seed 1234567.
    #[test]
    fn a_sequence_begins_at_its_seed() {
        let mut random = Random::new(1_234_567);
        let first = [random.next(), random.next(), random.next()];
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!(first, expected);
    }

    /// Protects the order of trials: a permutation, the same for the same seed and another for
    /// another seed.
    #[test]
    fn shuffling_permutes_by_the_seed_alone() {
        let order = |seed| {
            let mut items: Vec<u32> = (0..50).collect();
            Random::new(seed).shuffle(&mut items);
            items
        };
        assert_eq!(order(7), order(7));
        assert_ne!(order(7), order(8));
        let mut sorted = order(7);
        sorted.sort_unstable();
        assert_eq!(sorted, (0..50).collect::<Vec<u32>>());
    }

    /// Protects fingerprints from wrong constants: the draft's test vectors.
    #[test]
    fn hashes_are_those_of_fnv_1a() {
        assert_eq!(fnv_of_bytes(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_of_bytes(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_of_bytes(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
