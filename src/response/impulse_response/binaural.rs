//! Binaural responses: taps and noise filtered by head-related impulse responses.

use super::filters::{Crossing, Gauss, Spectra, add_from, impulse, samples_of};
use super::{Sound, amplitude};
use crate::bands::BAND_COUNT;
use crate::hrtf::{Facets, Hrir, HrirSet};
use crate::response::Tap;
use crate::sampling::lattice;
use glam::DVec3;

/// Number of ears of a listener.
const EARS: usize = 2;

/// Number of directions of the late part's noise. In a diffuse field the levels and the coherence at a rigid sphere's
/// ears are then within 0.01 dB and 0.001 of the values with 1,500 directions in each octave from 250 Hz to 8 kHz. Each
/// further direction takes eight transforms of the response's length.
const FIELD_DIRECTIONS: usize = 32;

/// Returns the channels of both ears; `hrirs` must be at the response's rate.
pub(super) fn channels(sound: &Sound, hrirs: &HrirSet) -> Vec<Vec<f32>> {
    // The HRIRs extend beyond the response.
    let length = sound.samples + hrirs.samples();
    let mut spectra = Spectra::new(EARS, length, sound.rate_hz);
    if !sound.taps.is_empty() {
        add_taps(&mut spectra, sound, hrirs);
    }
    if sound.echogram.bins() > 0 {
        let field = Field::new(sound);
        let mut one = Spectra::new(1, length, sound.rate_hz);
        for (number, from) in field.facets.directions().iter().enumerate() {
            field.add_noise(&mut one, number);
            spectra.add_filtered(&mut one, filters(&spectra, &hrirs.pair(*from), sound));
        }
    }
    spectra.into_channels(sound.samples)
}

/// A response shifted by a fractional number of samples, and the index of its first sample.
struct Placed {
    first: i64,
    samples: Vec<f32>,
}

impl Placed {
    /// Places a response so that its time 0 is at `place` (in samples).
    fn new(hrir: &Hrir, place: f64, rate_hz: f64) -> Placed {
        let (first, impulse) = impulse(place + hrir.delay_s * rate_hz);
        let impulse = impulse.map(|value| value as f32);
        let mut samples = vec![0.0; hrir.samples.len() + impulse.len() - 1];
        for (offset, sample) in hrir.samples.iter().enumerate() {
            for (sum, value) in samples[offset..].iter_mut().zip(&impulse) {
                *sum += sample * value;
            }
        }
        Placed { first, samples }
    }

    fn pair(pair: &[Hrir; EARS], place: f64, rate_hz: f64) -> [Placed; EARS] {
        pair.each_ref()
            .map(|hrir| Placed::new(hrir, place, rate_hz))
    }

    /// Adds the response; samples before the first or after the last are dropped.
    fn add(&self, samples: &mut [f64], amplitude: f64) {
        let values = self.samples.iter();
        let values = values.map(|value| amplitude * f64::from(*value));
        add_from(samples, self.first, values);
    }
}

fn add_taps(spectra: &mut Spectra, sound: &Sound, hrirs: &HrirSet) {
    let mut pair = <[Hrir; EARS]>::default();
    let mut place = |tap: &Tap| {
        hrirs.pair_into(sound.axes.to_listener(-tap.direction), &mut pair);
        Placed::pair(&pair, tap.seconds * sound.rate_hz, sound.rate_hz)
    };
    let placed: Vec<[Placed; EARS]> = sound.taps.iter().map(&mut place).collect();
    let mut unfiltered = vec![spectra.silence(); EARS];
    for band in 0..BAND_COUNT {
        for (tap, ears) in sound.taps.iter().zip(&placed) {
            let amplitude = amplitude(tap.energy[band]);
            for (samples, ear) in unfiltered.iter_mut().zip(ears) {
                ear.add(samples, amplitude);
            }
        }
        spectra.add(&mut unfiltered, Crossing::Amplitude, band);
    }
}

/// The responses as filters of a spectrum: samples before time 0 are at the end.
fn filters(spectra: &Spectra, pair: &[Hrir; EARS], sound: &Sound) -> Vec<Vec<f64>> {
    let filter = |placed: Placed| {
        let mut filter = spectra.silence();
        let length = filter.len() as i64;
        for (index, value) in (placed.first..).zip(&placed.samples) {
            filter[index.rem_euclid(length) as usize] += f64::from(*value);
        }
        filter
    };
    Placed::pair(pair, 0.0, sound.rate_hz)
        .map(filter)
        .into_iter()
        .collect()
}

/// The energy of one band of one bin, divided among directions.
#[derive(Clone, Copy, Default)]
struct Share {
    /// Energy from each direction.
    diffuse: f64,
    /// Additional energy from the directions around the mean direction.
    directed: [(usize, f64); 3],
}

