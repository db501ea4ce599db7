//! The effort of a round: numbers of waves and the length of the record, and what the next round takes.
//!
//! Three kinds of waves cause noise. The waves of early arrivals find exact paths and fly a few reflections. The waves of
//! the onset end after the first part of the record, and the others are followed to the record's end. The noise of each
//! figure is attributed to them, and the numbers grow where the noise is.

use super::accuracy::{Accuracy, Ended};
use super::figures::{Demand, Figures, Growth, Parts, Record};
use super::from_arrivals::Traced;
use super::late::Onset;
use super::source_sound::Medium;
use super::{ResponseSettings, taps_of_energy};
use crate::bands::{BAND_COUNT, Bands};
use crate::scene::Pair;
use crate::tracer;

/// Number of waves of the first round. In rooms its errors predict the number of waves that the accuracy takes.
const FIRST_WAVES: u32 = 1 << 14;

/// Number of waves that the first round follows to the record's end if the other waves end after the onset.
const FIRST_FOLLOWED: u32 = 1 << 12;

/// Factor of the predicted number of waves. The errors of 16 batches are themselves uncertain by 18 %.
const SPARE: f64 = 1.2;

/// The least growth of a further round. With less growth many rounds would repeat most of their work, or compute many
/// figures in vain.
const LEAST_GROWTH: f64 = 1.5;

/// The greatest growth of a further round. Errors of few waves do not predict more.
const GREATEST_GROWTH: f64 = 4.0;

/// Factor of the record's length if sound continues after its end.
const LONGER: f64 = 1.5;

/// The share of the energy beyond a record's end from which on a further round has a longer record, if the decay of the band
/// is unknown. Ten times this share withholds figures.
const MOST_CUT_OFF: f64 = 1e-3;

/// The share of the greatest energy beyond the record of a defined T30 (3 dB less) from which on a further round has a
/// longer record, if T30 is not defined for half of the waves: their decays end somewhat earlier or later.
const MOST_CUT_OFF_IN_HALVES: f64 = 0.5;

/// The least growth of a kind of waves for a further round. With less growth a round would not change the figures
/// noticeably.
const NOTICEABLE_GROWTH: f64 = 1.05;

/// Factor between the numbers of waves that are compared, and how many of them: up to the greatest growth.
const STEP: f64 = 1.15;
const STEPS: i32 = 10;

/// The waves of a round, and the length of its record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    /// Number of waves that are followed to the record's end.
    pub waves: u32,
    /// Number of waves of the onset: `waves` or more.
    pub onset_waves: u32,
    /// Number of waves of early arrivals. Without an onset it is at least `waves`, and these waves are not counted as
    /// effort.
    pub early_waves: u32,
    /// Length of the record in seconds.
    pub seconds: f64,
    /// The onset of the round's listeners; `None` if all waves are followed to the end.
    onset: Option<OnsetTime>,
    /// The time of a wave of early arrivals, relative to the time of a wave that is followed to the record's end. 0 before
    /// the first round.
    early_share: f64,
    /// Whether the round traces all its waves, although they could extend those of the round before: that round has more
    /// waves of the onset than the limit of waves allows besides.
    pub begins_anew: bool,
}

/// The time that rounds took, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Took {
    /// The last round.
    pub last_s: f64,
    /// All rounds whose waves a further round extends; `None` if the listeners do not keep their waves.
    pub extended_s: Option<f64>,
}

/// The onset of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OnsetTime {
    /// Length after the direct sound, in seconds.
    length_s: f64,
    /// The time of a wave of the onset, relative to the time of a wave that is followed to the record's end.
    share: f64,
}

impl Effort {
    /// The effort of the first round for listeners of one source.
    pub fn first(
        pairs: &[Pair],
        settings: &ResponseSettings,
        accuracy: &Accuracy,
        seconds: f64,
    ) -> Effort {
        let most = accuracy.most_waves.unwrap_or(FIRST_WAVES);
        let effort = Effort {
            waves: FIRST_FOLLOWED.min(most),
            onset_waves: FIRST_WAVES.min(most),
            early_waves: settings.trace.waves,
            seconds,
            onset: None,
            early_share: 0.0,
            begins_anew: false,
        };
        effort.of_pairs(pairs, settings)
    }

