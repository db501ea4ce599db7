//! Reproducible samples, the same on every machine (random numbers by SplitMix64, hashes by FNV-1a, directions on a
//! lattice), and the statistics of reports: mean, median and quantiles.
//!
//! G. L. Steele, D. Lea and C. H. Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014: a counter
//! advances by a fixed odd number, and each of its values is mixed. A number can therefore also be computed from its
//! index, without the previous numbers.
//!
//! G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, *The FNV Non-Cryptographic Hash Algorithm*, IETF draft. The standard
//! algorithm hashes bytes; here it also hashes whole numbers.
//!
//! Mean, median and quantiles have one definition for every report.
//!
//! A quantile is interpolated linearly between order statistics: for *n* sorted values, the quantile of share *p* is at
//! position (*n* − 1)*p*, counted from 0. This is type 7 of R. J. Hyndman and Y. Fan, *Sample Quantiles in Statistical
//! Packages*, The American Statistician 50 (4), 1996. The median of an even number of values is therefore the mean of
//! the two in the middle.

use glam::DVec3;
use std::f64::consts::TAU;

/// The odd integer next to 2^64 ÷ the golden ratio, the step of the counter.
pub const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The number with this index, from 0, in the sequence of seed 0: 64 well mixed bits.
pub fn hash(index: u64) -> u64 {
    mix(index.wrapping_add(1).wrapping_mul(GOLDEN_GAMMA))
}

/// Uniform in 0 … 1, excluding 1, from the upper 53 bits, which is the precision of an `f64`.
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
    /// Creates the sequence for a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN_GAMMA);
        mix(self.0)
    }

    /// Uniform in 0 … `count` − 1; 0 if `count` is 0. Computed as the high half of a product, whose bias is below
    /// `count` ÷ 2^64.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.next()) * count as u128) >> 64) as usize
    }

    /// Shuffles the items into an order that depends only on the seed and the number of items (Fisher and Yates).
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

/// The quantiles for these shares, each 0 … 1; 0 without values.
pub fn quantiles<const N: usize>(
    values: impl IntoIterator<Item = f64>,
    shares: [f64; N],
) -> [f64; N] {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    shares.map(|share| at(&sorted, share))
}

/// The median; 0 without values.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let [median] = quantiles(values, [0.5]);
    median
}

/// The arithmetic mean; `None` without values.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let add = |(sum, count): (f64, usize), value| (sum + value, count + 1);
    let (sum, count) = values.into_iter().fold((0.0, 0), add);
    (count > 0).then(|| sum / count as f64)
}

fn at(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let (low, weight) = (place.floor() as usize, place.fract());
    let (below, above) = (sorted[low], sorted[(low + 1).min(last)]);
    // Interpolation between equal values would add rounding, and 0 times infinity is NaN.
    if weight == 0.0 || below == above {
        return below;
    }
    (1.0 - weight) * below + weight * above
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects results for every seed: the first numbers match the published generator.
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

    /// Protects sequences from starting like the sequence of another seed: the first numbers of seed 1234567.
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

    /// Protects the order of trials: it is a permutation, equal for equal seeds and different for different seeds.
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

    /// Protects fingerprints from wrong constants: the hashes match the draft's test vectors.
    #[test]
    fn hashes_are_those_of_fnv_1a() {
        assert_eq!(fnv_of_bytes(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv_of_bytes(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv_of_bytes(b"foobar"), 0x8594_4171_f739_67e8);
    }

    /// Protects the median, by which every time in a report is stated.
    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median([]), 0.0);
    }

    /// Protects the definition: types 1 to 6 give other values than type 7 for these shares.
    #[test]
    fn quantiles_are_interpolated_between_order_statistics() {
        let ten = || (1..=10).rev().map(f64::from);
        let found = quantiles(ten(), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(found, [1.0, 3.25, 5.5, 7.75, 10.0]);
        let [p99] = quantiles((1..=101).map(f64::from), [0.99]);
        assert_eq!(p99, 100.0);
    }

    /// Protects reports from NaN and rounding with infinite or equal values.
    #[test]
    fn equal_and_infinite_values_stay_what_they_are() {
        assert_eq!(quantiles([0.1; 4], [0.3, 0.99]), [0.1, 0.1]);
        assert_eq!(quantiles([7.0], [0.5, 0.99]), [7.0, 7.0]);
        assert_eq!(quantiles([], [0.5, 1.0]), [0.0, 0.0]);
        let some_infinite = [1.0, 2.0, f64::INFINITY];
        assert_eq!(quantiles(some_infinite, [0.5, 1.0]), [2.0, f64::INFINITY]);
    }

    /// Protects means without values: they are `None`, not a number.
    #[test]
    fn the_mean_of_nothing_is_none() {
        assert_eq!(mean([]), None);
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
    }
}
