//! Head-related impulse responses: the effect of a head, its ears and its torso on sound from each
//! direction.
//!
//! A [`HrirSet`] contains one pair of responses for each measured direction, and interpolates
//! between them. It is made from measurements ([`HrirSet::new`]) or read from a SOFA file
//! (`HrirSet::read_sofa`, feature `sofa`).
//!
//! # Axes
//! The axes of SOFA and AmbiX: x ahead of the listener, y to the left, z up. Directions point towards the origin of the
//! sound. [`ListenerAxes::to_listener`](crate::response::ListenerAxes::to_listener) converts a world vector to these
//! axes.
//!
//! # Method
//! - The **onset** of each response is found (`onset.rs`) and removed: all responses of a set begin at the same sample,
//!   and each has a separate delay. Mixing responses with different onsets would cancel high frequencies.
//! - **Between measured directions** the responses of the three surrounding directions are mixed (`facets.rs`): their
//!   samples and their delays, with the same weights.
//! - **Delays count from the head's centre**: the mean delay over all directions and both ears is taken as the time at
//!   which sound would pass the centre without the head. Silence before the onsets in a file therefore does not delay
//!   the sound. For a rigid sphere this mean is off by 0.04 radii, 10 µs.
//! - **Levels** are not changed. If the measured levels are relative to the sound pressure at the head's centre without
//!   the head, as is usual, the response to a direct sound at 1 m is the unscaled HRIR of its direction.

use crate::resample;
use crate::sampling::lattice;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::RangeInclusive;

pub(crate) mod balloon;
mod facet_index;
mod facets;
mod onset;
#[cfg(feature = "sofa")]
mod sofa;
#[cfg(test)]
pub(crate) mod tests;

#[cfg(feature = "sofa")]
pub use sofa::{SofaError, SofaProblem};

#[cfg(feature = "sofa")]
pub(crate) use balloon::{Balloon, BalloonError};
#[cfg(feature = "simulator")]
pub(crate) use facet_index::IndexedFacets;
pub(crate) use facets::Facets;

/// Silent samples before and after shifted responses. A shift by a fraction of a sample causes a ripple, which decays
/// within these samples.
const MARGIN: usize = 32;

/// Number of directions over which the mean delay is taken. They are spread evenly over the sphere and do not depend on
/// the measured directions.
const DELAY_DIRECTIONS: u64 = 256;

/// The measurement of one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredHrir {
    /// Direction that the sound comes from, listener axes, any length.
    pub from: DVec3,
    /// Samples of the left and of the right ear.
    pub ears: [Vec<f32>; 2],
    /// Delay of each response in addition to its samples, in seconds.
    pub delays_s: [f64; 2],
}

/// The response of one ear to an impulse.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hrir {
    /// The samples, at the set's rate.
    pub samples: Vec<f32>,
    /// Time of the first sample: seconds after the sound would pass the head's centre without the head. It is mostly
    /// negative, because silent samples precede the onset.
    pub delay_s: f64,
}

/// Head-related impulse responses of many directions.
///
/// ```
/// use echomarch::hrtf::{HrirSet, MeasuredHrir};
/// use echomarch::glam::DVec3;
///
/// // Two directions of a head that only attenuates: left is louder on the left.
/// let measured = |y: f64, left: f32, right: f32| MeasuredHrir {
///     from: DVec3::new(0.0, y, 0.0),
///     ears: [vec![left, 0.0], vec![right, 0.0]],
///     delays_s: [0.0; 2],
/// };
/// let set = HrirSet::new(48_000, vec![measured(1.0, 0.9, 0.3), measured(-1.0, 0.3, 0.9)])?;
/// let [at_left, at_right] = set.pair(DVec3::Y);
/// let sum = |samples: &[f32]| samples.iter().sum::<f32>();
/// assert!((sum(&at_left.samples) - 0.9).abs() < 1e-3);
/// assert!((sum(&at_right.samples) - 0.3).abs() < 1e-3);
/// # Ok::<(), echomarch::hrtf::HrirError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct HrirSet {
    rate_hz: u32,
    samples: usize,
    facets: Facets,
    /// The responses of the left and of the right ear for each direction of `facets`.
    pairs: Vec<[Hrir; 2]>,
}