/// A sound field of independent noise signals from a few directions.
struct Field<'a> {
    facets: Facets,
    sound: &'a Sound<'a>,
    shares: Vec<[Share; BAND_COUNT]>,
}

impl Field<'_> {
    fn new<'a>(sound: &'a Sound) -> Field<'a> {
        let echogram = sound.echogram;
        let facets = Facets::new(lattice(FIELD_DIRECTIONS as u64).collect());
        let share = |energy: f64, flow: DVec3| {
            if energy <= 0.0 {
                return Share::default();
            }
            let mean = sound.axes.to_listener(-flow / energy);
            let directed = mean.length().min(1.0);
            let towards = mean.try_normalize().unwrap_or(DVec3::X);
            Share {
                diffuse: energy * (1.0 - directed) / FIELD_DIRECTIONS as f64,
                directed: facets
                    .around(towards)
                    .map(|(index, weight)| (index, energy * directed * weight)),
            }
        };
        let bin = |bin: usize| {
            let (energy, flow) = (echogram.energy(bin), echogram.flow(bin));
            std::array::from_fn(|band| share(energy[band], flow[band]))
        };
        Field {
            shares: (0..echogram.bins()).map(bin).collect(),
            facets,
            sound,
        }
    }

    /// Adds the noise from one direction, for all bands.
    fn add_noise(&self, spectra: &mut Spectra, direction: usize) {
        let mut unfiltered = vec![spectra.silence()];
        for band in 0..BAND_COUNT {
            let stream = (band * FIELD_DIRECTIONS + direction) as u64;
            let mut noise = Gauss::new(self.sound.seed, stream);
            for (bin, shares) in self.shares.iter().enumerate() {
                let energy = shares[band].of(direction);
                if energy <= 0.0 {
                    continue;
                }
                for (sample, share) in samples_of(self.sound, bin) {
                    unfiltered[0][sample] += amplitude(energy * share) * noise.next();
                }
            }
            spectra.add(&mut unfiltered, Crossing::Power, band);
        }
    }
}

impl Share {
    fn of(&self, direction: usize) -> f64 {
        let directed = self.directed.iter();
        let directed = directed.filter(|(index, _)| *index == direction);
        self.diffuse + directed.map(|(_, energy)| energy).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{ONE, RATE_HZ, empty, filtered, response, tap};
    use super::super::{Format, ImpulseResponse};
    use super::*;
    use crate::hrtf::tests::{SAMPLES, grid, set, transfer};
    use crate::response::Echogram;
    use crate::sampling::lattice;
    use realfft::num_complex::Complex;
    use std::f64::consts::{PI, TAU};
    use std::sync::Arc;

    /// Converts a direction from listener to world axes: the listener looks along −z, y is up.
    fn world(listener: DVec3) -> DVec3 {
        DVec3::new(-listener.y, listener.z, -listener.x)
    }

    fn heard(taps: &[Tap], echogram: &Echogram, seed: u64) -> ImpulseResponse {
        let format = Format::Binaural(Arc::new(set(grid(30))));
        response(taps, echogram, format, seed)
    }

    /// The spectrum at a frequency, with time 0 at `seconds`.
    fn spectrum(samples: &[f32], hertz: f64, seconds: f64) -> Complex<f64> {
        let term = |(index, sample): (usize, &f32)| {
            let turn = -TAU * hertz * (index as f64 / RATE_HZ - seconds);
            Complex::from_polar(f64::from(*sample), turn)
        };
        samples.iter().enumerate().map(term).sum()
    }

    /// Protects taps: they have the transfer function of each ear for a measured direction, at the tap's time and
    /// level, with left and right not swapped.
    #[test]
    fn a_tap_goes_through_the_head() {
        for from in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::Z] {
            let seconds = 0.020_007;
            let made = heard(&[tap(seconds, ONE, world(from))], &empty(), 0);
            assert_eq!(made.channels().len(), 2);
            for (ear, samples) in made.channels().iter().enumerate() {
                let exact = transfer(from, ear);
                for bin in [1, 4, 10, 30, 60] {
                    let hertz = bin as f64 * RATE_HZ / SAMPLES as f64;
                    let found = spectrum(samples, hertz, seconds);
                    let level = found.norm() / exact[bin].norm();
                    assert!((level - 1.0).abs() < 0.01, "{from} {ear} {hertz}: {level}");
                    // Time 0 of the set is 6 µs off the head's centre.
                    let late = (exact[bin] / found).arg() / (TAU * hertz);
                    let limit = if bin <= 10 { 15e-6 } else { f64::INFINITY };
                    assert!(late.abs() < limit, "{from} {ear} {hertz}: {late}");
                }
            }
        }
    }

