//! Channels of a response, and their gains by direction.

use super::ListenerAxes;
use crate::acoustics::hrir::HrirSet;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::Arc;

/// Maximum number of channels of an encoding.
pub(crate) const MOST_CHANNELS: usize = 4;

/// The mean square of one component of a unit vector over all directions: the share of a diffuse
/// field's energy in a first-order channel (SN3D).
const DIFFUSE_SHARE: f64 = 1.0 / 3.0;

/// The channels of an impulse response.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Format {
    /// One channel, the same for all directions.
    #[default]
    Mono,
    /// Left and right: each arrival is panned with constant power by its lateral component s along
    /// the right ear, with gains cos and sin of (1 + s) π/4.
    Stereo,
    /// First-order ambisonics in the convention AmbiX (C. Nachbar et al., *AmbiX – A Suggested
    /// Ambisonics Format*, 2011): channels W, Y, Z, X (ACN), of a wave from (x, y, z) with gains
    /// 1, y, z, x (SN3D); x is ahead of the listener, y to the left, z up.
    AmbiX,
    /// Left and right ear, for headphones: each arrival is filtered by the head-related impulse
    /// responses of its direction. A set at another rate is resampled.
    Binaural(Arc<HrirSet>),
}

/// An encoding of directions by gains alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Encoding {
    Mono,
    Stereo,
    AmbiX,
}

/// Amplitudes of noise in each channel: of one noise common to all, and of one of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    pub(super) common: [f64; MOST_CHANNELS],
    pub(super) own: [f64; MOST_CHANNELS],
}

impl Format {
    /// Number of channels.
    pub fn channels(&self) -> usize {
        match self {
            Format::Mono => 1,
            Format::Stereo | Format::Binaural(_) => 2,
            Format::AmbiX => 4,
        }
    }
}

impl Encoding {
    /// Number of channels.
    pub(super) fn channels(self) -> usize {
        match self {
            Encoding::Mono => 1,
            Encoding::Stereo => 2,
            Encoding::AmbiX => 4,
        }
    }

    /// The gains of sound from a direction (a unit vector towards its source).
    pub(crate) fn gains(self, axes: &ListenerAxes, from: DVec3) -> [f64; MOST_CHANNELS] {
        match self {
            Encoding::Mono => [1.0, 0.0, 0.0, 0.0],
            Encoding::Stereo => {
                let side = from.dot(axes.right()).clamp(-1.0, 1.0);
                let (right, left) = ((1.0 + side) * FRAC_PI_4).sin_cos();
                [left, right, 0.0, 0.0]
            }
            Encoding::AmbiX => {
                let DVec3 { x, y, z } = axes.to_listener(from);
                [1.0, y, z, x]
            }
        }
    }

    /// Noise of power 1 from all directions, weighted by a mean direction: `mean` is the
    /// energy-weighted mean of the unit vectors towards the sources, of length 0 (diffuse) to 1.
    ///
    /// AmbiX: the share |mean| of the energy is one wave from there, the rest is diffuse; so both
    /// the energy and the intensity are correct. Stereo: independent noises with the powers of one
    /// wave at that lateral position; equal if it is diffuse.
    pub(super) fn noise(self, axes: &ListenerAxes, mean: DVec3) -> Noise {
        let none = [0.0; MOST_CHANNELS];
        match self {
            Encoding::Mono => Noise {
                common: none,
                own: self.gains(axes, mean),
            },
            Encoding::Stereo => {
                let side = mean.dot(axes.right()).clamp(-1.0, 1.0);
                let sine = (side * FRAC_PI_2).sin();
                let own = [(1.0 - sine) / 2.0, (1.0 + sine) / 2.0, 0.0, 0.0];
                Noise {
                    common: none,
                    own: own.map(f64::sqrt),
                }
            }
            Encoding::AmbiX => {
                let directed = mean.length().min(1.0);
                let gains = self.gains(axes, mean.try_normalize().unwrap_or(DVec3::ZERO));
                let diffuse = (1.0 - directed).sqrt();
                let side = diffuse * DIFFUSE_SHARE.sqrt();
                Noise {
                    common: gains.map(|gain| gain * directed.sqrt()),
                    own: [diffuse, side, side, side],
                }
            }
        }
    }
}
