//! Audible impulse responses: taps, and noise shaped by an echogram, in the channels of a format.

use super::error::check_taps;
use super::{Echogram, ResponseError, Tap};
use crate::bands::BAND_COUNT;
use crate::hrtf::HrirSet;
use crate::scene::Listener;
pub use ambisonics::AmbisonicOrder;
use ambisonics::{MOST_CHANNELS, degree, harmonics};
use filters::{Crossing, Spectra};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::RangeInclusive;
use std::sync::Arc;

mod ambisonics;
mod binaural;
mod filters;
#[cfg(test)]
mod tests;

/// The default rate of an impulse response, in hertz.
const DEFAULT_RATE_HZ: u32 = 48_000;

/// Maximum number of samples of all channels, 2^27. Their spectra take some 4 GiB.
const MOST_SAMPLES: usize = 134_217_728;

/// Settings of an impulse response.
///
/// Each field is serialised by its name. The format is `"mono"`, `"stereo"` or `{"ambix": order}`. `binaural` is refused,
/// because it contains a set of measurements. A missing field has its default, except the seconds, which are required.
/// Unknown fields and numbers out of range are refused.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "SettingsFile")]
#[non_exhaustive]
pub struct ImpulseSettings {
    /// Samples per second, in [`ImpulseSettings::RATES_HZ`].
    pub rate_hz: u32,
    /// Length in seconds, from the source's impulse on: above 0, at most [`ImpulseSettings::MAX_SECONDS`].
    pub seconds: f64,
    /// Format of the channels.
    pub format: Format,
    /// Seed of the late part's noise. The same seed gives the same samples.
    pub seed: u64,
}

impl ImpulseSettings {
    /// The lowest and the highest rate of an impulse response, in hertz.
    pub const RATES_HZ: RangeInclusive<u32> = HrirSet::RATES_HZ;

    /// The longest impulse response, in seconds.
    pub const MAX_SECONDS: f64 = 60.0;

    /// One channel at 48 kHz, with seed 0.
    pub fn new(seconds: f64) -> ImpulseSettings {
        ImpulseSettings {
            rate_hz: DEFAULT_RATE_HZ,
            seconds,
            format: Format::Mono,
            seed: 0,
        }
    }

    /// Checks the rate and the length against their ranges.
    ///
    /// # Errors
    /// [`ResponseError::BadRate`] and [`ResponseError::BadLength`].
    pub fn validate(&self) -> Result<(), ResponseError> {
        let (rate_hz, seconds) = (self.rate_hz, self.seconds);
        if !ImpulseSettings::RATES_HZ.contains(&rate_hz) {
            return Err(ResponseError::BadRate { rate_hz });
        }
        if !(seconds > 0.0 && seconds <= ImpulseSettings::MAX_SECONDS) {
            return Err(ResponseError::BadLength { seconds });
        }
        Ok(())
    }
}

/// The fields of [`ImpulseSettings`] as they are read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SettingsFile {
    #[serde(default = "default_rate_hz")]
    rate_hz: u32,
    seconds: f64,
    #[serde(default)]
    format: Format,
    #[serde(default)]
    seed: u64,
}

fn default_rate_hz() -> u32 {
    DEFAULT_RATE_HZ
}

impl TryFrom<SettingsFile> for ImpulseSettings {
    type Error = ResponseError;

    fn try_from(file: SettingsFile) -> Result<ImpulseSettings, ResponseError> {
        let settings = ImpulseSettings {
            rate_hz: file.rate_hz,
            seconds: file.seconds,
            format: file.format,
            seed: file.seed,
        };
        settings.validate()?;
        Ok(settings)
    }
}