    /// This effort for a round with these pairs. All waves are followed to the end if no pair can have an onset.
    pub fn of_pairs(self, pairs: &[Pair], settings: &ResponseSettings) -> Effort {
        let of_pair = |pair: &Pair| {
            let (directions, direct_s) = (settings.trace.directions, Medium::of(*pair).direct_s);
            Onset::of_record(*pair, directions, direct_s, self.seconds)
        };
        let found = pairs.iter().filter_map(of_pair);
        let longest = found.reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)));
        let onset = longest.map(|(length_s, share)| OnsetTime { length_s, share });
        let waves = if onset.is_some() {
            self.waves
        } else {
            self.onset_waves
        };
        Effort {
            waves,
            onset,
            ..self
        }
    }

    /// The effort that serves both.
    pub fn and(self, other: Effort) -> Effort {
        Effort {
            waves: self.waves.max(other.waves),
            onset_waves: self.onset_waves.max(other.onset_waves),
            early_waves: self.early_waves.max(other.early_waves),
            seconds: self.seconds.max(other.seconds),
            begins_anew: self.begins_anew || other.begins_anew,
            ..self
        }
    }

    /// The settings of a round with this effort. Without an onset, the number of waves of early arrivals is raised to the
    /// number of followed waves if it is smaller.
    pub fn settings(self, settings: &ResponseSettings) -> ResponseSettings {
        let onset = self.onset.map(|onset| Onset {
            waves: self.onset_waves,
            seconds: onset.length_s,
        });
        let mut settings = ResponseSettings {
            accuracy: None,
            seconds: Some(self.seconds),
            late_waves: Some(self.waves),
            onset,
            ..settings.clone()
        };
        settings.trace.waves = match onset {
            Some(_) => self.early_waves,
            None => self.early_waves.max(self.waves),
        };
        settings
    }

    /// The effort of the next round after a response of this effort.
    ///
    /// # Errors
    /// Why none follows: its figures are accurate, or all waves are spent.
    pub fn further(
        self,
        traced: &Traced,
        pair: Pair,
        settings: &ResponseSettings,
        accuracy: &Accuracy,
    ) -> Result<Effort, Ended> {
        let response = &traced.response;
        let can_grow = settings.seconds.is_none() && decays(pair);
        let seconds = match can_grow && is_cut_off(&response.figures, &response.energy()) {
            true => (LONGER * self.seconds).min(settings.longest_s.max(self.seconds)),
            false => self.seconds,
        };
        let iterations = response.counts.iterations.max(1);
        let order = settings.order_in(pair.scene);
        let early_groups = tracer::early_band_groups(pair.scene, order).len();
        let late_groups = tracer::resampled_band_groups(pair.scene).len();
        let groups = early_groups as f64 / late_groups as f64;
        let now = Effort {
            early_share: groups * f64::from((order + 1).min(iterations)) / f64::from(iterations),
            begins_anew: false,
            ..self
        };
        let demands = now.demands(traced, pair, accuracy);
        let grown = now.grown(&demands).within(now, iterations, accuracy);
        match demands.iter().any(Demand::is_open) {
            true if grown.exceeds(now) => Ok(Effort { seconds, ..grown }),
            _ if seconds > now.seconds => Ok(Effort { seconds, ..now }),
            true => Err(accuracy.limit_of_waves(iterations)),
            false => Err(Ended::NothingOpen),
        }
    }

    /// The demands of a response's figures.
    fn demands(self, traced: &Traced, pair: Pair, accuracy: &Accuracy) -> Vec<Demand> {
        let response = &traced.response;
        // The shares take as long as the figures, and accurate figures need none.
        let is_open = response.figures.waves_for(accuracy.share) > 1.0;
        let onset = self.onset.filter(|_| is_open);
        let parts = onset.map(|onset| Parts {
            early: &traced.in_own_sphere,
            early_can_grow: traced.is_search_complete,
            onset_s: Medium::of(pair).direct_s + onset.length_s,
        });
        let taps = taps_of_energy(&response.paths);
        let ends_s = response.followed_s.unwrap_or(response.seconds);
        let record = Record::new(&taps, &response.echogram, ends_s);
        let direct_s = response.direct().map(|path| path.delay_s);
        response
            .figures
            .demands(accuracy.share, &record, direct_s, parts)
    }

    /// The waves that fulfil the demands and take the least time. If the greatest growth does not fulfil them: of those
    /// that come close to it.
    fn grown(self, demands: &[Demand]) -> Effort {
        if self.onset.is_none() {
            let factor = demands.iter().map(Demand::factor).fold(0.0, f64::max);
            let waves = grown(self.waves, factor);
            return Effort {
                waves,
                onset_waves: waves,
                ..self
            };
        }
        let left = |growth: Growth| {
            let left = demands.iter().map(|demand| demand.left(growth));
            left.fold(0.0, f64::max)
        };
        let least = left(Growth {
            early: GREATEST_GROWTH,
            onset: GREATEST_GROWTH,
            followed: GREATEST_GROWTH,
        });
        // Another round follows if the greatest growth does not fulfil the demands.
        let accepted = if least <= 1.0 { 1.0 } else { SPARE * least };
        let steps = (0..=STEPS).flat_map(|early| (0..=STEPS).map(move |late| (early, late)));
        let of_step = |(early, late): (i32, i32)| {
            let early_waves = grown(self.early_waves, STEP.powi(early));
            let waves = grown(self.waves, STEP.powi(late));
            let mut growth = Growth {
                early: growth(self.early_waves, early_waves),
                onset: 1.0,
                followed: growth(self.waves, waves),
            };
            let onset = demands
                .iter()
                .map(|demand| demand.onset_factor(growth, accepted));
            let onset_waves = grown(self.onset_waves, onset.fold(0.0, f64::max));
            // All waves pass through the onset.
            let onset_waves = onset_waves.max(self.onset_waves + (waves - self.waves));
            growth.onset = self::growth(self.onset_waves, onset_waves);
            let effort = Effort {
                waves,
                onset_waves,
                early_waves,
                ..self
            };
            (left(growth) <= accepted).then_some(effort)
        };
        let fulfilling = steps.filter_map(of_step);
        let shortest = fulfilling.min_by(|a, b| a.flight_s().total_cmp(&b.flight_s()));
        shortest.unwrap_or(self)
    }

    /// Whether the waves of this effort are further waves of `last`: its waves start evenly, and the record is the same.
    pub fn extends(self, last: Effort) -> bool {
        let is_same = self.onset == last.onset && self.seconds == last.seconds;
        self.onset.is_some() && is_same && !self.begins_anew
    }

    /// Whether a round of this effort improves on one of `last` noticeably.
    pub fn exceeds(self, last: Effort) -> bool {
        self.seconds > last.seconds || self.grows(last, NOTICEABLE_GROWTH)
    }

    /// Whether a kind of waves is at least `factor` times that of `last`.
    fn grows(self, last: Effort, factor: f64) -> bool {
        let is_enough = |now: u32, last: u32| f64::from(now) >= factor * f64::from(last);
        is_enough(self.waves, last.waves)
            || is_enough(self.onset_waves, last.onset_waves)
            || is_enough(self.early_waves, last.early_waves)
    }

    /// Time in seconds that all waves fly.
    fn flight_s(self) -> f64 {
        let share = self.onset.map_or(1.0, |onset| onset.share);
        let in_onset = f64::from(self.onset_waves.saturating_sub(self.waves));
        let early = self
            .onset
            .map_or(0.0, |_| self.early_share * f64::from(self.early_waves));
        self.seconds * (f64::from(self.waves) + share * in_onset + early)
    }

    /// This effort, or the part of its growth since `last` that flies at most `flight_s` seconds. `None` if not even the
    /// waves of `last` fit.
    fn limited(self, last: Effort, flight_s: f64) -> Option<Effort> {
        if self.flight_s() <= flight_s {
            return Some(self);
        }
        let least = Effort {
            waves: self.waves.min(last.waves),
            onset_waves: self.onset_waves.min(last.onset_waves),
            early_waves: self.early_waves.min(last.early_waves),
            ..self
        };
        let part = (flight_s - least.flight_s()) / (self.flight_s() - least.flight_s());
        let between = |least: u32, most: u32| least + (part * f64::from(most - least)) as u32;
        (part >= 0.0).then(|| Effort {
            waves: between(least.waves, self.waves),
            onset_waves: between(least.onset_waves, self.onset_waves),
            early_waves: between(least.early_waves, self.early_waves),
            ..self
        })
    }

    /// This effort within the limits of an accuracy, but at least that of `last`. A wave that ends after the onset counts
    /// as a part of a wave.
    pub fn within(self, last: Effort, iterations: u32, accuracy: &Accuracy) -> Effort {
        let most = accuracy.most_waves(iterations, FIRST_WAVES);
        let limited = self.limited(last, f64::from(most) * self.seconds);
        let limited = limited.unwrap_or(Effort {
            seconds: self.seconds,
            ..last
        });
        let most_asked = accuracy.most_waves_asked();
        let onset_waves = limited.onset_waves.min(most_asked);
        let waves = limited.waves.min(most_asked);
        // All waves pass through the onset.
        let most_further = onset_waves.saturating_sub(last.onset_waves);
        let is_too_many = self.extends(last) && waves > last.waves + most_further;
        Effort {
            waves,
            onset_waves,
            begins_anew: self.begins_anew || is_too_many,
            early_waves: limited.early_waves.min(most_asked.max(last.early_waves)),
            ..limited
        }
    }

    /// This effort with at most as many waves as fit `left_s` seconds, if rounds up to the effort `last` took this time;
    /// `None` if that is less than [`LEAST_GROWTH`] times the waves of `last`. The predicted time is rather too long,
    /// because parts of a round, such as the search for exact paths, do not grow with the waves.
    pub fn fitting(self, left_s: f64, last: Effort, took: Took) -> Option<Effort> {
        // The first round does not know the time of a wave of early arrivals.
        let last = Effort {
            early_share: self.early_share,
            ..last
        };
        let times_last = match took.extended_s.filter(|_| self.extends(last)) {
            Some(extended_s) => 1.0 + left_s / extended_s,
            None => left_s / took.last_s,
        };
        let fitting = self.limited(last, last.flight_s() * times_last)?;
        let is_worth_it = fitting == self || fitting.grows(last, LEAST_GROWTH);
        is_worth_it.then_some(fitting)
    }
}

