//! Rounds with more and more waves, until the errors of all figures have the requested accuracy.

use super::accuracy::{Accuracy, FIRST_WAVES};
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

/// A round of a response with a requested accuracy.
#[doc(hidden)]
pub struct Round<'a> {
    /// The response of this round.
    pub response: &'a Response,
    /// Number of waves of the next round; `None` after the last round.
    pub next_waves: Option<u32>,
}

/// Traces rounds until the figures have the accuracy, or a limit is reached. `observe` receives each round.
pub(super) fn trace(
    tracer: &mut Tracer,
    pair: Pair,
    settings: &ResponseSettings,
    accuracy: &Accuracy,
    observe: &mut dyn FnMut(Round),
) -> Result<Response, Error> {
    settings.validate()?;
    let began = Instant::now();
    let mut seconds = settings.seconds_needed(tracer, pair)?;
    let can_grow = settings.seconds.is_none() && decays(pair);
    let mut waves = FIRST_WAVES.min(accuracy.most_waves.unwrap_or(FIRST_WAVES));
    let mut rounds = 0;
    loop {
        let of_round = ResponseSettings {
            accuracy: None,
            seconds: Some(seconds),
            ..settings.clone()
        };
        let mut response = Response::of_pair(tracer, pair, &of_round.with_waves(waves))?;
        rounds += 1;
        response.milliseconds = began.elapsed().as_secs_f64() * 1e3;
        let most = accuracy.most_waves(response.counts.iterations);
        let is_late = accuracy
            .time_limit_s
            .is_some_and(|limit_s| began.elapsed().as_secs_f64() >= limit_s);
        let longer_s = match can_grow && is_cut_off(&response) {
            true => (LONGER * seconds).min(settings.longest_s.max(seconds)),
            false => seconds,
        };
        let next = match is_late || rounds == MOST_ROUNDS {
            true => None,
            false => more_waves(waves, response.figures.waves_for(accuracy.share), most)
                .or((longer_s > seconds).then_some(waves)),
        };
        observe(Round {
            response: &response,
            next_waves: next,
        });
        let Some(next) = next else {
            return Ok(response);
        };
        (waves, seconds) = (next, longer_s);
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
    /// These settings with this number of waves for late arrivals, and at least as many waves for exact paths.
    fn with_waves(mut self, waves: u32) -> ResponseSettings {
        self.late_waves = Some(waves);
        self.trace.waves = self.trace.waves.max(waves);
        self
    }
}
