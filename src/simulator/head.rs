//! A measured head: the responses of both ears for direct ways, and their delays and levels by octave for echoes.
//!
//! Both are computed once for 4096 directions, about 3° apart. In between, those of the three surrounding directions are
//! mixed.
//!
//! All responses of a set begin at the same sample. They are cut to the part that contains the effect of head and ears,
//! which begins [`LEAD_S`] before their common onset.

use super::SimulatorError;
use super::fit::{BANDS, EARS, Fit, Frame};
use crate::bands::{BANDS_HZ, Bands};
use crate::hrtf::{Hrir, HrirSet, IndexedFacets};
use crate::sampling::lattice;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use std::thread;

/// Number of directions in which the ears of a measured head are known: about 3° apart.
const DIRECTIONS: u64 = 4096;

/// Number of frequencies of an octave at which the level of a response is averaged.
const TONES: usize = 8;

/// Length of the responses of direct ways in seconds. The echoes within an ear arrive within a millisecond of the onset;
/// with 1.3 ms, the time between the ears of a rigid sphere was off by 20 µs at 375 Hz.
const RESPONSE_S: f64 = 80.0 / 48_000.0;

/// Time in seconds before the common onset with which a response begins: the ripple of a shift by a fraction of a sample.
const LEAD_S: f64 = 4.0 / 48_000.0;

/// Lengths of a response after which samples count in full, and not at all, for the level and the delay at low
/// frequencies. Later ones are echoes in the room of the measurement, and noise.
const COUNTED: [f64; 2] = [2.0, 4.0];

/// Share of a response at its end that fades out.
const FADE: f64 = 0.25;

/// Energy of the common onset as a share of the loudest sample's, over all directions.
const ONSET: f64 = 0.01;

/// Number of samples of a response before the common onset.
fn lead(rate_hz: u32) -> usize {
    (LEAD_S * f64::from(rate_hz)).ceil() as usize
}

/// Number of samples of the responses of direct ways.
pub(super) fn response_length(rate_hz: u32) -> usize {
    (RESPONSE_S * f64::from(rate_hz)).ceil() as usize
}

/// One ear and one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ear {
    /// Seconds after the first sample of the earliest response of all directions.
    delay_s: f64,
    /// Amplitudes by band.
    gain: Bands,
}

/// Delays and levels of sound from a direction at both ears.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtEars {
    /// Seconds after the sound would reach the earliest ear of all directions.
    pub delays_s: [f64; EARS],
    pub gains: [Frame; EARS],
    /// Time in seconds from the first sample of the responses to their onset.
    pub lead_s: f64,
}

/// The ears of a measured head by direction.
pub(super) struct Measured {
    facets: IndexedFacets,
    /// Delays in seconds and gains of both ears.
    ears: Vec<[(f64, Frame); EARS]>,
    /// Responses of the left ear, then of the right one, of each direction.
    responses: Vec<f32>,
    /// Number of samples of a response.
    length: usize,
    /// Time in seconds from the first sample of a response to its onset.
    lead_s: f64,
}

impl Measured {
    /// The ears of a set of responses at its sampling rate. Takes about half a second.
    fn of(set: &HrirSet) -> Measured {
        let rate_hz = set.rate_hz();
        let fit = Fit::new(rate_hz);
        let directions: Vec<DVec3> = lattice(DIRECTIONS).collect();
        let fitted = |ear: Ear| (ear.delay_s, fit.gains(&ear.gain));
        let length = response_length(rate_hz);
        Measured {
            ears: (ears(set, &directions).into_iter())
                .map(|both| both.map(fitted))
                .collect(),
            responses: responses(set, &directions, length),
            facets: IndexedFacets::new(directions),
            length,
            lead_s: lead(rate_hz) as f64 / f64::from(rate_hz),
        }
    }

