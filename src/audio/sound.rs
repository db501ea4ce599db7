//! The one mono sound that is played.

use super::clip::Clip;
use super::noise::Noise;
use super::rate::check_rate;
use super::sine::Sine;
use super::speech::Speech;
use super::{AudioError, Signal, SoundSpec, resample, wav_read};
use std::fmt;
use std::path::Path;

/// A mono sound that is read forwards, sample by sample; 1 is full scale. A caller's own is made
/// of a [`Signal`].
///
/// A sine, noise and speech never end. A WAV clip starts over at its end unless
/// [`set_looping`](Self::set_looping) turned that off: then it ends in silence. Where its end does
/// not fit its start, the first 5 ms are cross-faded with the end each time that it starts over.
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
    /// A sound of the caller's own.
    pub fn new(signal: impl Signal + 'static) -> Self {
        Self {
            signal: Box::new(signal),
        }
    }

    /// Reads a description such as `sine:440` (see [`SoundSpec`]) and loads it at `sample_rate`
    /// samples a second, commonly [`SAMPLE_RATE`](super::SAMPLE_RATE).
    ///
    /// # Errors
    /// [`AudioError::UnknownSound`], or as [`load`](Self::load).
    pub fn parse(text: &str, sample_rate: u32) -> Result<Self, AudioError> {
        Self::load(&text.parse()?, sample_rate)
    }

    /// Makes the sound at `sample_rate` samples a second.
    ///
    /// A WAV file of several channels becomes their mean. At another rate it is resampled with a
    /// linear-phase filter whose delay is taken out: what starts at `t` seconds in the file starts
    /// at `t` seconds here, and `n` samples become `n · sample_rate / rate` rounded. Resampling
    /// keeps what lies below both rates' halves, up to a narrow band beneath the lower one, and may
    /// overshoot full scale a little.
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

    /// Overwrites `out` with the next `out.len()` samples. Allocates nothing.
    pub fn fill(&mut self, out: &mut [f32]) {
        self.signal.fill(out);
    }

    /// Goes back to the first sample.
    pub fn rewind(&mut self) {
        self.seek(0);
    }

    /// Makes the sample with this number, counted from 0, the next one. Allocates nothing.
    ///
    /// In a looping clip the numbers go on past its end; without looping, all that lies there is
    /// silence.
    pub fn seek(&mut self, sample: u64) {
        self.signal.seek(sample);
    }

    /// Chooses whether a clip starts over at its end (as it does when loaded) or falls silent.
    /// Sounds without an end ignore this.
    pub fn set_looping(&mut self, looping: bool) {
        self.signal.set_looping(looping);
    }

    /// The number of samples from the start to the end; none for sounds without an end.
    pub fn length(&self) -> Option<usize> {
        self.signal.length()
    }

    /// Whether all that is left is silence: of the sounds here, only ever true of a clip that does
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
