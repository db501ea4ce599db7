//! Rounds with more and more waves, until the errors of all figures have the requested accuracy.

use super::accuracy::Accuracy;
use super::effort::Effort;
use super::shared::Listeners;
use super::{Response, ResponseSettings};
use crate::error::Error;
use crate::platform::Instant;
use crate::tracer::Tracer;

/// Maximum number of rounds. A factor of 4 reaches the limit of waves in four rounds, and the record may grow.
const MOST_ROUNDS: u32 = 6;

/// A round of responses with a requested accuracy.
#[doc(hidden)]
pub struct Round<'a> {
    /// The responses of the round: of all listeners whose responses were not accurate before.
    pub responses: &'a [Response],
    /// Number of listeners whose responses are complete after this round.
    pub finished: usize,
    /// Number of waves of the next round, those that end after the onset included; `None` after the last round.
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
    let seconds = settings.seconds_of_pairs(tracer, listeners.pairs())?;
    let mut next = Effort::first(listeners.pairs(), settings, accuracy, seconds);
    for round in 1.. {
        next = next.of_pairs(open.pairs(), settings);
        let of_round = next.settings(settings);
        let before_s = began.elapsed().as_secs_f64();
        let mut responses = open.trace(tracer, &of_round, next.seconds)?;
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
        let iterations = responses.iter().map(|response| response.counts.iterations);
        let most_iterations = iterations.max().unwrap_or(0);
        let all = all.map(|wanted| wanted.within(next, most_iterations, accuracy));
        let all = all.and_then(|wanted| match accuracy.time_limit_s {
            Some(limit_s) => wanted.fitting(limit_s - elapsed_s, next, elapsed_s - before_s),
            None => Some(wanted),
        });
        if all.is_none() {
            further.fill(None);
        }
        observe(Round {
            responses: &responses,
            finished: further.iter().filter(|effort| effort.is_none()).count(),
            next_waves: all.map(|effort| effort.onset_waves),
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
