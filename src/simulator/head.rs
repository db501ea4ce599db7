//! The delays and gains of both ears by direction: panning, or a measured head.

use super::SimulatorError;
use super::taps::EARS;
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::hrtf::{Facets, Hrir, HrirPair, HrirSet};
use crate::response::{Encoding, ListenerAxes};
use crate::sampling::lattice;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};
use std::thread;

/// Number of directions in which the ears of a measured head are known: about 6° apart.
const DIRECTIONS: u64 = 1024;

/// Number of frequencies of an octave at which the level of a response is averaged.
const TONES: usize = 8;

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
    Measured(Arc<Measured>),
}

/// The ears of a measured head by direction.
pub(super) struct Measured {
    facets: Facets,
    ears: Vec<[Ear; EARS]>,
}

impl Measured {
    /// The ears of a set of responses. Takes about a tenth of a second.
    fn of(set: &HrirSet) -> Measured {
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
        Measured {
            facets: Facets::new(directions),
            ears,
        }
    }
}

impl Head {
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
            Head::Measured(head) => {
                let Measured { facets, ears } = &**head;
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

/// A head that is known, or being analysed.
type Analysis = Arc<OnceLock<Arc<Measured>>>;

/// The heads of a simulator. Each is analysed once, on a thread of its own.
#[derive(Default)]
pub(super) struct Heads {
    known: Mutex<Vec<(Weak<HrirSet>, Analysis)>>,
}

impl Heads {
    /// Calls `then` with the head of a set, now or as soon as it is analysed.
    ///
    /// # Errors
    /// [`SimulatorError::NoThread`] if the system starts no thread.
    pub fn with(
        &self,
        set: &Arc<HrirSet>,
        then: impl FnOnce(Head) + Send + 'static,
    ) -> Result<(), SimulatorError> {
        let analysis = self.analysis(set);
        if let Some(head) = analysis.get() {
            then(Head::Measured(Arc::clone(head)));
            return Ok(());
        }
        let set = Arc::clone(set);
        let analyse = move || {
            let head = analysis.get_or_init(|| Arc::new(Measured::of(&set)));
            then(Head::Measured(Arc::clone(head)));
        };
        let name = "echomarch head".to_owned();
        let started = thread::Builder::new().name(name).spawn(analyse);
        let failed = |error: std::io::Error| SimulatorError::NoThread {
            reason: error.to_string(),
        };
        started.map(drop).map_err(failed)
    }

    fn analysis(&self, set: &Arc<HrirSet>) -> Analysis {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|(other, _)| other.strong_count() > 0);
        let is_it = |(other, _): &&(Weak<HrirSet>, Analysis)| other.as_ptr() == Arc::as_ptr(set);
        if let Some((_, analysis)) = known.iter().find(is_it) {
            return Arc::clone(analysis);
        }
        let analysis = Analysis::default();
        known.push((Arc::downgrade(set), Arc::clone(&analysis)));
        analysis
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
        let head = Head::Measured(Arc::new(Measured::of(&set(grid(30)))));
        let axes = ListenerAxes::new(DVec3::NEG_Z, DVec3::Y).expect("good axes");
        for (from, near) in [(DVec3::NEG_X, 0), (DVec3::X, 1)] {
            let ears = head.ears(&axes, from);
            let (near, far) = (ears[near], ears[1 - near]);
            let later_s = far.delay_s - near.delay_s;
            assert!((4e-4..9e-4).contains(&later_s), "{later_s}");
            assert!(near.delay_s >= 0.0, "{}", near.delay_s);
            for (ear, found) in ears.iter().enumerate() {
                let exact = transfer(axes.to_listener(from), ear);
                for (band, centre_hz) in BANDS_HZ.iter().enumerate().take(7).skip(4) {
                    let bin_hz = f64::from(RATE_HZ) / SAMPLES as f64;
                    let ends =
                        [1.0 / SQRT_2, SQRT_2].map(|end| (end * centre_hz / bin_hz) as usize);
                    let octave = &exact[ends[0]..=ends[1]];
                    let power = octave.iter().map(|value| value.norm_sqr()).sum::<f64>();
                    let level = (power / octave.len() as f64).sqrt();
                    let off_db = 20.0 * (found.gain[band] / level).log10();
                    assert!(off_db.abs() < 1.0, "{from} {ear} {band}: {off_db} dB");
                }
            }
        }
    }

    /// Protects loudspeakers: constant power, and only the ear of the side that the sound comes from.
    #[test]
    fn loudspeakers_have_constant_power() {
        let axes = ListenerAxes::new(DVec3::NEG_Z, DVec3::Y).expect("good axes");
        for from in [DVec3::X, DVec3::NEG_Z, DVec3::new(-0.6, 0.0, -0.8)] {
            let [left, right] = Head::Stereo.ears(&axes, from);
            let power = left.gain[0].powi(2) + right.gain[0].powi(2);
            assert!((power - 1.0).abs() < 1e-9);
        }
        assert!(Head::Stereo.ears(&axes, DVec3::X)[0].gain[0] < 1e-9);
    }
}
