//! Binaural responses: taps and noise through head-related impulse responses.

use super::late::{Gauss, samples_of};
use super::spectrum::{Crossing, Spectra};
use super::{Sound, amplitude, taps};
use crate::acoustics::hrir::{Facets, Hrir, HrirPair, HrirSet};
use crate::acoustics::{Echogram, Tap};
use crate::bands::BAND_COUNT;
use crate::sphere_directions::lattice;
use glam::DVec3;

/// Number of ears of a listener.
const EARS: usize = 2;

/// Number of directions of the late part's noise. In a diffuse field the levels and the coherence of
/// a rigid sphere's ears are then within 0.01 dB and 0.001 of those with 1,500 directions in each
/// octave from 250 Hz to 8 kHz; each further one costs eight transforms of the response's length.
const FIELD_DIRECTIONS: usize = 32;

/// The channels of both ears; `hrirs` are at the response's rate.
pub(super) fn channels(
    taps: &[Tap],
    echogram: &Echogram,
    hrirs: &HrirSet,
    sound: &Sound,
    samples: usize,
) -> Vec<Vec<f32>> {
    // The HRIRs extend beyond the response.
    let length = samples + hrirs.samples();
    let mut spectra = Spectra::new(EARS, length, sound.rate_hz);
    if !taps.is_empty() {
        add_taps(&mut spectra, taps, hrirs, sound);
    }
    if echogram.bins() > 0 {
        let field = Field::new(echogram, sound);
        let mut one = Spectra::new(1, length, sound.rate_hz);
        for (number, from) in field.facets.directions().iter().enumerate() {
            field.add_noise(&mut one, samples, number);
            spectra.add_filtered(&mut one, filters(&spectra, &hrirs.pair(*from), sound));
        }
    }
    spectra.into_channels(samples)
}

/// A response placed between samples, and the index of its first sample.
struct Placed {
    first: i64,
    samples: Vec<f32>,
}

impl Placed {
    /// A response whose time 0 is at `place` (in samples).
    fn new(hrir: &Hrir, place: f64, rate_hz: f64) -> Placed {
        let (first, impulse) = taps::impulse(place + hrir.delay_s * rate_hz);
        let impulse: Vec<f32> = impulse.map(|value| value as f32).collect();
        let mut samples = vec![0.0; hrir.samples.len() + impulse.len() - 1];
        for (offset, sample) in hrir.samples.iter().enumerate() {
            for (sum, value) in samples[offset..].iter_mut().zip(&impulse) {
                *sum += sample * value;
            }
        }
        Placed { first, samples }
    }

    fn pair(pair: &HrirPair, place: f64, rate_hz: f64) -> [Placed; EARS] {
        [&pair.left, &pair.right].map(|hrir| Placed::new(hrir, place, rate_hz))
    }

    /// Adds it; samples before the first or after the last are lost.
    fn add(&self, samples: &mut [f64], amplitude: f64) {
        for (index, value) in (self.first..).zip(&self.samples) {
            let sample = usize::try_from(index)
                .ok()
                .and_then(|index| samples.get_mut(index));
            if let Some(sample) = sample {
                *sample += amplitude * f64::from(*value);
            }
        }
    }
}

fn add_taps(spectra: &mut Spectra, taps: &[Tap], hrirs: &HrirSet, sound: &Sound) {
    let mut pair = HrirPair::default();
    let mut place = |tap: &Tap| {
        hrirs.pair_into(sound.axes.to_listener(-tap.direction), &mut pair);
        Placed::pair(&pair, tap.seconds * sound.rate_hz, sound.rate_hz)
    };
    let placed: Vec<[Placed; EARS]> = taps.iter().map(&mut place).collect();
    let mut unfiltered = vec![spectra.silence(); EARS];
    for band in 0..BAND_COUNT {
        for (tap, ears) in taps.iter().zip(&placed) {
            let amplitude = amplitude(tap.energy[band]);
            for (samples, ear) in unfiltered.iter_mut().zip(ears) {
                ear.add(samples, amplitude);
            }
        }
        spectra.add(&mut unfiltered, Crossing::Amplitude, band);
    }
}

/// The responses as filters of a spectrum: samples before time 0 are at the end.
fn filters(spectra: &Spectra, pair: &HrirPair, sound: &Sound) -> Vec<Vec<f64>> {
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

/// The energy of one band of one bin by direction.
#[derive(Clone, Copy, Default)]
struct Share {
    /// Energy from each direction.
    diffuse: f64,
    /// Additional energy from the directions around the mean one.
    directed: [(usize, f64); 3],
}

/// A sound field of independent noises from a few directions.
struct Field<'a> {
    facets: Facets,
    echogram: &'a Echogram,
    shares: Vec<[Share; BAND_COUNT]>,
    rate_hz: f64,
    seed: u64,
}

impl Field<'_> {
    fn new<'a>(echogram: &'a Echogram, sound: &Sound) -> Field<'a> {
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
            echogram,
            rate_hz: sound.rate_hz,
            seed: sound.seed,
        }
    }

    /// Adds the noise from one direction, all bands.
    fn add_noise(&self, spectra: &mut Spectra, samples: usize, direction: usize) {
        let mut unfiltered = vec![spectra.silence()];
        for band in 0..BAND_COUNT {
            let stream = (band * FIELD_DIRECTIONS + direction) as u64;
            let mut noise = Gauss::new(self.seed, stream);
            for (bin, shares) in self.shares.iter().enumerate() {
                let energy = shares[band].of(direction);
                if energy <= 0.0 {
                    continue;
                }
                for (sample, share) in samples_of(self.echogram, bin, self.rate_hz) {
                    if sample < samples {
                        unfiltered[0][sample] += amplitude(energy * share) * noise.next();
                    }
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