    /// Delays and levels of sound from a direction.
    pub fn at_ears(&self, towards: DVec3) -> AtEars {
        let mut found = AtEars {
            delays_s: [0.0; EARS],
            gains: [[0.0; BANDS]; EARS],
            lead_s: self.lead_s,
        };
        for (index, weight) in self.facets.around(towards) {
            for (ear, (delay_s, gains)) in self.ears[index].iter().enumerate() {
                found.delays_s[ear] += weight * delay_s;
                for (sum, gain) in found.gains[ear].iter_mut().zip(gains) {
                    *sum += weight as f32 * gain;
                }
            }
        }
        found
    }

    /// Overwrites the responses of both ears to sound from a direction.
    pub fn respond(&self, towards: DVec3, responses: &mut [Vec<f32>; EARS]) {
        responses.iter_mut().for_each(|response| response.fill(0.0));
        for (index, weight) in self.facets.around(towards) {
            for (ear, response) in responses.iter_mut().enumerate() {
                let first = (EARS * index + ear) * self.length;
                let known = &self.responses[first..first + self.length];
                for (sum, sample) in response.iter_mut().zip(known) {
                    *sum += weight as f32 * sample;
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
    // No ear hears a sound before it passes the nearest ear: everything is later by a fraction of a millisecond.
    let all = || ears.iter().flatten();
    let earliest_s = all().map(|ear| ear.delay_s).fold(f64::INFINITY, f64::min);
    for ear in ears.iter_mut().flatten() {
        ear.delay_s -= earliest_s;
    }
    ears
}

/// The responses of both ears in these directions, cut to a length.
fn responses(set: &HrirSet, directions: &[DVec3], length: usize) -> Vec<f32> {
    let mut pair = <[Hrir; 2]>::default();
    let mut energy = vec![0.0; set.samples()];
    for from in set.directions() {
        set.pair_into(*from, &mut pair);
        for hrir in &pair {
            let samples = energy.iter_mut().zip(&hrir.samples);
            samples.for_each(|(sum, sample)| *sum += f64::from(*sample).powi(2));
        }
    }
    let loudest = energy.iter().copied().fold(0.0, f64::max);
    let is_onset = |energy: &f64| *energy >= ONSET * loudest;
    let onset = energy.iter().position(is_onset).unwrap_or(0);
    let first = onset.saturating_sub(lead(set.rate_hz()));
    let mut all = Vec::with_capacity(EARS * directions.len() * length);
    for from in directions {
        set.pair_into(*from, &mut pair);
        for hrir in &pair {
            all.extend(cut(&hrir.samples, first, length));
        }
    }
    all
}

/// The samples of a response from `first` on, cut to a length, with the level and the delay of the whole response at low
/// frequencies: the sums of the samples, and of the samples weighted by time, stay the same.
fn cut(samples: &[f32], first: usize, length: usize) -> Vec<f32> {
    let whole = length as f64;
    let middle = first as f64 + 0.5 * (whole - 1.0);
    let time = |at: usize| at as f64 - middle;
    let sample = |at: usize| samples.get(at).map_or(0.0, |sample| f64::from(*sample));
    // The share of a sample that stays.
    let kept = |at: usize| {
        let left = (first + length).saturating_sub(at) as f64 / (FADE * whole);
        match at < first {
            true => 0.0,
            false => 0.5 - 0.5 * (PI * left.min(1.0)).cos(),
        }
    };
    let counts = |at: usize| {
        let lengths = at.saturating_sub(first) as f64 / whole;
        ((COUNTED[1] - lengths) / (COUNTED[1] - COUNTED[0])).clamp(0.0, 1.0)
    };
    // Added to the samples: a bell times a straight line.
    let bell = |at: usize| 0.5 - 0.5 * (2.0 * PI * ((at - first) as f64 + 0.5) / whole).cos();
    let [mut lost, mut lost_by_time] = [0.0; 2];
    for at in 0..samples.len() {
        let part = sample(at) * (1.0 - kept(at)) * counts(at);
        lost += part;
        lost_by_time += part * time(at);
    }
    let places = first..first + length;
    let bells: f64 = places.clone().map(bell).sum();
    let bells_by_time: f64 = places.clone().map(|at| bell(at) * time(at).powi(2)).sum();
    let (offset, slope) = (lost / bells, lost_by_time / bells_by_time);
    places
        .map(|at| (sample(at) * kept(at) + bell(at) * (offset + slope * time(at))) as f32)
        .collect()
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
    /// The head of a set of responses, at a sampling rate. It is ready when it is analysed.
    ///
    /// # Errors
    /// [`SimulatorError::NoThread`] if the system starts no thread, [`SimulatorError::Head`] if the responses have no
    /// such rate.
    pub fn head(&self, set: &Arc<HrirSet>, rate_hz: u32) -> Result<Analysis, SimulatorError> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|((other, _), _)| other.strong_count() > 0);
        let is_it = |((other, rate), _): &&(HeadKey, Analysis)| {
            other.as_ptr() == Arc::as_ptr(set) && *rate == rate_hz
        };
        if let Some((_, analysis)) = known.iter().find(is_it) {
            return Ok(Arc::clone(analysis));
        }
        set.check_rate(rate_hz)?;
        let analysis = Analysis::default();
        let (set_here, analysis_here) = (Arc::clone(set), Arc::clone(&analysis));
        let analyse = move || {
            // The rate has been checked.
            if let Ok(set) = set_here.at_rate(rate_hz) {
                analysis_here.get_or_init(|| Measured::of(&set));
            }
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

    /// Protects the sound of long responses: an echo in the measuring room changes nothing, and level and delay at low
    /// frequencies are those of the whole response.
    #[test]
    fn responses_are_cut_without_a_change_at_low_frequencies() {
        let mut samples: Vec<f32> = (0..2048).map(|at| 0.9_f32.powi(at - 20)).collect();
        samples[..20].fill(0.0);
        let moments = |samples: &[f32], first: f64| {
            let timed = |(at, sample): (usize, &f32)| (at as f64 + first) * f64::from(*sample);
            let sum: f64 = samples.iter().map(|sample| f64::from(*sample)).sum();
            [
                sum,
                samples.iter().enumerate().map(timed).sum::<f64>() / sum,
            ]
        };
        let short = cut(&samples, 16, 80);
        let (whole, found) = (moments(&samples, 0.0), moments(&short, 16.0));
        assert!(
            (found[0] / whole[0] - 1.0).abs() < 1e-5,
            "{found:?} {whole:?}"
        );
        assert!((found[1] - whole[1]).abs() < 1e-3, "{found:?} {whole:?}");
        samples[1000] = 0.5;
        assert_eq!(cut(&samples, 16, 80), short);
    }

    /// Protects headphones in motion: between the known directions, delays are within 20 µs of those of the responses,
    /// and gains within 6 % of the loudest band.
    #[test]
    fn directions_in_between_are_interpolated() {
        let set = set(grid(30));
        let head = Measured::of(&set);
        let fit = Fit::new(RATE_HZ);
        let directions: Vec<DVec3> = lattice(DIRECTIONS).chain(lattice(301)).collect();
        let exact = ears(&set, &directions);
        for (number, towards) in directions.iter().enumerate().skip(DIRECTIONS as usize) {
            let found = head.at_ears(*towards);
            for (ear, exact) in exact[number].iter().enumerate() {
                let off_s = found.delays_s[ear] - exact.delay_s;
                assert!(off_s.abs() < 20e-6, "{off_s} s");
                let loudest = exact.gain.into_iter().fold(0.0, f64::max);
                for (gain, wanted) in found.gains[ear].iter().zip(fit.gains(&exact.gain)) {
                    let off = f64::from(gain - wanted).abs() / loudest;
                    assert!(off < 0.06, "{towards} {ear}: {off}");
                }
            }
        }
    }
}
