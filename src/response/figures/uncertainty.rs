//! Errors of the figures: the spread over halves of the batches, errors common to all waves, and differences between
//! two records of the same sound.
//!
//! # Few waves
//! The spread over batches is unreliable for a few dozen arrivals in a band, and is not defined without arrivals. In
//! such a band the missed energy is estimated from the number of arrivals: as the energy of √n arrivals for n arrivals,
//! and as one arrival if there are none.

use super::pieces::{Origin, Record};
use super::{BandFigures, FIGURE_COUNT, Figures, List, lists};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::Echogram;
use glam::DVec3;
use rayon::prelude::*;

/// Maximum error of a reported decay time from noise, as a share of the time: the just noticeable difference in
/// reverberation (ISO 3382-1, annex A).
pub(super) const WORST_TIME_ERROR: f64 = 0.05;

const NO_FIGURES: [List; BAND_COUNT] = [[None; FIGURE_COUNT]; BAND_COUNT];

/// Errors common to all waves, one standard deviation each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommonErrors {
    /// Error of T20 and T30, as a share of the decay time.
    pub decay_share: f64,
    /// Error of EDT, as a share of EDT.
    pub early_decay_share: f64,
    /// Error of C50 and C80, in decibels.
    pub clarity_db: f64,
    /// Error of G, in decibels.
    pub strength_db: f64,
    /// Error of Ts, in seconds.
    pub centre_s: f64,
}

impl CommonErrors {
    /// These errors times a factor.
    pub fn scaled(self, factor: f64) -> CommonErrors {
        CommonErrors {
            decay_share: factor * self.decay_share,
            early_decay_share: factor * self.early_decay_share,
            clarity_db: factor * self.clarity_db,
            strength_db: factor * self.strength_db,
            centre_s: factor * self.centre_s,
        }
    }

    /// Error of D50, derived from the error of C50, because C50 is 10 lg(D50 / (1 − D50)).
    fn definition(&self, d50: f64) -> f64 {
        let change_in_db = 10.0 / (std::f64::consts::LN_10 * d50 * (1.0 - d50));
        self.clarity_db / change_in_db
    }
}

impl Figures {
    /// Adds the differences from the figures of another record to the errors, each times the weight of its band.
    pub(crate) fn with_differences(self, record: Record, weights: &Bands) -> Figures {
        self.differing(self.begins_s, &record, weights)
    }

    /// Adds the error of a time origin that is known only to within a bin of `within_s` seconds.
    pub(super) fn with_start_within(self, record: &Record, within_s: f64) -> Figures {
        /// The standard deviation of a uniform distribution, relative to half the length of its interval.
        const EVEN: f64 = 0.577_350_269_189_625_8;
        let later = self.begins_s.map(|begins_s| begins_s + 0.5 * within_s);
        self.differing(later, record, &[EVEN; BAND_COUNT])
    }

    /// Adds the weighted differences from the figures of a record to the errors, if the record has figures with times
    /// from `begins_s` on.
    fn differing(self, begins_s: Option<f64>, record: &Record, weights: &Bands) -> Figures {
        match begins_s.and_then(|begins_s| others(record, begins_s)) {
            Some(others) => self.differing_from(&others, weights),
            None => self,
        }
    }

    /// Adds the weighted differences from other figures to the errors.
    fn differing_from(mut self, others: &[List; BAND_COUNT], weights: &Bands) -> Figures {
        for band in 0..BAND_COUNT {
            let pairs = self.bands[band].list().into_iter().zip(others[band]);
            let differences =
                pairs.map(|(own, other)| own.zip(other).map(|(own, other)| own - other));
            let mut errors = self.errors[band].list();
            for (error, difference) in errors.iter_mut().zip(differences) {
                let difference = difference.filter(|difference| difference.is_finite());
                let weighted = weights[band] * difference.unwrap_or(0.0);
                *error = error.map(|error| error.hypot(weighted));
            }
            self.errors[band] = BandFigures::from_list(errors);
        }
        self
    }

