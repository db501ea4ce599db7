//! Panning laws (from a pan to two gains), the stereo mixer, and the division of samples among video frames.

use std::f32::consts::FRAC_PI_4;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use super::{AudioError, check_rate};
use crate::tracer::Profile;

/// The amplitude factors of the two channels, without a unit; 1 leaves the sound unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gains {
    /// The left channel's factor.
    pub left: f32,
    /// The right channel's factor.
    pub right: f32,
}

impl Gains {
    /// Silence on both channels.
    pub const SILENT: Self = Self {
        left: 0.0,
        right: 0.0,
    };
}

/// A law that turns a pan into the gains of two channels.
///
/// | law | all left (−1) | centre (0) | all right (+1) | constant |
/// | --- | --- | --- | --- | --- |
/// | linear | 0 dB, silent | −6.02 dB each | silent, 0 dB | sum of the gains, 1 |
/// | constant power | 0 dB, silent | −3.01 dB each | silent, 0 dB | sum of their squares, 1 |
///
/// Sounds from two loudspeakers add up in a room by their power, not by their amplitude. With the linear law a source
/// in front is therefore 3 dB quieter than a source at the side; with constant power both are equally loud. Constant
/// power is the default, except for the thesis' own profile ([`for_profile`](Self::for_profile)).
///
/// Names, for `FromStr` and `Display`: `linear`, `constant-power`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum PanningLaw {
    /// The gains are (1 ∓ pan) / 2: the thesis' "equal level".
    Linear,
    /// The gains are sine and cosine over a quarter turn.
    #[default]
    ConstantPower,
}

impl PanningLaw {
    /// The default law of a profile: linear for the thesis' algorithm, constant power for all other profiles.
    pub fn for_profile(profile: Profile) -> PanningLaw {
        match profile {
            Profile::Thesis => Self::Linear,
            _ => Self::ConstantPower,
        }
    }

    /// The gains for `pan`, −1 (left) to 1 (right); each is between 0 and 1.
    ///
    /// A pan outside the range is clamped to the range; NaN counts as the centre. Mirrored pans give exactly mirrored
    /// gains.
    ///
    /// ```
    /// let gains = echomarch::audio::PanningLaw::Linear.gains(0.5);
    /// assert_eq!((gains.left, gains.right), (0.25, 0.75));
    /// ```
    pub fn gains(self, pan: f32) -> Gains {
        let pan = if pan.is_nan() {
            0.0
        } else {
            pan.clamp(-1.0, 1.0)
        };
        Gains {
            left: self.gain_towards(1.0 - pan),
            right: self.gain_towards(1.0 + pan),
        }
    }

    /// The gain of one channel. `share` is 0 if the pan is at the opposite side, and 2 if it is at this channel's side.
    fn gain_towards(self, share: f32) -> f32 {
        match self {
            Self::Linear => share / 2.0,
            Self::ConstantPower => (share * FRAC_PI_4).sin(),
        }
    }
}

impl FromStr for PanningLaw {
    type Err = AudioError;

    /// Reads `linear` or `constant-power`; anything else is [`AudioError::UnknownPanningLaw`].
    fn from_str(name: &str) -> Result<Self, AudioError> {
        match name {
            "linear" => Ok(Self::Linear),
            "constant-power" => Ok(Self::ConstantPower),
            _ => Err(AudioError::UnknownPanningLaw {
                name: name.to_owned(),
            }),
        }
    }
}

impl fmt::Display for PanningLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Linear => "linear",
            Self::ConstantPower => "constant-power",
        })
    }
}

/// Mixes one mono sound to two channels, block by block, with gliding gains.
///
/// A block's gains run linearly from the previous block's gains to its own target, which its last sample reaches. The
/// first block starts at its target. Between successive samples, also across block boundaries, a gain changes by at
/// most the block's gain change divided by its length.
///
/// ```
/// use echomarch::audio::{Mixer, PanningLaw};
///
/// let mut mixer = Mixer::new(PanningLaw::Linear);
/// let mut stereo = [0.0; 4];
/// mixer.mix(&[1.0, 1.0], -1.0, &mut stereo)?;
/// assert_eq!(stereo, [1.0, 0.0, 1.0, 0.0]);
/// mixer.mix(&[1.0, 1.0], 1.0, &mut stereo)?; // glides to the right
/// assert_eq!(stereo, [0.5, 0.5, 0.0, 1.0]);
/// # Ok::<(), echomarch::audio::AudioError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mixer {
    law: PanningLaw,
    /// The gains of the last mixed sample; `None` before the first block.
    current: Option<Gains>,
}

impl Mixer {
    /// Creates a mixer in its initial state.
    pub fn new(law: PanningLaw) -> Self {
        Self { law, current: None }
    }

