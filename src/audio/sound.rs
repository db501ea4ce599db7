//! The mono sound that is played.

use super::clip::Clip;
use super::noise::Noise;
use super::rate::check_rate;
use super::sine::Sine;
use super::speech::Speech;
use super::{AudioError, Signal, SoundSpec, resample, wav_read};
use std::fmt;
use std::path::Path;

/// A mono sound that is read forwards, sample by sample; 1 is full scale. A caller's own sound is
/// made from a [`Signal`].
///
/// A sine, noise and speech never end. A WAV clip starts over at its end unless
/// [`set_looping`](Self::set_looping) turned that off: then it ends in silence. If its end does not
/// fit its start, the first 5 ms are cross-faded with the end each time it starts over.
///
/// ```
/// use echomarch::audio::{SAMPLE_RATE, Sound};
///
/// let mut sound = Sound::parse("sine:440", SAMPLE_RATE)?;
/// let mut block = [0.0; 480];
/// sound.fill(&mut block);
/// assert!(block.iter().any(|sample| *sample > 0.0));
/// # Ok::<(), echomarch::audio::AudioError>(())
/// ```
pub struct Sound {
    signal: Box<dyn Signal>,
}

impl Sound {
    /// Creates a sound from a caller's own signal.
    pub fn new(signal: impl Signal + 'static) -> Self {
        Self {
            signal: Box::new(signal),
        }
    }

    /// Parses a description such as `sine:440` (see [`SoundSpec`]) and loads it at `sample_rate`
    /// samples per second, commonly [`SAMPLE_RATE`](super::SAMPLE_RATE).
    ///
    /// # Errors
    /// [`AudioError::UnknownSound`], or as [`load`](Self::load).
    pub fn parse(text: &str, sample_rate: u32) -> Result<Self, AudioError> {
        Self::load(&text.parse()?, sample_rate)
    }

    /// Creates the sound at `sample_rate` samples per second.
    ///
    /// A WAV file of several channels is mixed to their mean. At another rate it is resampled with
    /// a linear-phase filter whose delay is removed: a sound that starts at `t` seconds in the file
    /// starts at `t` seconds here, and `n` samples become `n · sample_rate / rate`, rounded.
    /// Resampling keeps frequencies below half of both rates, except a narrow band below half the
    /// lower one, and may overshoot full scale a little.
    ///
    /// # Errors
    /// [`AudioError::BadSampleRate`] for a rate outside [`SAMPLE_RATES`](super::SAMPLE_RATES);
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

    /// Makes the sample with this number, counted from 0, the next one. Does not allocate.
    ///
    /// The numbers of a looping clip continue past its end; without looping, only silence follows
    /// there.
    pub fn seek(&mut self, sample: u64) {
        self.signal.seek(sample);
    }

    /// Chooses whether a clip starts over at its end (as it does when loaded) or falls silent.
    /// Sounds without an end ignore this.
    pub fn set_looping(&mut self, looping: bool) {
        self.signal.set_looping(looping);
    }

    /// The number of samples from the start to the end; `None` for sounds without an end.
    pub fn length(&self) -> Option<usize> {
        self.signal.length()
    }

    /// Whether only silence is left: of the built-in sounds, only ever true for a clip that does
    /// not loop.
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
