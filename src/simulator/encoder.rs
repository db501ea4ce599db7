//! The format of the ears: the delays and gains of each channel by the direction of the sound.

use super::SimulatorError;
use super::fit::{CHUNK, EARS, Frame};
use super::head::{Analysis, AtEars, Heads};
use crate::hrtf::HrirSet;
use crate::response::{AmbisonicOrder, Encoding, ListenerAxes};
use glam::{DVec2, DVec3, Quat};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// Maximum number of channels: those of ambisonics of the third order.
pub(super) const MOST_CHANNELS: usize = 16;

/// Samples of all channels.
pub(super) type Planes = [[f32; CHUNK]; MOST_CHANNELS];

/// Greatest order of ambisonics.
const MOST_ORDER: u8 = 3;

/// The format of [`Ears`](super::Ears) and [`Mix`](super::Mix).
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum EarsFormat {
    /// Two loudspeakers, left and right, with constant power. Front and back are the same.
    #[default]
    Stereo,
    /// Headphones: direct ways have the responses of both ears, echoes the delays of both ears and their levels by octave.
    Binaural(Arc<HrirSet>),
    /// Ambisonics of an order up to 3 in the convention AmbiX: channels in the order ACN with the normalisation SN3D, in
    /// the axes of the head. Horizontal and vertical directions are encoded.
    Ambisonics(AmbisonicOrder),
    /// Six channels: front left, front right, centre, low frequencies (silent), left and right at 110°.
    Surround51,
    /// Eight channels: front left, front right, centre, low frequencies (silent), left and right at 150°, left and right
    /// at 90°.
    Surround71,
}

impl EarsFormat {
    /// Number of channels.
    pub fn channels(&self) -> usize {
        match self {
            EarsFormat::Stereo | EarsFormat::Binaural(_) => EARS,
            EarsFormat::Ambisonics(order) => order.channels(),
            EarsFormat::Surround51 => 6,
            EarsFormat::Surround71 => 8,
        }
    }

    /// # Errors
    /// [`SimulatorError::BadNumber`] for ambisonics of an order above 3.
    pub(super) fn validate(&self) -> Result<(), SimulatorError> {
        match self {
            EarsFormat::Ambisonics(order) if order.number() > MOST_ORDER => {
                Err(SimulatorError::BadNumber {
                    what: "the order of ambisonics",
                    must: "1 to 3",
                    value: order.number().into(),
                })
            }
            _ => Ok(()),
        }
    }
}

/// The loudspeakers of a format around the listener, with their channels and azimuths in degrees to the left, in the
/// order of the azimuths.
const SPEAKERS_51: &[(usize, f64)] = &[(5, -110.0), (1, -30.0), (2, 0.0), (0, 30.0), (4, 110.0)];
const SPEAKERS_71: &[(usize, f64)] = &[
    (5, -150.0),
    (7, -90.0),
    (1, -30.0),
    (2, 0.0),
    (0, 30.0),
    (6, 90.0),
    (4, 150.0),
];

/// Amplitudes of the channels.
pub(super) type Gains = [f32; MOST_CHANNELS];

/// The delays and gains of sound from a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Encoded {
    /// Delay in seconds of each ear after the sound would pass the centre of the head.
    pub delays_s: [f64; EARS],
    /// Gains of the bands at each ear.
    pub ears: [Frame; EARS],
    /// Time in seconds from the first sample of the ears' responses to their onset.
    pub lead_s: f64,
    /// Gains of the channels, for formats without ears.
    pub channels: Gains,
}

/// How directions reach the channels.
pub(super) enum Encoder {
    /// Panned with constant power.
    Stereo,
    /// A head's responses for direct ways, and their delays and levels by octave for echoes.
    Binaural(Analysis),
    /// By gains of all channels.
    Ambisonics(AmbisonicOrder),
    Surround(&'static [(usize, f64)]),
}

impl Encoder {
    /// The encoder of a format. That of a head is ready when the head is analysed.
    ///
    /// # Errors
    /// The errors of [`Heads::head`].
    pub fn of(format: &EarsFormat, rate_hz: u32, heads: &Heads) -> Result<Encoder, SimulatorError> {
        Ok(match format {
            EarsFormat::Stereo => Encoder::Stereo,
            EarsFormat::Binaural(set) => Encoder::Binaural(heads.head(set, rate_hz)?),
            EarsFormat::Ambisonics(order) => Encoder::Ambisonics(*order),
            EarsFormat::Surround51 => Encoder::Surround(SPEAKERS_51),
            EarsFormat::Surround71 => Encoder::Surround(SPEAKERS_71),
        })
    }

