//! Playable sounds: their descriptions, their sources, and their samples, mono or stereo.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::signals::{self, Clip, Noise, Signal, Sine};
use super::speech::{self, Speech};
use super::{AudioError, check_rate, wav_read};
use crate::resample;

/// A mono sound that is read forwards, sample by sample; 1 is full scale. [`Sound::new`] creates a sound from a
/// caller's own [`Signal`].
///
/// A sine, noise and speech never end. A WAV clip restarts at its end, or falls silent after
/// [`set_looping`](Self::set_looping)`(false)`. If its end does not match its start, the first 5 ms of each repetition
/// are cross-faded with the end.
///
/// ```
/// use echomarch::audio::Sound;
///
/// let mut sound = Sound::parse("sine:440", Sound::SAMPLE_RATE)?;
/// let mut block = [0.0; 480];
/// sound.fill(&mut block);
/// assert!(block.iter().any(|sample| *sample > 0.0));
/// # Ok::<(), echomarch::audio::AudioError>(())
/// ```
pub struct Sound {
    signal: Box<dyn Signal>,
}

impl Sound {
    /// Sample rate of playback and written files, in hertz.
    pub const SAMPLE_RATE: u32 = 48_000;

    /// The lowest and the highest accepted sample rate, in hertz.
    pub const SAMPLE_RATES: RangeInclusive<u32> = 1_000..=768_000;

    /// The peak of a sine, relative to full scale 1: −6.02 dBFS.
    pub const SINE_AMPLITUDE: f32 = signals::SINE_AMPLITUDE;

    /// The peak of the noise, relative to full scale 1: −6.02 dBFS, at a level of −10.8 dBFS (RMS).
    pub const NOISE_AMPLITUDE: f32 = signals::NOISE_AMPLITUDE;

    /// Peak of the voice, relative to full scale 1: no sample's magnitude is larger.
    pub const SPEECH_PEAK: f32 = speech::SPEECH_PEAK;

    /// Creates a sound from a caller's own signal.
    pub fn new(signal: impl Signal + 'static) -> Self {
        Self {
            signal: Box::new(signal),
        }
    }

    /// Parses a description such as `sine:440` (see [`SoundSpec`]) and loads it at `sample_rate`
    /// samples per second, commonly [`Sound::SAMPLE_RATE`].
    ///
    /// # Errors
    /// [`AudioError::UnknownSound`], and the errors of [`load`](Self::load).
    pub fn parse(text: &str, sample_rate: u32) -> Result<Self, AudioError> {
        Self::load(&text.parse()?, sample_rate)
    }

    /// Creates the sound at `sample_rate` samples per second.
    ///
    /// A WAV file of several channels is mixed to their mean. A file of another rate is resampled with a linear-phase
    /// filter whose delay is removed. A sound that starts at `t` seconds in the file starts at `t` seconds in the
    /// result, and `n` samples become `n · sample_rate / rate`, rounded. Resampling keeps frequencies below half of
    /// both rates, except in a narrow band below half the lower rate. Resampled sound may slightly exceed full scale.
    ///
    /// # Errors
    /// [`AudioError::BadSampleRate`] for a rate outside [`Sound::SAMPLE_RATES`];
    /// [`AudioError::BadSineFrequency`]; and for a WAV file [`AudioError::OpenWav`],
    /// [`NotWav`](AudioError::NotWav), [`UnsupportedWav`](AudioError::UnsupportedWav),
    /// [`DamagedWav`](AudioError::DamagedWav), [`EmptyWav`](AudioError::EmptyWav),
    /// [`NonFiniteSample`](AudioError::NonFiniteSample),
    /// [`LoudSample`](AudioError::LoudSample), [`LongWav`](AudioError::LongWav) or [`Resample`](AudioError::Resample).
    pub fn load(spec: &SoundSpec, sample_rate: u32) -> Result<Self, AudioError> {
        check_rate(sample_rate)?;
        Ok(match spec {
            SoundSpec::Sine { frequency_hz } => Self::new(Sine::new(*frequency_hz, sample_rate)?),
            SoundSpec::Noise { seed } => Self::new(Noise::new(*seed)),
            SoundSpec::Speech { seed } => Self::new(Speech::new(*seed, sample_rate)),
            SoundSpec::Wav { path } => Self::new(load_clip(path, sample_rate)?),
        })
    }

    /// Overwrites `out` with the next `out.len()` samples. Does not allocate.
    pub fn fill(&mut self, out: &mut [f32]) {
        self.signal.fill(out);
    }

