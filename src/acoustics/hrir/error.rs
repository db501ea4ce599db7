//! Errors of sets of head-related impulse responses.

use super::{HRIR_RATES_HZ, MAX_DIRECTIONS, MAX_SAMPLES, MAX_VALUES};

/// The reason why measurements are not a valid set of head-related impulse responses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HrirError {
    /// A sampling rate outside [`HRIR_RATES_HZ`].
    #[error(
        "head-related impulse responses at {rate_hz} Hz: the rate must be {} Hz to {} Hz",
        HRIR_RATES_HZ.start(),
        HRIR_RATES_HZ.end()
    )]
    BadRate {
        /// The rate, in hertz.
        rate_hz: u32,
    },
    /// No direction, or more than [`MAX_DIRECTIONS`].
    #[error("{count} measured directions: there must be 1 to {MAX_DIRECTIONS}")]
    BadCount {
        /// Number of directions.
        count: usize,
    },
    /// A response without samples, or with more than [`MAX_SAMPLES`].
    #[error(
        "head-related impulse responses of {samples} samples: they must have 1 to {MAX_SAMPLES}"
    )]
    BadLength {
        /// Number of samples of a response.
        samples: usize,
    },
    /// More than [`MAX_VALUES`] samples in total.
    #[error("{values} samples in all directions and both ears: there must be at most {MAX_VALUES}")]
    TooLarge {
        /// Total number of samples.
        values: u64,
    },
    /// A response whose length differs from that of the first.
    #[error("measurement {index} has {samples} samples where the first has {expected}")]
    UnevenLength {
        /// Index of the measurement, from 0.
        index: usize,
        /// Its number of samples.
        samples: usize,
        /// Number of samples of the first one.
        expected: usize,
    },
    /// A direction that is not a finite vector, or has no length.
    #[error("measurement {index} comes from {from:?}, which is not a direction")]
    BadDirection {
        /// Index of the measurement, from 0.
        index: usize,
        /// Its direction, listener axes.
        from: glam::DVec3,
    },
    /// A sample that is not a finite number, or is larger than [`LOUDEST`](super::LOUDEST).
    #[error(
        "measurement {index} has the sample {value}: samples must be finite and no larger than {}",
        super::LOUDEST
    )]
    BadSample {
        /// Index of the measurement, from 0.
        index: usize,
        /// The sample.
        value: f32,
    },
    /// A delay that is not a finite number, or beyond [`LONGEST_DELAY_S`](super::LONGEST_DELAY_S).
    #[error(
        "measurement {index} has a delay of {seconds} s: it must be within ±{} s",
        super::LONGEST_DELAY_S
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