/// A sampled impulse response: the sound at a listener after an impulse at the source.
///
/// The direct sound of a source of unit power is an impulse of amplitude 1 at 1 m: an energy E
/// (1/m²) has the amplitude √(4π E). The first sample is the time of the source's impulse.
///
/// # Method
/// - **Taps** are at their exact time, also between samples (windowed sinc). Zero-phase filters give each tap the
///   energies of its bands: at a band's centre its amplitude is exactly √(4π E), with a smooth transition between
///   centres. The peak of a tap is therefore at its time for all energies of its bands. Taps at the same time add their
///   amplitudes, while figures add their energies.
/// - **The echogram** becomes Gaussian noise, independent for each band and with zero mean, with the energy of each
///   bin. The noise is then filtered to its octave. The powers of all filters add up to 1. A filter spreads the energy
///   of a bin in time, by about 20 ms at 63 Hz and less than 1 ms from 2 kHz on, in both directions, because no filter
///   is sharp both in time and in frequency.
/// - **Binaural**: each tap is convolved with the HRIRs of its direction, at its exact time. The noise consists of
///   independent signals from 32 directions around the listener, each filtered by the HRIRs of its direction. If the
///   mean direction of a bin and band has the length m (0 diffuse, 1 one wave), the share 1 − m comes evenly from all
///   directions, and the share m from the three directions around the mean direction.
/// - Below 63 Hz the energy is that of the band at 63 Hz, above 8 kHz that of the band at 8 kHz.
///
/// ```
/// use echomarch::response::{Echogram, ImpulseResponse, ImpulseSettings, ListenerAxes, Tap};
/// use echomarch::glam::{DVec3, Vec3};
/// use echomarch::Listener;
///
/// // The direct sound 1 m away, and nothing else.
/// let energy = [1.0 / (4.0 * std::f64::consts::PI); 8];
/// let direct = Tap { seconds: 0.01, energy, direction: DVec3::X };
/// let silence = Echogram::new(0.001, 1)?;
/// let axes = ListenerAxes::of(&Listener::at(Vec3::ZERO, 0.1))?;
/// let impulse = ImpulseResponse::new(&[direct], &silence, &axes, &ImpulseSettings::new(0.1))?;
/// let mono = &impulse.channels()[0];
/// assert!((mono[480] - 1.0).abs() < 1e-3);
/// # Ok::<(), echomarch::response::ResponseError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ImpulseResponse {
    rate_hz: u32,
    format: Format,
    channels: Vec<Vec<f32>>,
}

impl ImpulseResponse {
    /// Computes the response to the arriving sound: each of `taps` separately, `echogram` as noise. `axes` are the
    /// listener's; [`Format::Mono`] does not use them.
    ///
    /// # Errors
    /// [`ResponseError::BadRate`] and [`ResponseError::BadLength`] if the settings are out of
    /// range, [`ResponseError::BadTap`] for a tap whose time, energy or direction is out of range,
    /// [`ResponseError::Hrir`] if a set of head-related impulse responses cannot be resampled,
    /// [`ResponseError::BadNumber`] for more than 134,217,728 samples of all channels.
    pub fn new(
        taps: &[Tap],
        echogram: &Echogram,
        axes: &ListenerAxes,
        settings: &ImpulseSettings,
    ) -> Result<ImpulseResponse, ResponseError> {
        let ImpulseSettings {
            rate_hz, seconds, ..
        } = *settings;
        settings.validate()?;
        check_taps(taps)?;
        let samples = (seconds * f64::from(rate_hz)).ceil() as usize;
        let of_all = samples * settings.format.channels();
        if of_all > MOST_SAMPLES {
            return Err(ResponseError::BadNumber {
                what: "the number of samples of all channels",
                must: "at most 134217728",
                value: of_all as f64,
            });
        }
        let sound = Sound {
            taps,
            echogram,
            axes,
            rate_hz: rate_hz.into(),
            samples,
            seed: settings.seed,
        };
        let channels = match &settings.format {
            Format::Mono => sound.channels(Encoding::Mono),
            Format::Stereo => sound.channels(Encoding::Stereo),
            Format::AmbiX(order) => sound.channels(Encoding::AmbiX(*order)),
            Format::Binaural(hrirs) if hrirs.rate_hz() == rate_hz => {
                binaural::channels(&sound, hrirs)
            }
            Format::Binaural(hrirs) => binaural::channels(&sound, &hrirs.at_rate(rate_hz)?),
        };
        Ok(ImpulseResponse {
            rate_hz,
            format: settings.format.clone(),
            channels,
        })
    }

    /// Samples per second.
    pub fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    /// Format of the channels.
    pub fn format(&self) -> &Format {
        &self.format
    }

    /// The samples of each channel.
    pub fn channels(&self) -> &[Vec<f32>] {
        &self.channels
    }

    /// The samples of all channels, interleaved as in a WAV file.
    pub fn interleaved(&self) -> Vec<f32> {
        let frames = self.channels.first().map_or(0, Vec::len);
        let frame = |index: usize| self.channels.iter().map(move |samples| samples[index]);
        (0..frames).flat_map(frame).collect()
    }
}

/// The gain of a band's filter for taps at a frequency in hertz: see [`ImpulseResponse`].
#[cfg(feature = "audio")]
pub(crate) fn tap_filter_gain(band: usize, frequency_hz: f64) -> f64 {
    Crossing::Amplitude.gain(band, frequency_hz)
}

