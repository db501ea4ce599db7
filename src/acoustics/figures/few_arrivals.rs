//! Figures that depend on few waves.
//!
//! The spread over batches is unreliable for a few dozen arrivals in a band, and is not defined without any. There the
//! energy that the waves may have missed is estimated from the number of arrivals: √n of n arrivals, and one if there
//! are none.

use super::uncertainty::others;
use super::{BandFigures, FIGURE_COUNT, Figures, List};
use crate::acoustics::{Echogram, Tap};
use crate::bands::{BAND_COUNT, Bands};
use glam::DVec3;

/// Number of arrivals of equal energy in a band below which the spread over batches alone does not
/// give its error.
const FEW: f64 = 64.0;

/// Seconds over which a further arrival is spread, from the time origin on: half of it is before 80 ms.
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

/// Error of the sum of a number of arrivals' energies that the spread over batches does not include: about √n times
/// their mean if they are few. With more arrivals the batches report more of it: the factor is √(1 + n (1 − n / 64)),
/// and 1 from 64 on. 0 without arrivals.
pub(crate) fn uncertain_energy(sum: f64, arrivals: f64) -> f64 {
    if arrivals == 0.0 {
        return 0.0;
    }
    let counted = arrivals * (1.0 - arrivals / FEW).max(0.0);
    sum / arrivals * (1.0 + counted).sqrt()
}

impl Figures {
    /// Adds the effect of one more arrival of these energies as an error. In bands with few arrivals only figures that
    /// change little are kept.
    pub(crate) fn with_further_arrival(
        self,
        (taps, echogram, ends_s): (&[Tap], &Echogram, f64),
        energy: &Bands,
    ) -> Figures {
        let Some(begins_s) = self.begins_s.filter(|_| echogram.batches() > 1) else {
            return self;
        };
        let mut further = echogram.clone();
        let seconds = FURTHER_S.min(ends_s - begins_s);
        let bins = (seconds / echogram.bin_s()).ceil().max(1.0);
        let of_bin = energy.map(|energy| energy / bins);
        for bin in 0..bins as usize {
            let seconds = begins_s + (bin as f64 + 0.5) * echogram.bin_s();
            // The energies of waves that were already added are in range.
            let _ = further.add(0, seconds, &of_bin, DVec3::ZERO);
        }
        let Some(others) = others(taps, &further, begins_s, ends_s) else {
            return self;
        };
        let mut figures = self.differing(&others, &[1.0; BAND_COUNT]);
        for (band, others) in others.iter().enumerate() {
            if echogram.effective_arrivals(band, begins_s) < FEW {
                figures.leave_certain(band, others);
            }
        }
        figures
    }

    /// Keeps the figures of a band that have small errors and are also in `others`, with one arrival more.
    fn leave_certain(&mut self, band: usize, others: &List) {
        let (mut list, mut errors) = (self.bands[band].list(), self.errors[band].list());
        for figure in 0..FIGURE_COUNT {
            let is_certain = errors[figure]
                .zip(WORST_ERRORS[figure])
                .is_some_and(|(error, worst)| error <= worst);
            if !is_certain || others[figure].is_none() {
                self.have_few_arrivals[band] |= list[figure].is_some();
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

    /// The figures of a direct sound of energy 1 and some arrivals of 0.001 each, with the effect of one more of these
    /// as their error.
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
        figures.with_further_arrival((&taps, &echogram, ends_s), &[uncertain; BAND_COUNT])
    }

    /// Protects against errors estimated from a few dozen waves, and errors of 0: if one arrival changes G by more
    /// than 1 dB G is not reported, otherwise its error is at least that of one arrival.
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
        // One arrival among many changes little.
        let many = figures(2000, 0.1);
        assert!(many.bands[3].g_db.is_some() && many.errors[3].g_db.is_some_and(|e| e < 0.2));
    }
}
