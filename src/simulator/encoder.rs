//! The format of the ears: the delays and gains of each channel by the direction of the sound.

use super::SimulatorError;
use super::fit::{CHUNK, EARS, Fit, Frame};
use crate::bands::{BANDS_HZ, Bands};
use crate::hrtf::{Hrir, HrirSet, IndexedFacets};
use crate::response::{AmbisonicOrder, Encoding, ListenerAxes};
use crate::sampling::lattice;
use glam::{DVec2, DVec3, Quat};
use num_complex::Complex64;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use std::thread;

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
    /// Headphones: direct ways and echoes have the delays of both ears, and their levels by octave.
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
    /// Gains of the channels, for formats without ears.
    pub channels: Gains,
}

/// How directions reach the channels.
pub(super) enum Encoder {
    /// Panned with constant power.
    Stereo,
    /// The levels by octave and the delays of a head's responses. Finer features of the spectra are left out.
    Binaural(Analysis),
    /// By gains of all channels.
    Ambisonics(AmbisonicOrder),
    Surround(&'static [(usize, f64)]),
}

impl Encoder {
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

    /// The encoding of sound from a direction of the world (a unit vector), for a head with this rotation. Does not
    /// allocate.
    pub fn encode(&self, rotation: Quat, from: DVec3) -> Encoded {
        // Axes of AmbiX and SOFA: x ahead, y to the left, z up.
        let own = rotation.as_dquat().inverse() * from;
        let towards = DVec3::new(-own.z, -own.x, own.y);
        let towards = towards.try_normalize().unwrap_or(DVec3::X);
        let mut encoded = Encoded {
            delays_s: [0.0; EARS],
            ears: [[0.0; 4]; EARS],
            channels: [0.0; MOST_CHANNELS],
        };
        match self {
            Encoder::Stereo => {
                let gains = Encoding::Stereo.gains(&ListenerAxes::OWN, towards);
                encoded.ears = [gains[0], gains[1]].map(|gain| [gain as f32; 4]);
            }
            Encoder::Binaural(analysis) => {
                if let Some(head) = analysis.get() {
                    head.encode(towards, &mut encoded);
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

/// Number of directions in which the ears of a measured head are known: about 3° apart.
const DIRECTIONS: u64 = 4096;

/// Number of frequencies of an octave at which the level of a response is averaged.
const TONES: usize = 8;

/// One ear and one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ear {
    /// Seconds after the sound would pass the centre of the head.
    delay_s: f64,
    /// Amplitudes by band.
    gain: Bands,
}

/// The ears of a measured head by direction.
pub(super) struct Measured {
    facets: IndexedFacets,
    /// Delays in seconds and gains of both ears.
    ears: Vec<[(f64, Frame); EARS]>,
}

impl Measured {
    /// The ears of a set of responses, for a sampling rate. Takes about half a second.
    fn of(set: &HrirSet, rate_hz: u32) -> Measured {
        let fit = Fit::new(rate_hz);
        let directions: Vec<DVec3> = lattice(DIRECTIONS).collect();
        let ears = ears(set, &directions);
        let fitted = |ear: Ear| (ear.delay_s, fit.gains(&ear.gain));
        Measured {
            facets: IndexedFacets::new(directions),
            ears: ears.into_iter().map(|both| both.map(fitted)).collect(),
        }
    }

    fn encode(&self, towards: DVec3, encoded: &mut Encoded) {
        for (index, weight) in self.facets.around(towards) {
            for (ear, (delay_s, gains)) in self.ears[index].iter().enumerate() {
                encoded.delays_s[ear] += weight * delay_s;
                for (sum, gain) in encoded.ears[ear].iter_mut().zip(gains) {
                    *sum += weight as f32 * gain;
                }
            }
        }
    }
}

/// Both ears of a set of responses in these directions.
fn ears(set: &HrirSet, directions: &[DVec3]) -> Vec<[Ear; EARS]> {
    let mut pair = <[Hrir; 2]>::default();
    let rate_hz = f64::from(set.rate_hz());
    let mut ears: Vec<[Ear; EARS]> = directions
        .iter()
        .map(|from| {
            set.pair_into(*from, &mut pair);
            pair.each_ref().map(|hrir| ear(hrir, rate_hz))
        })
        .collect();
    // All responses of a set begin at the same sample, and on average sound passes the centre at 0 s.
    let all = || ears.iter().flatten();
    let mean_s = all().map(|ear| ear.delay_s).sum::<f64>() / all().count() as f64;
    let earliest_s = all().map(|ear| ear.delay_s).fold(f64::INFINITY, f64::min);
    for ear in ears.iter_mut().flatten() {
        // No ear hears a sound before it passes the nearest ear: everything is later by a fraction of a millisecond.
        ear.delay_s += (mean_s - earliest_s).max(0.0) - mean_s;
    }
    ears
}

/// A head that is known, or being analysed.
pub(super) type Analysis = Arc<OnceLock<Measured>>;

/// A head and a sampling rate in hertz.
type HeadKey = (Weak<HrirSet>, u32);

/// The heads of a simulator. Each is analysed once, on a thread of its own.
#[derive(Default)]
pub(super) struct Heads {
    known: Mutex<Vec<(HeadKey, Analysis)>>,
}

impl Heads {
    /// The encoder of a format. That of a head is ready when the head is analysed.
    ///
    /// # Errors
    /// [`SimulatorError::NoThread`] if the system starts no thread.
    pub fn encoder(&self, format: &EarsFormat, rate_hz: u32) -> Result<Encoder, SimulatorError> {
        Ok(match format {
            EarsFormat::Stereo => Encoder::Stereo,
            EarsFormat::Binaural(set) => Encoder::Binaural(self.head(set, rate_hz)?),
            EarsFormat::Ambisonics(order) => Encoder::Ambisonics(*order),
            EarsFormat::Surround51 => Encoder::Surround(SPEAKERS_51),
            EarsFormat::Surround71 => Encoder::Surround(SPEAKERS_71),
        })
    }

    fn head(&self, set: &Arc<HrirSet>, rate_hz: u32) -> Result<Analysis, SimulatorError> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|((other, _), _)| other.strong_count() > 0);
        let is_it = |((other, rate), _): &&(HeadKey, Analysis)| {
            other.as_ptr() == Arc::as_ptr(set) && *rate == rate_hz
        };
        if let Some((_, analysis)) = known.iter().find(is_it) {
            return Ok(Arc::clone(analysis));
        }
        let analysis = Analysis::default();
        let (set_here, analysis_here) = (Arc::clone(set), Arc::clone(&analysis));
        let analyse = move || {
            analysis_here.get_or_init(|| Measured::of(&set_here, rate_hz));
        };
        let started = thread::Builder::new()
            .name("echomarch head".to_owned())
            .spawn(analyse);
        started.map_err(|error| SimulatorError::NoThread {
            reason: error.to_string(),
        })?;
        known.push(((Arc::downgrade(set), rate_hz), Arc::clone(&analysis)));
        Ok(analysis)
    }
}

/// The delay and the levels of a response.
fn ear(hrir: &Hrir, rate_hz: f64) -> Ear {
    let power = |hertz: f64| {
        let step = -2.0 * PI * hertz / rate_hz;
        let turn = Complex64::from_polar(1.0, step);
        let mut phase = Complex64::new(1.0, 0.0);
        let mut sum = Complex64::default();
        for sample in &hrir.samples {
            sum += f64::from(*sample) * phase;
            phase *= turn;
        }
        sum.norm_sqr()
    };
    let level = |centre_hz: f64| {
        let tone = |tone: usize| {
            let octaves = (tone as f64 + 0.5) / TONES as f64 - 0.5;
            (centre_hz * SQRT_2.powf(2.0 * octaves)).min(0.49 * rate_hz)
        };
        ((0..TONES).map(|index| power(tone(index))).sum::<f64>() / TONES as f64).sqrt()
    };
    Ear {
        delay_s: hrir.delay_s,
        gain: BANDS_HZ.map(level),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hrtf::tests::{RATE_HZ, SAMPLES, grid, set, transfer};

    /// Protects headphones: sound from the left of a rigid sphere reaches the left ear earlier, by 0.4 to 0.9 ms, and
    /// the levels of the octaves at 1 to 4 kHz are those of the sphere's exact transfer function, to 1 dB. Sound from
    /// the right is the mirror image, and no ear hears before time.
    #[test]
    fn the_near_ear_is_earlier_and_louder() {
        for (towards, near) in [(DVec3::Y, 0), (DVec3::NEG_Y, 1)] {
            let both = ears(&set(grid(30)), &[towards, DVec3::Y, DVec3::NEG_Y]);
            let (near, far) = (both[0][near], both[0][1 - near]);
            let later_s = far.delay_s - near.delay_s;
            assert!((4e-4..9e-4).contains(&later_s), "{later_s}");
            assert!(near.delay_s >= 0.0, "{}", near.delay_s);
            for (ear, found) in both[0].iter().enumerate() {
                let exact = transfer(towards, ear);
                for (band, centre_hz) in BANDS_HZ.iter().enumerate().take(7).skip(4) {
                    let bin_hz = f64::from(RATE_HZ) / SAMPLES as f64;
                    let ends =
                        [1.0 / SQRT_2, SQRT_2].map(|end| (end * centre_hz / bin_hz) as usize);
                    let octave = &exact[ends[0]..=ends[1]];
                    let power = octave.iter().map(|value| value.norm_sqr()).sum::<f64>();
                    let level = (power / octave.len() as f64).sqrt();
                    let off_db = 20.0 * (found.gain[band] / level).log10();
                    assert!(off_db.abs() < 1.0, "{towards} {ear} {band}: {off_db} dB");
                }
            }
        }
    }

    /// Protects headphones in motion: between the known directions, delays are within 20 µs of those of the responses,
    /// and gains within 6 % of the loudest band, for every rotation of the head.
    #[test]
    fn directions_in_between_are_interpolated() {
        let set = Arc::new(set(grid(30)));
        let heads = Heads::default();
        let format = EarsFormat::Binaural(Arc::clone(&set));
        let encoder = heads.encoder(&format, RATE_HZ).expect("a thread");
        while !encoder.is_ready() {
            thread::yield_now();
        }
        let fit = Fit::new(RATE_HZ);
        let directions: Vec<DVec3> = lattice(DIRECTIONS).chain(lattice(301)).collect();
        let exact = ears(&set, &directions);
        for (number, towards) in directions.iter().enumerate().skip(DIRECTIONS as usize) {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, number as f32, 0.3, 0.7);
            let own = DVec3::new(-towards.y, towards.z, -towards.x);
            let found = encoder.encode(turn, turn.as_dquat() * own);
            for (ear, exact) in exact[number].iter().enumerate() {
                let off_s = found.delays_s[ear] - exact.delay_s;
                assert!(off_s.abs() < 20e-6, "{off_s} s");
                let loudest = exact.gain.into_iter().fold(0.0, f64::max);
                for (gain, wanted) in found.ears[ear].iter().zip(fit.gains(&exact.gain)) {
                    let off = f64::from(gain - wanted).abs() / loudest;
                    assert!(off < 0.06, "{towards} {ear}: {off}");
                }
            }
        }
    }

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
