//! The differences between the figures of two records of the same waves, and the noise of these differences.

use super::uncertainty::{Halves, Noisy};
use super::{BandFigures, FIGURE_COUNT, Figures, List, Record, lists};
use crate::bands::BAND_COUNT;

/// The differences of all figures by band.
pub(crate) struct Differences {
    /// The figures of the first record.
    values: [List; BAND_COUNT],
    /// The squares of the differences. `None` if a record lacks the figure.
    squares: [List; BAND_COUNT],
    /// The variances of the differences from the noise of the waves.
    variances: [List; BAND_COUNT],
}

impl Differences {
    /// The differences of the other record's figures from the record's figures. Both have the same batches of the same
    /// waves, so that most of their noise is common. `direct_s` is the arrival time of the direct sound.
    pub fn between(record: &Record, other: &Record, direct_s: Option<f64>) -> Differences {
        let whole = [record, other].map(|of| of_all(of, direct_s));
        let halves = [record, other].map(|of| Halves::new(of, direct_s, Noisy::All));
        let difference = |lists: [&[List; BAND_COUNT]; 2], band: usize, figure: usize| {
            Some(lists[1][band][figure]? - lists[0][band][figure]?)
        };
        let mut differences = Differences {
            values: whole[0],
            squares: [[None; FIGURE_COUNT]; BAND_COUNT],
            variances: [[None; FIGURE_COUNT]; BAND_COUNT],
        };
        let of_halves = || halves[0].lists().iter().zip(halves[1].lists());
        for band in 0..BAND_COUNT {
            for figure in 0..FIGURE_COUNT {
                let Some(all) = difference([&whole[0], &whole[1]], band, figure) else {
                    continue;
                };
                let of_half = of_halves().map(|(a, b)| difference([a, b], band, figure));
                let squares: Option<Vec<f64>> =
                    of_half.map(|half| Some((half? - all).powi(2))).collect();
                let variance = squares
                    .filter(|squares| !squares.is_empty())
                    .map(|squares| squares.iter().sum::<f64>() / squares.len() as f64);
                differences.squares[band][figure] = Some(all.powi(2));
                differences.variances[band][figure] = variance;
            }
        }
        differences
    }

    /// The differences times a factor.
    pub fn scaled(mut self, factor: f64) -> Differences {
        let lists = self.squares.iter_mut().chain(&mut self.variances);
        for number in lists.flatten().flatten() {
            *number *= factor.powi(2);
        }
        self
    }

    /// Whether a figure differs by far more than noise and by more than an accuracy allows: the squares exceed the
    /// multiple `most_times` of the variances, on the average over the bands, and the biases are on the average more than
    /// the tolerance of the accuracy (a share of decay times).
    pub fn exceed(&self, most_times: f64, accuracy: f64) -> bool {
        (0..FIGURE_COUNT).any(|figure| self.exceeds(figure, most_times, accuracy))
    }

    fn exceeds(&self, figure: usize, most_times: f64, accuracy: f64) -> bool {
        let (mut count, mut of_variances, mut of_tolerances) = (0, 0.0, 0.0);
        for band in 0..BAND_COUNT {
            let (Some(value), Some(square)) =
                (self.values[band][figure], self.squares[band][figure])
            else {
                continue;
            };
            let Some(variance) = self.variances[band][figure].filter(|variance| *variance > 0.0)
            else {
                continue;
            };
            let tolerance = Figures::tolerance(accuracy, figure, value);
            count += 1;
            of_variances += square / variance;
            of_tolerances += (square - variance) / tolerance.powi(2);
        }
        let bands = f64::from(count);
        of_variances > most_times * bands && of_tolerances > bands
    }
}

impl Figures {
    /// Adds the differences beyond their noise to the errors: the root of the square less the variance.
    pub(crate) fn with_bias(mut self, differences: &Differences) -> Figures {
        for band in 0..BAND_COUNT {
            let mut errors = self.errors[band].list();
            for (figure, error) in errors.iter_mut().enumerate() {
                let square = differences.squares[band][figure].unwrap_or(0.0);
                let variance = differences.variances[band][figure].unwrap_or(0.0);
                let bias = (square - variance).max(0.0).sqrt();
                *error = error.map(|error| error.hypot(bias));
            }
            self.errors[band] = BandFigures::from_list(errors);
        }
        self
    }
}

/// The figures of all bands of a record.
fn of_all(record: &Record, direct_s: Option<f64>) -> [List; BAND_COUNT] {
    let energy = |bin| record.echogram.energy(bin);
    let Some(start) = record.origin(direct_s, energy) else {
        return [[None; FIGURE_COUNT]; BAND_COUNT];
    };
    if start.seconds >= record.ends_s {
        return [[None; FIGURE_COUNT]; BAND_COUNT];
    }
    let pieces = record.pieces(start.seconds, energy);
    lists(&pieces, record.echogram.bin_s()).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::Echogram;
    use crate::sampling::{hash, unit_interval};
    use glam::DVec3;

    /// Two records of a decay of 0.5 s over 60 dB by the same waves. In the second record the energies are multiplied by
    /// `factor` in the second half, and vary by up to half of `noise`.
    fn records(factor: f64, noise: f64) -> [Echogram; 2] {
        [(1.0, 0.0), (factor, noise)].map(|(factor, noise)| {
            let mut echogram = Echogram::new(1e-3, 16).expect("a good bin");
            for wave in 0..8000_u64 {
                let random = |salt: u64| unit_interval(hash(2 * wave + salt));
                let seconds = 0.6 * random(0);
                let late = if seconds > 0.3 { factor } else { 1.0 };
                let energy = late * (1.0 + noise * (random(1) - 0.5)) * (-27.6 * seconds).exp();
                echogram
                    .add(wave as usize % 16, seconds, &[energy; BAND_COUNT], DVec3::X)
                    .unwrap();
            }
            echogram
        })
    }

    /// Protects the check of the larger sphere: a bias is far above the noise of the differences and becomes part of
    /// the errors; without a bias the ratio is that of noise.
    #[test]
    fn a_bias_exceeds_the_noise_of_differences() {
        let between = |factor: f64, noise: f64| {
            let [a, b] = records(factor, noise);
            let [a, b] = [&a, &b].map(|echogram| Record::new(&[], echogram, 0.6));
            let figures = Figures::new(&[], a.echogram, Some(0.0), 0.6);
            let differences = Differences::between(&a, &b, Some(0.0));
            let exceed = |most_times: f64, accuracy: f64| differences.exceed(most_times, accuracy);
            let exceeded = [exceed(50.0, 0.01), exceed(50.0, 0.5), exceed(6.0, 1e-9)];
            (exceeded, figures.with_bias(&differences), figures)
        };
        // A bias of some per cent, and far above the noise.
        let (exceeded, with_bias, without) = between(1.3, 0.0);
        assert_eq!(exceeded, [true, false, true]);
        let (more, less) = (
            with_bias.errors[3].t30_s.unwrap(),
            without.errors[3].t30_s.unwrap(),
        );
        assert!(more > 2.0 * less, "{more} {less}");
        let (exceeded, with_bias, without) = between(1.0, 1.0);
        assert_eq!(exceeded, [false; 3]);
        let (more, less) = (
            with_bias.errors[3].t30_s.unwrap(),
            without.errors[3].t30_s.unwrap(),
        );
        assert!(more < 2.0 * less, "{more} {less}");
    }
}