    /// Goes back to the first sample.
    pub fn rewind(&mut self) {
        self.seek(0);
    }

    /// Sets the position so that sample number `sample`, counted from 0, is the next sample. Does not allocate.
    ///
    /// The sample numbers of a looping clip continue past its end. Without looping, silence follows the end.
    pub fn seek(&mut self, sample: u64) {
        self.signal.seek(sample);
    }

    /// Chooses whether a clip restarts at its end (the default) or falls silent. Has no effect on sounds without an
    /// end.
    pub fn set_looping(&mut self, looping: bool) {
        self.signal.set_looping(looping);
    }

    /// The number of samples from the start to the end; `None` for sounds without an end.
    pub fn length(&self) -> Option<usize> {
        self.signal.length()
    }

    /// Whether the sound has ended, so that only silence follows. A clip that does not loop ends; all other
    /// built-in sounds are endless.
    pub fn is_finished(&self) -> bool {
        self.signal.is_finished()
    }
}

impl fmt::Debug for Sound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sound").finish_non_exhaustive()
    }
}

fn load_clip(path: &Path, sample_rate: u32) -> Result<Clip, AudioError> {
    let wav = wav_read::read_mono(path, sample_rate)?;
    let samples = resample::to_rate(wav.samples, wav.rate_hz, sample_rate).map_err(|reason| {
        AudioError::Resample {
            path: path.to_owned(),
            from_hz: wav.rate_hz,
            to_hz: sample_rate,
            reason,
        }
    })?;
    if samples.is_empty() {
        return Err(AudioError::EmptyWav {
            path: path.to_owned(),
        });
    }
    Ok(Clip::new(samples, sample_rate))
}

/// A description of a sound; [`Sound::load`](super::Sound::load) makes the sound.
///
/// | text | sound |
/// | --- | --- |
/// | `sine:440` | a sine, its frequency in hertz |
/// | `noise` | white noise with seed 0 |
/// | `noise:7` | white noise with another seed |
/// | `speech` | a synthetic voice with seed 0 |
/// | `speech:7` | the voice with another seed: other syllables |
/// | `drum.wav` | a WAV file; the ending `.wav` may be in upper or lower case |
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum SoundSpec {
    /// A sine.
    Sine {
        /// In hertz; checked against the sample rate when the sound is loaded.
        frequency_hz: f64,
    },
    /// White noise.
    Noise {
        /// The same seed gives the same noise.
        seed: u64,
    },
    /// A synthetic voice without words.
    Speech {
        /// The same seed gives the same syllables.
        seed: u64,
    },
    /// A WAV file.
    Wav {
        /// Path of the file, which is read when the sound is loaded.
        path: PathBuf,
    },
}

impl FromStr for SoundSpec {
    type Err = AudioError;

    /// Parses a text of the table above without opening a file. Any other text is [`AudioError::UnknownSound`].
    fn from_str(text: &str) -> Result<Self, AudioError> {
        known(text).ok_or_else(|| AudioError::UnknownSound {
            spec: text.to_owned(),
        })
    }
}

fn known(text: &str) -> Option<SoundSpec> {
    let is_wav = Path::new(text)
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("wav"));
    if is_wav {
        return Some(SoundSpec::Wav { path: text.into() });
    }
    let (kind, number) = match text {
        "noise" | "speech" => (text, "0"),
        _ => text.split_once(':')?,
    };
    match kind {
        "sine" => number
            .parse()
            .ok()
            .map(|frequency_hz| SoundSpec::Sine { frequency_hz }),
        "noise" => number.parse().ok().map(|seed| SoundSpec::Noise { seed }),
        "speech" => number.parse().ok().map(|seed| SoundSpec::Speech { seed }),
        _ => None,
    }
}

impl fmt::Display for SoundSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sine { frequency_hz } => write!(f, "sine:{frequency_hz}"),
            Self::Noise { seed } => write!(f, "noise:{seed}"),
            Self::Speech { seed } => write!(f, "speech:{seed}"),
            Self::Wav { path } => path.display().fmt(f),
        }
    }
}

/// A caller's own stereo sound, such as the sources heard in a scene: live output plays it instead
/// of a mono sound and its pan.
pub trait StereoSignal: Send {
    /// Adds the next samples of both channels to `stereo` (left, right, …). Called on the real-time audio thread, so it
    /// must not allocate, lock or wait.
    fn add(&mut self, stereo: &mut [f32]);
}
