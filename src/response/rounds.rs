//! Rounds with more and more waves, until the errors of all figures have the requested accuracy.

use super::accuracy::{Accuracy, FIRST_WAVES};
use super::shared::Listeners;
use super::{Response, ResponseSettings};
use crate::error::Error;
use crate::platform::Instant;
use crate::scene::Pair;
use crate::tracer::Tracer;

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

/// Maximum number of rounds. A factor of 4 reaches the limit of waves in four rounds, and the record may grow.
const MOST_ROUNDS: u32 = 6;

/// A round of responses with a requested accuracy.
#[doc(hidden)]
pub struct Round<'a> {
    /// The responses of the round: of all listeners whose responses were not accurate before.
    pub responses: &'a [Response],
    /// Number of listeners whose responses are complete after this round.
    pub finished: usize,
    /// Number of waves of the next round; `None` after the last round.
    pub next_waves: Option<u32>,
}

/// Traces rounds until the figures of all listeners have the accuracy, or a limit is reached. A listener whose figures
/// are accurate takes no part in further rounds. `observe` receives each round.
pub(super) fn trace(
    tracer: &mut Tracer,
    listeners: Listeners,
    settings: &ResponseSettings,
    accuracy: &Accuracy,
    observe: &mut dyn FnMut(Round),
) -> Result<Vec<Response>, Error> {
    let began = Instant::now();
    let mut last: Vec<Option<Response>> = vec![None; listeners.pairs().len()];
    let (mut open, mut open_indices) = (listeners.clone(), (0..last.len()).collect::<Vec<_>>());
    let mut next = Effort {
        waves: FIRST_WAVES.min(accuracy.most_waves.unwrap_or(FIRST_WAVES)),
        seconds: settings.seconds_of_pairs(tracer, listeners.pairs())?,
    };
    for round in 1.. {
        let of_round = ResponseSettings {
            accuracy: None,
            seconds: Some(next.seconds),
            ..settings.clone()
        };
        let before_s = began.elapsed().as_secs_f64();
        let mut responses = open.trace(tracer, &of_round.with_waves(next.waves), next.seconds)?;
        let elapsed_s = began.elapsed().as_secs_f64();
        for response in &mut responses {
            response.milliseconds = elapsed_s * 1e3;
        }
        let mut further: Vec<Option<Effort>> = match round == MOST_ROUNDS {
            true => vec![None; responses.len()],
            false => (responses.iter().zip(open.pairs()))
                .map(|(response, pair)| next.further(response, *pair, settings, accuracy))
                .collect(),
        };
        let all = further.iter().flatten().copied().reduce(Effort::and);
        let all = all.and_then(|wanted| match accuracy.time_limit_s {
            Some(limit_s) => wanted.within(limit_s - elapsed_s, next, elapsed_s - before_s),
            None => Some(wanted),
        });
        if all.is_none() {
            further.fill(None);
        }
        observe(Round {
            responses: &responses,
            finished: further.iter().filter(|effort| effort.is_none()).count(),
            next_waves: all.map(|effort| effort.waves),
        });
        for (index, response) in open_indices.iter().zip(responses) {
            last[*index] = Some(response);
        }
        let Some(effort) = all else {
            break;
        };
        let is_open = |index: &usize| further[*index].is_some();
        let kept: Vec<usize> = (0..further.len()).filter(is_open).collect();
        open = open.only(&kept);
        open_indices = kept.iter().map(|index| open_indices[*index]).collect();
        next = effort;
    }
    // The first round has all listeners.
    Ok(last.into_iter().flatten().collect())
}

/// The waves of a round, and the length of its record.
#[derive(Clone, Copy)]
struct Effort {
    waves: u32,
    seconds: f64,
}

impl Effort {
    /// The effort that serves both.
    fn and(self, other: Effort) -> Effort {
        Effort {
            waves: self.waves.max(other.waves),
            seconds: self.seconds.max(other.seconds),
        }
    }

    /// This effort with at most as many waves as fit `left_s` seconds, if a round of the effort `last` took `last_s`
    /// seconds and the time is proportional to waves and length; `None` if that is less than [`LEAST_GROWTH`] times the
    /// waves of `last`. The prediction errs towards a round that is too long, because parts of a round, such as the
    /// search for exact paths, do not grow with the waves.
    fn within(self, left_s: f64, last: Effort, last_s: f64) -> Option<Effort> {
        let fitting = f64::from(last.waves) * (left_s / last_s) * (last.seconds / self.seconds);
        if f64::from(self.waves) <= fitting {
            return Some(self);
        }
        let is_worth_it = fitting >= LEAST_GROWTH * f64::from(last.waves);
        is_worth_it.then_some(Effort {
            waves: fitting as u32,
            ..self
        })
    }

    /// The effort of the next round after a response of this effort; `None` if its figures are accurate, or if all
    /// waves are spent.
    fn further(
        self,
        response: &Response,
        pair: Pair,
        settings: &ResponseSettings,
        accuracy: &Accuracy,
    ) -> Option<Effort> {
        let can_grow = settings.seconds.is_none() && decays(pair);
        let longer_s = match can_grow && is_cut_off(response) {
            true => (LONGER * self.seconds).min(settings.longest_s.max(self.seconds)),
            false => self.seconds,
        };
        let most = accuracy.most_waves(response.counts.iterations);
        let waves = more_waves(self.waves, response.figures.waves_for(accuracy.share), most)
            .or((longer_s > self.seconds).then_some(self.waves))?;
        Some(Effort {
            waves,
            seconds: longer_s,
        })
    }
}

/// Number of waves of the next round; `None` if the figures are accurate, or if all waves are spent.
fn more_waves(waves: u32, factor: f64, most: u32) -> Option<u32> {
    if factor <= 1.0 || waves >= most {
        return None;
    }
    let growth = (SPARE * factor).clamp(LEAST_GROWTH, GREATEST_GROWTH);
    let next = (f64::from(waves) * growth).min(f64::from(most)) as u32;
    Some(next.max(waves + 1))
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

impl ResponseSettings {
    /// These settings with this number of waves for late arrivals. The number of waves for exact paths is raised to it if
    /// it is smaller.
    fn with_waves(mut self, waves: u32) -> ResponseSettings {
        self.late_waves = Some(waves);
        self.trace.waves = self.trace.waves.max(waves);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects time limits: a round is made no longer than the time that is left, as the last round predicts it, and is
    /// not begun if it would hardly improve the result.
    #[test]
    fn a_round_fits_the_time_that_is_left() {
        let effort = |waves: u32, seconds: f64| Effort { waves, seconds };
        let fitted = |wanted: Effort, left_s: f64| {
            let within = wanted.within(left_s, effort(1000, 1.0), 2.0);
            within.map(|effort| (effort.waves, effort.seconds))
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
    }
}
