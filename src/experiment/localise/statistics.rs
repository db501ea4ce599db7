//! Figures over answers: median, bias, spread, and how sure they are.
//!
//! The interval of a median is the percentile bootstrap (Efron 1979), stratified: the errors
//! are drawn anew, with replacement, [`RESAMPLES`] times by a generator of a fixed seed, as
//! many for each truth as there were; the interval holds the middle 95 % of the medians. It
//! makes no assumption about the errors' distribution, which is far from normal: answers end
//! at ±90°, and each truth has a bias of its own. So it tells of the chance in the waves (or
//! of people), not of the choice of truths.

use super::random::Random;
use crate::experiment::median;
use serde::Serialize;

/// Drawings of a bootstrap.
pub const RESAMPLES: usize = 1000;

/// What an interval holds of the resampled medians.
pub const CONFIDENCE: f64 = 0.95;

/// Errors of answers, in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorFigures {
    /// Median of the absolute errors.
    pub median_abs_deg: f64,
    /// Lower end of the median's interval.
    pub low_deg: f64,
    /// Upper end of the median's interval.
    pub high_deg: f64,
    /// Mean error: positive for answers too far to the right.
    pub bias_deg: f64,
    /// Mean error away from the middle, over truths beside it: negative for answers that are
    /// pulled to the middle. 0 when all truths are in the middle.
    pub outward_bias_deg: f64,
    /// Deviation from the mean answer to the same truth.
    pub spread_deg: f64,
}

/// A truth and the answer to it, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// What would have been right.
    pub truth_deg: f64,
    /// What was said.
    pub answer_deg: f64,
}

impl Pair {
    fn error(&self) -> f64 {
        self.answer_deg - self.truth_deg
    }
}

/// The figures of some answers; all 0 for none.
pub fn figures(pairs: &[Pair]) -> ErrorFigures {
    if pairs.is_empty() {
        return ErrorFigures::default();
    }
    let strata = by_truth(pairs);
    let absolute: Vec<Vec<f64>> = strata
        .iter()
        .map(|of| of.iter().map(|pair| pair.error().abs()).collect())
        .collect();
    let (low_deg, high_deg) = median_interval(&absolute);
    // A truth this near to the middle has no outside.
    const MIDDLE_DEG: f64 = 1.0;
    let beside = pairs
        .iter()
        .filter(|pair| pair.truth_deg.abs() > MIDDLE_DEG);
    let outward: Vec<f64> = beside
        .map(|pair| pair.error() * pair.truth_deg.signum())
        .collect();
    ErrorFigures {
        median_abs_deg: median(absolute.into_iter().flatten()),
        low_deg,
        high_deg,
        bias_deg: mean(pairs.iter().map(Pair::error)),
        outward_bias_deg: mean(outward.iter().copied()),
        spread_deg: spread(&strata),
    }
}

/// The answers to each truth together.
fn by_truth(pairs: &[Pair]) -> Vec<Vec<Pair>> {
    let mut strata: Vec<Vec<Pair>> = Vec::new();
    for pair in pairs {
        let same = |stratum: &&mut Vec<Pair>| stratum[0].truth_deg == pair.truth_deg;
        match strata.iter_mut().find(same) {
            Some(stratum) => stratum.push(*pair),
            None => strata.push(vec![*pair]),
        }
    }
    strata
}

/// The bootstrap's interval of the median of all values, drawn from each stratum apart.
pub fn median_interval(strata: &[Vec<f64>]) -> (f64, f64) {
    const SEED: u64 = 1979;
    let mut random = Random::new(SEED);
    let mut medians: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut draw = Vec::new();
            for values in strata {
                draw.extend((0..values.len()).map(|_| values[random.below(values.len())]));
            }
            median(draw)
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    let tail = (0.5 * (1.0 - CONFIDENCE) * RESAMPLES as f64) as usize;
    (medians[tail], medians[RESAMPLES - 1 - tail])
}

