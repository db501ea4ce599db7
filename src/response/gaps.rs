//! Reasons why figures of a response are missing.

use crate::acoustics::{BandFigures, Figures};

/// Share of the energy after the response's end above which it is reported: a tenth of the limit
/// for figures.
const TOLD_CUT_OFF: f64 = 0.001;

/// Reason why figures of a band are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gap {
    /// Nothing arrives in this band.
    Silence,
    /// The response ends before its sound has decayed.
    TooShort,
    /// The sound arrives too early for a clarity figure: without reverberation.
    NoLateSound,
    /// Sound decays, but there are too few waves to estimate the decay.
    TooNoisy,
}

impl Gap {
    /// All reasons, in the order of reporting.
    pub const ALL: [Gap; 4] = [Gap::Silence, Gap::TooShort, Gap::NoLateSound, Gap::TooNoisy];

    /// The reason why figures of a band are missing or inexact; `None` if all its decay times are present. `is_heard`:
    /// whether any sound arrives in it.
    pub fn of(figures: &Figures, band: usize, is_heard: bool) -> Option<Gap> {
        match is_heard {
            true => Gap::of_band(
                &figures.bands[band],
                figures.cut_off[band],
                figures.have_few_arrivals[band],
            ),
            false => Some(Gap::Silence),
        }
    }

    fn of_band(figures: &BandFigures, cut_off: Option<f64>, has_few_arrivals: bool) -> Option<Gap> {
        if cut_off.is_none_or(|share| share > TOLD_CUT_OFF) {
            return Some(Gap::TooShort);
        }
        let times = [figures.edt_s, figures.t20_s, figures.t30_s];
        if times.iter().all(Option::is_some) && !has_few_arrivals {
            return None;
        }
        match figures.c80_db {
            None if !has_few_arrivals => Some(Gap::NoLateSound),
            _ => Some(Gap::TooNoisy),
        }
    }

    /// The reason in two or three words.
    pub fn words(self) -> &'static str {
        match self {
            Gap::Silence => "nothing arrives",
            Gap::TooShort => "record too short",
            Gap::NoLateSound => "no late sound",
            Gap::TooNoisy => "too noisy",
        }
    }

    /// The reason as a number in tables: from 1 in the order of [`Gap::ALL`].
    pub fn code(self) -> u64 {
        Gap::ALL
            .iter()
            .position(|gap| *gap == self)
            .map_or(0, |at| at as u64 + 1)
    }

    /// The reason of a code; `None` for 0 and for unknown codes.
    pub fn of_code(code: u64) -> Option<Gap> {
        Gap::ALL.into_iter().find(|gap| gap.code() == code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the advice: it follows from the missing figures, and is absent if all are present.
    #[test]
    fn each_missing_figure_has_its_reason() {
        let whole = BandFigures {
            edt_s: Some(1.0),
            t20_s: Some(1.0),
            t30_s: Some(1.0),
            c80_db: Some(3.0),
            ..BandFigures::default()
        };
        let noisy = BandFigures {
            t30_s: None,
            ..whole
        };
        let dry = BandFigures::default();
        assert_eq!(Gap::of_band(&whole, Some(0.0), false), None);
        assert_eq!(Gap::of_band(&noisy, Some(0.0), false), Some(Gap::TooNoisy));
        assert_eq!(Gap::of_band(&dry, Some(0.0), false), Some(Gap::NoLateSound));
        assert_eq!(Gap::of_band(&dry, Some(0.0), true), Some(Gap::TooNoisy));
        for figures in [whole, noisy, dry] {
            assert_eq!(Gap::of_band(&figures, None, false), Some(Gap::TooShort));
            assert_eq!(
                Gap::of_band(&figures, Some(0.002), false),
                Some(Gap::TooShort)
            );
        }
    }

    /// Protects tables: each code means one reason.
    #[test]
    fn codes_mean_reasons() {
        for gap in Gap::ALL {
            assert_eq!(Gap::of_code(gap.code()), Some(gap));
        }
        assert_eq!(Gap::ALL.map(Gap::code), [1, 2, 3, 4]);
        assert_eq!((Gap::of_code(0), Gap::of_code(5)), (None, None));
    }
}
