//! Energies of sounds that interfere, in octave bands.

use crate::bands::BANDS_HZ;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Centres of the third octaves of an octave band, as factors of its centre.
pub(super) const THIRDS: [f64; 3] = [0.793_700_525_984_099_7, 1.0, 1.259_921_049_894_873_2];

/// Width of a third octave, as a share of its centre.
const WIDTH: f64 = 0.231_563_184_6;

/// A sound of one wave number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sound {
    pub pressure: Complex64,
    /// Length of its way in metres: the phase of the pressure turns with it over a band.
    pub length_m: f64,
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

/// The energy in a band of the sum of samples that have these energies and whose ways have these lengths in metres, as a
/// multiple of the sum of the energies.
///
/// It is above 0.1 for two ways: no difference of lengths cancels a whole octave.
pub(super) fn of_samples(band: usize, speed: f64, ways: &[(f64, f64)]) -> f64 {
    let all: f64 = ways.iter().map(|(energy, _)| energy).sum();
    if all == 0.0 {
        return 1.0;
    }
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