/// The amplitude for an energy in 1/m².
pub(crate) fn amplitude(energy: f64) -> f64 {
    (4.0 * PI * energy.max(0.0)).sqrt()
}

/// The arriving sound, and the parameters of its response.
struct Sound<'a> {
    taps: &'a [Tap],
    echogram: &'a Echogram,
    axes: &'a ListenerAxes,
    rate_hz: f64,
    /// Number of samples of each channel.
    samples: usize,
    seed: u64,
}

impl Sound<'_> {
    /// The channels of an encoding.
    fn channels(&self, encoding: Encoding) -> Vec<Vec<f32>> {
        let count = encoding.channels();
        let mut spectra = Spectra::new(count, self.samples, self.rate_hz);
        let mut unfiltered = vec![spectra.silence(); count];
        let placed = |tap| PlacedTap::new(self, tap, encoding);
        let taps: Vec<PlacedTap> = self.taps.iter().map(placed).collect();
        for band in 0..BAND_COUNT {
            if !taps.is_empty() {
                taps.iter().for_each(|tap| tap.add(&mut unfiltered, band));
                spectra.add(&mut unfiltered, Crossing::Amplitude, band);
            }
            if self.echogram.bins() > 0 {
                filters::add_noise(&mut unfiltered, self, band, encoding);
                spectra.add(&mut unfiltered, Crossing::Power, band);
            }
        }
        spectra.into_channels(self.samples)
    }
}

/// A tap with its impulse, which is that of all bands and channels.
struct PlacedTap<'a> {
    tap: &'a Tap,
    /// Index of the first sample of the impulse.
    first: i64,
    impulse: filters::Impulse,
    /// The gain of each channel.
    gains: [f64; MOST_CHANNELS],
}

impl PlacedTap<'_> {
    fn new<'a>(sound: &Sound, tap: &'a Tap, encoding: Encoding) -> PlacedTap<'a> {
        let (first, impulse) = filters::impulse(tap.seconds * sound.rate_hz);
        PlacedTap {
            tap,
            first,
            impulse,
            gains: encoding.gains(sound.axes, -tap.direction),
        }
    }

    /// Adds the tap's sound in a band, unfiltered, to the samples of each channel.
    fn add(&self, channels: &mut [Vec<f64>], band: usize) {
        let amplitude = amplitude(self.tap.energy[band]);
        for (samples, gain) in channels.iter_mut().zip(self.gains) {
            let of_band = self.impulse.map(|value| gain * amplitude * value);
            filters::add_from(samples, self.first, of_band);
        }
    }
}

/// Least length of a vector, and least sine of the angle between forward and up. Below it, the rounding of the vectors
/// to `f32` hides the direction.
const LEAST_LENGTH: f64 = 1e-6;

/// A listener's axes in the world: orthogonal unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListenerAxes {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

impl ListenerAxes {
    /// The axes for vectors that are in listener axes already: see [`ListenerAxes::to_listener`].
    #[cfg(feature = "simulator")]
    pub(crate) const OWN: ListenerAxes = ListenerAxes {
        forward: DVec3::X,
        right: DVec3::NEG_Y,
        up: DVec3::Z,
    };

    /// The axes of a listener with the viewing direction `forward` and the upward direction `up` (world axes, any
    /// length): `up` is made perpendicular to `forward`.
    ///
    /// # Errors
    /// [`ResponseError::BadAxes`] if a vector has length zero or is not finite, or both are parallel.
    pub fn new(forward: DVec3, up: DVec3) -> Result<ListenerAxes, ResponseError> {
        let bad = ResponseError::BadAxes { forward, up };
        let unit = |vector: DVec3| {
            let told = vector.is_finite() && vector.length() > LEAST_LENGTH;
            told.then(|| vector.normalize())
        };
        let (Some(ahead), Some(above)) = (unit(forward), unit(up)) else {
            return Err(bad);
        };
        let Some(right) = unit(ahead.cross(above)) else {
            return Err(bad);
        };
        Ok(ListenerAxes {
            forward: ahead,
            right,
            up: right.cross(ahead),
        })
    }

    /// The axes of a scene's listener.
    ///
    /// # Errors
    /// [`ResponseError::BadAxes`] if the axes are not finite.
    pub fn of(listener: &Listener) -> Result<ListenerAxes, ResponseError> {
        ListenerAxes::new(listener.forward().as_dvec3(), listener.up().as_dvec3())
    }