    /// The panning law that [`mix`](Self::mix) applies.
    pub fn law(&self) -> PanningLaw {
        self.law
    }

    /// The gains of the last mixed sample; `None` before the first sample.
    pub fn current(&self) -> Option<Gains> {
        self.current
    }

    /// Discards the gains, so that the next block starts at the gains of its own pan.
    pub fn reset(&mut self) {
        self.current = None;
    }

    /// Mixes one block towards the gains of the law for `pan`, −1 (left) to 1 (right).
    ///
    /// `out` is interleaved (left, right, …) and is overwritten. An empty block changes nothing.
    ///
    /// # Errors
    /// The errors of [`mix_to`](Self::mix_to).
    pub fn mix(&mut self, mono: &[f32], pan: f32, out: &mut [f32]) -> Result<(), AudioError> {
        self.mix_to(mono, self.law.gains(pan), out)
    }

    /// Mixes one block towards the `target` gains: [`Gains::SILENT`] fades out over the block.
    ///
    /// A gain that is not finite counts as 0. `out` is interleaved (left, right, …) and is
    /// overwritten. An empty block changes nothing.
    ///
    /// # Errors
    /// [`AudioError::BadStereoLength`] if `out` is not twice as long as `mono`: then nothing changes.
    pub fn mix_to(
        &mut self,
        mono: &[f32],
        target: Gains,
        out: &mut [f32],
    ) -> Result<(), AudioError> {
        if out.len() / 2 != mono.len() || !out.len().is_multiple_of(2) {
            let (mono, stereo) = (mono.len(), out.len());
            return Err(AudioError::BadStereoLength { mono, stereo });
        }
        if mono.is_empty() {
            return Ok(());
        }
        let target = finite(target);
        let start = self.current.unwrap_or(target);
        let length = mono.len() as f32;
        for (i, (&sample, pair)) in mono.iter().zip(out.chunks_exact_mut(2)).enumerate() {
            let along = (i + 1) as f32 / length;
            pair[0] = sample * glide(start.left, target.left, along);
            pair[1] = sample * glide(start.right, target.right, along);
        }
        self.current = Some(target);
        Ok(())
    }
}

/// The gain after the fraction `along` (0 to 1) of the glide; exactly `start` if both ends are equal.
fn glide(start: f32, target: f32, along: f32) -> f32 {
    start + (target - start) * along
}

fn finite(gains: Gains) -> Gains {
    let or_silent = |gain: f32| if gain.is_finite() { gain } else { 0.0 };
    Gains {
        left: or_silent(gains.left),
        right: or_silent(gains.right),
    }
}

/// Divides audio samples among video frames, without gaps, overlaps or drift.
///
/// Frame `i` starts at the sample nearest to `i · rate / fps`. Each boundary is rounded separately, so frames differ by
/// at most one sample in length, and picture and sound are always less than a sample apart (up to 2⁵³ samples,
/// thousands of years).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameBlocks {
    fps: f64,
    rate_hz: u32,
}

impl FrameBlocks {
    /// Creates the division for `fps` frames per second and `rate_hz` samples per second.
    ///
    /// # Errors
    /// [`AudioError::BadFrameRate`] if `fps` is not 0.001 to 1,000,000, and
    /// [`AudioError::BadSampleRate`] if `rate_hz` is outside [`Sound::SAMPLE_RATES`](super::Sound::SAMPLE_RATES).
    pub fn new(fps: f64, rate_hz: u32) -> Result<Self, AudioError> {
        if !is_usable(fps) {
            return Err(AudioError::BadFrameRate { fps });
        }
        check_rate(rate_hz)?;
        Ok(Self { fps, rate_hz })
    }

    /// The samples of frame `i`, counted from the first sample of frame 0.
    pub fn samples(&self, i: u64) -> Range<u64> {
        let border = |frame: f64| (frame * f64::from(self.rate_hz) / self.fps).round() as u64;
        border(i as f64)..border(i as f64 + 1.0)
    }

    /// The number of samples of frame `i`; 0 is possible only with more frames than samples.
    #[allow(clippy::len_without_is_empty)] // A frame's length, not this value's.
    pub fn len(&self, i: u64) -> usize {
        let samples = self.samples(i);
        (samples.end - samples.start) as usize
    }

    /// An upper bound of the number of samples in a frame, for allocating buffers.
    pub fn longest(&self) -> usize {
        (f64::from(self.rate_hz) / self.fps).ceil() as usize + 1
    }
}

/// Rejects frames longer than a quarter of an hour, and frames shorter than a microsecond, which contain no sample at
/// any rate.
fn is_usable(fps: f64) -> bool {
    (1e-3..=1e6).contains(&fps)
}