    /// Protects a set whose rate differs from the response's: level and time are unchanged.
    #[test]
    fn a_set_at_another_rate_is_resampled() {
        let resampled = set(grid(30)).at_rate(44_100).expect("a good rate");
        let arrival = [tap(0.02, ONE, world(DVec3::Y))];
        let other = response(&arrival, &empty(), Format::Binaural(Arc::new(resampled)), 0);
        let same = heard(&arrival, &empty(), 0);
        for (a, b) in other.channels().iter().zip(same.channels()) {
            for hertz in [500.0, 2e3, 8e3] {
                let off = spectrum(a, hertz, 0.02) / spectrum(b, hertz, 0.02) - 1.0;
                assert!(off.norm() < 0.01, "{hertz}: {off}");
            }
        }
    }

    /// Constant energy for a second, in equal parts from all of `from` (listener axes).
    fn steady(from: &[DVec3]) -> Echogram {
        let mut echogram = empty();
        let energy = 1e-3 / from.len() as f64;
        for bin in 0..1000 {
            for direction in from {
                let seconds = (f64::from(bin) + 0.5) * 1e-3;
                let towards = -world(direction.normalize());
                echogram
                    .add(0, seconds, &[energy; BAND_COUNT], towards)
                    .unwrap();
            }
        }
        echogram
    }

    /// Energies of both ears and their product in an octave, for these directions, from the exact head.
    fn expected(from: &[DVec3], band: usize) -> [f64; 3] {
        let centre = 62.5 * 2_f64.powi(band as i32);
        let bins = 1..SAMPLES / 2;
        let bins: Vec<usize> = bins
            .filter(|bin| {
                let hertz = *bin as f64 * RATE_HZ / SAMPLES as f64;
                (hertz / centre).log2().abs() < 0.5
            })
            .collect();
        let mut sums = [0.0; 3];
        for direction in from {
            let (left, right) = (transfer(*direction, 0), transfer(*direction, 1));
            for bin in &bins {
                sums[0] += left[*bin].norm_sqr();
                sums[1] += right[*bin].norm_sqr();
                sums[2] += (left[*bin] * right[*bin].conj()).re;
            }
        }
        sums.map(|sum| sum / (from.len() * bins.len()) as f64)
    }

    /// Protects the late part's levels at both ears and their coherence, for sound from all around and from one side.
    /// An octave of 1 kHz has about 700 independent values in a second. Its energy is within 4 %, and the test allows
    /// four times that. From one side 1.6 dB are allowed, because three directions represent that direction, and the
    /// head's shadow differs between them.
    #[test]
    fn noise_goes_through_the_head() {
        let around: Vec<DVec3> = lattice(200).collect();
        // The direction is not exactly at the side, because sound diffracted around a sphere converges on the far side,
        // in a spot that is smaller than the distance between the noise's directions.
        let side = vec![DVec3::new(0.6, 0.7, 0.4)];
        for (from, limit, is_diffuse) in [(around, 0.16, true), (side, 0.45, false)] {
            let made = heard(&[], &steady(&from), 6);
            for band in [4, 5, 6, 7] {
                let ears: Vec<Vec<f64>> = made
                    .channels()
                    .iter()
                    .map(|samples| filtered(samples, band, 0.5))
                    .collect();
                let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let width_hz = 62.5 * 2_f64.powi(band as i32) * 0.5_f64.sqrt();
                // 1 s of 1 1/m² in total, at half the sampling rate.
                let unit = 4.0 * PI * width_hz / (RATE_HZ / 2.0);
                let [left, right, both] = expected(&from, band);
                for (found, expected) in [
                    (sum(&ears[0], &ears[0]) / unit, left),
                    (sum(&ears[1], &ears[1]) / unit, right),
                ] {
                    let ratio = found / expected;
                    assert!((ratio - 1.0).abs() < limit, "{band}: {ratio}");
                }
                // From one side the product's phase changes with the frequency, and differs between the three
                // directions.
                if !is_diffuse {
                    continue;
                }
                let level = (left * right).sqrt();
                let found = sum(&ears[0], &ears[1])
                    / (sum(&ears[0], &ears[0]) * sum(&ears[1], &ears[1])).sqrt();
                assert!((found - both / level).abs() < limit, "{band}: {found}");
            }
        }
    }

    /// Protects the reproducibility of the noise: the seed determines it.
    #[test]
    fn the_seed_chooses_the_binaural_noise() {
        let echogram = steady(&[DVec3::X]);
        let made = |seed| heard(&[], &echogram, seed);
        assert!(made(1) == made(1));
        assert!(made(1) != made(2));
    }
}
