//! Passages: parts of the energy of waves that continue through solids.
//!
//! A wave that meets the solid of a transmitting material is reflected as in any other scene, and its energy after the
//! reflection does not depend on transmission. In addition, with the probability [`PASSAGE_SHARE`], the shader records
//! the hit. A recorded hit is a [`Passage`]: a new wave that starts behind the solid, with the energy of the wave
//! before the hit, times the share that passes, over the probability. The sound that leaves through the wall is part of
//! the absorption of the material.
//!
//! Passages are traced after the waves that they come from. Passages of passages are the next *generation*. If a
//! generation has more passages than [`kept`] returns, this number is drawn, and weights preserve the energy of all.
//!
//! Transmission does not change the waves from the source, except by rounding: if a material occurs on surfaces with
//! and without a far side, it has two numbers, and events may then need more bits (`shader/materials.rs`).

use crate::arrival::Arrival;
use crate::bands::{BAND_COUNT, Bands};
use crate::sampling::{hash, unit_interval};
use glam::{DVec3, Vec3};

/// Probability of a passage at a hit of a solid that transmits. In a decay of 60 dB a wave hits a wall of an ordinary
/// room about ten times, so that there are more passages than waves, from which those with the most energy are drawn.
pub const PASSAGE_SHARE: f64 = 0.5;

/// The share of the energy of all waves at the source below which a generation of passages is not traced: −100 dB, as
/// for the exact path through solids.
pub const LEAST_GENERATION: f64 = 1e-10;

/// Maximum number of generations. Generations that each carry 91 % of the energy of the previous one then reach
/// [`LEAST_GENERATION`]. Between mirrors close to a sheet that transmits all sound, the number would be that of all
/// flights of a wave.
pub const MOST_GENERATIONS: u32 = 256;

/// Minimum number of passages of a generation that are kept: 6 % error of their energy.
const FEWEST_KEPT: u32 = 256;

/// Number of passages of a block above which half of this number is drawn from them. This number takes 80 MB.
pub const MOST_PASSAGES: usize = 1 << 20;

/// The share of passages that are drawn evenly. These passages carry the end of a decay, and all others its level.
const EVEN_SHARE: f64 = 0.35;

/// Passages that are kept if waves from the source arrive, in units of the number of waves and the root of the energy
/// share of the passages. Passages of little energy then change little at the listener.
const KEPT_BESIDE_WAVES: f64 = 2.0;

/// A hit of a solid by a wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SolidHit {
    /// Number of the surface, from 1.
    pub surface: u32,
    /// World position in metres.
    pub point: DVec3,
    /// Direction of flight before the hit: a unit vector in world axes.
    pub direction: DVec3,
}

/// The far end of the way through a solid, or through solids in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FarEnd {
    /// Number of the surface at which the wave leaves the solids, from 1.
    pub surface: u32,
    /// World position in metres.
    pub point: DVec3,
    /// Length of the way through the solids in metres.
    pub length_m: f64,
    /// The share of the energy that passes, by band.
    pub share: Bands,
}

/// The transmission of solids, and the receiver of the arrivals behind them.
pub(crate) struct Transmitting<'a> {
    /// Returns the far end of the way through a solid; `None` if nothing passes.
    pub through: &'a (dyn Fn(&SolidHit) -> Option<FarEnd> + Sync),
    /// Receives the arrivals of passages, in the order of the generations. The number of a passage is that of the wave
    /// from the source that it comes from.
    pub take: &'a mut dyn FnMut(Arrival),
}

/// A part of a wave's energy that continues in a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Passage {
    /// Number of the wave from the source.
    pub wave: u32,
    /// Number of the surface, from 1: the surface that is hit, and then the surface at the far end.
    pub surface: u32,
    /// Reflections before the hit.
    pub reflections: u32,
    /// World position in metres.
    pub point: DVec3,
    pub direction: Vec3,
    /// Metres flown from the source.
    pub length_m: f64,
    /// Energies by band, in units of a wave at the source.
    pub energy: [f32; BAND_COUNT],
}

impl Passage {
    /// The passage at the far end of the solid that it hits; `None` if nothing passes.
    pub fn behind(
        &self,
        through: &(dyn Fn(&SolidHit) -> Option<FarEnd> + Sync),
    ) -> Option<Passage> {
        let end = through(&SolidHit {
            surface: self.surface,
            point: self.point,
            direction: self.direction.as_dvec3().normalize(),
        })?;
        let energy = |band: usize| self.energy[band] * (end.share[band] / PASSAGE_SHARE) as f32;
        let passage = Passage {
            surface: end.surface,
            point: end.point,
            length_m: self.length_m + end.length_m,
            energy: std::array::from_fn(energy),
            ..*self
        };
        (passage.energy != [0.0; BAND_COUNT]).then_some(passage)
    }
}