impl HrirSet {
    /// The lowest and the highest sampling rate of a set, in hertz.
    pub const RATES_HZ: RangeInclusive<u32> = 8_000..=192_000;

    /// Maximum number of directions of a set. The densest measurements have about 20,000.
    pub const MAX_DIRECTIONS: usize = 1 << 16;

    /// Maximum number of samples of a response: 85 ms at 192 kHz. A head's response lasts a few
    /// milliseconds.
    pub const MAX_SAMPLES: usize = 1 << 14;

    /// Maximum number of samples of a set, both ears: 128 MiB. A dense set has 6 million.
    pub const MAX_VALUES: u64 = 1 << 25;

    /// Maximum magnitude of a sample: 120 dB above full scale. Files in pascal or in arbitrary units are far below.
    /// With larger samples, sums lose small values.
    pub const LOUDEST: f32 = 1e6;

    /// Maximum delay of a response in addition to its samples, in seconds: sound travels 34 m in this
    /// time.
    pub const LONGEST_DELAY_S: f64 = 0.1;

    /// Creates a set of these measurements. If several measurements have the same direction, the first is used.
    ///
    /// # Errors
    /// [`HrirError`]: numbers out of range, responses of different lengths, silence.
    pub fn new(rate_hz: u32, mut measured: Vec<MeasuredHrir>) -> Result<HrirSet, HrirError> {
        let samples = check(rate_hz, &measured)?;
        for measured in &mut measured {
            measured.from = measured.from.normalize();
        }
        let directions: Vec<DVec3> = measured.iter().map(|measured| measured.from).collect();
        let kept: Vec<&MeasuredHrir> = facets::distinct(&directions)
            .into_iter()
            .map(|index| &measured[index])
            .collect();
        let facets = Facets::new(kept.iter().map(|measured| measured.from).collect());
        let aligned = onset::aligned(&kept, samples, rate_hz).ok_or(HrirError::Silent)?;
        let mut set = HrirSet {
            rate_hz,
            samples: length(&aligned.pairs),
            facets,
            pairs: aligned.pairs,
        };
        set.count_from_the_centre(aligned.onset_s);
        Ok(set)
    }

    /// Samples per second.
    pub fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    /// Number of samples of each response.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The measured directions: unit vectors in listener axes.
    pub fn directions(&self) -> &[DVec3] {
        self.facets.directions()
    }

    /// Checks that the set can be converted to a sampling rate, by one of its responses.
    ///
    /// # Errors
    /// [`HrirError::BadRate`], [`HrirError::Resample`].
    #[cfg(feature = "simulator")]
    pub(crate) fn check_rate(&self, rate_hz: u32) -> Result<(), HrirError> {
        let one = HrirSet {
            rate_hz: self.rate_hz,
            samples: self.samples,
            facets: self.facets.clone(),
            pairs: self.pairs.iter().take(1).cloned().collect(),
        };
        one.at_rate(rate_hz).map(|_| ())
    }

    /// Converts the set to another sampling rate. Responses keep their spectrum: samples are scaled by the ratio of the
    /// rates.
    ///
    /// # Errors
    /// [`HrirError::BadRate`], [`HrirError::Resample`].
    pub fn at_rate(&self, rate_hz: u32) -> Result<HrirSet, HrirError> {
        if !HrirSet::RATES_HZ.contains(&rate_hz) {
            return Err(HrirError::BadRate { rate_hz });
        }
        let resample = |hrir: &Hrir| -> Result<Hrir, HrirError> {
            let samples = resample::to_rate(hrir.samples.clone(), self.rate_hz, rate_hz);
            let samples = samples.map_err(|reason| HrirError::Resample {
                from_hz: self.rate_hz,
                to_hz: rate_hz,
                reason,
            })?;
            let scale = self.rate_hz as f32 / rate_hz as f32;
            Ok(Hrir {
                samples: samples.into_iter().map(|sample| sample * scale).collect(),
                delay_s: hrir.delay_s,
            })
        };
        let both = |[left, right]: &[Hrir; 2]| Ok([resample(left)?, resample(right)?]);
        let pairs: Result<Vec<_>, HrirError> = self.pairs.par_iter().map(both).collect();
        let pairs = pairs?;
        Ok(HrirSet {
            rate_hz,
            samples: length(&pairs),
            facets: self.facets.clone(),
            pairs,
        })
    }

