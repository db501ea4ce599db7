//! Errors of sounds and WAV files.

use crate::file_input::InputError;
use crate::text::there_is_no;
use std::io;
use std::path::PathBuf;

/// Error of a sound, a panning law, a frame rate or a WAV file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AudioError {
    /// The sound file is missing, or reading it is not allowed.
    #[error("cannot open the sound file {}: {source}", path.display())]
    OpenWav {
        /// The requested file.
        path: PathBuf,
        /// The operating system's error, or the reason why the file is rejected.
        source: InputError,
    },
    /// The file does not have the header of a WAV file.
    #[error("{} is not a WAV file ({source}): convert it to WAV first", path.display())]
    NotWav {
        /// The file that was read.
        path: PathBuf,
        /// The WAV reader's error.
        source: hound::Error,
    },
    /// A WAV file whose sample format or sample rate is not supported.
    #[error(
        "{} holds {found}: convert it to 8, 16, 24 or 32-bit integer or 32-bit float samples at \
         {} to {} Hz",
        path.display(),
        super::Sound::SAMPLE_RATES.start(),
        super::Sound::SAMPLE_RATES.end()
    )]
    UnsupportedWav {
        /// The file that was read.
        path: PathBuf,
        /// Description of the file's format.
        found: String,
    },
    /// A WAV file that is truncated, or whose samples cannot be decoded.
    #[error("{} ends early, at sample {sample} ({source}): write the file again", path.display())]
    DamagedWav {
        /// The file that was read.
        path: PathBuf,
        /// The first sample that could not be read, counted over all channels from 0.
        sample: u64,
        /// The WAV reader's error.
        source: hound::Error,
    },
    /// A WAV file without samples.
    #[error("{} holds no samples: use a file that contains sound", path.display())]
    EmptyWav {
        /// The file that was read.
        path: PathBuf,
    },
    /// A float WAV file holds a NaN or an infinity.
    #[error(
        "{} holds a sample that is not a finite number, sample {sample} over all channels: \
         export the file again",
        path.display()
    )]
    NonFiniteSample {
        /// The file that was read.
        path: PathBuf,
        /// The first such sample, counted over all channels from 0.
        sample: u64,
    },
    /// A sound too long to be read into memory.
    #[error(
        "{} holds {frames} samples in {channels} channels at {rate_hz} Hz, which are {needed} \
         at {to_hz} Hz: at most {limit} are read (11 minutes at 48000 Hz), so shorten the file",
        path.display()
    )]
    LongWav {
        /// The file that was read.
        path: PathBuf,
        /// Samples of each channel.
        frames: u64,
        /// Number of channels.
        channels: u16,
        /// The file's sample rate, in hertz.
        rate_hz: u32,
        /// Number of samples that the sound would need in memory.
        needed: u64,
        /// The requested sample rate, in hertz.
        to_hz: u32,
        /// Maximum number of samples in memory.
        limit: u64,
    },
    /// A float WAV file to be resampled contains a sample far beyond full scale.
    #[error(
        "{} holds a sample of {value:e}, sample {sample} over all channels: samples of a magnitude above \
         {limit:e} cannot be resampled, where 1 is full scale: export the file again",
        path.display()
    )]
    LoudSample {
        /// The file that was read.
        path: PathBuf,
        /// The first such sample, counted over all channels from 0.
        sample: u64,
        /// The sample's value.
        value: f32,
        /// The largest accepted magnitude.
        limit: f32,
    },
    /// The WAV file could not be converted to the requested sample rate.
    #[error("cannot resample {} from {from_hz} Hz to {to_hz} Hz: {reason}", path.display())]
    Resample {
        /// The file that was read.
        path: PathBuf,
        /// The file's sample rate, in hertz.
        from_hz: u32,
        /// The requested sample rate, in hertz.
        to_hz: u32,
        /// The resampler's error.
        reason: String,
    },
    /// A sample rate outside [`Sound::SAMPLE_RATES`](super::Sound::SAMPLE_RATES).
    #[error(
        "a sample rate of {sample_rate_hz} Hz is not supported: use {} to {} Hz",
        super::Sound::SAMPLE_RATES.start(),
        super::Sound::SAMPLE_RATES.end()
    )]
    BadSampleRate {
        /// The sample rate, in hertz.
        sample_rate_hz: u32,
    },
    /// A sine that is not above 0 Hz and below half the sample rate.
    #[error("a sine of {frequency_hz} Hz cannot be played: choose above 0 and below {limit_hz} Hz")]
    BadSineFrequency {
        /// The requested frequency, in hertz.
        frequency_hz: f64,
        /// Half the sample rate, in hertz.
        limit_hz: f64,
    },
    /// An unknown description of a sound.
    #[error(
        "unknown sound `{spec}`: write `sine:HERTZ`, `noise`, `speech`, `noise:SEED` or \
         `speech:SEED` with a whole number, or the path of a .wav file"
    )]
    UnknownSound {
        /// The given description.
        spec: String,
    },
    /// An unknown name of a panning law.
    #[error("{}", there_is_no("panning law", name, &["constant-power", "linear"]))]
    UnknownPanningLaw {
        /// The given name.
        name: String,
    },
    /// A frame rate outside 0.001 to 1,000,000.
    #[error("a rate of {fps} frames per second cannot be used: choose 0.001 to 1000000")]
    BadFrameRate {
        /// The requested frame rate, in frames per second.
        fps: f64,
    },
    /// A sound too long for a WAV file.
    #[error("{} would be longer than {limit_s} s, the limit of WAV files: write a shorter file", path.display())]
    WavTooLong {
        /// The file to be written.
        path: PathBuf,
        /// The longest possible sound in whole seconds.
        limit_s: u64,
    },
    /// A number of channels that is not supported in WAV files.
    #[error("a WAV file of {channels} channels cannot be written: choose 1 to {limit}")]
    BadChannels {
        /// The requested number.
        channels: u16,
        /// The maximum.
        limit: u16,
    },
    /// Interleaved samples that end with an incomplete frame.
    #[error("{}: {samples} samples are not a whole number of frames of {channels} channels", path.display())]
    CutFrame {
        /// The file to be written.
        path: PathBuf,
        /// Number of given samples.
        samples: usize,
        /// Channels of the file.
        channels: u16,
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
    /// The number of sounds differs from the number of sources.
    #[error("{given} sounds for {sources} sources: give one for each")]
    NotASoundEach {
        /// Number of given sounds.
        given: usize,
        /// Number of sources.
        sources: usize,
    },
    /// The WAV file could not be written.
    #[error("cannot write the WAV file {}: {source}", path.display())]
    WriteWav {
        /// The file to be written.
        path: PathBuf,
        /// The operating system's error.
        source: io::Error,
    },
}

impl AudioError {
    /// Whether the caller's input is at fault (a name, a number, a given file), rather than this program or the disk.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::WriteWav { source, .. } => crate::file_output::is_bad_place(source),
            Self::Resample { .. } => false,
            _ => true,
        }
    }
}
