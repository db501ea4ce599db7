//! Errors of echograms and impulse responses, and range checks of the numbers of arriving sound.

use super::Tap;
use crate::bands::Bands;
use glam::DVec3;

/// The reason why an echogram or impulse response cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// A time bin outside [`Echogram::BINS_S`](super::Echogram::BINS_S).
    #[error(
        "a time bin of {bin_s} s: it must be {} s to {} s long",
        super::Echogram::BINS_S.start(),
        super::Echogram::BINS_S.end()
    )]
    BadBin {
        /// The requested length, in seconds.
        bin_s: f64,
    },
    /// A number of batches outside [`Echogram::BATCHES`](super::Echogram::BATCHES), or not a power of two.
    #[error(
        "{batches} batches of waves: the number must be a power of two, {} to {}",
        super::Echogram::BATCHES.start(),
        super::Echogram::BATCHES.end()
    )]
    BadBatches {
        /// The requested number.
        batches: usize,
    },
    /// A sampling rate outside [`ImpulseSettings::RATES_HZ`](super::ImpulseSettings::RATES_HZ).
    #[error(
        "a sampling rate of {rate_hz} Hz: impulse responses are made for {} Hz to {} Hz",
        super::ImpulseSettings::RATES_HZ.start(),
        super::ImpulseSettings::RATES_HZ.end()
    )]
    BadRate {
        /// The requested rate, in hertz.
        rate_hz: u32,
    },
    /// A length that is not above 0 s and at most
    /// [`ImpulseSettings::MAX_SECONDS`](super::ImpulseSettings::MAX_SECONDS).
    #[error(
        "an impulse response of {seconds} s: it must be longer than 0 s and no longer than {} s",
        super::ImpulseSettings::MAX_SECONDS
    )]
    BadLength {
        /// The requested length, in seconds.
        seconds: f64,
    },
    /// A number out of range for arriving sound.
    #[error("{what} must be {must}, not {value}")]
    BadNumber {
        /// Name of the number, with its unit.
        what: &'static str,
        /// The valid range of the number.
        must: &'static str,
        /// The value of the number.
        value: f64,
    },
    /// A tap with a number out of range.
    #[error("tap {index}: {what} must be {must}, not {value}")]
    BadTap {
        /// The tap's index among the taps or paths, from 0.
        index: usize,
        /// Name of the number, with its unit.
        what: &'static str,
        /// The valid range of the number.
        must: &'static str,
        /// The value of the number.
        value: f64,
    },
    /// A batch number out of range.
    #[error("batch {batch} of an echogram with {batches} batches, counted from 0")]
    NoSuchBatch {
        /// The requested batch, from 0.
        batch: usize,
        /// Number of batches.
        batches: usize,
    },
    /// Slices for one channel and for two channels whose lengths do not match.
    #[error(
        "{stereo} stereo samples for {mono} mono samples: there must be two stereo samples for each mono sample"
    )]
    BadStereoLength {
        /// Samples of one channel.
        mono: usize,
        /// Samples of both channels.
        stereo: usize,
    },
    /// An `auralisation::Heard` made for another player: its delays are in that player's samples.
    #[error(
        "the heard sound was made for {heard_hz} Hz and {heard_s} s, but is played at {played_hz} Hz for {played_s} s: make both with one Spec"
    )]
    OtherSpec {
        /// The rate of the heard sound in hertz.
        heard_hz: u32,
        /// The longest response of the heard sound in seconds.
        heard_s: f64,
        /// The player's rate, in hertz.
        played_hz: u32,
        /// The player's longest response, in seconds.
        played_s: f64,
    },
    /// A source number out of range.
    #[error("source {source_number} of a player with {sources} sources, counted from 0")]
    NoSuchSource {
        /// The requested source, from 0.
        source_number: usize,
        /// Number of sources.
        sources: usize,
    },
    /// A listener whose directions do not define axes, because one has length zero or both are parallel.
    #[error(
        "a listener with the viewing direction {forward:?} and the upward direction {up:?}: neither may \
         be zero, and they must not be parallel"
    )]
    BadAxes {
        /// Viewing direction of the listener, world axes.
        forward: glam::DVec3,
        /// Upward direction of the listener, world axes.
        up: glam::DVec3,
    },
    /// A set of head-related impulse responses that cannot be resampled to the response's rate.
    #[error(transparent)]
    Hrir(#[from] crate::hrtf::HrirError),
}

/// The largest energy density in 1/m². The amplitude of this density is far within the range of samples (`f32`), and
/// sums of squares of such densities are far within the range of `f64`. The loudest source, of 120 dB, reaches this
/// density only within 10⁻²⁴ m.
const LARGEST_ENERGY: f64 = 1e60;

/// Maximum length of a unit vector after rounding to `f32`.
const LONGEST_UNIT: f64 = 1.0 + 1e-5;

/// Checks an energy by bands and its direction of flight. A direction is shorter than 1 if the sound comes from several
/// sides.
///
/// # Errors
/// [`ResponseError::BadNumber`] with the first number out of range.
pub(super) fn check(energy: &Bands, direction: DVec3) -> Result<(), ResponseError> {
    let in_range = |energy: &f64| (0.0..=LARGEST_ENERGY).contains(energy);
    if let Some(&value) = energy.iter().find(|energy| !in_range(energy)) {
        return Err(bad("an energy in 1/m²", "0 to 1e60", value));
    }
    match direction.length() {
        length if length <= LONGEST_UNIT => Ok(()),
        length => Err(bad("the length of a direction", "at most 1", length)),
    }
}

/// Checks every number of these taps.
///
/// # Errors
/// [`ResponseError::BadTap`] with the first number out of range.
pub(crate) fn check_taps<'a>(taps: impl IntoIterator<Item = &'a Tap>) -> Result<(), ResponseError> {
    for (index, tap) in taps.into_iter().enumerate() {
        check_tap(tap).map_err(|refused| match refused {
            ResponseError::BadNumber { what, must, value } => ResponseError::BadTap {
                index,
                what,
                must,
                value,
            },
            other => other,
        })?;
    }
    Ok(())
}

fn check_tap(tap: &Tap) -> Result<(), ResponseError> {
    if !(tap.seconds.is_finite() && tap.seconds >= 0.0) {
        let must = "finite and not negative";
        return Err(bad("its time in seconds", must, tap.seconds));
    }
    check(&tap.energy, tap.direction)
}

/// Checks a speed of sound in metres per second.
///
/// # Errors
/// [`ResponseError::BadNumber`] unless it is finite and above 0.
pub(super) fn check_speed(m_per_s: f64) -> Result<(), ResponseError> {
    match m_per_s > 0.0 && m_per_s.is_finite() {
        true => Ok(()),
        false => Err(bad(
            "the speed of sound in m/s",
            "finite and above 0",
            m_per_s,
        )),
    }
}

/// Returns the error for a number out of its range.
pub(super) fn bad(what: &'static str, must: &'static str, value: f64) -> ResponseError {
    ResponseError::BadNumber { what, must, value }
}