    /// Adds the errors common to all waves.
    pub(crate) fn with_common_errors(mut self, common: &CommonErrors) -> Figures {
        for (band, error) in self.bands.iter().zip(&mut self.errors) {
            let add = |error: &mut Option<f64>, common: Option<f64>| {
                *error = error.zip(common).map(|(error, common)| error.hypot(common));
            };
            let share = |time_s: Option<f64>, share: f64| time_s.map(|time_s| share * time_s);
            add(
                &mut error.edt_s,
                share(band.edt_s, common.early_decay_share),
            );
            add(&mut error.t20_s, share(band.t20_s, common.decay_share));
            add(&mut error.t30_s, share(band.t30_s, common.decay_share));
            add(&mut error.c50_db, Some(common.clarity_db));
            add(&mut error.c80_db, Some(common.clarity_db));
            add(&mut error.d50, band.d50.map(|d50| common.definition(d50)));
            add(&mut error.ts_s, Some(common.centre_s));
            add(&mut error.g_db, Some(common.strength_db));
        }
        self
    }
}

/// The figures of all bands of a record, with times from `begins_s` on.
fn others(record: &Record, begins_s: f64) -> Option<[List; BAND_COUNT]> {
    if begins_s >= record.ends_s {
        return None;
    }
    let pieces = record.pieces(begins_s, |bin| record.echogram.energy(bin));
    Some(lists(&pieces, record.echogram.bin_s()).0)
}

/// The part of a record whose noise is determined. The rest is that of all batches.
#[derive(Clone, Copy)]
pub(super) enum Noisy<'a> {
    /// The whole record.
    All,
    /// The bins before this one.
    Before(usize),
    /// These arrivals, which the record contains.
    Arrivals(&'a Echogram),
}

impl Noisy<'_> {
    /// The energy of a bin of `echogram` in the half of the batches for which `is_in` holds.
    fn energy(self, echogram: &Echogram, bin: usize, is_in: &dyn Fn(usize) -> bool) -> Bands {
        let twice = |of: &Echogram| {
            let mut sum = [0.0; BAND_COUNT];
            for batch in (0..of.batches()).filter(|&batch| is_in(batch)) {
                bands::add(&mut sum, &of.batch_energy(bin, batch));
            }
            sum.map(|energy| 2.0 * energy)
        };
        match self {
            Noisy::Before(until) if bin >= until => echogram.energy(bin),
            Noisy::All | Noisy::Before(_) => twice(echogram),
            Noisy::Arrivals(part) => {
                let (all, mean, half) = (echogram.energy(bin), part.energy(bin), twice(part));
                // A rounding error would otherwise be a negative energy.
                std::array::from_fn(|band| (all[band] - mean[band]).max(0.0) + half[band])
            }
        }
    }
}

/// The figures of halves of the batches.
pub(super) struct Halves {
    lists: Vec<[List; BAND_COUNT]>,
    /// The time origin of each half, in seconds.
    starts_s: Vec<f64>,
    batches: usize,
}

impl Halves {
    /// Computes every half and its complement. The sign of an entry of Sylvester's matrix determines whether batch b is
    /// in half h. The rows of the matrix are orthogonal, and half of the entries in each row except the first are
    /// positive.
    ///
    /// Each half has a separate time origin, so that the errors include the uncertainty of the common origin.
    ///
    /// Only the noise of the part `noisy` remains.
    pub fn new(record: &Record, direct_s: Option<f64>, noisy: Noisy) -> Halves {
        let echogram = record.echogram;
        let batches = echogram.batches();
        let is_in = |half: usize, batch: usize| (half & batch).count_ones() % 2 == 1;
        let of = |(half, complement): (usize, bool)| {
            let is_in = |batch: usize| is_in(half, batch) != complement;
            let energy = |bin: usize| noisy.energy(echogram, bin, &is_in);
            let begins_s = record.origin(direct_s, energy)?.seconds;
            if begins_s >= record.ends_s {
                return None;
            }
            let pieces = record.pieces(begins_s, energy);
            Some((begins_s, lists(&pieces, echogram.bin_s()).0))
        };
        let halves: Vec<(usize, bool)> = (1..batches)
            .flat_map(|half| [(half, false), (half, true)])
            .collect();
        // A half without arrivals has no figures.
        let found: Vec<Option<(f64, [List; BAND_COUNT])>> =
            halves.into_par_iter().map(of).collect();
        let list = |half: &Option<(f64, _)>| half.map_or(NO_FIGURES, |(_, list)| list);
        Halves {
            lists: found.iter().map(list).collect(),
            starts_s: found.iter().flatten().map(|(start, _)| *start).collect(),
            batches,
        }
    }

