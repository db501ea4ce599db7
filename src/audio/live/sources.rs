//! Sounds that live output creates at the device's rate, and again when the rate changes.

use crate::audio::{AudioError, Sound, SoundSpec, StereoSignal};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// A function from a sample rate in hertz to a sound at its start.
type Maker<T> = Arc<dyn Fn(u32) -> T + Send + Sync>;

/// Creates one sound at any sample rate: live output calls it again when the device's rate changes.
///
/// A source is made from a [`SoundSpec`], from the text of a [`SoundSpec`], or from a caller's own function:
///
/// ```
/// use echomarch::audio::live::SoundSource;
/// use echomarch::audio::{Sound, SoundSpec};
///
/// let by_text: SoundSource = "sine:440".parse()?;
/// let by_spec = SoundSource::from(SoundSpec::Noise { seed: 7 });
/// let own = SoundSource::new("two octaves up", |rate_hz| Sound::parse("sine:1760", rate_hz));
/// assert!(own.sound(48_000).is_ok());
/// # Ok::<(), echomarch::audio::AudioError>(())
/// ```
#[derive(Clone)]
pub struct SoundSource {
    name: String,
    make: Maker<Result<Sound, AudioError>>,
}

impl SoundSource {
    /// Creates a source of a caller's own sound: `make` gets the rate in samples per second and is
    /// called on the thread that supervises live output.
    pub fn new(
        name: impl Into<String>,
        make: impl Fn(u32) -> Result<Sound, AudioError> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            make: Arc::new(make),
        }
    }

    /// Returns the sound at `rate_hz` samples per second, at its start.
    ///
    /// # Errors
    /// The errors of [`Sound::load`], or the error that the caller's own function returns.
    pub fn sound(&self, rate_hz: u32) -> Result<Sound, AudioError> {
        (self.make)(rate_hz)
    }
}

impl From<SoundSpec> for SoundSource {
    fn from(spec: SoundSpec) -> Self {
        Self::new(spec.to_string(), move |rate_hz| Sound::load(&spec, rate_hz))
    }
}

impl FromStr for SoundSource {
    type Err = AudioError;

    /// Parses the text of a [`SoundSpec`] without opening a file.
    fn from_str(text: &str) -> Result<Self, AudioError> {
        text.parse::<SoundSpec>().map(Self::from)
    }
}

impl fmt::Debug for SoundSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SoundSource").field(&self.name).finish()
    }
}

/// Creates a [`StereoSignal`] at any sample rate: live output calls it again when the device's rate changes.
#[derive(Clone)]
pub struct StereoSource {
    make: Maker<Box<dyn StereoSignal>>,
}

impl StereoSource {
    /// Creates a source: `make` gets the rate in samples per second and is called on the thread that supervises live
    /// output.
    pub fn new(make: impl Fn(u32) -> Box<dyn StereoSignal> + Send + Sync + 'static) -> Self {
        Self {
            make: Arc::new(make),
        }
    }

    /// Returns the sound at `rate_hz` samples per second, at its start.
    pub fn signal(&self, rate_hz: u32) -> Box<dyn StereoSignal> {
        (self.make)(rate_hz)
    }
}

impl fmt::Debug for StereoSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StereoSource").finish_non_exhaustive()
    }
}
