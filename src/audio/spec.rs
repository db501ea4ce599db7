//! Names of sounds on a command line or in a file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::AudioError;

/// A description of a sound; [`Sound::load`](super::Sound::load) makes the sound.
///
/// | text | sound |
/// | --- | --- |
/// | `sine:440` | a sine, its frequency in hertz |
/// | `noise` | white noise with seed 0 |
/// | `noise:7` | white noise with another seed |
/// | `speech` | a synthetic voice with seed 0 |
/// | `speech:7` | the voice with another seed: other syllables |
/// | `drum.wav` | a WAV file, known by its ending `.wav` in either case |
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

    /// Parses the text of the table above; opens no file. Anything else is
    /// [`AudioError::UnknownSound`].
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
    if text == "noise" {
        return Some(SoundSpec::Noise { seed: 0 });
    }
    if text == "speech" {
        return Some(SoundSpec::Speech { seed: 0 });
    }
    match text.split_once(':')? {
        ("sine", hertz) => Some(SoundSpec::Sine {
            frequency_hz: hertz.parse().ok()?,
        }),
        ("noise", seed) => Some(SoundSpec::Noise {
            seed: seed.parse().ok()?,
        }),
        ("speech", seed) => Some(SoundSpec::Speech {
            seed: seed.parse().ok()?,
        }),
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