    /// Whether the head is analysed.
    pub fn is_ready(&self) -> bool {
        match self {
            Encoder::Binaural(analysis) => analysis.get().is_some(),
            _ => true,
        }
    }

    /// Whether sound is rendered for two ears with their own delays and bands.
    pub fn has_ears(&self) -> bool {
        matches!(self, Encoder::Stereo | Encoder::Binaural(_))
    }

    /// Whether direct ways have the responses of both ears.
    pub fn has_responses(&self) -> bool {
        matches!(self, Encoder::Binaural(_))
    }

    /// Overwrites the responses of both ears to sound from a direction of the world, for a head with this rotation. Does
    /// not allocate.
    pub fn respond(&self, rotation: Quat, from: DVec3, responses: &mut [Vec<f32>; EARS]) {
        let Encoder::Binaural(analysis) = self else {
            return;
        };
        if let Some(head) = analysis.get() {
            head.respond(own_direction(rotation, from), responses);
        }
    }

    /// The encoding of sound from a direction of the world (a unit vector), for a head with this rotation. Does not
    /// allocate.
    pub fn encode(&self, rotation: Quat, from: DVec3) -> Encoded {
        let towards = own_direction(rotation, from);
        let mut encoded = Encoded {
            delays_s: [0.0; EARS],
            ears: [[0.0; 4]; EARS],
            lead_s: 0.0,
            channels: [0.0; MOST_CHANNELS],
        };
        match self {
            Encoder::Stereo => {
                let gains = Encoding::Stereo.gains(&ListenerAxes::OWN, towards);
                encoded.ears = [gains[0], gains[1]].map(|gain| [gain as f32; 4]);
            }
            Encoder::Binaural(analysis) => {
                if let Some(head) = analysis.get() {
                    let AtEars {
                        delays_s,
                        gains,
                        lead_s,
                    } = head.at_ears(towards);
                    (encoded.delays_s, encoded.ears, encoded.lead_s) = (delays_s, gains, lead_s);
                }
            }
            Encoder::Ambisonics(order) => {
                let gains = Encoding::AmbiX(*order).gains(&ListenerAxes::OWN, towards);
                encoded.channels = std::array::from_fn(|channel| gains[channel] as f32);
            }
            Encoder::Surround(speakers) => encoded.channels = pan(speakers, towards),
        }
        encoded
    }

