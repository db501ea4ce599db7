//! The sum over all half-planes around the line from source to listener.
//!
//! # Theory
//! The field behind an obstacle is a sum over the half-planes through the line from source to listener: each contributes
//! the phase of its string. For a straight thin edge at right angles to the line, with a detour δ₀, the detour in the
//! half-plane that is turned by φ is δ₀/cos²φ, and
//!
//! ```text
//! 1/2π ∫ exp(ikδ₀/cos²φ) dφ = ½ e^{ikδ₀} W(√(kδ₀)),
//! ```
//!
//! which is Fresnel's diffraction at that edge. The detours of a scene also contain the ends of edges, their curvature,
//! and the focus behind a ball, where all half-planes contribute the same phase.

use super::samples::Samples;
use super::string::{HALF_PLANES, STEP};
use num_complex::Complex64;

/// Difference of detours in metres up to which strings are equally long: a phase of 0.003 rad at 8 kHz. Without it the
/// rounding of numbers would decide which strings are shortest on the axis of a body of revolution.
const EQUAL_M: f64 = 2e-5;

/// Detours in metres in half-planes all around a line, from azimuth 0; `None` where no string leads around.
pub(super) type Detours = [Option<f64>; HALF_PLANES];

/// The detours that a function of the azimuth in radians gives.
pub(super) fn detours(of: impl Fn(f64) -> Option<f64>) -> Detours {
    std::array::from_fn(|index| of(index as f64 * STEP))
}

/// Half-planes around a local shortest string.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Basin {
    /// Index of the half-plane with the shortest string.
    pub shortest: usize,
    /// Number of half-planes before it and after it in which strings become longer.
    before: usize,
    after: usize,
}

impl Basin {
    /// The basins of detours.
    pub fn all(detours: &Detours) -> Vec<Basin> {
        let known = (0..HALF_PLANES).filter_map(|index| Some((index, detours[index]?)));
        let shortest = (0..HALF_PLANES).filter(|index| Basin::is_shortest(detours, *index));
        let mut basins: Vec<Basin> = shortest.map(|index| Basin::of(detours, index)).collect();
        if basins.is_empty()
            && let Some((shortest, _)) = known.min_by(|a, b| a.1.total_cmp(&b.1))
        {
            // All strings are equally long: the axis of a body of revolution.
            basins.push(Basin {
                shortest,
                before: HALF_PLANES / 2,
                after: HALF_PLANES / 2,
            });
        }
        basins
    }

    /// Whether strings become longer on both sides of one before they become shorter. The first of equally long ones
    /// counts.
    fn is_shortest(detours: &Detours, index: usize) -> bool {
        let Some(own) = detours[index] else {
            return false;
        };
        let becomes_longer = |step: usize| {
            for steps in 1..HALF_PLANES {
                match detours[(index + steps * step) % HALF_PLANES] {
                    Some(other) if other < own || (other == own && step > 1) => return false,
                    Some(other) if other <= own + EQUAL_M => {}
                    _ => return true,
                }
            }
            false
        };
        becomes_longer(1) && becomes_longer(HALF_PLANES - 1)
    }

    fn of(detours: &Detours, shortest: usize) -> Basin {
        let after = Basin::rise(detours, shortest, 1, HALF_PLANES);
        let before = Basin::rise(detours, shortest, HALF_PLANES - 1, HALF_PLANES - after);
        Basin {
            shortest,
            before,
            after,
        }
    }

    /// Number of steps, at most `most`, from the shortest string to the longest one before they become shorter again.
    fn rise(detours: &Detours, shortest: usize, step: usize, most: usize) -> usize {
        let mut longest = (0, detours[shortest].unwrap_or(f64::INFINITY));
        for steps in 1..=most {
            match detours[(shortest + steps * step) % HALF_PLANES] {
                Some(detour) if detour >= longest.1 => longest = (steps, detour),
                Some(detour) if detour >= longest.1 - EQUAL_M => {}
                _ => break,
            }
        }
        longest.0
    }

    /// Whether the strings become longer on both sides up to the same one.
    pub fn is_closed(&self) -> bool {
        self.before + self.after == HALF_PLANES
    }

    /// Index of the half-plane in which the strings after the shortest one are longest.
    pub fn longest_after(&self) -> usize {
        (self.shortest + self.after) % HALF_PLANES
    }

    /// The half-planes with strings around the one with the longest, and the index of that one; `None` without strings.
    pub fn around_longest(detours: &Detours) -> Option<(Basin, usize)> {
        let known = (0..HALF_PLANES).filter_map(|index| Some((index, detours[index]?)));
        let (longest, _) = known.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let has_string = |index: usize| detours[index % HALF_PLANES].is_some();
        let steps = 1..=HALF_PLANES;
        let after = steps
            .clone()
            .take_while(|steps| has_string(longest + steps))
            .count();
        let steps = steps.take(HALF_PLANES - after);
        let before = steps
            .take_while(|steps| has_string(longest + HALF_PLANES - steps))
            .count();
        let basin = Basin {
            shortest: longest,
            before,
            after,
        };
        Some((basin, longest))
    }

