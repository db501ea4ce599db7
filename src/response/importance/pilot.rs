//! What pilot waves tell of the others: in which directions those start that bring the end of a decay.

use crate::bands::{BAND_COUNT, Bands};

/// Moments at which a decay is looked at: each is 1.26 times as late as the one before, so that fast bands are looked
/// at as well as slow ones, and an exponential decay that ends at one falls by a fifth of its decibels between it and
/// the one before.
const MOMENTS: usize = 20;

/// The first of them, as a share of the response's length.
const FIRST_MOMENT: f64 = 0.01;

/// The decay is looked at until this share of the energy is left: T30 is told from a decay of 35 dB, and
/// what is still to come there decides its end.
const LEAST_LEFT: f64 = 3e-5;

/// A number for each moment and band.
type Moments<T> = [[T; BAND_COUNT]; MOMENTS];

/// What each pilot wave brings, by moment and band.
pub struct Pilot {
    seconds: f64,
    waves: Vec<Moments<f32>>,
}

impl Pilot {
    /// So many waves, followed for so many seconds.
    pub fn new(waves: u32, seconds: f64) -> Pilot {
        Pilot {
            seconds,
            waves: vec![[[0.0; BAND_COUNT]; MOMENTS]; waves as usize],
        }
    }

    /// Adds what a wave brings `seconds` after the source's impulse.
    pub fn add(&mut self, wave: u32, seconds: f64, energy: &Bands) {
        let sums = &mut self.waves[wave as usize][last_moment(seconds / self.seconds)];
        for (sum, energy) in sums.iter_mut().zip(energy) {
            *sum += *energy as f32;
        }
    }

    /// How important each wave is: the root of the sum of the squares of its shares of what comes after each moment in
    /// each band. Waves drawn by it make the variance of all these sums together the least (H. Kahn and A. W. Marshall,
    /// *Methods of reducing sample size in Monte Carlo computations*, 1953). `None` where each sum is what at least
    /// `enough` waves bring.
    pub fn importance(mut self, enough: f64) -> Option<Vec<f64>> {
        let (sums, squares) = self.sum_to_come();
        // 1 / sum², where figures are told from the sum.
        let mut factors = [[0.0; BAND_COUNT]; MOMENTS];
        let mut fewest = f64::INFINITY;
        for moment in 0..MOMENTS {
            for band in 0..BAND_COUNT {
                let sum = sums[moment][band];
                if sum > LEAST_LEFT * sums[0][band] {
                    factors[moment][band] = sum.powi(-2);
                    // So many waves of one energy would be as noisy (L. Kish, *Survey Sampling*, 1965, section 11.7).
                    fewest = fewest.min(sum * sum / squares[moment][band]);
                }
            }
        }
        if fewest >= enough {
            return None;
        }
        let square = |(energy, factor): (&f32, &f64)| f64::from(*energy).powi(2) * factor;
        let importance = |wave: &Moments<f32>| {
            let energies = wave.as_flattened().iter();
            energies
                .zip(factors.as_flattened())
                .map(square)
                .sum::<f64>()
                .sqrt()
        };
        Some(self.waves.iter().map(importance).collect())
    }

    /// Makes of what each wave brings between moments what it brings after each; the sums of that over all waves, and
    /// those of its squares.
    fn sum_to_come(&mut self) -> (Moments<f64>, Moments<f64>) {
        let mut sums = [[0.0; BAND_COUNT]; MOMENTS];
        let mut squares = sums;
        for wave in &mut self.waves {
            add_later(wave);
            for moment in 0..MOMENTS {
                for band in 0..BAND_COUNT {
                    let energy = f64::from(wave[moment][band]);
                    sums[moment][band] += energy;
                    squares[moment][band] += energy * energy;
                }
            }
        }
        (sums, squares)
    }
}

/// The last moment that is not after a share of the response's length; the first where all are.
fn last_moment(share: f64) -> usize {
    let later = (share / FIRST_MOMENT).ln() / (1.0 / FIRST_MOMENT).ln();
    ((later * MOMENTS as f64).max(0.0) as usize).min(MOMENTS - 1)
}

/// Makes what comes between moments what comes after each.
fn add_later(wave: &mut Moments<f32>) {
    for moment in (1..MOMENTS).rev() {
        let later = wave[moment];
        for (sum, later) in wave[moment - 1].iter_mut().zip(later) {
            *sum += later;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects waves that bring as much as all others from being moved, and finds the few that bring the end.
    #[test]
    fn few_waves_that_bring_the_end_are_important() {
        const WAVES: u32 = 1000;
        let pilot = |last: u32| {
            let mut pilot = Pilot::new(WAVES, 1.0);
            for wave in 0..WAVES {
                pilot.add(wave, 0.1, &[1.0; BAND_COUNT]);
            }
            for wave in 0..last {
                pilot.add(wave, 0.9, &[1e-2; BAND_COUNT]);
            }
            pilot
        };
        assert!(pilot(WAVES).importance(500.0).is_none());
        let importance = pilot(10).importance(500.0).expect("10 waves are few");
        assert_eq!(importance.len(), WAVES as usize);
        assert!(importance[..10].iter().all(|important| *important > 0.1));
        assert!(importance[10..].iter().all(|important| *important < 0.02));
        // What is 50 dB down no figure is told from.
        let mut faint = pilot(0);
        faint.add(3, 0.9, &[1e-2; BAND_COUNT]);
        assert!(faint.importance(500.0).is_none());
    }
}