/// Maximum number of passages of a generation (from 1) that are kept, for this number of waves. The number is halved
/// from each generation to the next, down to [`FEWEST_KEPT`]. All generations before this minimum together have at most
/// twice the number of waves from the source.
pub(crate) fn kept(waves: u32, generation: u32) -> usize {
    let fewest = FEWEST_KEPT.min(waves);
    (waves.checked_shr(generation - 1).unwrap_or(0)).max(fewest) as usize
}

/// Maximum number of passages of a generation that are kept if waves from the source arrive, and if the passages have
/// this share of the energy of these waves.
pub(crate) fn kept_beside_waves(waves: u32, generation: u32, share: f64) -> usize {
    let by_energy = KEPT_BESIDE_WAVES * share.sqrt() * f64::from(waves);
    (by_energy as usize).clamp(FEWEST_KEPT.min(waves) as usize, kept(waves, generation))
}

/// Draws `most` of more passages, and weights their energies by the inverse of the probability of each draw. The
/// probability is a mixture of even draws and of draws by energy, averaged over the bands. Passages with more energy
/// may be drawn several times. The draws are spread over the passages in their order.
pub(crate) fn thinned(passages: Vec<Passage>, most: usize, seed: u64) -> Vec<Passage> {
    if passages.len() <= most {
        return passages;
    }
    let sums = sums(&passages);
    let carried = sums.iter().filter(|sum| **sum > 0.0).count().max(1) as f64;
    let evenly = EVEN_SHARE / passages.len() as f64;
    let probability = |passage: &Passage| {
        let bands = passage.energy.iter().zip(&sums);
        let share = |(energy, sum): (&f32, &f64)| f64::from(*energy) / sum.max(f64::MIN_POSITIVE);
        evenly + (1.0 - EVEN_SHARE) * bands.map(share).sum::<f64>() / carried
    };
    let mut sum = 0.0;
    let cumulative: Vec<f64> = passages
        .iter()
        .map(|passage| {
            sum += probability(passage);
            sum
        })
        .collect();
    let stream = hash(seed);
    let draw = |number: usize| {
        let random = unit_interval(hash(stream.wrapping_add(number as u64)));
        let until = (number as f64 + random) / most as f64 * sum;
        let index = cumulative.partition_point(|sum| *sum <= until);
        let mut drawn = passages[index.min(passages.len() - 1)];
        let weight = sum / (most as f64 * probability(&drawn));
        drawn.energy = drawn.energy.map(|energy| energy * weight as f32);
        drawn
    };
    (0..most).map(draw).collect()
}

/// The energies of passages by band.
fn sums(passages: &[Passage]) -> [f64; BAND_COUNT] {
    std::array::from_fn(|band| passages.iter().map(|one| f64::from(one.energy[band])).sum())
}

/// The energy of passages, in the band with the most.
pub(crate) fn loudest(passages: &[Passage]) -> f64 {
    sums(passages).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passages(count: u32) -> Vec<Passage> {
        let one = |wave: u32| Passage {
            wave,
            surface: 1,
            reflections: 0,
            point: DVec3::ZERO,
            direction: Vec3::X,
            length_m: 1.0,
            energy: [1.0 + wave as f32 / count as f32; BAND_COUNT],
        };
        (0..count).map(one).collect()
    }

    /// Protects the energy of passages that are thinned out: the kept ones carry the energy of all, in their order.
    #[test]
    fn thinned_passages_carry_the_energy_of_all() {
        let all = passages(10_007);
        assert_eq!(thinned(all.clone(), 20_000, 1), all);
        for most in [1, 256, 5000, 9999] {
            let few = thinned(all.clone(), most, 7);
            assert_eq!(few.len(), most);
            assert!(few.windows(2).all(|two| two[0].wave <= two[1].wave));
            // Each draw is from 1/most of the passages. Over all of them, energy / probability varies by a quarter.
            let ratio = loudest(&few) / loudest(&all);
            assert!((ratio - 1.0).abs() < 1.0 / most as f64, "{most}: {ratio}");
        }
    }

    /// Protects levels from noise if most passages have little energy: the loud ones are drawn more often.
    #[test]
    fn loud_passages_are_drawn_more_often() {
        let mut all = passages(10_000);
        for passage in &mut all {
            if passage.wave % 100 != 7 {
                passage.energy = [1e-6; BAND_COUNT];
            }
        }
        let few = thinned(all.clone(), 1000, 3);
        let loud = few.iter().filter(|passage| passage.wave % 100 == 7);
        assert!(loud.count() > 600);
        assert!((loudest(&few) / loudest(&all) - 1.0).abs() < 0.02);
    }

    /// Protects the time of a response from passages of passages.
    #[test]
    fn generations_become_smaller() {
        assert_eq!([1, 2, 3].map(|g| kept(4096, g)), [4096, 2048, 1024]);
        assert_eq!([20, 90].map(|g| kept(4096, g)), [256, 256]);
        assert_eq!(kept(16, 3), 16);
        assert_eq!(
            [1.0, 0.01, 1e-9].map(|s| kept_beside_waves(4096, 1, s)),
            [4096, 819, 256]
        );
        assert_eq!(kept_beside_waves(16, 4, 0.1), 16);
    }
}