/// Number of waves after growth by a factor, with the spare, between the least and the greatest growth; the same number
/// for a factor of at most 1.
fn grown(waves: u32, factor: f64) -> u32 {
    if factor <= 1.0 {
        return waves;
    }
    let growth = (SPARE * factor).clamp(LEAST_GROWTH, GREATEST_GROWTH);
    (f64::from(waves) * growth) as u32
}

/// The factor between two numbers of waves.
fn growth(now: u32, next: u32) -> f64 {
    f64::from(next) / f64::from(now.max(1))
}

/// Whether sound decays in the scene.
fn decays(pair: Pair) -> bool {
    pair.scene.has_materials() || pair.scene.air.is_some()
}

/// Whether a longer record is needed: the decay of a band does not end in this one, or it is known and T30 is not defined
/// for all waves or for half of them. `energy` is that of all arrivals by band.
fn is_cut_off(figures: &Figures, energy: &Bands) -> bool {
    let mut heard = (0..BAND_COUNT).filter(|band| energy[*band] > 0.0);
    heard.any(|band| {
        let most = match (figures.bands[band].edt_s, figures.lacks_t30_in_halves(band)) {
            (Some(_), false) => Figures::most_cut_off(),
            (Some(_), true) => MOST_CUT_OFF_IN_HALVES * Figures::most_cut_off(),
            // A few late arrivals do not show a decay.
            (None, _) => MOST_CUT_OFF,
        };
        figures.cut_off[band].is_none_or(|share| share > most)
    })
}

#[cfg(test)]
mod tests;
