//! Aligns responses to a common onset, with a delay for each.

use super::onset::{Mover, OnsetFinder};
use super::{Hrir, HrirPair, MARGIN, MeasuredHrir};
use rayon::prelude::*;

/// Responses with a common onset.
pub(super) struct Aligned {
    pub(super) pairs: Vec<HrirPair>,
    /// The common onset, in seconds after their first sample.
    pub(super) onset_s: f64,
}

/// Removes the onsets: all responses begin at the same sample afterwards, and no sample of a
/// measurement is lost. `None` if all are silent.
pub(super) fn aligned(measured: &[&MeasuredHrir], samples: usize, rate_hz: u32) -> Option<Aligned> {
    let finder = OnsetFinder::new(samples);
    // An onset is within the response: a result beyond its ends is due to rounding.
    let onset = |ear: &Vec<f32>| Some(finder.find(ear)?.clamp(0.0, samples as f64));
    let found: Vec<[Option<f64>; 2]> = measured
        .par_iter()
        .map(|measured| measured.ears.each_ref().map(onset))
        .collect();
    let known = || found.iter().flatten().flatten().copied();
    let (earliest, latest) = (known().reduce(f64::min)?, known().reduce(f64::max)?);
    // Silence has no onset; the mean of the others does not disturb the delays next to it.
    let middle = known().sum::<f64>() / known().count() as f64;
    let mover = Mover::new(samples + (latest - earliest).ceil() as usize + 2 * MARGIN);
    let (rate, place) = (f64::from(rate_hz), MARGIN as f64 + latest);
    let pair = |(measured, found): (&&MeasuredHrir, &[Option<f64>; 2])| {
        let [left, right] = std::array::from_fn(|ear| {
            let later = place - found[ear].unwrap_or(middle);
            Hrir {
                samples: mover.later(&measured.ears[ear], later),
                delay_s: measured.delays_s[ear] - later / rate,
            }
        });
        HrirPair { left, right }
    };
    Some(Aligned {
        pairs: measured.par_iter().zip(&found).map(pair).collect(),
        onset_s: place / rate,
    })
}
