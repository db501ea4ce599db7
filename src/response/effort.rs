//! The effort of a round: numbers of waves and the length of the record, and what the next round takes.

use super::accuracy::Accuracy;
use super::figures::{Demand, Record};
use super::late::Onset;
use super::source_sound::Medium;
use super::{Response, ResponseSettings};
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

/// Factor between numbers of followed waves that are compared, and how many of them.
const STEP: f64 = 1.15;
const STEPS: i32 = 24;

/// The waves of a round, and the length of its record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Effort {
    /// Number of waves that are followed to the record's end.
    pub waves: u32,
    /// Number of waves of the onset: `waves` or more.
    pub onset_waves: u32,
    /// Length of the record in seconds.
    pub seconds: f64,
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
        let has_onset = pairs
            .iter()
            .any(|pair| onset(*pair, settings, seconds).is_some());
        let waves = if has_onset {
            FIRST_FOLLOWED
        } else {
            FIRST_WAVES
        };
        Effort {
            waves: waves.min(most),
            onset_waves: FIRST_WAVES.min(most),
            seconds,
        }
    }

    /// The effort that serves both.
    pub fn and(self, other: Effort) -> Effort {
        Effort {
            waves: self.waves.max(other.waves),
            onset_waves: self.onset_waves.max(other.onset_waves),
            seconds: self.seconds.max(other.seconds),
        }
    }

    /// The settings of a round with this effort. The number of waves for exact paths is raised to the number of followed
    /// waves if it is smaller.
    pub fn settings(self, pairs: &[Pair], settings: &ResponseSettings) -> ResponseSettings {
        let onsets = pairs
            .iter()
            .filter_map(|pair| onset(*pair, settings, self.seconds));
        let length_s = onsets.map(|(length_s, _)| length_s).reduce(f64::max);
        let onset = length_s.map(|seconds| Onset {
            waves: self.onset_waves,
            seconds,
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
        let (demands, share) = demands(self, response, pair, settings, accuracy);
        let most = accuracy.most_waves(response.counts.iterations, FIRST_WAVES);
        let grown = self.grown(&demands, share).within(most, share, accuracy);
        let is_spent = grown.waves <= self.waves && grown.onset_waves <= self.onset_waves;
        match (demands.iter().any(Demand::is_open), is_spent) {
            (true, false) => Some(Effort { seconds, ..grown }),
            _ if seconds > self.seconds => Some(Effort { seconds, ..self }),
            _ => None,
        }
    }

    /// This effort with at most as many waves as fit `left_s` seconds, if a round of the effort `last` took `last_s`
    /// seconds; `None` if that is less than [`LEAST_GROWTH`] times the waves of `last`. The prediction errs towards a
    /// round that is too long, because parts of a round, such as the search for exact paths, do not grow with the waves.
    pub fn fitting(self, left_s: f64, last: Effort, last_s: f64) -> Option<Effort> {
        let share = (left_s / last_s) * (last.flight_s() / self.flight_s());
        if share >= 1.0 {
            return Some(self);
        }
        let fit = |waves: u32| (f64::from(waves) * share) as u32;
        let waves = fit(self.waves);
        let onset_waves = fit(self.onset_waves).max(waves);
        let grows = |waves: u32, last: u32| f64::from(waves) >= LEAST_GROWTH * f64::from(last);
        let is_worth_it = grows(waves, last.waves) || grows(onset_waves, last.onset_waves);
        is_worth_it.then_some(Effort {
            waves,
            onset_waves,
            ..self
        })
    }

    /// Time in seconds that all waves fly.
    fn flight_s(self) -> f64 {
        let in_onset = f64::from(self.onset_waves.saturating_sub(self.waves));
        self.seconds * (f64::from(self.waves) + Onset::SHARE * in_onset)
    }

    /// The waves that fulfil the demands in the least time. `share` is the time of a wave of the onset relative to that
    /// of a wave that is followed to the end; `None` without an onset.
    fn grown(self, demands: &[Demand], share: Option<f64>) -> Effort {
        let Some(share) = share else {
            let factor = demands.iter().map(Demand::factor).fold(0.0, f64::max);
            let waves = grown(self.waves, factor);
            return Effort {
                waves,
                onset_waves: waves,
                ..self
            };
        };
        let time = |of: &Effort| {
            f64::from(of.waves) + share * f64::from(of.onset_waves.saturating_sub(of.waves))
        };
        let of_step = |step: i32| {
            let followed = STEP.powi(step);
            let onset = demands
                .iter()
                .map(|demand| demand.onset_factor(followed))
                .fold(0.0, f64::max);
            let is_possible = onset.is_finite();
            let waves = grown(self.waves, if step == 0 { 1.0 } else { followed });
            let onset_waves = grown(self.onset_waves, onset).max(waves);
            is_possible.then_some(Effort {
                waves,
                onset_waves,
                ..self
            })
        };
        let least = (0..=STEPS)
            .filter_map(of_step)
            .min_by(|a, b| time(a).total_cmp(&time(b)));
        // More than the greatest growth is demanded.
        least.unwrap_or(Effort {
            waves: grown(self.waves, GREATEST_GROWTH),
            onset_waves: grown(self.onset_waves, GREATEST_GROWTH),
            ..self
        })
    }

    /// This effort within the limits: `most` waves that are followed to the end take the greatest time.
    fn within(self, most: u32, share: Option<f64>, accuracy: &Accuracy) -> Effort {
        let waves = self.waves.min(most);
        let left = f64::from(most - waves) / share.unwrap_or(1.0);
        let most_onset = (f64::from(waves) + left).min(accuracy.most_waves_asked().into()) as u32;
        Effort {
            waves,
            onset_waves: self.onset_waves.min(most_onset).max(waves),
            ..self
        }
    }
}

/// The length in seconds of the onset of a pair's record, and the time of its waves relative to waves that are followed
/// to the end ([`Onset::of_record`]).
fn onset(pair: Pair, settings: &ResponseSettings, seconds: f64) -> Option<(f64, f64)> {
    Onset::of_record(
        pair,
        settings.trace.directions,
        Medium::of(pair).direct_s,
        seconds,
    )
}

/// The demands of a response's figures, and the relative time of a wave of the onset.
fn demands(
    effort: Effort,
    response: &Response,
    pair: Pair,
    settings: &ResponseSettings,
    accuracy: &Accuracy,
) -> (Vec<Demand>, Option<f64>) {
    let onset = onset(pair, settings, effort.seconds);
    let onset_s = onset.map(|(length_s, _)| Medium::of(pair).direct_s + length_s);
    let taps = response.taps();
    let ends_s = response.followed_s.unwrap_or(response.seconds);
    let record = Record::new(&taps, &response.echogram, ends_s);
    let direct_s = response.direct().map(|path| path.delay_s);
    let demands = response
        .figures
        .demands(accuracy.share, &record, direct_s, onset_s);
    (demands, onset.map(|(_, share)| share))
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
    };

    fn demand(noise: f64, onset_share: f64) -> Demand {
        Demand {
            noise,
            onset_share,
            least: 0.0,
        }
    }

    /// Protects the time of a response: noise of the onset asks for waves of the onset, noise of the late decay for waves
    /// that are followed to the end, and accurate figures for none.
    #[test]
    fn waves_are_added_where_the_noise_is() {
        let share = Some(0.2);
        let grown = |demands: &[Demand]| EFFORT.grown(demands, share);
        assert_eq!(grown(&[demand(0.9, 0.5)]), EFFORT);
        let early = grown(&[demand(2.0, 1.0), demand(0.5, 0.0)]);
        assert_eq!((early.waves, early.onset_waves), (4096, 39_321));
        let late = grown(&[demand(2.0, 0.0)]);
        assert!(
            late.waves >= 2 * 4096 && late.onset_waves == 16_384,
            "{late:?}"
        );
        // Both parts make the same noise, so both need more waves.
        let both = grown(&[demand(2.0, 0.5)]);
        assert!(both.waves > 4096 && both.onset_waves > 16_384, "{both:?}");
        // An unknown noise, and one that takes more than the greatest growth, take the greatest growth.
        let much = grown(&[demand(1e4, 0.5)]);
        assert_eq!((much.waves, much.onset_waves), (16_384, 65_536));
        assert_eq!(EFFORT.grown(&[demand(2.0, 1.0)], None).waves, 9830);
    }

    /// Protects time limits: a round is made no longer than the time that is left, as the last round predicts it, and is
    /// not begun if it would hardly improve the result.
    #[test]
    fn a_round_fits_the_time_that_is_left() {
        let effort = |waves: u32, seconds: f64| Effort {
            waves,
            onset_waves: waves,
            seconds,
        };
        let fitted = |wanted: Effort, left_s: f64| {
            let fitting = wanted.fitting(left_s, effort(1000, 1.0), 2.0);
            fitting.map(|effort| (effort.waves, effort.seconds))
        };
        assert_eq!(fitted(effort(4000, 1.0), 8.0), Some((4000, 1.0)));
        assert_eq!(fitted(effort(4000, 1.0), 6.0), Some((3000, 1.0)));
        assert_eq!(fitted(effort(4000, 1.0), 3.0), Some((1500, 1.0)));
        assert_eq!(fitted(effort(4000, 1.0), 2.9), None);
        // A longer record takes more time for each wave.
        assert_eq!(fitted(effort(4000, 1.5), 6.0), Some((2000, 1.5)));
        assert_eq!(fitted(effort(1000, 1.5), 3.0), Some((1000, 1.5)));
        assert_eq!(fitted(effort(1000, 1.5), 2.9), None);
        // A small rest of the waves is traced if it fits.
        assert_eq!(fitted(effort(1100, 1.0), 2.5), Some((1100, 1.0)));
        for left_s in [0.0, -1.0, f64::NAN] {
            assert_eq!(fitted(effort(4000, 1.0), left_s), None);
        }
        // Waves that end after the onset take a sixth of the time.
        let onset = Effort {
            onset_waves: 7000,
            ..effort(1000, 1.0)
        };
        assert_eq!(onset.fitting(4.0, effort(1000, 1.0), 2.0), Some(onset));
        let half = onset.fitting(2.0, effort(1000, 1.0), 2.0).unwrap();
        assert_eq!((half.waves, half.onset_waves), (500, 3500));
    }

    /// Protects the limits of waves and of time.
    #[test]
    fn efforts_keep_their_limits() {
        let within = |accuracy: &Accuracy| EFFORT.within(5096, Some(0.2), accuracy);
        assert_eq!(within(&Accuracy::default()).onset_waves, 9096);
        let few = Accuracy::default().with_most_waves(4500);
        assert_eq!((within(&few).waves, within(&few).onset_waves), (4096, 4500));
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
                waves,
                onset_waves,
                seconds: 0.6,
            };
            let settings = effort.settings(&[pair], &settings);
            Response::trace(&mut tracer, pair, &settings).unwrap()
        };
        let (few, dense, many) = (
            trace(2048, 2048),
            trace(2048, 32_768),
            trace(32_768, 32_768),
        );
        let (length_s, _) = onset(pair, &settings, 0.6).unwrap();
        let until = (few.echogram).bins_before(Medium::of(pair).direct_s + length_s);
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
