//! Predictions from pilot waves: the start directions of waves that carry the end of a decay.

use crate::bands::{BAND_COUNT, Bands};
use rayon::prelude::*;

/// Number of moments at which a decay is evaluated. Each moment is 1.26 times as late as the previous one, to cover
/// fast and slow bands alike. For an exponential decay that ends at one of these moments, the last step covers a fifth
/// of its decibels.
const MOMENTS: usize = 20;

/// The first moment, as a share of the response's length.
const FIRST_MOMENT: f64 = 0.01;

/// The decay is evaluated until this share of the energy remains: T30 needs a decay of 35 dB, and the remaining energy
/// determines the time at which this level is reached.
const LEAST_LEFT: f64 = 3e-5;

/// Number of iterations that equalise the noise of the sums. In six very uneven rooms with 262,144 waves the worst
/// error of T30 was on average 1.00 % with no iteration, 0.91 % with one, 0.84 % with two and 0.82 % with four.
const EVENED_OUT: usize = 2;

/// A number for each moment and band.
type Moments<T> = [[T; BAND_COUNT]; MOMENTS];

/// The energy of each pilot wave, by moment and band.
pub struct Pilot {
    seconds: f64,
    waves: Vec<Moments<f32>>,
    /// Index of the first wave of the last call of [`begin`](Self::begin).
    first: usize,
}

/// The sums over all pilot waves of the energy after each moment, and of its squares.
pub struct Sums {
    energies: Moments<f64>,
    squares: Moments<f64>,
}

impl Sums {
    /// The smallest effective number of waves, over the sums used for figures: the number of waves of equal energy with
    /// the same noise (L. Kish, *Survey Sampling*, 1965, section 11.7).
    pub fn fewest_waves(&self) -> f64 {
        let waves = |(moment, band): (usize, usize)| {
            self.energies[moment][band].powi(2) / self.squares[moment][band]
        };
        self.told().map(waves).fold(f64::INFINITY, f64::min)
    }

    /// The moments and bands that figures are computed from.
    fn told(&self) -> impl Iterator<Item = (usize, usize)> {
        all().filter(|(moment, band)| {
            self.energies[*moment][*band] > LEAST_LEFT * self.energies[0][*band]
        })
    }
}

impl Pilot {
    /// Creates an empty estimate for `waves` waves, which are followed for `seconds` seconds.
    pub fn new(waves: u32, seconds: f64) -> Pilot {
        Pilot {
            seconds,
            waves: Vec::with_capacity(waves as usize),
            first: 0,
        }
    }

    /// Adds `waves` further waves, numbered from 0.
    pub fn begin(&mut self, waves: u32) {
        self.first = self.waves.len();
        let all = self.first + waves as usize;
        self.waves.resize(all, [[0.0; BAND_COUNT]; MOMENTS]);
    }

    /// Adds the weighted energy that a wave has `seconds` after the source's impulse.
    pub fn add(&mut self, wave: u32, seconds: f64, energy: &Bands) {
        let moment = last_moment(seconds / self.seconds);
        let sums = &mut self.waves[self.first + wave as usize][moment];
        for (sum, energy) in sums.iter_mut().zip(energy) {
            *sum += *energy as f32;
        }
    }

    /// Sums over all waves.
    pub fn sums(&self) -> Sums {
        let mut energies = [[0.0; BAND_COUNT]; MOMENTS];
        let mut squares = energies;
        for wave in self.waves.iter().map(to_come) {
            for (moment, band) in all() {
                let energy = f64::from(wave[moment][band]);
                energies[moment][band] += energy;
                squares[moment][band] += energy * energy;
            }
        }
        Sums { energies, squares }
    }

