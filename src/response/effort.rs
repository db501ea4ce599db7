//! The effort of a round: numbers of waves and the length of the record, and what the next round takes.

use super::accuracy::Accuracy;
use super::figures::{Demand, Record};
use super::late::Onset;
use super::source_sound::Medium;
use super::{Response, ResponseSettings, taps_of_energy};
use crate::scene::Pair;

/// Number of waves of the first round. In rooms its errors predict the number of waves that the accuracy takes.
const FIRST_WAVES: u32 = 1 << 14;

/// Number of waves that the first round follows to the record's end if the other waves end after the onset.
const FIRST_FOLLOWED: u32 = 1 << 12;

/// Factor of the predicted number of waves. The errors of 16 batches are themselves uncertain by 18 %.
const SPARE: f64 = 1.2;

/// The least growth of a further round. With less growth many rounds would repeat most of their work.
const LEAST_GROWTH: f64 = 1.5;

/// The greatest growth of a further round. Errors of few waves do not predict more.
const GREATEST_GROWTH: f64 = 4.0;

/// Factor of the record's length if sound continues after its end.
const LONGER: f64 = 1.5;

/// The share of the energy beyond a record's end from which on a further round has a longer record. Ten times this
/// share withholds figures.
const MOST_CUT_OFF: f64 = 1e-3;

/// Factor between the numbers of followed waves that are compared, and how many of them: up to the greatest growth.
const STEP: f64 = 1.15;
const STEPS: i32 = 10;

