//! Audible impulse responses: taps, and noise shaped by an echogram.

mod axes;
mod binaural;
mod format;
mod late;
mod spectrum;
mod taps;
#[cfg(test)]
mod tests;

pub use axes::ListenerAxes;
pub use format::Format;

use super::arriving::check_taps;
use super::{AcousticsError, Echogram, Tap};
use crate::bands::BAND_COUNT;
pub(crate) use format::Encoding;
use spectrum::{Crossing, Spectra};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// The lowest and the highest rate of an impulse response, in hertz.
pub const RATES_HZ: RangeInclusive<u32> = 8_000..=192_000;

/// The longest impulse response, in seconds.
pub const MAX_SECONDS: f64 = 60.0;

/// The default rate of an impulse response, in hertz.
const DEFAULT_RATE_HZ: u32 = 48_000;

/// Settings of an impulse response.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImpulseSettings {
    /// Samples a second, in [`RATES_HZ`].
    pub rate_hz: u32,
    /// Length in seconds from the source's impulse on: above 0, at most [`MAX_SECONDS`].
    pub seconds: f64,
    /// Its channels.
    pub format: Format,
    /// Seed of the late part's noise. The same seed gives the same samples.
    pub seed: u64,
}

impl ImpulseSettings {
    /// One channel at 48 kHz, with seed 0.
    pub fn new(seconds: f64) -> ImpulseSettings {
        ImpulseSettings {
            rate_hz: DEFAULT_RATE_HZ,
            seconds,
            format: Format::Mono,
            seed: 0,
        }
    }
}

/// A sampled impulse response: the sound at a listener after an impulse at the source.
///
/// The direct sound of a source of unit power is an impulse of amplitude 1 at 1 m: an energy E
/// (1/m²) has the amplitude √(4π E). The first sample is the time of the source's impulse.
///
/// # Method
/// - **Taps** are at their exact time, also between samples (windowed sinc). Each is filtered to
///   the energies of its bands, zero-phase: at a band's centre its amplitude is √(4π E) exactly,
///   with a smooth transition between centres. So its peak is at its time whatever its bands. Taps
///   at one time add their amplitudes, while figures add their energies.
/// - **The echogram** becomes Gaussian noise, independent for each band and with zero mean, with
///   the energy of each bin. Then it is filtered to its octave; the filters' powers add up to 1. A
///   filter spreads the energy of a bin in time, by about 20 ms at 63 Hz and less than 1 ms from 2
///   kHz on, in both directions: no filter is sharp both in time and in frequency.
/// - **Binaural**: each tap is convolved with the HRIRs of its direction, at its exact time. The
///   noise comes from 32 directions around the listener, independent in each, through their HRIRs.
///   If the mean direction of a bin and band has the length m (0 diffuse, 1 one wave), the share 1
///   − m comes from all of them evenly, and the share m from the three around the mean direction.
/// - Below 63 Hz the energy is that of 63 Hz, above 8 kHz that of 8 kHz.
///
/// ```
/// use echomarch::acoustics::{Echogram, ImpulseResponse, ImpulseSettings, ListenerAxes, Tap};
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
/// # Ok::<(), echomarch::acoustics::AcousticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ImpulseResponse {
    rate_hz: u32,
    format: Format,
    channels: Vec<Vec<f32>>,
}

impl ImpulseResponse {
    /// Computes the response to the arriving sound: `taps` one by one, `echogram` as noise. `axes`
    /// are the listener's; [`Format::Mono`] does not use them.
    ///
    /// # Errors
    /// [`AcousticsError::BadRate`] and [`AcousticsError::BadLength`] if the settings are out of
    /// range, [`AcousticsError::BadTap`] for a tap whose time, energy or direction is out of range,
    /// [`AcousticsError::Hrir`] if a set of head-related impulse responses cannot be resampled.
    pub fn new(
        taps: &[Tap],
        echogram: &Echogram,
        axes: &ListenerAxes,
        settings: &ImpulseSettings,
    ) -> Result<ImpulseResponse, AcousticsError> {
        let ImpulseSettings {
            rate_hz, seconds, ..
        } = *settings;
        if !RATES_HZ.contains(&rate_hz) {
            return Err(AcousticsError::BadRate { rate_hz });
        }
        if !(seconds > 0.0 && seconds <= MAX_SECONDS) {
            return Err(AcousticsError::BadLength { seconds });
        }
        check_taps(taps)?;
        let samples = (seconds * f64::from(rate_hz)).ceil() as usize;
        let sound = Sound {
            axes: *axes,
            rate_hz: rate_hz.into(),
            seed: settings.seed,
        };
        let encoded = |encoding| channels(taps, echogram, encoding, &sound, samples);
        let channels = match &settings.format {
            Format::Mono => encoded(Encoding::Mono),
            Format::Stereo => encoded(Encoding::Stereo),
            Format::AmbiX => encoded(Encoding::AmbiX),
            Format::Binaural(hrirs) if hrirs.rate_hz() == rate_hz => {
                binaural::channels(taps, echogram, hrirs, &sound, samples)
            }
            Format::Binaural(hrirs) => {
                binaural::channels(taps, echogram, &hrirs.at_rate(rate_hz)?, &sound, samples)
            }
        };
        Ok(ImpulseResponse {
            rate_hz,
            format: settings.format.clone(),
            channels,
        })
    }

    /// Samples a second.
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

    /// The samples of all channels in turn, as in a WAV file.
    pub fn interleaved(&self) -> Vec<f32> {
        let frames = self.channels.first().map_or(0, Vec::len);
        let frame = |index: usize| self.channels.iter().map(move |samples| samples[index]);
        (0..frames).flat_map(frame).collect()
    }
}

/// The gain of a band's filter for taps at a frequency in hertz: see [`ImpulseResponse`].
pub(crate) fn tap_filter_gain(band: usize, frequency_hz: f64) -> f64 {
    Crossing::Amplitude.gain(band, frequency_hz)
}

/// The amplitude of an energy in 1/m².
pub(crate) fn amplitude(energy: f64) -> f64 {
    (4.0 * PI * energy.max(0.0)).sqrt()
}

/// Parameters of a response.
struct Sound {
    axes: ListenerAxes,
    rate_hz: f64,
    seed: u64,
}

fn channels(
    taps: &[Tap],
    echogram: &Echogram,
    encoding: Encoding,
    sound: &Sound,
    samples: usize,
) -> Vec<Vec<f32>> {
    let count = encoding.channels();
    let mut spectra = Spectra::new(count, samples, sound.rate_hz);
    let mut unfiltered = vec![spectra.silence(); count];
    for band in 0..BAND_COUNT {
        if !taps.is_empty() {
            add_taps(&mut unfiltered, taps, band, encoding, sound);
            spectra.add(&mut unfiltered, Crossing::Amplitude, band);
        }
        if echogram.bins() > 0 {
            late::add(&mut unfiltered, samples, echogram, band, encoding, sound);
            spectra.add(&mut unfiltered, Crossing::Power, band);
        }
    }
    spectra.into_channels(samples)
}

fn add_taps(
    unfiltered: &mut [Vec<f64>],
    taps: &[Tap],
    band: usize,
    encoding: Encoding,
    sound: &Sound,
) {
    for tap in taps {
        let gains = encoding.gains(&sound.axes, -tap.direction);
        for (samples, gain) in unfiltered.iter_mut().zip(gains) {
            let place = tap.seconds * sound.rate_hz;
            taps::add(samples, place, gain * amplitude(tap.energy[band]));
        }
    }
}