    /// The responses of the left and of the right ear to sound from a direction in listener axes, of any length; a zero
    /// vector counts as straight ahead.
    pub fn pair(&self, from: DVec3) -> [Hrir; 2] {
        let mut pair = <[Hrir; 2]>::default();
        self.pair_into(from, &mut pair);
        pair
    }

    /// Like [`pair`](Self::pair), but stores the responses in an existing pair. Does not allocate if this set has
    /// filled the pair before.
    pub fn pair_into(&self, from: DVec3, pair: &mut [Hrir; 2]) {
        let from = from.try_normalize().unwrap_or(DVec3::X);
        let around = self.facets.around(from);
        for (ear, hrir) in pair.iter_mut().enumerate() {
            self.mix(&around, ear, hrir);
        }
    }

    fn mix(&self, around: &[facets::Weight; 3], ear: usize, out: &mut Hrir) {
        out.samples.clear();
        out.samples.resize(self.samples, 0.0);
        out.delay_s = 0.0;
        for (index, weight) in around.iter().filter(|(_, weight)| *weight > 0.0) {
            let hrir = &self.pairs[*index][ear];
            out.delay_s += weight * hrir.delay_s;
            for (sum, sample) in out.samples.iter_mut().zip(&hrir.samples) {
                *sum += *weight as f32 * sample;
            }
        }
    }

    /// Subtracts the mean delay, so that the mean onset is at 0 s.
    fn count_from_the_centre(&mut self, onset_s: f64) {
        let delay = |from: DVec3| -> f64 {
            let of = |(index, weight): (usize, f64)| {
                let [left, right] = &self.pairs[index];
                weight * 0.5 * (left.delay_s + right.delay_s)
            };
            self.facets.around(from).into_iter().map(of).sum()
        };
        let mean = lattice(DELAY_DIRECTIONS).map(delay).sum::<f64>() / DELAY_DIRECTIONS as f64;
        for hrir in self.pairs.iter_mut().flatten() {
            hrir.delay_s -= mean + onset_s;
        }
    }
}

/// Omits the samples.
impl std::fmt::Debug for HrirSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HrirSet")
            .field("rate_hz", &self.rate_hz)
            .field("directions", &self.directions().len())
            .field("samples", &self.samples)
            .finish_non_exhaustive()
    }
}

/// Number of samples of each response.
fn length(pairs: &[[Hrir; 2]]) -> usize {
    pairs.first().map_or(0, |[left, _]| left.samples.len())
}

