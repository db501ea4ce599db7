//! The precision of figures: their noise, also where a figure is withheld, and why it is withheld.

use super::uncertainty::{Halves, WORST_TIME_ERROR};
use super::{BandFigures, DECAY_TIMES, FIGURE_COUNT, Figures, LEAST_ARRIVALS, List};
use crate::serialised::finite;
use serde::{Deserialize, Serialize};

/// The noise of a figure from the finite number of waves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Precision {
    /// The figure from all waves, also if it is too noisy to be reported. `None` if it is not defined.
    #[serde(serialize_with = "finite")]
    pub value: Option<f64>,
    /// One standard deviation of the figure from the noise of the waves alone, in the figure's unit. `None` without
    /// batches, and if the figure is not defined for half of the batches.
    #[serde(serialize_with = "finite")]
    pub noise: Option<f64>,
    /// Number of arrivals of equal energy after the end of the decay. `None` except for decay times.
    #[serde(serialize_with = "finite")]
    pub arrivals: Option<f64>,
    /// Number of independent waves of equal energy after the end of the decay, from the spread over the batches: copies of
    /// a wave and repeated arrivals count once. `None` for figures other than decay times, without arrivals, with fewer
    /// than 16 batches, and if all batches are equal.
    #[serde(serialize_with = "finite")]
    pub independent_waves: Option<f64>,
}

/// Why a figure that is defined is not reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Withheld {
    /// Too few waves arrive after the end of the decay: their number.
    FewArrivals(f64),
    /// The error of a decay time from the noise of the waves, as a share of the time. `None` if it is unknown, because
    /// half of the waves do not give the figure.
    Noise(Option<f64>),
    /// One further arrival in a band with few arrivals changes the figure by more than a just noticeable difference.
    FewWaves,
}

/// The arrivals of a band.
pub(super) struct Arrivals {
    /// Number of arrivals of equal energy.
    pub all: f64,
    /// Their number after the end of each decay.
    pub after_decays: [f64; DECAY_TIMES],
    /// Number of independent waves of equal energy after the end of each decay, where it is known.
    pub independent_waves: [Option<f64>; DECAY_TIMES],
}

/// Factor of the number of waves if the noise is unknown: half of the waves do not give the figure.
const UNKNOWN_NOISE: f64 = 4.0;

impl Figures {
    /// Minimum number of arrivals of equal energy after the end of a reported decay.
    pub const LEAST_ARRIVALS: f64 = LEAST_ARRIVALS;

    /// The standard error that corresponds to an accuracy, a share of decay times, for the figure at this place in
    /// [`BandFigures::NAMES`] and with this value, in the figure's unit. Just noticeable differences (ISO 3382-1, annex
    /// A) are in proportion: for 2 % these are 2 % of a decay time, 0.2 dB, 0.01 for D50 and 2 ms for Ts, or 2 % of Ts if
    /// that is more.
    pub(super) fn tolerance(accuracy: f64, figure: usize, value: f64) -> f64 {
        /// Decibels, D50 and seconds per unit of accuracy.
        const DECIBELS: f64 = 10.0;
        const DEFINITION: f64 = 0.5;
        const CENTRE_S: f64 = 0.1;
        let units: [f64; FIGURE_COUNT] = [
            value,
            value,
            value,
            DECIBELS,
            DECIBELS,
            DEFINITION,
            CENTRE_S.max(value),
            DECIBELS,
        ];
        accuracy * units[figure]
    }

    /// Whether T30 of a band is defined for all waves, but not for some half of them.
    pub(in crate::response) fn lacks_t30_in_halves(&self, band: usize) -> bool {
        let t30 = &self.precision[band][DECAY_TIMES - 1];
        t30.value.is_some() && t30.noise.is_none()
    }

    /// Why a figure of a band is withheld, with the figure's place in [`BandFigures::NAMES`]. `None` if it is reported,
    /// and if it is not defined for this sound.
    pub(crate) fn withheld(&self, band: usize, figure: usize) -> Option<Withheld> {
        let precision = &self.precision[band][figure];
        let value = precision.value?;
        if self.bands[band].list()[figure].is_some() {
            return None;
        }
        if figure >= DECAY_TIMES {
            return Some(Withheld::FewWaves);
        }
        let share = precision.noise.map(|noise| noise / value);
        match precision.arrivals {
            Some(arrivals) if arrivals < LEAST_ARRIVALS => Some(Withheld::FewArrivals(arrivals)),
            _ => Some(Withheld::Noise(share)),
        }
    }

    /// The factor by which the number of waves must grow until a figure of a band is reported; `None` if it is
    /// reported or not defined, and infinite if no wave arrives after the end of its decay.
    pub(crate) fn waves_to_report(&self, band: usize, figure: usize) -> Option<f64> {
        let factor = match self.withheld(band, figure)? {
            Withheld::FewArrivals(arrivals) if arrivals < 1.0 => f64::INFINITY,
            Withheld::FewArrivals(arrivals) => LEAST_ARRIVALS / arrivals,
            Withheld::Noise(Some(share)) => (share / WORST_TIME_ERROR).powi(2),
            Withheld::Noise(None) | Withheld::FewWaves => UNKNOWN_NOISE,
        };
        Some(factor.max(1.0))
    }

    /// The precision of all figures of a band.
    pub(super) fn precision_of(
        halves: &Halves,
        band: usize,
        list: &List,
        arrivals: &Arrivals,
    ) -> [Precision; FIGURE_COUNT] {
        let noise = halves.noise(band, list, arrivals.all);
        std::array::from_fn(|figure| Precision {
            value: list[figure].filter(|value| value.is_finite()),
            noise: noise[figure],
            arrivals: arrivals.after_decays.get(figure).copied(),
            independent_waves: arrivals.independent_waves.get(figure).copied().flatten(),
        })
    }

    /// The figures of a band that are precise enough to be reported, and their errors.
    pub(super) fn reported(
        precision: &[Precision; FIGURE_COUNT],
        has_batches: bool,
    ) -> (BandFigures, BandFigures) {
        let is_reported = |figure: usize| {
            let Precision {
                value,
                noise,
                arrivals,
                ..
            } = precision[figure];
            if !has_batches {
                return true;
            }
            let worst = match figure < DECAY_TIMES {
                true => WORST_TIME_ERROR * value.unwrap_or(0.0),
                false => f64::INFINITY,
            };
            arrivals.is_none_or(|arrivals| arrivals >= LEAST_ARRIVALS)
                && noise.is_some_and(|noise| noise <= worst)
        };
        let told = |of: fn(&Precision) -> Option<f64>| {
            let list = std::array::from_fn(|figure| {
                of(&precision[figure]).filter(|_| is_reported(figure))
            });
            BandFigures::from_list(list)
        };
        (told(|figure| figure.value), told(|figure| figure.noise))
    }
}
