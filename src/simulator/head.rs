//! The delays and gains of both ears by direction: panning, or a measured head.

use super::taps::EARS;
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::hrtf::{Facets, Hrir, HrirPair, HrirSet};
use crate::response::{Encoding, ListenerAxes};
use crate::sampling::lattice;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};

/// Number of directions in which the ears of a measured head are known: about 9° apart.
const DIRECTIONS: u64 = 512;

/// Number of frequencies of an octave at which the level of a response is averaged.
const TONES: usize = 4;

/// One ear and one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ear {
    /// Seconds after the sound would pass the centre of the head.
    pub delay_s: f64,
    /// Amplitudes by band.
    pub gain: Bands,
}

/// How directions reach the ears.
pub(super) enum Head {
    /// Panned with constant power.
    Stereo,
    /// The levels by octave and the delays of a head's responses. Finer features of the spectra are left out.
    Measured {
        facets: Box<Facets>,
        ears: Vec<[Ear; EARS]>,
    },
}

impl Head {
    /// The ears of a set of responses.
    pub fn of(set: &HrirSet) -> Head {
        let directions: Vec<DVec3> = lattice(DIRECTIONS).collect();
        let mut pair = HrirPair::default();
        let rate_hz = f64::from(set.rate_hz());
        let mut ears: Vec<[Ear; EARS]> = directions
            .iter()
            .map(|from| {
                set.pair_into(*from, &mut pair);
                [&pair.left, &pair.right].map(|hrir| ear(hrir, rate_hz))
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
        Head::Measured {
            facets: Box::new(Facets::new(directions)),
            ears,
        }
    }

    /// Both ears, for sound from a direction of the world.
    pub fn ears(&self, axes: &ListenerAxes, from: DVec3) -> [Ear; EARS] {
        match self {
            Head::Stereo => {
                let [left, right, ..] = Encoding::Stereo.gains(axes, from);
                [left, right].map(|gain| Ear {
                    delay_s: 0.0,
                    gain: [gain; BAND_COUNT],
                })
            }
            Head::Measured { facets, ears } => {
                let towards = axes.to_listener(from).try_normalize().unwrap_or(DVec3::X);
                let around = facets.around(towards);
                std::array::from_fn(|side| {
                    let mut sum = Ear {
                        delay_s: 0.0,
                        gain: [0.0; BAND_COUNT],
                    };
                    for (index, weight) in around {
                        let ear = &ears[index][side];
                        sum.delay_s += weight * ear.delay_s;
                        for (sum, gain) in sum.gain.iter_mut().zip(&ear.gain) {
                            *sum += weight * gain;
                        }
                    }
                    sum
                })
            }
        }
    }
}

/// The delay and the levels of a response.
fn ear(hrir: &Hrir, rate_hz: f64) -> Ear {
    let power = |hertz: f64| {
        let step = -2.0 * PI * hertz / rate_hz;
        let term = |(index, sample): (usize, &f32)| {
            Complex64::from_polar(f64::from(*sample), step * index as f64)
        };
        hrir.samples
            .iter()
            .enumerate()
            .map(term)
            .sum::<Complex64>()
            .norm_sqr()
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