/// The reason why measurements are not a valid set of head-related impulse responses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HrirError {
    /// A sampling rate outside [`HrirSet::RATES_HZ`].
    #[error(
        "head-related impulse responses at {rate_hz} Hz: the rate must be {} Hz to {} Hz",
        HrirSet::RATES_HZ.start(),
        HrirSet::RATES_HZ.end()
    )]
    BadRate {
        /// The rate, in hertz.
        rate_hz: u32,
    },
    /// No direction, or more than [`HrirSet::MAX_DIRECTIONS`].
    #[error(
        "{count} measured directions: there must be 1 to {}",
        HrirSet::MAX_DIRECTIONS
    )]
    BadCount {
        /// Number of directions.
        count: usize,
    },
    /// A response without samples, or with more than [`HrirSet::MAX_SAMPLES`].
    #[error(
        "head-related impulse responses of {samples} samples: they must have 1 to {}",
        HrirSet::MAX_SAMPLES
    )]
    BadLength {
        /// Number of samples of a response.
        samples: usize,
    },
    /// More than [`HrirSet::MAX_VALUES`] samples in total.
    #[error(
        "{values} samples in all directions and both ears: there must be at most {}",
        HrirSet::MAX_VALUES
    )]
    TooLarge {
        /// Total number of samples.
        values: u64,
    },
    /// A response whose length differs from that of the first response.
    #[error("measurement {index} has {samples} samples, but the first has {expected}")]
    UnevenLength {
        /// Index of the measurement, from 0.
        index: usize,
        /// Number of samples of the measurement.
        samples: usize,
        /// Number of samples of the first measurement.
        expected: usize,
    },
    /// A direction that is not a finite vector, or has length zero.
    #[error("measurement {index} comes from {from:?}, which is not a direction")]
    BadDirection {
        /// Index of the measurement, from 0.
        index: usize,
        /// Direction of the measurement, listener axes.
        from: glam::DVec3,
    },
    /// A sample that is not a finite number, or is larger than [`HrirSet::LOUDEST`].
    #[error(
        "measurement {index} has the sample {value}: samples must be finite and no larger than {}",
        HrirSet::LOUDEST
    )]
    BadSample {
        /// Index of the measurement, from 0.
        index: usize,
        /// The sample.
        value: f32,
    },
    /// A delay that is not a finite number, or beyond [`HrirSet::LONGEST_DELAY_S`].
    #[error(
        "measurement {index} has a delay of {seconds} s: it must be within ±{} s",
        HrirSet::LONGEST_DELAY_S
    )]
    BadDelay {
        /// Index of the measurement, from 0.
        index: usize,
        /// The delay in seconds.
        seconds: f64,
    },
    /// Both ears are silent in all directions.
    #[error("all samples are 0")]
    Silent,
    /// The resampler rejects the pair of rates.
    #[error(
        "cannot resample head-related impulse responses from {from_hz} Hz to {to_hz} Hz: {reason}"
    )]
    Resample {
        /// The rate of the set, in hertz.
        from_hz: u32,
        /// The requested rate, in hertz.
        to_hz: u32,
        /// The resampler's error.
        reason: String,
    },
}

/// The number of samples of each response, if all numbers are in range.
fn check(rate_hz: u32, measured: &[MeasuredHrir]) -> Result<usize, HrirError> {
    if !HrirSet::RATES_HZ.contains(&rate_hz) {
        return Err(HrirError::BadRate { rate_hz });
    }
    let samples = measured.first().map_or(0, |first| first.ears[0].len());
    check_sizes(measured.len(), samples)?;
    for (index, measured) in measured.iter().enumerate() {
        check_one(index, measured, samples)?;
    }
    Ok(samples)
}

/// Rejects sets that are too large.
fn check_sizes(directions: usize, samples: usize) -> Result<(), HrirError> {
    if !(1..=HrirSet::MAX_DIRECTIONS).contains(&directions) {
        return Err(HrirError::BadCount { count: directions });
    }
    if !(1..=HrirSet::MAX_SAMPLES).contains(&samples) {
        return Err(HrirError::BadLength { samples });
    }
    let values = 2 * directions as u64 * samples as u64;
    if values > HrirSet::MAX_VALUES {
        return Err(HrirError::TooLarge { values });
    }
    Ok(())
}

fn check_one(index: usize, measured: &MeasuredHrir, expected: usize) -> Result<(), HrirError> {
    let from = measured.from;
    if !from.is_finite() || from.try_normalize().is_none() {
        return Err(HrirError::BadDirection { index, from });
    }
    for ear in &measured.ears {
        let samples = ear.len();
        if samples != expected {
            return Err(HrirError::UnevenLength {
                index,
                samples,
                expected,
            });
        }
        let is_good = |sample: &f32| sample.is_finite() && sample.abs() <= HrirSet::LOUDEST;
        if let Some(value) = ear.iter().find(|sample| !is_good(sample)) {
            return Err(HrirError::BadSample {
                index,
                value: *value,
            });
        }
    }
    let is_good = |seconds: &f64| seconds.abs() <= HrirSet::LONGEST_DELAY_S;
    match measured.delays_s.into_iter().find(|delay| !is_good(delay)) {
        Some(seconds) => Err(HrirError::BadDelay { index, seconds }),
        None => Ok(()),
    }
}