    /// The amplitude of the diffuse late part in each channel, where the energy of all of it is 1.
    pub fn diffuse(&self) -> Gains {
        let mut gains = [0.0; MOST_CHANNELS];
        match self {
            // Half of the energy for each ear.
            Encoder::Stereo | Encoder::Binaural(_) => {
                gains[..EARS].fill(FRAC_1_SQRT_2 as f32);
            }
            // Each harmonic of a degree has the same share.
            Encoder::Ambisonics(order) => {
                for (channel, gain) in gains.iter_mut().enumerate().take(order.channels()) {
                    *gain = 1.0 / ((2 * channel.isqrt() + 1) as f32).sqrt();
                }
            }
            Encoder::Surround(speakers) => {
                for (channel, _) in *speakers {
                    gains[*channel] = 1.0 / (speakers.len() as f32).sqrt();
                }
            }
        }
        gains
    }
}

/// A direction of the world in the axes of a head, which are those of AmbiX and SOFA: x ahead, y to the left, z up.
fn own_direction(rotation: Quat, from: DVec3) -> DVec3 {
    let own = rotation.as_dquat().inverse() * from;
    let towards = DVec3::new(-own.z, -own.x, own.y);
    towards.try_normalize().unwrap_or(DVec3::X)
}

/// The gains of loudspeakers in a ring, with the power 1: the two around the azimuth share the horizontal part (V.
/// Pulkki, *Virtual sound source positioning using vector base amplitude panning*, JAES 45, 1997), all share the vertical
/// part.
fn pan(speakers: &[(usize, f64)], towards: DVec3) -> Gains {
    let mut gains = [0.0; MOST_CHANNELS];
    let flat = DVec2::new(towards.x, towards.y);
    let horizontal = flat.length_squared().min(1.0);
    let azimuth = flat.y.atan2(flat.x).to_degrees();
    let count = speakers.len();
    for (index, (channel, left)) in speakers.iter().enumerate() {
        let (next_channel, right) = speakers[(index + 1) % count];
        let width = (right - left).rem_euclid(360.0);
        let along = (azimuth - left).rem_euclid(360.0);
        if along < width {
            let pair = [(width - along), along].map(|angle| angle.to_radians().sin());
            let scale = (horizontal / (pair[0].powi(2) + pair[1].powi(2))).sqrt();
            gains[*channel] = (scale * pair[0]) as f32;
            gains[next_channel] = (scale * pair[1]) as f32;
            break;
        }
    }
    let vertical = ((1.0 - horizontal) / count as f64) as f32;
    for (channel, _) in speakers {
        let gain = &mut gains[*channel];
        *gain = (*gain * *gain + vertical).sqrt();
    }
    gains
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;

    fn encode(encoder: &Encoder, from: DVec3) -> Encoded {
        encoder.encode(Quat::IDENTITY, from)
    }

    /// Protects loudspeakers: constant power, and only the ear of the side that the sound comes from.
    #[test]
    fn loudspeakers_have_constant_power() {
        let first = |encoded: Encoded| encoded.ears.map(|ear| ear[0]);
        for from in [DVec3::X, DVec3::NEG_Z, DVec3::new(-0.6, 0.0, -0.8)] {
            let [left, right] = first(encode(&Encoder::Stereo, from));
            assert!((left.powi(2) + right.powi(2) - 1.0).abs() < 1e-6);
        }
        assert!(first(encode(&Encoder::Stereo, DVec3::X))[0] < 1e-6);
        let turned = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let ahead = Encoder::Stereo.encode(turned, DVec3::NEG_X);
        assert!((first(ahead)[0] - first(ahead)[1]).abs() < 1e-6);
    }

    /// Protects surround sound: the power is 1 from everywhere; sound from a loudspeaker's direction comes from this one
    /// alone, and the channel of low frequencies is silent.
    #[test]
    fn loudspeakers_around_the_listener_have_constant_power() {
        for speakers in [SPEAKERS_51, SPEAKERS_71] {
            let encoder = Encoder::Surround(speakers);
            for from in lattice(200) {
                let gains = encode(&encoder, from).channels;
                let power: f32 = gains.iter().map(|gain| gain * gain).sum();
                assert!((power - 1.0).abs() < 1e-5, "{from}: {power}");
                assert_eq!(gains[3], 0.0);
            }
            for (channel, azimuth) in speakers {
                let (sin, cos) = azimuth.to_radians().sin_cos();
                let gains = encode(&encoder, DVec3::new(-sin, 0.0, -cos)).channels;
                assert!((gains[*channel] - 1.0).abs() < 1e-5, "{channel}: {gains:?}");
            }
        }
        // To the right: the right loudspeakers.
        let gains = encode(&Encoder::Surround(SPEAKERS_71), DVec3::X).channels;
        assert!((gains[7] - 1.0).abs() < 1e-5);
    }

    /// Protects ambisonics: the first four channels have the gains 1, left, up, ahead in the axes of the turned head,
    /// and orders above 3 are refused.
    #[test]
    fn ambisonics_turn_with_the_head() {
        let third = AmbisonicOrder::new(3).expect("an order");
        let encoder = Encoder::Ambisonics(third);
        let turn = Quat::from_euler(glam::EulerRot::YXZ, 0.4, -0.3, 0.9);
        for from in lattice(30) {
            let gains = encoder.encode(turn, from).channels;
            let own = turn.as_dquat().inverse() * from;
            for (found, exact) in gains.iter().zip([1.0, -own.x, own.y, -own.z]) {
                assert!((f64::from(*found) - exact).abs() < 1e-6);
            }
        }
        assert!(EarsFormat::Ambisonics(third).validate().is_ok());
        let fourth = EarsFormat::Ambisonics(AmbisonicOrder::new(4).expect("an order"));
        assert!(fourth.validate().is_err());
    }
}
