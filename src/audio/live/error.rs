//! Errors of live sound.

use crate::audio::AudioError;

/// Error of live sound.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// An error of a sound or a file.
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// The sound system is missing, or has no output device.
    #[error("there is no sound device to play on ({reason})")]
    NoDevice {
        /// The sound system's error.
        reason: String,
    },
    /// The named output device does not exist.
    #[error("no sound device is called `{name}` (known: {known})")]
    UnknownDevice {
        /// The requested name.
        name: String,
        /// List of the known names.
        known: String,
    },
    /// The device accepts none of the supported sample formats.
    #[error("the sound device {device} takes {format} samples, which are not supported")]
    UnsupportedFormat {
        /// The device.
        device: String,
        /// The sample format of the device.
        format: String,
    },
    /// The device exists but cannot be opened.
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
        /// The waiting time.
        seconds: u64,
    },
    /// The sound system's client panicked.
    #[error("the sound system's client has failed and is started again")]
    BrokenDown,
    /// The connection to the device was lost.
    #[error("the sound device {device} is lost: {reason}")]
    Lost {
        /// The device.
        device: String,
        /// The sound system's error.
        reason: String,
    },
    /// A recording is in progress already.
    #[error("a recording is already in progress: stop it first")]
    AlreadyRecording,
    /// A request to stop a recording while none is in progress.
    #[error("nothing is being recorded")]
    NotRecording,
    /// The recording ended because the device resumed at another rate.
    #[error(
        "the recording ended: the sound device now runs at {rate_hz} Hz, and a file has one rate"
    )]
    RecordingRate {
        /// The device's rate, in hertz.
        rate_hz: u32,
    },
    /// The callback that owns the recording hangs.
    #[error("the recording ended: the sound device has not released it")]
    RecordingHeld,
    /// The operating system refused to start a thread.
    #[error("cannot start a thread: {source}")]
    Thread {
        /// The operating system's error.
        source: std::io::Error,
    },
}

impl LiveError {
    /// Whether the request is at fault: the sound, the named device, or the order of recordings.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Audio(error) => error.is_bad_input(),
            Self::UnknownDevice { .. } | Self::AlreadyRecording | Self::NotRecording => true,
            _ => false,
        }
    }
}