    /// The indices of its half-planes.
    pub fn half_planes(&self) -> impl Iterator<Item = usize> {
        let first = self.shortest + HALF_PLANES - self.before;
        (first..=first + self.before + self.after).map(|index| index % HALF_PLANES)
    }

    /// Whether both half-planes next to the shortest string have strings.
    pub fn is_inner(&self, detours: &Detours) -> bool {
        let beside = [1, HALF_PLANES - 1].map(|step| (self.shortest + step) % HALF_PLANES);
        beside.iter().all(|index| detours[*index].is_some())
    }

    /// Angle between the shortest half-plane and an azimuth. The azimuth is in radians; the result is in units of the
    /// angle between neighbouring half-planes.
    pub fn turns_from(&self, azimuth: f64) -> f64 {
        let turns = azimuth / STEP - self.shortest as f64;
        let whole = HALF_PLANES as f64;
        (turns - whole * (turns / whole).round()).abs()
    }

    /// The part of the sum that the half-planes of the basin contribute.
    pub fn samples(&self, detours: &Detours) -> Samples {
        let first = self.shortest + HALF_PLANES - self.before;
        let last = self.shortest + HALF_PLANES + self.after;
        let at = |index: usize| detours[index % HALF_PLANES];
        let is_endless = [first + HALF_PLANES - 1, last + 1].map(|next| at(next).is_none());
        Samples::interpolated(first, (first..=last).map(at).collect(), is_endless)
    }
}

/// The shares of the half-planes that belong to the longest string: from 0 at the shortest to 1 at the longest, in
/// proportion to the detours. A half each if all strings are equally long.
pub(super) fn shares_of_longest(detours: &Detours) -> [f64; HALF_PLANES] {
    let known = || detours.iter().flatten().copied();
    let least = known().fold(f64::INFINITY, f64::min);
    let most = known().fold(0.0, f64::max);
    detours.map(|detour| match detour {
        Some(detour) if most > least + EQUAL_M => (detour - least) / (most - least),
        _ => 0.5,
    })
}

/// The detours of all half-planes that have one.
pub(super) fn all_samples(detours: &Detours) -> Vec<Samples> {
    Basin::all(detours)
        .iter()
        .map(|basin| basin.samples(detours))
        .collect()
}

/// The integral of exp(ikδ) over the half-planes of all samples, divided by 2π.
pub(super) fn sum(samples: &[Samples], k: f64) -> Complex64 {
    let sums = samples
        .iter()
        .map(|samples| samples.weighted_sum(k, |_| Complex64::ONE));
    sums.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the axis of a body of revolution: one basin all around, although rounding makes some strings shorter.
    #[test]
    fn strings_that_differ_by_rounding_are_equally_long() {
        let detours: Detours = std::array::from_fn(|index| Some(0.3 + 1e-9 * (index % 3) as f64));
        let basins = Basin::all(&detours);
        assert_eq!(basins.len(), 1, "{basins:?}");
        assert!(basins[0].is_closed());
        let half = (basins[0].shortest + HALF_PLANES / 2) % HALF_PLANES;
        assert_eq!(basins[0].longest_after(), half);
    }

    /// Protects shallow ends of basins: rounding ends none before its longest string.
    #[test]
    fn basins_end_at_their_longest_strings() {
        let ripple = |index: usize| 1e-9 * (index % 2) as f64;
        let around = |waves: usize| -> Vec<(usize, usize, usize)> {
            let detours: Detours = std::array::from_fn(|index| {
                let turned = (waves * index) as f64 * STEP;
                Some(0.3 - 1e-3 * turned.cos() + ripple(index))
            });
            let basins = Basin::all(&detours);
            let of = |basin: &Basin| (basin.shortest, basin.before, basin.after);
            basins.iter().map(of).collect()
        };
        assert_eq!(around(1), [(0, 16, 16)]);
        assert_eq!(around(2), [(0, 8, 8), (16, 8, 8)]);
    }

    /// Protects the sum over a whole ring of equal detours, and over half a ring: all half-planes have the same phase.
    #[test]
    fn equal_detours_have_one_phase() {
        let k = 7.0;
        for (known, share) in [(HALF_PLANES, 1.0), (HALF_PLANES / 2 + 1, 0.5)] {
            let detours: Detours = std::array::from_fn(|index| (index < known).then_some(0.3));
            let (basin, _) = Basin::around_longest(&detours).expect("strings");
            let sum = basin.samples(&detours).weighted_sum(k, |_| Complex64::ONE);
            let expected = Complex64::cis(k * 0.3) * share;
            assert!((sum - expected).norm() < 1e-9, "{sum}, {expected}");
        }
    }
}
