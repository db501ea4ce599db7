//! Energies of sounds that interfere, in octave bands.
//!
//! The samples of ways around an obstacle interfere in an impulse response by their delays, while the energies of the ways
//! contain this interference already. A common factor takes it out of the samples.

use crate::bands::{BANDS_HZ, Bands};
use num_complex::Complex64;
use std::array;
use std::f64::consts::TAU;

/// Centres of the third octaves of an octave band, as factors of its centre.
pub(super) const THIRDS: [f64; 3] = [0.793_700_525_984_099_7, 1.0, 1.259_921_049_894_873_2];

/// Width of a third octave, as a share of its centre.
const WIDTH: f64 = 0.231_563_184_6;

/// Least energy of the sum of samples, as a share of the sum of their energies: −10 dB. Two ways of the same energy cancel
/// 8 dB of an octave at most. More than two can cancel all of it, where a slightly different delay or level leaves much
/// more: the factor that makes up for it would amplify this difference without limit.
const LEAST_OF_SAMPLES: f64 = 0.1;

/// A sound of one wave number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sound {
    pub pressure: Complex64,
    /// Length of its way in metres: the phase of the pressure turns with it over a band.
    pub length_m: f64,
}

impl Sound {
    /// The same sound, with a factor of the pressure.
    pub fn weighted(self, weight: f64) -> Sound {
        Sound {
            pressure: self.pressure * weight,
            ..self
        }
    }
}

/// The mean of a function of the wave number over the third octaves of a band.
pub(super) fn band_mean(band: usize, speed: f64, value: impl FnMut(f64) -> f64) -> f64 {
    let numbers = THIRDS.map(|factor| TAU * BANDS_HZ[band] * factor / speed);
    numbers.map(value).iter().sum::<f64>() / THIRDS.len() as f64
}

/// The energy of the sum of sounds, as the mean over the third octave about `k`.
pub(super) fn energy(sounds: &[Sound], k: f64) -> f64 {
    let mut energy = 0.0;
    for (index, a) in sounds.iter().enumerate() {
        energy += a.pressure.norm_sqr();
        for b in &sounds[..index] {
            let cross = (a.pressure * b.pressure.conj()).re;
            energy += 2.0 * cross * coherence(a.length_m - b.length_m, k);
        }
    }
    energy.max(0.0)
}

/// The energy by band that the samples of ways around the same obstacle need so that their sum has the sum of the ways'
/// energies, as a multiple of these energies: 1 for a single way, at most 10. `ways` are the energies at the listener by
/// band, and the lengths in metres.
pub(in crate::response) fn in_samples(speed: f64, ways: &[(Bands, f64)]) -> Bands {
    array::from_fn(|band| {
        let of_band = ways
            .iter()
            .map(|(energy, length_m)| (energy[band], *length_m));
        let heard: Vec<(f64, f64)> = of_band.filter(|(energy, _)| *energy > 0.0).collect();
        match heard.len() {
            0 | 1 => 1.0,
            _ => 1.0 / of_samples(band, speed, &heard).max(LEAST_OF_SAMPLES),
        }
    })
}

/// The energy in a band of the sum of samples that have these energies and whose ways have these lengths in metres, as a
/// multiple of the sum of the energies. Not all energies are 0.
fn of_samples(band: usize, speed: f64, ways: &[(f64, f64)]) -> f64 {
    let all: f64 = ways.iter().map(|(energy, _)| energy).sum();
    let whole = band_mean(band, speed, |k| {
        let sound = |&(energy, length_m): &(f64, f64)| Sound {
            pressure: Complex64::from_polar(energy.sqrt(), k * length_m),
            length_m,
        };
        energy(&ways.iter().map(sound).collect::<Vec<_>>(), k)
    });
    whole / all
}

/// How much two sounds interfere over the third octave about `k` if their ways differ by `difference_m` metres: from 1 if
/// they are equally long.
pub(super) fn coherence(difference_m: f64, k: f64) -> f64 {
    sinc(0.5 * WIDTH * k * difference_m)
}

/// sin x / x.
pub(super) fn sinc(x: f64) -> f64 {
    match x.abs() < 1e-4 {
        true => 1.0 - x * x / 6.0,
        false => x.sin() / x,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;

    const SPEED: f64 = 343.0;

    /// The factors for ways half a wavelength of 1 kHz apart, with these amplitudes in all bands.
    fn half_a_wavelength_apart(amplitudes: &[f64]) -> Bands {
        let way = |(index, amplitude): (usize, &f64)| {
            let length_m = 10.0 + 0.5 * index as f64 * SPEED / 1e3;
            ([amplitude * amplitude; BAND_COUNT], length_m)
        };
        let ways: Vec<(Bands, f64)> = amplitudes.iter().enumerate().map(way).collect();
        in_samples(SPEED, &ways)
    }

    /// Protects samples against amplification without limit: ways that cancel each other need at most 10 dB, at finite
    /// values. Two ways need less.
    #[test]
    fn samples_of_ways_that_cancel_gain_at_most_ten_decibels() {
        let two = half_a_wavelength_apart(&[1.0, 1.0]);
        assert!(two[4] > 4.0 && two[4] < 9.9, "{two:?}");
        for amplitudes in [&[1.0, 2.0, 1.0][..], &[1.0, 4.0, 6.0, 4.0, 1.0]] {
            let factors = half_a_wavelength_apart(amplitudes);
            assert!((factors[4] - 10.0).abs() < 1e-9, "{factors:?}");
            assert!(
                factors
                    .iter()
                    .all(|factor| *factor > 0.0 && *factor <= 10.0 + 1e-9)
            );
        }
    }

    /// Protects ways without another that is heard: their samples have their own energy.
    #[test]
    fn samples_of_a_way_alone_have_its_energy() {
        assert_eq!(in_samples(SPEED, &[]), [1.0; BAND_COUNT]);
        for amplitudes in [&[0.3][..], &[0.0, 0.3], &[0.0, 0.0]] {
            assert_eq!(half_a_wavelength_apart(amplitudes), [1.0; BAND_COUNT]);
        }
    }
}
