//! The demands of figures for waves until they have a requested accuracy, by the kind of waves.

use super::precision::Withheld;
use super::uncertainty::{Halves, Noisy};
use super::{DECAY_TIMES, DecayEnds, FIGURE_COUNT, Figures, List, Record, lists};
use crate::bands::BAND_COUNT;
use crate::response::Echogram;

/// The least part of the requested precision that the noise may use up, as a share. Errors that more waves do not
/// reduce may use up the remainder.
const LEAST_NOISE_SHARE: f64 = 0.5;

/// Minimum number of independent waves after the end of a decay for an accuracy. Rounds end when the noise is small, and
/// the noise of few independent waves is small if strong waves are missing by chance (docs/acoustics.md, *The late part*).
const LEAST_INDEPENDENT_WAVES: f64 = 200.0;

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

/// A multiple of a limit that falls as the numbers of waves grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Need {
    /// The multiple with the present waves; above 1 the need is open. Infinite if no number of waves fulfils it.
    pub factor: f64,
    /// The share that the waves of early arrivals cause, 0 … 1.
    pub early_share: f64,
    /// The share that the other waves cause in the onset, 0 … 1 − `early_share`.
    pub onset_share: f64,
}

impl Need {
    /// A need for waves that are followed to the record's end.
    pub fn of_followed(factor: f64) -> Need {
        Need {
            factor,
            early_share: 0.0,
            onset_share: 0.0,
        }
    }

    /// This need with parts that other waves cause. If the waves of early arrivals `can_grow` no more, without their part.
    fn by_waves(self, [early, onset]: [f64; 2], can_grow: bool) -> Need {
        let early = early.clamp(0.0, 1.0);
        let onset = onset.clamp(0.0, 1.0 - early);
        match (can_grow, early < 1.0) {
            (true, _) => Need {
                early_share: early,
                onset_share: onset,
                ..self
            },
            (false, true) => Need {
                factor: (1.0 - early) * self.factor,
                early_share: 0.0,
                onset_share: onset / (1.0 - early),
            },
            (false, false) => Need::of_followed(0.0),
        }
    }

    /// The parts that waves beyond the onset do not reduce, and those in the onset, after growth of the other waves.
    fn parts(&self, growth: Growth) -> (f64, f64) {
        let late_share = 1.0 - self.early_share - self.onset_share;
        let others = self.early_share / growth.early + late_share / growth.followed;
        (self.factor * others, self.factor * self.onset_share)
    }

    fn left(&self, growth: Growth) -> f64 {
        let (others, onset) = self.parts(growth);
        others + onset / growth.onset
    }

    /// The factor of the waves of the onset that leaves `accepted`.
    fn onset_factor(&self, growth: Growth, accepted: f64) -> f64 {
        let (others, onset) = self.parts(growth);
        match (self.factor <= accepted, others < accepted) {
            (true, _) => 0.0,
            (false, true) => onset / (accepted - others),
            (false, false) => f64::INFINITY,
        }
    }
}

/// The demand of a band's figure for waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Demand {
    /// The variance of the noise relative to the variance that the accuracy allows.
    pub noise: Need,
    /// Until the figure is reported and enough independent waves arrive after the end of its decay. If the noise alone
    /// withholds the figure, only the latter.
    pub least: Need,
}

impl Demand {
    /// Whether the demand is not fulfilled.
    pub fn is_open(&self) -> bool {
        self.factor() > 1.0
    }

    /// The factor of all waves that fulfils the demand. 0 if no number of waves does.
    pub fn factor(&self) -> f64 {
        match self.least.factor.is_finite() {
            true => self.least.factor.max(self.noise.factor),
            false => 0.0,
        }
    }

    /// The multiple of the limit that is left after the growth; more than 1 also if the figure is not reported.
    pub fn left(&self, growth: Growth) -> f64 {
        match self.least.factor.is_finite() {
            true => self.noise.left(growth).max(self.least.left(growth)),
            false => 0.0,
        }
    }

    /// The factor of the waves of the onset with which this growth of the other waves [leaves](Self::left) at most
    /// `accepted`, 1 or more. Infinite if no number does.
    pub fn onset_factor(&self, growth: Growth, accepted: f64) -> f64 {
        if !self.is_open() {
            return 0.0;
        }
        let of = |need: &Need| need.onset_factor(growth, accepted);
        of(&self.noise).max(of(&self.least))
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
        Some(demand.least.factor.max(demand.noise.factor))
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
        let shares = parts.map(|parts| Shares::new(self, record, direct_s, parts));
        let mut demands = Vec::new();
        for band in 0..BAND_COUNT {
            let of_band = shares.as_ref().map(|shares| shares.of_band(band));
            for figure in 0..FIGURE_COUNT {
                let demand = self.demand(accuracy, band, figure);
                demands.extend(demand.map(|demand| match &of_band {
                    Some(shares) => shares.part(demand, figure),
                    None => demand,
                }));
            }
        }
        demands
    }

    /// Whether a reported figure has this accuracy by its noise, which may be too small, because few independent waves
    /// arrive after the end of its decay.
    pub(in crate::response) fn rests_on_few_waves(
        &self,
        accuracy: f64,
        band: usize,
        figure: usize,
    ) -> bool {
        let is_reported = self.bands[band].list()[figure].is_some();
        let demand = self.demand(accuracy, band, figure);
        is_reported && demand.is_some_and(|demand| demand.noise.factor <= 1.0 && demand.is_open())
    }

