//! Panning laws: from one pan to two gains.

use std::f32::consts::FRAC_PI_4;
use std::fmt;
use std::str::FromStr;

use super::AudioError;
use crate::trace::Profile;

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

/// The law that distributes a pan to two channels.
///
/// | law | all left (−1) | centre (0) | all right (+1) | constant |
/// | --- | --- | --- | --- | --- |
/// | linear | 0 dB, silent | −6.02 dB each | silent, 0 dB | sum of the gains, 1 |
/// | constant power | 0 dB, silent | −3.01 dB each | silent, 0 dB | sum of their squares, 1 |
///
/// Sounds from two loudspeakers add up in a room by their power, not by their amplitude: with the
/// linear law a source in front is 3 dB quieter than one at the side, with constant power it is
/// equally loud. So constant power is the default, except for the thesis' own profile
/// ([`for_profile`](Self::for_profile)).
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
    /// The default law of a profile: linear for the thesis' algorithm, constant power for the
    /// others.
    pub fn for_profile(profile: Profile) -> PanningLaw {
        match profile {
            Profile::Thesis => Self::Linear,
            _ => Self::ConstantPower,
        }
    }

    /// The gains for `pan`, −1 (left) to 1 (right); each is between 0 and 1.
    ///
    /// A pan outside the range counts as the nearer end, NaN as the centre. Mirrored pans give
    /// exactly mirrored gains.
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

    /// One channel's gain; `share` is 0 with the pan at the far side and 2 at the near one.
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
