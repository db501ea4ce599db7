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
        "a sampling rate of {rate_hz} Hz: impulse responses are made for {} Hz to {} Hz",
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
    /// A number of what arrives that no sound has.
    #[error("{what} must be {must}, not {value}")]
    BadNumber {
        /// Which number, with its unit.
        what: &'static str,
        /// Its range.
        must: &'static str,
        /// The value.
        value: f64,
    },
    /// A tap with a number that no sound has.
    #[error("tap {index}: {what} must be {must}, not {value}")]
    BadTap {
        /// Its place among the taps or paths, from 0.
        index: usize,
        /// Which number, with its unit.
        what: &'static str,
        /// Its range.
        must: &'static str,
        /// The value.
        value: f64,
    },
    /// A batch that an echogram does not have.
    #[error("batch {batch} of an echogram of {batches}: they are counted from 0")]
    NoSuchBatch {
        /// The requested one, from 0.
        batch: usize,
        /// How many there are.
        batches: usize,
    },
    /// Slices for one channel and for two whose lengths do not fit.
    #[error(
        "{stereo} samples of two channels for {mono} samples of one: there must be twice as many"
    )]
    BadStereoLength {
        /// Samples of one channel.
        mono: usize,
        /// Samples of both channels.
        stereo: usize,
    },
    /// What is heard was made for another player: its delays are samples of that one.
    #[error(
        "what is heard was made for {heard_hz} Hz and {heard_s} s, and is played at {played_hz} Hz for {played_s} s: make both of one Spec"
    )]
    OtherSpec {
        /// The rate that it was made for, in hertz.
        heard_hz: u32,
        /// The longest response that it was made for, in seconds.
        heard_s: f64,
        /// The player's rate, in hertz.
        played_hz: u32,
        /// The player's longest response, in seconds.
        played_s: f64,
    },
    /// A source that is not played.
    #[error("source {source_number} of a player of {sources}: they are counted from 0")]
    NoSuchSource {
        /// The requested one, from 0.
        source_number: usize,
        /// How many there are.
        sources: usize,
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
