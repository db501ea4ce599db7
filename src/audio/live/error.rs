//! What can go wrong with live sound.

use crate::audio::AudioError;

/// What went wrong with live sound.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// A sound or a file.
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// The sound system has no output device, or is not there itself.
    #[error("there is no sound device to play on ({reason})")]
    NoDevice {
        /// The sound system's error.
        reason: String,
    },
    /// No output device of that name.
    #[error("no sound device is called `{name}` (known: {known})")]
    UnknownDevice {
        /// The requested name.
        name: String,
        /// The names that there are, in words.
        known: String,
    },
    /// The device takes no form of sample that is made here.
    #[error("the sound device {device} takes {format} samples, which are not supported")]
    UnsupportedFormat {
        /// The device.
        device: String,
        /// Its form of sample.
        format: String,
    },
    /// The device is there but cannot be opened.
    #[error("cannot open the sound device {device}: {reason}")]
    Open {
        /// The device.
        device: String,
        /// The sound system's error.
        reason: String,
    },
    /// The sound system did not answer in time.
    #[error("the sound system has not answered for {seconds} s")]
    NoAnswer {
        /// How long it was waited for.
        seconds: u64,
    },
    /// The sound system's client panicked.
    #[error("the sound system's client has failed: it is started again")]
    BrokenDown,
    /// The device broke off.
    #[error("the sound device {device} is lost: {reason}")]
    Lost {
        /// The device.
        device: String,
        /// The sound system's error.
        reason: String,
    },
    /// A recording is in progress already.
    #[error("a recording is under way: stop it first")]
    AlreadyRecording,
    /// There is no recording to stop.
    #[error("nothing is being recorded")]
    NotRecording,
    /// A recording whose device went on at another rate.
    #[error(
        "the recording ended: the sound device now runs at {rate_hz} Hz, and a file has one rate"
    )]
    RecordingRate {
        /// The device's rate, in hertz.
        rate_hz: u32,
    },
    /// A recording whose callback hangs.
    #[error("the recording ended: the sound device has not released it")]
    RecordingHeld,
    /// The operating system gave no thread.
    #[error("cannot start a thread: {source}")]
    Thread {
        /// Its error.
        source: std::io::Error,
    },
}
