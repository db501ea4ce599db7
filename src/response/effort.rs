//! The effort of a round: numbers of waves and the length of the record, and what the next round takes.
//!
//! Three kinds of waves cause noise. The waves of early arrivals find exact paths and fly a few reflections. The waves of
//! the onset end after the first part of the record, and the others are followed to the record's end. The noise of each
//! figure is attributed to them, and the numbers grow where the noise is.

use super::accuracy::Accuracy;
use super::figures::{Demand, Growth, Parts, Record};
use super::late::Onset;
use super::shared::Traced;
use super::source_sound::Medium;
use super::{Response, ResponseSettings};
use crate::scene::Pair;

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

/// The share of the energy beyond a record's end from which on a further round has a longer record. Ten times this
/// share withholds figures.
const MOST_CUT_OFF: f64 = 1e-3;

/// The least growth of a further round's flights. A round with less growth would not change the figures noticeably.
const LEAST_MORE_FLIGHTS: f64 = 1.05;

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
}

/// The time that rounds took, in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Took {
    /// The last round.
    pub last_s: f64,
    /// All rounds, with the estimate of the length.
    pub all_s: f64,
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
            ..self
        }
    }

    /// The settings of a round with this effort. Without an onset, the number of waves of early arrivals is raised to the
    /// number of followed waves if it is smaller.
    pub fn settings(self, settings: &ResponseSettings) -> ResponseSettings {
        let onset = self.onset.map(|onset| Onset {
            followed: self.waves,
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

    /// The effort of the next round after a response of this effort; `None` if its figures are accurate, or if all
    /// waves are spent.
    pub fn further(
        self,
        traced: &Traced,
        pair: Pair,
        settings: &ResponseSettings,
        accuracy: &Accuracy,
    ) -> Option<Effort> {
        let response = &traced.response;
        let can_grow = settings.seconds.is_none() && decays(pair);
        let seconds = match can_grow && is_cut_off(response) {
            true => (LONGER * self.seconds).min(settings.longest_s.max(self.seconds)),
            false => self.seconds,
        };
        let iterations = response.counts.iterations.max(1);
        let early_iterations = settings.order_in(pair.scene) + 1;
        let now = Effort {
            early_share: f64::from(early_iterations.min(iterations)) / f64::from(iterations),
            ..self
        };
        let demands = now.demands(traced, pair, accuracy);
        let grown = now.grown(&demands).within(now, iterations, accuracy);
        let is_spent = grown.flight_s() < LEAST_MORE_FLIGHTS * now.flight_s();
        match (demands.iter().any(Demand::is_open), is_spent) {
            (true, false) => Some(Effort { seconds, ..grown }),
            _ if seconds > now.seconds => Some(Effort { seconds, ..now }),
            _ => None,
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
            onset_s: Medium::of(pair).direct_s + onset.length_s,
        });
        let taps = response.taps();
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
        let steps = (0..=STEPS).flat_map(|early| (0..=STEPS).map(move |late| (early, late)));
        let of_step = |(early, late): (i32, i32)| {
            let early_waves = grown(self.early_waves, STEP.powi(early));
            let waves = grown(self.waves, STEP.powi(late));
            let mut growth = Growth {
                early: growth(self.early_waves, early_waves),
                onset: 1.0,
                followed: growth(self.waves, waves),
            };
            let onset = demands.iter().map(|demand| demand.onset_factor(growth));
            let onset_waves = grown(self.onset_waves, onset.fold(0.0, f64::max));
            // All waves pass through the onset.
            let onset_waves = onset_waves.max(self.onset_waves + (waves - self.waves));
            growth.onset = self::growth(self.onset_waves, onset_waves);
            let left = demands.iter().map(|demand| demand.left(growth));
            let effort = Effort {
                waves,
                onset_waves,
                early_waves,
                ..self
            };
            (left.fold(0.0, f64::max), effort)
        };
        let steps: Vec<(f64, Effort)> = steps.map(of_step).collect();
        let least = steps
            .iter()
            .map(|(left, _)| *left)
            .fold(f64::INFINITY, f64::min);
        // Where the greatest growth does not fulfil the demands, another round follows.
        let accepted = if least <= 1.0 { 1.0 } else { SPARE * least };
        let fulfilling = steps.into_iter().filter(|(left, _)| *left <= accepted);
        let shortest = fulfilling.min_by(|(_, a), (_, b)| a.flight_s().total_cmp(&b.flight_s()));
        shortest.map_or(self, |(_, effort)| effort)
    }

    /// Whether the waves of this effort are further waves of `last`: its waves start evenly, and the record is the same.
    fn extends(self, last: Effort) -> bool {
        self.onset.is_some() && self.onset == last.onset && self.seconds == last.seconds
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
        // All waves pass through the onset.
        let most_further = onset_waves.saturating_sub(last.onset_waves);
        let most = match self.extends(last) {
            true => last.waves + most_further,
            false => most_asked,
        };
        Effort {
            waves: limited.waves.min(most),
            onset_waves,
            early_waves: limited.early_waves.min(most_asked.max(last.early_waves)),
            ..limited
        }
    }

    /// This effort with at most as many waves as fit `left_s` seconds, if rounds up to the effort `last` took this time;
    /// `None` if that is less than [`LEAST_GROWTH`] times the waves of `last`. The predicted time is rather too long,
    /// because parts of a round, such as the search for exact paths, do not grow with the waves.
    pub fn fitting(self, left_s: f64, last: Effort, took: Took) -> Option<Effort> {
        let times_last = match self.extends(last) {
            true => 1.0 + left_s / took.all_s,
            false => left_s / took.last_s,
        };
        let fitting = self.limited(last, last.flight_s() * times_last)?;
        let grows = |waves: u32, last: u32| f64::from(waves) >= LEAST_GROWTH * f64::from(last);
        let is_worth_it = fitting == self
            || grows(fitting.waves, last.waves)
            || grows(fitting.onset_waves, last.onset_waves)
            || grows(fitting.early_waves, last.early_waves);
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

/// Whether sound arrives after the record's end in any band.
fn is_cut_off(response: &Response) -> bool {
    let cut_off = response.figures.cut_off.iter();
    let mut of_heard = cut_off.zip(response.energy()).filter(|(_, e)| *e > 0.0);
    of_heard.any(|(share, _)| share.is_none_or(|share| share > MOST_CUT_OFF))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::gl::{Context, ContextOptions};
    use crate::tracer::Tracer;

    const EFFORT: Effort = Effort {
        waves: 4096,
        onset_waves: 16_384,
        early_waves: 65_536,
        seconds: 1.0,
        onset: Some(OnsetTime {
            length_s: 0.17,
            share: 0.2,
        }),
        early_share: 0.0,
    };

    fn demand(noise: f64, onset_share: f64) -> Demand {
        Demand {
            noise,
            early_share: 0.0,
            onset_share,
            least: 0.0,
        }
    }

    /// The time of a first round.
    fn took(seconds: f64) -> Took {
        Took {
            last_s: seconds,
            all_s: seconds,
        }
    }

    /// An effort without an onset.
    fn even(waves: u32, seconds: f64) -> Effort {
        Effort {
            waves,
            onset_waves: waves,
            early_waves: 65_536,
            seconds,
            onset: None,
            early_share: 0.0,
        }
    }

    /// Protects the time of a response: noise of the onset asks for waves of the onset, noise of the late decay for waves
    /// that are followed to the end, noise of early arrivals for waves that find exact paths, and accurate figures for
    /// none.
    #[test]
    fn waves_are_added_where_the_noise_is() {
        let grown = |demands: &[Demand]| EFFORT.grown(demands);
        assert_eq!(grown(&[demand(0.9, 0.5)]), EFFORT);
        let early = grown(&[demand(2.0, 1.0), demand(0.5, 0.0)]);
        assert_eq!((early.waves, early.onset_waves), (4096, 39_321));
        let late = grown(&[demand(2.0, 0.0)]);
        let further = late.waves - 4096;
        assert!(further >= 4096, "{late:?}");
        assert_eq!(late.onset_waves, 16_384 + further);
        let found = Demand {
            early_share: 1.0,
            ..demand(2.0, 0.0)
        };
        let early = grown(&[found, demand(0.5, 0.0)]);
        assert!(early.early_waves >= 2 * 65_536, "{early:?}");
        assert_eq!((early.waves, early.onset_waves), (4096, 16_384));
        // Noise that takes more than the greatest growth takes about the greatest growth.
        let much = grown(&[demand(1e4, 0.5)]);
        assert!((12_288..=16_384).contains(&much.waves), "{much:?}");
        assert_eq!(much.onset_waves, 65_536);
        assert_eq!(even(4096, 1.0).grown(&[demand(2.0, 1.0)]).waves, 9830);
    }

    /// Protects rounds from efforts that are known to be too small: if the growth suffices for a demand, the demand is
    /// fulfilled.
    #[test]
    fn demands_are_fulfilled_at_once() {
        for noise in [1.5, 2.0, 2.5, 3.0] {
            for share in [0.0, 0.2, 0.3, 0.5, 0.8, 1.0] {
                let effort = EFFORT.grown(&[demand(noise, share)]);
                let onset = f64::from(effort.onset_waves) / 16_384.0;
                let followed = f64::from(effort.waves) / 4096.0;
                let left = noise * (share / onset + (1.0 - share) / followed);
                assert!(left <= 1.001, "{noise} {share}: {effort:?}, {left}");
            }
        }
    }

    /// Protects time limits: a round is made no longer than the time that is left, as the last round predicts it, and is
    /// not begun if it would hardly improve the result.
    #[test]
    fn a_round_fits_the_time_that_is_left() {
        let fitted = |wanted: Effort, left_s: f64| {
            let fitting = wanted.fitting(left_s, even(1000, 1.0), took(2.0));
            fitting.map(|effort| (effort.waves, effort.seconds))
        };
        assert_eq!(fitted(even(4000, 1.0), 8.0), Some((4000, 1.0)));
        assert_eq!(fitted(even(4000, 1.0), 6.0), Some((3000, 1.0)));
        assert_eq!(fitted(even(4000, 1.0), 3.0), Some((1500, 1.0)));
        assert_eq!(fitted(even(4000, 1.0), 2.9), None);
        // A longer record takes more time for each wave.
        assert_eq!(fitted(even(4000, 1.5), 6.0), Some((2000, 1.5)));
        assert_eq!(fitted(even(1000, 1.5), 3.0), Some((1000, 1.5)));
        assert_eq!(fitted(even(1000, 1.5), 2.9), None);
        // A small rest of the waves is traced if it fits.
        assert_eq!(fitted(even(1100, 1.0), 2.5), Some((1100, 1.0)));
        for left_s in [0.0, -1.0, f64::NAN] {
            assert_eq!(fitted(even(4000, 1.0), left_s), None);
        }
    }

    /// Protects the late decay and the onset from rounds with fewer waves than the round before: only the growth is
    /// reduced to the limits.
    #[test]
    fn limits_reduce_growth_only() {
        let wanted = Effort {
            onset_waves: 65_536,
            ..EFFORT
        };
        let half = wanted.fitting(1.5, EFFORT, took(2.0)).unwrap();
        assert_eq!(half.waves, 4096);
        assert!((24_576..50_000).contains(&half.onset_waves), "{half:?}");
        let large = Effort {
            waves: 100_000,
            onset_waves: 400_000,
            ..EFFORT
        };
        let wanted = Effort {
            waves: 400_000,
            onset_waves: 800_000,
            ..EFFORT
        };
        // 100 million waves times iterations.
        let within = wanted.within(large, 400, &Accuracy::default());
        assert!(
            within.waves >= 100_000 && within.onset_waves >= 400_000,
            "{within:?}"
        );
        assert!(within.flight_s() <= 250_000.0, "{within:?}");
        let few = Accuracy::default().with_most_waves(4500);
        let grown = Effort {
            onset_waves: 65_536,
            ..EFFORT
        };
        let asked = grown.within(even(4000, 1.0), 400, &few);
        assert!(
            asked.waves <= 4500 && asked.onset_waves <= 4500,
            "{asked:?}"
        );
    }

    /// A room whose walls scatter.
    fn scattering_room() -> Scene {
        let text = "Scene(surfaces: [Surface(shape: Room(size: (6, 3, 5)), material: \"m\")],
            materials: {\"m\": Material(absorption: 0.3, scattering: 0.3)},
            source: Source(position: (-1.5, 0.3, -1)), listener: Listener(position: (1.7, -0.2, 0.9), radius: 0.3))";
        Scene::from_ron(text, "room").unwrap()
    }

    /// Protects the two parts of a record: the late bins are those of the followed waves alone, and the bins of the onset
    /// have the energy of all waves, with less noise.
    #[test]
    fn only_the_onset_has_more_waves() {
        let mut tracer =
            Tracer::new(&Context::headless(&ContextOptions::default()).unwrap()).unwrap();
        let scene = scattering_room();
        let pair = scene.only_pair().unwrap();
        // Without exact paths the listener's own sphere counts all arrivals.
        let settings = ResponseSettings::default().with_order(0);
        let mut trace = |waves: u32, onset_waves: u32| {
            let effort = Effort {
                onset_waves,
                ..even(waves, 0.6)
            };
            // Without an onset all waves would be followed to the end.
            let effort = effort.of_pairs(&[pair], &settings);
            let settings = effort.settings(&settings);
            Response::trace(&mut tracer, pair, &settings).unwrap()
        };
        let (few, dense, many) = (
            trace(2048, 2048),
            trace(2048, 32_768),
            trace(32_768, 32_768),
        );
        let onset = even(1, 0.6).of_pairs(&[pair], &settings).onset.unwrap();
        let until = (few.echogram).bins_before(Medium::of(pair).direct_s + onset.length_s);
        assert!(until > 80 && few.echogram.bins() > 2 * until);
        for bin in until..few.echogram.bins() {
            assert_eq!(
                few.echogram.energy(bin),
                dense.echogram.energy(bin),
                "{bin}"
            );
        }
        let onset = |of: &Response| {
            (0..until)
                .map(|bin| of.echogram.energy(bin)[4])
                .sum::<f64>()
        };
        let off_by = |of: &Response| (onset(of) / onset(&many) - 1.0).abs();
        // Other waves of the same number would differ by 2 %.
        assert!(off_by(&dense) < 0.02, "{}", off_by(&dense));
        let noise = |of: &Response| of.figures.errors[4].c80_db.unwrap();
        assert!(
            noise(&dense) < 0.8 * noise(&few),
            "{} {}",
            noise(&dense),
            noise(&few)
        );
    }
}
