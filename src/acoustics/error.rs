//! What can go wrong with echograms and impulse responses.

/// A number that no echogram or impulse response can be made with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AcousticsError {
    /// A time bin outside [`BINS_S`](super::BINS_S).
    #[error(
        "a time bin of {bin_s} s: it must be {} s to {} s long",
        super::BINS_S.start(),
        super::BINS_S.end()
    )]
    BadBin {
        /// The requested length, in seconds.
        bin_s: f64,
    },
    /// A number of batches outside [`BATCHES`](super::BATCHES), or no power of two.
    #[error(
        "{batches} batches of waves: there must be a power of two, {} to {}",
        super::BATCHES.start(),
        super::BATCHES.end()
    )]
    BadBatches {
        /// The requested number.
        batches: usize,
    },
    /// A sampling rate outside [`RATES_HZ`](super::RATES_HZ).
    #[error(
        "an impulse response at {rate_hz} Hz: the rate must be {} Hz to {} Hz",
        super::RATES_HZ.start(),
        super::RATES_HZ.end()
    )]
    BadRate {
        /// The requested rate, in hertz.
        rate_hz: u32,
    },
    /// A length that is not above 0 s and at most [`MAX_SECONDS`](super::MAX_SECONDS).
    #[error(
        "an impulse response of {seconds} s: it must be longer than 0 s and no longer than {} s",
        super::MAX_SECONDS
    )]
    BadLength {
        /// The requested length, in seconds.
        seconds: f64,
    },
    /// Directions of a listener that span no axes: one has no length, or both are one line.
    #[error(
        "a listener that looks along {forward:?} with {up:?} above: the two must have lengths \
         and must not be parallel"
    )]
    BadAxes {
        /// Where the listener looks, world axes.
        forward: glam::DVec3,
        /// What is above it, world axes.
        up: glam::DVec3,
    },
    /// A set of head-related impulse responses that cannot be taken to the response's rate.
    #[error(transparent)]
    Hrir(#[from] super::hrir::HrirError),
}