    /// The viewing direction.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The direction of the right ear.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The upward direction.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Converts a world vector to listener axes, which are the axes of AmbiX and SOFA: x ahead, y to the left, z up.
    pub fn to_listener(&self, world: DVec3) -> DVec3 {
        DVec3::new(
            world.dot(self.forward),
            -world.dot(self.right),
            world.dot(self.up),
        )
    }
}

/// The channels of an impulse response.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// One channel, the same for all directions.
    #[default]
    Mono,
    /// Left and right: each arrival is panned with constant power by its component s along the right ear's direction,
    /// with gains cos and sin of (1 + s) π/4.
    Stereo,
    /// Ambisonics in the convention AmbiX (C. Nachbar et al., *AmbiX – A Suggested Ambisonics Format*, 2011): channels
    /// in the order ACN with the normalisation SN3D. A wave from (x, y, z) has the gains 1, y, z, x in the first four
    /// channels W, Y, Z, X, where x is ahead of the listener, y to the left, z up.
    AmbiX(AmbisonicOrder),
    /// Left and right ear, for headphones: each arrival is filtered by the head-related impulse
    /// responses of its direction. A set at another rate is resampled.
    #[serde(skip)]
    Binaural(Arc<HrirSet>),
}

/// An encoding of directions by gains only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Encoding {
    Mono,
    Stereo,
    AmbiX(AmbisonicOrder),
}

/// Amplitudes of the noise in each channel: of the noise common to all channels, and of the noise of this channel
/// alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Noise {
    common: [f64; MOST_CHANNELS],
    own: [f64; MOST_CHANNELS],
}

impl Format {
    /// Number of channels.
    pub fn channels(&self) -> usize {
        match self {
            Format::Mono => 1,
            Format::Stereo | Format::Binaural(_) => 2,
            Format::AmbiX(order) => order.channels(),
        }
    }
}

impl Encoding {
    /// Number of channels.
    fn channels(self) -> usize {
        match self {
            Encoding::Mono => 1,
            Encoding::Stereo => 2,
            Encoding::AmbiX(order) => order.channels(),
        }
    }

    /// The gains of sound from a direction (a unit vector towards its source).
    pub(crate) fn gains(self, axes: &ListenerAxes, from: DVec3) -> [f64; MOST_CHANNELS] {
        let mut gains = [0.0; MOST_CHANNELS];
        match self {
            Encoding::Mono => gains[0] = 1.0,
            Encoding::Stereo => {
                let side = from.dot(axes.right()).clamp(-1.0, 1.0);
                let (right, left) = ((1.0 + side) * FRAC_PI_4).sin_cos();
                gains[..2].copy_from_slice(&[left, right]);
            }
            Encoding::AmbiX(order) => gains = harmonics(order, axes.to_listener(from)),
        }
        gains
    }

    /// Noise of power 1 from all directions, weighted by a mean direction: `mean` is the energy-weighted mean of the
    /// unit vectors towards the sources, of length 0 (diffuse) to 1.
    ///
    /// AmbiX: the share |mean| of the energy is one wave from the mean direction, and the rest is diffuse. Energy and
    /// intensity are both correct. Stereo: independent noise in each channel with the power of one wave at that lateral
    /// position; the powers are equal if the sound is diffuse.
    fn noise(self, axes: &ListenerAxes, mean: DVec3) -> Noise {
        let none = [0.0; MOST_CHANNELS];
        match self {
            Encoding::Mono => Noise {
                common: none,
                own: self.gains(axes, mean),
            },
            Encoding::Stereo => {
                let side = mean.dot(axes.right()).clamp(-1.0, 1.0);
                let sine = (side * FRAC_PI_2).sin();
                let mut own = none;
                own[0] = ((1.0 - sine) / 2.0).sqrt();
                own[1] = ((1.0 + sine) / 2.0).sqrt();
                Noise { common: none, own }
            }
            Encoding::AmbiX(_) => {
                let directed = mean.length().min(1.0);
                let gains = match mean.try_normalize() {
                    Some(mean) => self.gains(axes, mean),
                    None => none,
                };
                // The share of a channel in the energy of a diffuse field.
                let share = |channel: usize| 1.0 / (2 * degree(channel) + 1) as f64;
                Noise {
                    common: gains.map(|gain| gain * directed.sqrt()),
                    own: std::array::from_fn(|channel| ((1.0 - directed) * share(channel)).sqrt()),
                }
            }
        }
    }
}