    /// The figures of each half.
    pub fn lists(&self) -> &[[List; BAND_COUNT]] {
        &self.lists
    }

    /// One standard deviation of the time origin of all batches, in seconds.
    pub fn error_of_start(&self, start: Origin) -> f64 {
        /// The variance of a uniform distribution, relative to the square of its interval's length.
        const EVEN: f64 = 1.0 / 12.0;
        let squares = self.starts_s.iter().map(|s| (s - start.seconds).powi(2));
        let variance = squares.sum::<f64>() / self.starts_s.len().max(1) as f64;
        (variance + EVEN * start.within_s.powi(2)).sqrt()
    }

    /// The errors of the figures of a band from the noise of the waves, one standard deviation each. `None` if a figure
    /// is missing in some half. `arrivals` is the number of arrivals of equal energy.
    pub fn noise(&self, band: usize, list: &List, arrivals: f64) -> List {
        if self.lists.is_empty() {
            return [None; FIGURE_COUNT];
        }
        let widening = self.widening(arrivals);
        std::array::from_fn(|figure| {
            let deviation = self.deviation(band, figure, list[figure]?)?;
            Some(widening * deviation).filter(|noise| noise.is_finite())
        })
    }

    /// Factor by which Student's t widens an error. The degrees of freedom are those of the batches, or those of the
    /// arrivals if there are fewer arrivals: most batches are then empty, and their spread is meaningless. Without
    /// arrivals the spread is 0. A single arrival counts as two, because it says nothing about the energies of other
    /// possible arrivals.
    fn widening(&self, arrivals: f64) -> f64 {
        let of_batches = self.batches - 1;
        let degrees = match arrivals > 0.0 {
            true => of_batches.min((arrivals.round() as usize).max(2) - 1),
            false => of_batches,
        };
        student_975(degrees) / 2.0
    }

    /// The standard deviation of a figure; `None` if the figure is missing in some half.
    fn deviation(&self, band: usize, figure: usize, whole: f64) -> Option<f64> {
        let mut squares = 0.0;
        for list in &self.lists {
            squares += (list[band][figure]? - whole).powi(2);
        }
        Some((squares / self.lists.len() as f64).sqrt())
    }
}