    fn demand(&self, accuracy: f64, band: usize, figure: usize) -> Option<Demand> {
        let demand = |noise: f64, least: f64| {
            Some(Demand {
                noise: Need::of_followed(noise),
                least: Need::of_followed(least),
            })
        };
        let precision = &self.precision[band][figure];
        let value = precision.value?;
        let least = match self.withheld(band, figure) {
            // Less noise than the accuracy allows reports the figure.
            Some(Withheld::Noise(Some(_))) => 0.0,
            _ => self.waves_to_report(band, figure).unwrap_or(0.0),
        };
        let independent = precision.independent_waves;
        let least = least.max(independent.map_or(0.0, |waves| LEAST_INDEPENDENT_WAVES / waves));
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

    /// Whether a figure is withheld because too few waves arrive after the end of its decay.
    fn has_few_arrivals(&self) -> bool {
        let bands = 0..BAND_COUNT;
        let mut figures = bands.flat_map(|band| (0..DECAY_TIMES).map(move |figure| (band, figure)));
        figures.any(|(band, figure)| {
            matches!(self.withheld(band, figure), Some(Withheld::FewArrivals(_)))
        })
    }
}

/// Which waves cause the noise of figures, and the unequal energies of the arrivals after the ends of decays.
struct Shares<'a> {
    figures: &'a Figures,
    record: &'a Record<'a>,
    early: &'a Echogram,
    early_can_grow: bool,
    /// The bins of the onset end before this one.
    until: usize,
    /// The noise of the waves of early arrivals, and of all waves in the onset.
    halves: [Halves; 2],
    /// Ends of the decays in seconds after the source's impulse, if some have too few arrivals.
    ends_s: Option<[DecayEnds; BAND_COUNT]>,
}

/// The shares of a band.
struct BandShares<'a> {
    of: &'a Shares<'a>,
    band: usize,
    noise: [List; 2],
}

impl<'a> Shares<'a> {
    fn new(
        figures: &'a Figures,
        record: &'a Record<'a>,
        direct_s: Option<f64>,
        parts: Parts<'a>,
    ) -> Shares<'a> {
        let until = record.echogram.bins_before(parts.onset_s);
        let halves = [Noisy::Arrivals(parts.early), Noisy::Before(until)];
        Shares {
            figures,
            record,
            early: parts.early,
            early_can_grow: parts.early_can_grow,
            until,
            halves: halves.map(|noisy| Halves::new(record, direct_s, noisy)),
            ends_s: figures
                .begins_s
                .filter(|_| figures.has_few_arrivals())
                .map(|begins_s| {
                    let pieces = record.pieces(begins_s, |bin| record.echogram.energy(bin));
                    let (_, ends_s, _) = lists(&pieces, record.echogram.bin_s());
                    ends_s.map(|of_band| of_band.map(|end_s| begins_s + end_s))
                }),
        }
    }

    fn of_band(&self, band: usize) -> BandShares<'_> {
        let arrivals = self.figures.begins_s.map_or(0.0, |begins_s| {
            self.record.echogram.effective_arrivals(band, begins_s)
        });
        let values = std::array::from_fn(|figure| self.figures.precision[band][figure].value);
        BandShares {
            of: self,
            band,
            noise: self
                .halves
                .each_ref()
                .map(|of| of.noise(band, &values, arrivals)),
        }
    }
}

impl BandShares<'_> {
    /// A figure's demand with the parts of the waves.
    fn part(&self, demand: Demand, figure: usize) -> Demand {
        let by_waves = |need: Need, shares| need.by_waves(shares, self.of.early_can_grow);
        Demand {
            noise: by_waves(demand.noise, self.of_noise(figure)),
            least: by_waves(
                demand.least,
                self.of_squares(figure)
                    .unwrap_or_else(|| self.of_noise(figure)),
            ),
        }
    }

    /// The shares of the waves of early arrivals and of the others in the onset in the variance of the noise.
    fn of_noise(&self, figure: usize) -> [f64; 2] {
        let all = self.of.figures.precision[self.band][figure].noise;
        let share = |part: usize| {
            let share = (self.noise[part][figure]? / all?).powi(2);
            Some(share.min(1.0)).filter(|share| share.is_finite())
        };
        let [early, onset] = [0, 1].map(|part| share(part).unwrap_or(0.0));
        // Early arrivals are a part of the onset.
        [early, (onset - early).max(0.0)]
    }

    /// Their shares in the sum of the squared energies after the end of a decay. Equal arrivals have a small sum. `None` if
    /// the figure does not lack arrivals.
    fn of_squares(&self, figure: usize) -> Option<[f64; 2]> {
        let withheld = self.of.figures.withheld(self.band, figure);
        let Some(Withheld::FewArrivals(_)) = withheld else {
            return None;
        };
        let after_s = self.of.ends_s?[self.band][figure];
        let (all, early) = (self.of.record.echogram, self.of.early);
        let later = all.bins_from(after_s);
        let in_onset = later.start..self.of.until.max(later.start);
        let squares = all.squares(self.band, later);
        // Without arrivals no number of waves suffices.
        if squares <= 0.0 {
            return None;
        }
        let of_early = early.squares(self.band, early.bins_from(after_s)) / squares;
        let of_onset = all.squares(self.band, in_onset) / squares;
        Some([of_early, (of_onset - of_early).max(0.0)])
    }
}