/// The waves of a round, and the length of its record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    /// Number of waves that are followed to the record's end.
    pub waves: u32,
    /// Number of waves of the onset: `waves` or more.
    pub onset_waves: u32,
    /// Length of the record in seconds.
    pub seconds: f64,
    /// The onset of the round's listeners; `None` if all waves are followed to the end.
    onset: Option<OnsetTime>,
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
            seconds,
            onset: None,
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
            seconds: self.seconds.max(other.seconds),
            ..self
        }
    }

    /// The settings of a round with this effort. The number of waves for exact paths is raised to the number of followed
    /// waves if it is smaller.
    pub fn settings(self, settings: &ResponseSettings) -> ResponseSettings {
        let onset = self.onset.map(|onset| Onset {
            waves: self.onset_waves,
            seconds: onset.length_s,
        });
        let mut settings = ResponseSettings {
            accuracy: None,
            seconds: Some(self.seconds),
            late_waves: Some(self.waves),
            onset: onset.filter(|onset| onset.waves > self.waves),
            ..settings.clone()
        };
        settings.trace.waves = settings.trace.waves.max(self.waves);
        settings
    }

    /// The effort of the next round after a response of this effort; `None` if its figures are accurate, or if all
    /// waves are spent.
    pub fn further(
        self,
        response: &Response,
        pair: Pair,
        settings: &ResponseSettings,
        accuracy: &Accuracy,
    ) -> Option<Effort> {
        let can_grow = settings.seconds.is_none() && decays(pair);
        let seconds = match can_grow && is_cut_off(response) {
            true => (LONGER * self.seconds).min(settings.longest_s.max(self.seconds)),
            false => self.seconds,
        };
        let demands = self.demands(response, pair, accuracy);
        let grown = self
            .grown(&demands)
            .within(self, response.counts.iterations, accuracy);
        let is_spent = grown.waves <= self.waves && grown.onset_waves <= self.onset_waves;
        match (demands.iter().any(Demand::is_open), is_spent) {
            (true, false) => Some(Effort { seconds, ..grown }),
            _ if seconds > self.seconds => Some(Effort { seconds, ..self }),
            _ => None,
        }
    }

    /// The demands of a response's figures.
    fn demands(self, response: &Response, pair: Pair, accuracy: &Accuracy) -> Vec<Demand> {
        // The shares of the onset take as long as the figures, and accurate figures need none.
        let is_open = response.figures.waves_for(accuracy.share) > 1.0;
        let onset = self.onset.filter(|_| is_open);
        let onset_s = onset.map(|onset| Medium::of(pair).direct_s + onset.length_s);
        let taps = taps_of_energy(&response.paths);
        let ends_s = response.followed_s.unwrap_or(response.seconds);
        let record = Record::new(&taps, &response.echogram, ends_s);
        let direct_s = response.direct().map(|path| path.delay_s);
        response
            .figures
            .demands(accuracy.share, &record, direct_s, onset_s)
    }

    /// The waves that come closest to the demands, and among those that fulfil them the waves that take the least time.
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
        let growth = |now: u32, next: u32| f64::from(next) / f64::from(now.max(1));
        let of_step = |step: i32| {
            let waves = grown(self.waves, STEP.powi(step));
            let followed = growth(self.waves, waves);
            let onset = demands.iter().map(|demand| demand.onset_factor(followed));
            let onset_waves = grown(self.onset_waves, onset.fold(0.0, f64::max)).max(waves);
            let onset = growth(self.onset_waves, onset_waves);
            let left = demands.iter().map(|demand| demand.left(onset, followed));
            let effort = Effort {
                waves,
                onset_waves,
                ..self
            };
            (left.fold(1.0, f64::max), effort)
        };
        let closest = (0..=STEPS).map(of_step).min_by(|(a_left, a), (b_left, b)| {
            let by_time = || a.flight_s().total_cmp(&b.flight_s());
            a_left.total_cmp(b_left).then_with(by_time)
        });
        closest.map_or(self, |(_, effort)| effort)
    }

    /// Time in seconds that all waves fly.
    fn flight_s(self) -> f64 {
        let share = self.onset.map_or(1.0, |onset| onset.share);
        let in_onset = f64::from(self.onset_waves.saturating_sub(self.waves));
        self.seconds * (f64::from(self.waves) + share * in_onset)
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
            ..self
        };
        let part = (flight_s - least.flight_s()) / (self.flight_s() - least.flight_s());
        let between = |least: u32, most: u32| least + (part * f64::from(most - least)) as u32;
        (part >= 0.0).then(|| Effort {
            waves: between(least.waves, self.waves),
            onset_waves: between(least.onset_waves, self.onset_waves),
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
        Effort {
            waves: limited.waves.min(most_asked),
            onset_waves: limited.onset_waves.min(most_asked),
            ..limited
        }
    }

    /// This effort with at most as many waves as fit `left_s` seconds, if a round of the effort `last` took `last_s`
    /// seconds; `None` if that is less than [`LEAST_GROWTH`] times the waves of `last`. The predicted time is rather too
    /// long, because parts of a round, such as the search for exact paths, do not grow with the waves.
    pub fn fitting(self, left_s: f64, last: Effort, last_s: f64) -> Option<Effort> {
        let fitting = self.limited(last, last.flight_s() * (left_s / last_s))?;
        let grows = |waves: u32, last: u32| f64::from(waves) >= LEAST_GROWTH * f64::from(last);
        let is_worth_it = fitting == self
            || grows(fitting.waves, last.waves)
            || grows(fitting.onset_waves, last.onset_waves);
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
        seconds: 1.0,
        onset: Some(OnsetTime {
            length_s: 0.17,
            share: 0.2,
        }),
    };

    fn demand(noise: f64, onset_share: f64) -> Demand {
        Demand {
            noise,
            onset_share,
            least: 0.0,
        }
    }

    /// An effort without an onset.
    fn even(waves: u32, seconds: f64) -> Effort {
        Effort {
            waves,
            onset_waves: waves,
            seconds,
            onset: None,
        }
    }

    /// Protects the time of a response: noise of the onset asks for waves of the onset, noise of the late decay for waves
    /// that are followed to the end, and accurate figures for none.
    #[test]
    fn waves_are_added_where_the_noise_is() {
        let grown = |demands: &[Demand]| EFFORT.grown(demands);
        assert_eq!(grown(&[demand(0.9, 0.5)]), EFFORT);
        let early = grown(&[demand(2.0, 1.0), demand(0.5, 0.0)]);
        assert_eq!((early.waves, early.onset_waves), (4096, 39_321));
        let late = grown(&[demand(2.0, 0.0)]);
        assert!(
            late.waves >= 2 * 4096 && late.onset_waves == 16_384,
            "{late:?}"
        );
        // Noise that takes more than the greatest growth takes the greatest growth.
        let much = grown(&[demand(1e4, 0.5)]);
        assert_eq!((much.waves, much.onset_waves), (16_384, 65_536));
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
            let fitting = wanted.fitting(left_s, even(1000, 1.0), 2.0);
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
        let half = wanted.fitting(3.5, EFFORT, 2.0).unwrap();
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
