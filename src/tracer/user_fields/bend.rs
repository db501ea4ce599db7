//! Checks whether a value bends more than stated, from second differences of three values in a row, where waves can be.

use super::growth::rounded_up;
use super::stars::{PAIRS, Scope, Star, Stars};
use super::{Error, Probe, TraceError};
use glam::Vec3;

/// Tolerated relative excess over the stated bend.
const TOLERANCE: f32 = 0.01;

/// The number that the error advises to state, as a multiple of the greatest bend that was found. The factor is greater
/// than for a growth, because a second derivative varies more between samples.
const MARGIN: f32 = 1.05;

/// The rounding error of a second difference (weights 1, 2 and 1) divided by the rounding error of a first difference
/// (weights 1 and 1).
const WEIGHT: f32 = 2.0;

/// Intervals on a line on which the check looks for an edge.
const CLOSER: usize = 128;

/// Intervals between the values of a second difference on that line, which are an eighth of the first width.
const NARROWER: usize = CLOSER / 16;

/// The bend of an edge has no limit. Over an eighth of the width it appears eight times as great. This factor detects
/// it.
const EDGE: f32 = 4.0;

/// The greatest bend that was found, per metre.
struct Greatest {
    bend: f32,
    centre: Vec3,
    /// The vector from the centre to an end, in metres.
    way: Vec3,
}

impl Probe<'_> {
    /// Rejects a field whose stated bend is too small where waves can be. The error advises a bend that this check
    /// accepts.
    pub(super) fn check_bend(&self, stars: &Stars) -> Result<(), Error> {
        let Some(stated) = self.field.bend else {
            return Ok(());
        };
        let greatest = self.greatest_bend(stars);
        if greatest.bend <= stated * (1.0 + TOLERANCE) {
            return Ok(());
        }
        let closer = self.bend_closer(&greatest)?;
        let advice = rounded_up(MARGIN * greatest.bend.max(closer));
        Err(TraceError::FieldBends {
            file: self.field.file.display().to_string(),
            place: greatest.centre,
            bend: greatest.bend,
            stated,
            advice: (closer <= EDGE * greatest.bend).then_some(advice),
        }
        .into())
    }

    fn greatest_bend(&self, stars: &Stars) -> Greatest {
        let mut greatest = Greatest {
            bend: 0.0,
            centre: Vec3::ZERO,
            way: Vec3::ZERO,
        };
        for star in stars.each() {
            let scope = self.scope(star);
            for pair in 0..PAIRS {
                let [one, other] = [2 * pair + 1, 2 * pair + 2];
                if !counts(star, [one, other], scope) {
                    continue;
                }
                let way = 0.5 * (star.points[other] - star.points[one]);
                let [one, other] = [star.values[one], star.values[other]];
                let bend = self.bend_of([one, star.values[0], other], way.length());
                // A gradient of 0 has no direction, so its two ends coincide.
                if bend.is_finite() && bend > greatest.bend {
                    let centre = star.points[0];
                    greatest = Greatest { bend, centre, way };
                }
            }
        }
        greatest
    }

    /// The bend of three values with this distance between neighbours, minus its rounding error.
    fn bend_of(&self, [one, middle, other]: [f32; 3], way: f32) -> f32 {
        let rounding = WEIGHT * self.rounding(self.field.lipschitz);
        ((middle - one) + (middle - other) - rounding) / (way * way)
    }

    /// The greatest bend on the same line over shorter distances.
    fn bend_closer(&self, greatest: &Greatest) -> Result<f32, Error> {
        let Greatest { centre, way, .. } = *greatest;
        let share = |step: usize| 2.0 * step as f32 / CLOSER as f32 - 1.0;
        let points: Vec<Vec3> = (0..=CLOSER).map(|s| centre + share(s) * way).collect();
        let values = self.values(&points)?;
        let length = way.length() * NARROWER as f32 * 2.0 / CLOSER as f32;
        let bends = values.windows(2 * NARROWER + 1).map(|values| {
            self.bend_of([values[0], values[NARROWER], values[2 * NARROWER]], length)
        });
        Ok(bends.filter(|bend| bend.is_finite()).fold(0.0, f32::max))
    }
}

/// Whether waves can be at a star's centre and at these two ends.
fn counts(star: Star, ends: [usize; 2], scope: Scope) -> bool {
    match scope {
        Scope::Whole => true,
        Scope::Nowhere => false,
        Scope::Air => [0, ends[0], ends[1]]
            .iter()
            .all(|place| star.values[*place] > 0.0),
    }
}
