//! The precision of figures: their noise, also where a figure is withheld, and the number of waves that a requested
//! precision takes.

use super::uncertainty::{Halves, Noisy, WORST_TIME_ERROR};
use super::{BandFigures, DECAY_TIMES, FIGURE_COUNT, Figures, LEAST_ARRIVALS, List, Record};
use crate::bands::BAND_COUNT;
use crate::response::Echogram;
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

/// Factor of the number of waves if the noise is unknown: half of the waves do not give the figure.
const UNKNOWN_NOISE: f64 = 4.0;

/// The least part of the requested precision that the noise may use up, as a share. Errors that more waves do not
/// reduce may use up the remainder.
const LEAST_NOISE_SHARE: f64 = 0.5;

/// Factors of the numbers of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Growth {
    /// The factor for the waves of early arrivals.
    pub early: f64,
    /// The factor for the waves of the onset.
    pub onset: f64,
    /// The factor for the waves that are followed to the record's end.
    pub followed: f64,
}

/// The demand of a band's figure for waves, as factors of their number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Demand {
    /// The variance of the noise relative to the variance that the accuracy allows.
    pub noise: f64,
    /// The share of the variance that the waves of early arrivals cause, 0 … 1.
    pub early_share: f64,
    /// The share of the variance that the other waves cause in the onset, 0 … 1 − `early_share`.
    pub onset_share: f64,
    /// The factor until the figure is reported; 0 if it is, and if its noise alone withholds it.
    pub least: f64,
}

impl Demand {
    /// The demand of the other noise, if the waves of early arrivals cannot grow.
    fn without_early(self) -> Demand {
        let others = 1.0 - self.early_share;
        Demand {
            noise: others * self.noise,
            early_share: 0.0,
            onset_share: match others > 0.0 {
                true => self.onset_share / others,
                false => 0.0,
            },
            ..self
        }
    }

    /// Whether the demand is not fulfilled.
    pub fn is_open(&self) -> bool {
        self.factor() > 1.0
    }

    /// The factor of all waves that fulfils the demand. 0 if no number of waves does.
    pub fn factor(&self) -> f64 {
        match self.least.is_finite() {
            true => self.least.max(self.noise),
            false => 0.0,
        }
    }

    /// The variance relative to the allowed variance that is left after the growth; more than 1 also if the figure is not
    /// reported.
    pub fn left(&self, growth: Growth) -> f64 {
        if !self.least.is_finite() {
            return 0.0;
        }
        let late_share = 1.0 - self.early_share - self.onset_share;
        let early = self.early_share / growth.early;
        let left = early + self.onset_share / growth.onset + late_share / growth.followed;
        (self.noise * left).max(self.least / growth.followed)
    }

    /// The factor of the waves of the onset with which this growth of the other waves [leaves](Self::left) at most
    /// `accepted`, 1 or more. Infinite if no number does.
    pub fn onset_factor(&self, growth: Growth, accepted: f64) -> f64 {
        if !self.is_open() {
            return 0.0;
        }
        let late_share = 1.0 - self.early_share - self.onset_share;
        let others = self.early_share / growth.early + late_share / growth.followed;
        let others = self.noise * others;
        match self.least <= accepted * growth.followed && others < accepted {
            true => self.onset_share * self.noise / (accepted - others),
            false => f64::INFINITY,
        }
    }
}

