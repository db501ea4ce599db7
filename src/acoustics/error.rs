//! Errors of echograms and impulse responses.

/// The reason why an echogram or impulse response cannot be made.
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
    /// A number of batches outside [`BATCHES`](super::BATCHES), or not a power of two.
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
    /// A number that is out of range for arriving sound.
    #[error("{what} must be {must}, not {value}")]
    BadNumber {
        /// Name of the number, with its unit.
        what: &'static str,
        /// Its valid range.
        must: &'static str,
        /// Its value.
        value: f64,
    },
    /// A tap with a number out of range.
    #[error("tap {index}: {what} must be {must}, not {value}")]
    BadTap {
        /// Its index among the taps or paths, from 0.
        index: usize,
        /// Name of the number, with its unit.
        what: &'static str,
        /// Its valid range.
        must: &'static str,
        /// Its value.
        value: f64,
    },
    /// A batch that an echogram does not have.
    #[error("batch {batch} of an echogram of {batches}: they are counted from 0")]
    NoSuchBatch {
        /// The requested batch, from 0.
        batch: usize,
        /// Number of batches.
        batches: usize,
    },
    /// Slices for one channel and for two with lengths that do not match.
    #[error(
        "{stereo} samples of two channels for {mono} samples of one: there must be twice as many"
    )]
    BadStereoLength {
        /// Samples of one channel.
        mono: usize,
        /// Samples of both channels.
        stereo: usize,
    },
    /// The heard sound was made for another player: its delays are in that player's samples.
    #[error(
        "the heard sound was made for {heard_hz} Hz and {heard_s} s, but is played at {played_hz} Hz for {played_s} s: make both with one Spec"
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
    /// A source number that the player does not have.
    #[error("source {source_number} of a player of {sources}: they are counted from 0")]
    NoSuchSource {
        /// The requested source, from 0.
        source_number: usize,
        /// Number of sources.
        sources: usize,
    },
    /// A listener's directions that do not define axes: one has no length, or both are parallel.
    #[error(
        "a listener that looks along {forward:?} with {up:?} above: the two must have lengths \
         and must not be parallel"
    )]
    BadAxes {
        /// Viewing direction of the listener, world axes.
        forward: glam::DVec3,
        /// Upward direction of the listener, world axes.
        up: glam::DVec3,
    },
    /// A set of head-related impulse responses that cannot be resampled to the response's rate.
    #[error(transparent)]
    Hrir(#[from] super::hrir::HrirError),
}
