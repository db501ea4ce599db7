//! The turn of a lattice of start directions.

use glam::{DQuat, Quat};
use std::f64::consts::TAU;

/// A rotation that is uniform over all rotations, one for each seed (Shoemake, *Uniform
/// random rotations*, Graphics Gems III, 1992).
pub(super) fn random_turn(seed: u32) -> Quat {
    let [share, first, second] = [0, 1, 2].map(|counter| unit_interval(seed, counter));
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    let (sin_first, cos_first) = (TAU * first).sin_cos();
    let (sin_second, cos_second) = (TAU * second).sin_cos();
    DQuat::from_xyzw(a * sin_first, a * cos_first, b * sin_second, b * cos_second)
        .normalize()
        .as_quat()
}

/// A number in [0, 1) for a seed and a counter: the mixing of SplitMix64 (Steele, Lea and
/// Flood 2014), which has no state.
fn unit_interval(seed: u32, counter: u32) -> f64 {
    const WEYL: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut z = (u64::from(seed) << 32 | u64::from(counter))
        .wrapping_add(1)
        .wrapping_mul(WEYL);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Protects the lattice from a turn that favours some directions: the mean of one
    /// turned axis over many seeds is 0 within five standard errors, 1 / √3N each.
    #[test]
    fn turns_are_uniform() {
        let seeds = 20_000;
        let sum: Vec3 = (0..seeds).map(|seed| random_turn(seed) * Vec3::Y).sum();
        let standard_error = (3.0 * seeds as f32).sqrt().recip();
        assert!((sum / seeds as f32).abs().max_element() < 5.0 * standard_error);
    }
}
