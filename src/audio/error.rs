//! What can go wrong with sounds and WAV files.

use crate::file_input::InputError;
use crate::text::there_is_no;
use std::io;
use std::path::PathBuf;

/// What went wrong with a sound, a panning law, a frame rate or a WAV file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AudioError {
    /// The sound file is missing, or may not be read.
    #[error("cannot open the sound file {}: {source}", path.display())]
    OpenWav {
        /// The requested file.
        path: PathBuf,
        /// The operating system's error, or the reason why it is not read.
        source: InputError,
    },
    /// The file's header is not that of a WAV file.
    #[error("{} is not a WAV file ({source}): convert it to WAV first", path.display())]
    NotWav {
        /// The file that was read.
        path: PathBuf,
        /// What the WAV reader stumbled over.
        source: hound::Error,
    },
    /// A WAV file whose samples are stored in a way, or at a rate, that is not read here.
    #[error(
        "{} holds {found}: convert it to 8, 16, 24 or 32-bit integer or 32-bit float samples at \
         {} to {} Hz",
        path.display(),
        super::SAMPLE_RATES.start(),
        super::SAMPLE_RATES.end()
    )]
    UnsupportedWav {
        /// The file that was read.
        path: PathBuf,
        /// What the file holds, in words.
        found: String,
    },
    /// A WAV file that breaks off, or whose samples cannot be decoded.
    #[error("{} ends early, at sample {sample} ({source}): write the file again", path.display())]
    DamagedWav {
        /// The file that was read.
        path: PathBuf,
        /// The first sample that could not be read, counted over all channels from 0.
        sample: u64,
        /// What the WAV reader stumbled over.
        source: hound::Error,
    },
    /// A WAV file without a single sample.
    #[error("{} holds no samples: give a file with some sound in it", path.display())]
    EmptyWav {
        /// The file that was read.
        path: PathBuf,
    },
    /// A float WAV file holds a NaN or an infinity.
    #[error(
        "{} holds a sample that is not a finite number, sample {sample} over all channels: \
         export the file anew",
        path.display()
    )]
    NonFiniteSample {
        /// The file that was read.
        path: PathBuf,
        /// The first such sample, counted over all channels from 0.
        sample: u64,
    },
    /// More sound than is read into memory.
    #[error(
        "{} holds {frames} samples in {channels} channels at {rate_hz} Hz, which are {needed} \
         at {to_hz} Hz: at most {limit} are read, 11 minutes at 48000 Hz, so cut it",
        path.display()
    )]
    LongWav {
        /// The file that was read.
        path: PathBuf,
        /// Samples of each channel.
        frames: u64,
        /// Channels.
        channels: u16,
        /// The file's sample rate, in hertz.
        rate_hz: u32,
        /// Samples that would be kept.
        needed: u64,
        /// The wanted sample rate, in hertz.
        to_hz: u32,
        /// How many samples may be kept.
        limit: u64,
    },
    /// A float WAV file that is to be resampled holds a sample far beyond full scale.
    #[error(
        "{} holds a sample of {value:e}, sample {sample} over all channels: at most {limit:e} \
         either way can be resampled, and 1 is full scale, so export the file anew",
        path.display()
    )]
    LoudSample {
        /// The file that was read.
        path: PathBuf,
        /// The first such sample, counted over all channels from 0.
        sample: u64,
        /// What it is.
        value: f32,
        /// The largest magnitude that is read.
        limit: f32,
    },
    /// The WAV file could not be brought to the wanted sample rate.
    #[error("cannot resample {} from {from_hz} Hz to {to_hz} Hz: {reason}", path.display())]
    Resample {
        /// The file that was read.
        path: PathBuf,
        /// The file's sample rate, in hertz.
        from_hz: u32,
        /// The wanted sample rate, in hertz.
        to_hz: u32,
        /// The resampler's error.
        reason: String,
    },
    /// A sample rate outside [`SAMPLE_RATES`](super::SAMPLE_RATES).
    #[error(
        "a sample rate of {sample_rate_hz} Hz is not supported: use {} to {} Hz",
        super::SAMPLE_RATES.start(),
        super::SAMPLE_RATES.end()
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
        /// The description that was given.
        spec: String,
    },
    /// A panning law's name that is not known.
    #[error("{}", there_is_no("panning law", name, &["constant-power", "linear"]))]
    UnknownPanningLaw {
        /// The name that was given.
        name: String,
    },
    /// A frame rate that is not 0.001 to 1,000,000.
    #[error("a rate of {fps} frames a second cannot be used: choose 0.001 to 1000000")]
    BadFrameRate {
        /// The requested frame rate, in frames a second.
        fps: f64,
    },
    /// More sound than a WAV file can hold.
    #[error("{} would pass {limit_s} s, the longest a WAV file can be: write a shorter one", path.display())]
    WavTooLong {
        /// The file that was to be written.
        path: PathBuf,
        /// The longest sound that fits, in whole seconds.
        limit_s: u64,
    },
    /// A number of channels that no WAV file is written with.
    #[error("a WAV file of {channels} channels cannot be written: choose 1 to {limit}")]
    BadChannels {
        /// The requested number.
        channels: u16,
        /// The most there may be.
        limit: u16,
    },
    /// Interleaved samples that end within a frame.
    #[error("{}: {samples} samples are no whole number of frames of {channels} channels", path.display())]
    CutFrame {
        /// The file that was to be written.
        path: PathBuf,
        /// How many samples were given.
        samples: usize,
        /// Channels of the file.
        channels: u16,
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
    /// Not as many sounds as sources.
    #[error("{given} sounds for {sources} sources: give one for each")]
    NotASoundEach {
        /// How many sounds were given.
        given: usize,
        /// How many sources there are.
        sources: usize,
    },
    /// The WAV file could not be written.
    #[error("cannot write the WAV file {}: {source}", path.display())]
    WriteWav {
        /// The file that was to be written.
        path: PathBuf,
        /// The operating system's error.
        source: io::Error,
    },
}

impl AudioError {
    /// Whether the caller's input is at fault (a name, a number, a file that was given), rather
    /// than this program or the disk that it writes to.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::WriteWav { source, .. } => crate::file_output::is_bad_place(source),
            Self::Resample { .. } => false,
            _ => true,
        }
    }
}