/// The parts of a record whose noise different waves cause.
pub(in crate::response) struct Parts<'a> {
    /// The arrivals of the waves of early arrivals.
    pub early: &'a Echogram,
    /// Whether more of these waves reduce their noise.
    pub early_can_grow: bool,
    /// The end of the onset in seconds after the source's impulse.
    pub onset_s: f64,
}

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

    /// The factor by which the number of waves must grow until every figure has this accuracy. 1 or less if all have
    /// it. Figures that are not defined, and errors that do not come from noise, ask for no waves.
    #[doc(hidden)]
    pub fn waves_for(&self, accuracy: f64) -> f64 {
        let bands = 0..BAND_COUNT;
        let factors = bands.flat_map(|band| (0..FIGURE_COUNT).map(move |figure| (band, figure)));
        factors
            .filter_map(|(band, figure)| self.factor_for(accuracy, band, figure))
            .filter(|factor| factor.is_finite())
            .fold(0.0, f64::max)
    }

    /// Whether a figure of a band has this accuracy. `None` if it is not defined.
    #[doc(hidden)]
    pub fn is_accurate(&self, accuracy: f64, band: usize, figure: usize) -> Option<bool> {
        Some(self.factor_for(accuracy, band, figure)? <= 1.0)
    }

    /// Whether the error of a reported figure exceeds this accuracy although its noise does not: more waves do not reduce
    /// it.
    pub(in crate::response) fn is_limited(
        &self,
        accuracy: f64,
        band: usize,
        figure: usize,
    ) -> bool {
        let value = self.bands[band].list()[figure];
        let error = self.errors[band].list()[figure];
        let exceeds =
            |(value, error): (f64, f64)| error > Figures::tolerance(accuracy, figure, value);
        value.zip(error).is_some_and(exceeds)
            && self.is_accurate(accuracy, band, figure) == Some(true)
    }

    fn factor_for(&self, accuracy: f64, band: usize, figure: usize) -> Option<f64> {
        let demand = self.demand(accuracy, band, figure)?;
        Some(demand.least.max(demand.noise))
    }

    /// What each defined figure demands of the numbers of waves. `record` is that of the figures. Without `parts` all noise
    /// is that of the waves that are followed to the record's end.
    pub(in crate::response) fn demands(
        &self,
        accuracy: f64,
        record: &Record,
        direct_s: Option<f64>,
        parts: Option<Parts>,
    ) -> Vec<Demand> {
        let early_can_grow = parts.as_ref().is_some_and(|parts| parts.early_can_grow);
        let halves = parts.map(|Parts { early, onset_s, .. }| {
            let until = record.echogram.bins_before(onset_s);
            [Noisy::Arrivals(early), Noisy::Before(until)]
                .map(|noisy| Halves::new(record, direct_s, noisy))
        });
        let mut demands = Vec::new();
        for band in 0..BAND_COUNT {
            let precision = &self.precision[band];
            let noise = halves.as_ref().map(|halves| {
                let arrivals = self.begins_s.map_or(0.0, |begins_s| {
                    record.echogram.effective_arrivals(band, begins_s)
                });
                let values = precision_values(precision);
                halves
                    .each_ref()
                    .map(|of| of.noise(band, &values, arrivals))
            });
            for (figure, precision) in precision.iter().enumerate() {
                let share = |part: usize| {
                    let part = noise.as_ref()?[part][figure]?;
                    let share = (part / precision.noise?).powi(2);
                    Some(share.min(1.0)).filter(|share| share.is_finite())
                };
                let [early, onset] = [0, 1].map(|part| share(part).unwrap_or(0.0));
                // Early arrivals are a part of the onset.
                let demand = self.demand(accuracy, band, figure).map(|demand| Demand {
                    early_share: early,
                    onset_share: (onset - early).max(0.0),
                    ..demand
                });
                let demand = demand.map(|demand| match early_can_grow {
                    true => demand,
                    false => demand.without_early(),
                });
                demands.extend(demand);
            }
        }
        demands
    }

    fn demand(&self, accuracy: f64, band: usize, figure: usize) -> Option<Demand> {
        let demand = |noise: f64, least: f64| {
            Some(Demand {
                noise,
                early_share: 0.0,
                onset_share: 0.0,
                least,
            })
        };
        let precision = &self.precision[band][figure];
        let value = precision.value?;
        let least = match self.withheld(band, figure) {
            // Less noise than the accuracy allows reports the figure.
            Some(Withheld::Noise(Some(_))) => 0.0,
            _ => self.waves_to_report(band, figure).unwrap_or(0.0),
        };
        let tolerance = Figures::tolerance(accuracy, figure, value);
        let error = self.errors[band].list()[figure].unwrap_or(0.0);
        let noise = match precision.noise {
            Some(noise) => noise,
            None if least > 0.0 => return demand(0.0, least),
            // Without batches the noise is unknown.
            None => return None,
        };
        let other = (error.powi(2) - noise.powi(2)).max(0.0).sqrt();
        let left = (tolerance.powi(2) - other.powi(2)).max(0.0).sqrt();
        let left = left.max(LEAST_NOISE_SHARE * tolerance);
        demand((noise / left).powi(2), least)
    }

    /// The precision of all figures of a band.
    pub(super) fn precision_of(
        halves: &Halves,
        band: usize,
        list: &List,
        (arrivals, in_decays): (f64, [f64; DECAY_TIMES]),
    ) -> [Precision; FIGURE_COUNT] {
        let noise = halves.noise(band, list, arrivals);
        std::array::from_fn(|figure| Precision {
            value: list[figure].filter(|value| value.is_finite()),
            noise: noise[figure],
            arrivals: in_decays.get(figure).copied(),
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

/// The values of all figures of a band.
fn precision_values(precision: &[Precision; FIGURE_COUNT]) -> List {
    std::array::from_fn(|figure| precision[figure].value)
}