    /// The importance of each wave: the root of the sum of squares of the wave's shares in the energy after each moment
    /// in each band. Drawing waves by this importance minimises the total variance of these sums (H. Kahn and A. W.
    /// Marshall, *Methods of reducing sample size in Monte Carlo computations*, 1953). The weights of sums that would
    /// still be noisier than other sums are then increased, because every band is reported.
    pub fn importance(&self, sums: &Sums) -> Vec<f64> {
        let squared = |moment: usize, band: usize| sums.energies[moment][band].powi(2);
        let mut weights = [[0.0; BAND_COUNT]; MOMENTS];
        for (moment, band) in sums.told() {
            weights[moment][band] = 1.0 / squared(moment, band);
        }
        let mut importance = self.weighted(&weights);
        for _ in 0..EVENED_OUT {
            let mean_squares = self.mean_squares(&importance);
            for (moment, band) in sums.told() {
                weights[moment][band] *= mean_squares[moment][band] / squared(moment, band);
            }
            importance = self.weighted(&weights);
        }
        importance
    }

    /// The root of the sum of the weighted squares of each wave's energy after each moment.
    fn weighted(&self, weights: &Moments<f64>) -> Vec<f64> {
        let square = |(energy, weight): (&f32, &f64)| f64::from(*energy).powi(2) * weight;
        let weights = weights.as_flattened();
        let importance = |wave: &Moments<f32>| {
            let energies = to_come(wave);
            let squares = energies.as_flattened().iter().zip(weights).map(square);
            squares.sum::<f64>().sqrt()
        };
        self.waves.par_iter().map(importance).collect()
    }

    /// The mean square of the energy after each moment, up to a constant factor, if waves were drawn by this
    /// importance.
    fn mean_squares(&self, importance: &[f64]) -> Moments<f64> {
        let mut squares = [[0.0; BAND_COUNT]; MOMENTS];
        for (wave, importance) in self.waves.iter().zip(importance) {
            if *importance == 0.0 {
                continue;
            }
            let energies = to_come(wave);
            for (moment, band) in all() {
                squares[moment][band] += f64::from(energies[moment][band]).powi(2) / importance;
            }
        }
        squares
    }
}

/// Every pair of moment and band.
fn all() -> impl Iterator<Item = (usize, usize)> {
    (0..MOMENTS).flat_map(|moment| (0..BAND_COUNT).map(move |band| (moment, band)))
}

/// The last moment not after this share of the response's length; the first moment if all are later.
fn last_moment(share: f64) -> usize {
    let later = (share / FIRST_MOMENT).ln() / (1.0 / FIRST_MOMENT).ln();
    ((later * MOMENTS as f64).max(0.0) as usize).min(MOMENTS - 1)
}

/// The energy after each moment, computed from the energy between moments.
fn to_come(between: &Moments<f32>) -> Moments<f32> {
    let mut wave = *between;
    for moment in (1..MOMENTS).rev() {
        let later = wave[moment];
        for (sum, later) in wave[moment - 1].iter_mut().zip(later) {
            *sum += later;
        }
    }
    wave
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects even starts for waves with equal energy, and the detection of the few waves that carry the end.
    #[test]
    fn few_waves_that_bring_the_end_are_important() {
        const WAVES: u32 = 1000;
        let pilot = |last: u32| {
            let mut pilot = Pilot::new(WAVES, 1.0);
            pilot.begin(WAVES);
            for wave in 0..WAVES {
                pilot.add(wave, 0.1, &[1.0; BAND_COUNT]);
            }
            for wave in 0..last {
                pilot.add(wave, 0.9, &[1e-2; BAND_COUNT]);
            }
            pilot
        };
        assert!(pilot(WAVES).sums().fewest_waves() > 999.0);
        let few = pilot(10);
        let sums = few.sums();
        assert!((sums.fewest_waves() - 10.0).abs() < 0.1);
        let importance = few.importance(&sums);
        assert_eq!(importance.len(), WAVES as usize);
        assert!(importance[..10].iter().all(|important| *important > 0.1));
        assert!(importance[10..].iter().all(|important| *important < 0.02));
        // Energy at −50 dB has no influence on any figure.
        let mut faint = pilot(0);
        faint.add(3, 0.9, &[1e-2; BAND_COUNT]);
        assert!(faint.sums().fewest_waves() > 999.0);
    }
}