/// Root of the mean variance of the answers to one truth, over truths with two answers or
/// more.
fn spread(strata: &[Vec<Pair>]) -> f64 {
    let variances = strata.iter().filter(|of| of.len() > 1).map(|of| {
        let middle = mean(of.iter().map(|pair| pair.answer_deg));
        let squares = of.iter().map(|pair| (pair.answer_deg - middle).powi(2));
        squares.sum::<f64>() / (of.len() - 1) as f64
    });
    let variances: Vec<f64> = variances.collect();
    mean(variances.iter().copied()).sqrt()
}

/// 0 for none.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count.max(1))
}

/// One count on the way to the largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Waves or iterations.
    pub count: u32,
    /// Median error there, in degrees.
    pub median_deg: f64,
    /// The median's interval, in degrees.
    pub interval_deg: (f64, f64),
    /// Whether there was enough to hear for the error to mean anything.
    pub heard: bool,
}

/// The smallest count from which on every median is within the interval of the largest
/// count's, or below it: from there on more does not help. `steps` in order of the count;
/// one that is not heard ends the plateau, so that silence, which is answered with the
/// middle, is never as good as an answer.
pub fn plateau(steps: &[Step]) -> Option<u32> {
    // Rounding is no improvement.
    const ROUNDING_DEG: f64 = 1e-6;
    let highest = steps.last()?.interval_deg.1 + ROUNDING_DEG;
    let settled = steps
        .iter()
        .rev()
        .take_while(|step| step.heard && step.median_deg <= highest);
    settled.last().map(|step| step.count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(truth_deg: f64, answer_deg: f64) -> Pair {
        Pair {
            truth_deg,
            answer_deg,
        }
    }

    /// Protects signs: a pull to the middle has no bias when both sides are pulled alike.
    #[test]
    fn biases_and_spread_are_told_apart() {
        let pulled = figures(&[
            pair(-40.0, -29.0),
            pair(-40.0, -31.0),
            pair(40.0, 31.0),
            pair(40.0, 29.0),
            pair(0.0, 0.0),
        ]);
        assert!(pulled.bias_deg.abs() < 1e-12);
        assert!((pulled.outward_bias_deg + 10.0).abs() < 1e-12);
        assert!((pulled.spread_deg - 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(pulled.median_abs_deg, 9.0);
        assert!(pulled.low_deg <= 9.0 && pulled.high_deg >= 9.0);
        assert_eq!(figures(&[]), ErrorFigures::default());
    }

    /// Protects the interval: the middle of many, wide for few, the same every time.
    #[test]
    fn intervals_narrow_with_more_values() {
        let ramp = |count: u32| -> Vec<f64> {
            (0..count)
                .map(|i| f64::from(i) / f64::from(count - 1))
                .collect()
        };
        let width = |count| {
            let (low, high) = median_interval(&[ramp(count)]);
            assert!(low < 0.5 && high > 0.5);
            high - low
        };
        assert!(width(11) > 2.0 * width(1001));
        // Truths with biases of their own, and no chance in any: nothing to be unsure of.
        assert_eq!(median_interval(&[vec![1.0; 3], vec![9.0; 5]]), (9.0, 9.0));
        assert_eq!(median_interval(&[ramp(11)]), median_interval(&[ramp(11)]));
    }

    /// Protects the plateau: a lucky small count does not end it.
    #[test]
    fn the_plateau_begins_where_all_that_follow_are_as_good() {
        let step = |count, median_deg| Step {
            count,
            median_deg,
            interval_deg: (median_deg - 1.0, median_deg + 1.0),
            heard: true,
        };
        let mut steps = [step(1, 5.5), step(2, 9.0), step(4, 5.9), step(8, 5.0)];
        assert_eq!(plateau(&steps), Some(4));
        steps[2].heard = false;
        assert_eq!(plateau(&steps), Some(8));
        steps[3].heard = false;
        assert_eq!(plateau(&steps), None);
        assert_eq!(plateau(&steps[..1]), Some(1));
        assert_eq!(plateau(&[]), None);
    }
}