/// Student's t at 97.5 %, for a number of degrees of freedom.
///
/// M. Abramowitz and I. Stegun, *Handbook of Mathematical Functions*, 1964, 26.7.5: a series in 1/degrees about the
/// normal variate. From 3 degrees on its error is below 1 %; for 1 and 2, where the series is not accurate, the exact
/// values are used.
pub(super) fn student_975(degrees: usize) -> f64 {
    /// The normal variate at 97.5 %.
    const NORMAL: f64 = 1.959_963_984_540_054;
    match degrees {
        0 => f64::INFINITY,
        1 => 12.706_204_736,
        2 => 4.302_652_730,
        _ => {
            let n = degrees as f64;
            let x = NORMAL;
            let first = (x.powi(3) + x) / 4.0;
            let second = (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / 96.0;
            let third = (3.0 * x.powi(7) + 19.0 * x.powi(5) + 17.0 * x.powi(3) - 15.0 * x) / 384.0;
            x + first / n + second / n.powi(2) + third / n.powi(3)
        }
    }
}

/// Number of arrivals of equal energy in a band below which the spread over batches alone does not give the error.
const FEW: f64 = 64.0;

/// Time in seconds after the time origin over which a further arrival is spread: half of it arrives before 80 ms.
const FURTHER_S: f64 = 0.16;

/// Maximum errors of figures reported from few arrivals: just noticeable differences (ISO 3382-1, annex A) of C50, C80,
/// D50, Ts and G. Decay times need more arrivals in any case.
const WORST_ERRORS: List = [
    None,
    None,
    None,
    Some(1.0),
    Some(1.0),
    Some(0.05),
    Some(0.01),
    Some(1.0),
];

/// Error of a sum of arrivals' energies that the spread over batches does not include. For few arrivals it is about √n
/// times their mean energy. With more arrivals the spread includes more of the error: the factor is √(1 + n (1 − n /
/// 64)), and 1 from 64 on. 0 without arrivals.
pub(crate) fn uncertain_energy(sum: f64, arrivals: f64) -> f64 {
    if arrivals == 0.0 {
        return 0.0;
    }
    let counted = arrivals * (1.0 - arrivals / FEW).max(0.0);
    sum / arrivals * (1.0 + counted).sqrt()
}

impl Figures {
    /// Adds the effect of one more arrival with these energies as an error. In bands with few arrivals, only figures
    /// that change little are kept.
    pub(crate) fn with_further_arrival(self, record: Record, energy: &Bands) -> Figures {
        let Record {
            taps,
            echogram,
            ends_s,
        } = record;
        let Some(begins_s) = self.begins_s.filter(|_| echogram.batches() > 1) else {
            return self;
        };
        let mut further = echogram.clone();
        let seconds = FURTHER_S.min(ends_s - begins_s);
        let bins = (seconds / echogram.bin_s()).ceil().max(1.0);
        let of_bin = energy.map(|energy| energy / bins);
        for bin in 0..bins as usize {
            let seconds = begins_s + (bin as f64 + 0.5) * echogram.bin_s();
            // The energies of waves that have already been added are in range.
            let _ = further.add(0, seconds, &of_bin, DVec3::ZERO);
        }
        let Some(others) = others(&Record::new(taps, &further, ends_s), begins_s) else {
            return self;
        };
        let mut figures = self.differing_from(&others, &bands::ALL);
        for (band, others) in others.iter().enumerate() {
            if echogram.effective_arrivals(band, begins_s) < FEW {
                figures.leave_certain(band, others);
            }
        }
        figures
    }

    /// Keeps the figures of a band that have small errors and are also present in `others`, the figures with one more
    /// arrival.
    fn leave_certain(&mut self, band: usize, others: &List) {
        let (mut list, mut errors) = (self.bands[band].list(), self.errors[band].list());
        for figure in 0..FIGURE_COUNT {
            let is_certain = errors[figure]
                .zip(WORST_ERRORS[figure])
                .is_some_and(|(error, worst)| error <= worst);
            if !is_certain || others[figure].is_none() {
                (list[figure], errors[figure]) = (None, None);
            }
        }
        self.bands[band] = BandFigures::from_list(list);
        self.errors[band] = BandFigures::from_list(errors);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::Tap;

    /// The figures of a direct sound of energy 1 and of arrivals of 0.001 each. Their errors include the effect of one
    /// more such arrival.
    fn figures(arrivals: usize, energy: f64) -> Figures {
        let direct = Tap {
            seconds: 0.01,
            energy: [1.0; BAND_COUNT],
            direction: DVec3::X,
        };
        let mut echogram = Echogram::new(1e-3, 16).expect("a good bin");
        for arrival in 0..arrivals {
            let seconds = 0.012 + 0.2 * (arrival as f64 * 0.618_034).fract();
            echogram
                .add(arrival % 16, seconds, &[energy; BAND_COUNT], DVec3::X)
                .unwrap();
        }
        let (taps, ends_s) = ([direct], 0.5);
        let figures = Figures::new(&taps, &echogram, Some(0.01), ends_s);
        let uncertain = match arrivals {
            0 => energy,
            _ => uncertain_energy(arrivals as f64 * energy, arrivals as f64),
        };
        figures.with_further_arrival(
            Record::new(&taps, &echogram, ends_s),
            &[uncertain; BAND_COUNT],
        )
    }

    /// Protects against errors that are estimated from a few dozen waves or are 0: if one arrival changes G by more
    /// than 1 dB, G is not reported; otherwise its error is at least that of one arrival.
    #[test]
    fn few_arrivals_give_no_certain_figures() {
        for arrivals in [0, 8] {
            let weak = figures(arrivals, 1e-3);
            let one_more = 10.0 * (1.0_f64 + 1e-3 / (1.0 + arrivals as f64 * 1e-3)).log10();
            let error = weak.errors[3].g_db.expect("an error");
            assert!(
                weak.bands[3].g_db.is_some() && error >= 0.999 * one_more,
                "{weak:?}"
            );
            let strong = figures(arrivals, 1.0);
            assert_eq!((strong.bands[3].g_db, strong.errors[3].g_db), (None, None));
            assert_eq!(strong.bands[3].c80_db, None);
        }
        // One more arrival among many changes little.
        let many = figures(2000, 0.1);
        assert!(many.bands[3].g_db.is_some() && many.errors[3].g_db.is_some_and(|e| e < 0.2));
    }
}
