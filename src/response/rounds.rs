//! Rounds with more and more waves, until the errors of all figures have the requested accuracy.

use super::accuracy::{Accuracy, Ended};
use super::effort::{Effort, Took};
use super::shared::Listeners;
use super::{Response, ResponseSettings};
use crate::error::Error;
use crate::platform::Instant;
use crate::tracer::Tracer;

/// Maximum number of rounds. A growth by a factor of 4 reaches the limit of waves in fewer rounds, but the record may
/// become longer.
const MOST_ROUNDS: u32 = 12;

/// A round of responses with a requested accuracy.
#[doc(hidden)]
pub struct Round<'a> {
    /// The responses of the round: of all listeners whose responses were not accurate before.
    pub responses: &'a [Response],
    /// Number of listeners whose responses are complete after this round.
    pub finished: usize,
    /// Number of late waves after the next round, those that end after the onset included; `None` after the last round.
    /// It stays the same if only the followed waves or the waves of early arrivals grow.
    pub next_waves: Option<u32>,
}

/// Traces rounds until the figures of all listeners have the accuracy, or a limit is reached. A listener whose figures
/// are accurate takes no part in further rounds. `observe` receives each round.
pub(super) fn trace(
    tracer: &mut Tracer,
    mut open: Listeners,
    settings: &ResponseSettings,
    accuracy: &Accuracy,
    observe: &mut dyn FnMut(Round),
) -> Result<Vec<Response>, Error> {
    let began = Instant::now();
    let mut pairs = open.pairs();
    let mut last: Vec<Option<Response>> = vec![None; pairs.len()];
    let mut open_indices: Vec<usize> = (0..pairs.len()).collect();
    let seconds = settings.seconds_of_pairs(tracer, &pairs)?;
    let mut next = Effort::first(&pairs, settings, accuracy, seconds);
    let (mut elapsed_s, mut tallies_began_s) = (0.0, 0.0);
    for round in 1.. {
        let of_round = next.settings(settings);
        let (told_s, before_s) = (elapsed_s, began.elapsed().as_secs_f64());
        let mut traced = open.trace(tracer, &of_round, next.seconds)?;
        elapsed_s = began.elapsed().as_secs_f64();
        let share_s = (elapsed_s - told_s) / traced.len().max(1) as f64;
        for (traced, index) in traced.iter_mut().zip(&open_indices) {
            let before_ms = last[*index].as_ref().map_or(0.0, |last| last.milliseconds);
            traced.response.accuracy = Some(accuracy.share);
            traced.response.milliseconds = before_ms + share_s * 1e3;
        }
        let of_listener =
            |(traced, pair): (&_, &_)| next.further(traced, *pair, settings, accuracy);
        let mut further: Vec<Result<Effort, Ended>> =
            traced.iter().zip(&pairs).map(of_listener).collect();
        let responses = traced.into_iter().map(|traced| traced.response);
        let mut responses: Vec<Response> = responses.collect();
        let all = further.iter().flatten().copied().reduce(Effort::and);
        let iterations = responses.iter().map(|response| response.counts.iterations);
        let most_iterations = iterations.max().unwrap_or(0);
        let all = all.map(|wanted| wanted.within(next, most_iterations, accuracy));
        let all = all.filter(|wanted| wanted.exceeds(next));
        let all = all.ok_or(accuracy.limit_of_waves(most_iterations));
        let all = all.and_then(|wanted| match accuracy.time_limit_s {
            _ if round == MOST_ROUNDS => Err(Ended::Rounds),
            Some(limit_s) => {
                let keeps_waves = open.keeps_waves(&of_round, next.seconds);
                // The figures of the round are counted too.
                let now_s = began.elapsed().as_secs_f64();
                let took = Took {
                    last_s: now_s - before_s,
                    extended_s: keeps_waves.then_some(now_s - tallies_began_s),
                };
                let fitting = wanted.fitting(limit_s - now_s, next, took);
                fitting.ok_or(Ended::Time)
            }
            None => Ok(wanted),
        });
        for (further, response) in further.iter_mut().zip(&mut responses) {
            *further = further.and_then(|effort| all.map(|_| effort));
            response.ended = further.err();
        }
        observe(Round {
            responses: &responses,
            finished: further.iter().filter(|effort| effort.is_err()).count(),
            next_waves: all.ok().map(|effort| effort.onset_waves),
        });
        for (index, response) in open_indices.iter().zip(responses) {
            last[*index] = Some(response);
        }
        let Ok(effort) = all else {
            break;
        };
        let is_open: Vec<bool> = further.iter().map(Result::is_ok).collect();
        open.keep(&is_open);
        pairs = open.pairs();
        let mut is_kept = is_open.into_iter();
        open_indices.retain(|_| is_kept.next().unwrap_or(false));
        if !effort.extends(next) {
            open.begin_anew();
            tallies_began_s = elapsed_s;
        }
        next = match effort.seconds == next.seconds {
            true => effort,
            false => effort.of_pairs(&pairs, settings),
        };
    }
    // The first round has all listeners.
    Ok(last.into_iter().flatten().collect())
}
