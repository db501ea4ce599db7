//! Figures behind which few waves stand.
//!
//! The spread over batches says little where a band has a few dozen arrivals, and nothing where it has none. There the
//! number of arrivals is the measure of what the waves may have missed: √n of n arrivals, and one of none.

use super::uncertainty::others;
use super::{BandFigures, FIGURE_COUNT, Figures, List};
use crate::acoustics::{Echogram, Tap};
use crate::bands::{BAND_COUNT, Bands};
use glam::DVec3;

/// Arrivals of one energy in a band below which its spread over batches is not reported alone.
const FEW: f64 = 64.0;

/// Seconds over which a further arrival is spread, from the time origin on: half of it comes before 80 ms.
const FURTHER_S: f64 = 0.16;

/// The largest errors with which figures of few arrivals are reported: just noticeable differences (ISO 3382-1, annex A) of
/// C50, C80, D50, Ts and G. Decay times need more arrivals in any case.
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

/// The energy that some arrivals may lack or have too much, from their sum: about √n times their mean where they are few.
/// The more they are, the more of that the batches report: the factor is √(1 + n (1 − n / 64)), and 1 from 64 on. 0 of
/// none.
pub(crate) fn uncertain_energy(sum: f64, arrivals: f64) -> f64 {
    if arrivals == 0.0 {
        return 0.0;
    }
    let counted = arrivals * (1.0 - arrivals / FEW).max(0.0);
    sum / arrivals * (1.0 + counted).sqrt()
}

impl Figures {
    /// The same with what one more arrival of these energies would change as an error besides. In bands with few arrivals
    /// only those figures are left that this hardly changes.
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
            // Energies of waves that were added before are in range.
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

    /// Leaves those figures of a band that have small errors, and are among `others` with one arrival more.
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

    /// The figures of a direct sound of energy 1 and some arrivals of 0.001 each, with one more of these as their error.
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

    /// Protects errors from a few dozen waves, and errors of 0: where these change G by more than 1 dB there is no G,
    /// else its error is at least that of one arrival.
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
