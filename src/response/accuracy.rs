//! Responses of a requested accuracy: rounds with more and more waves, until the errors of all figures are small
//! enough.

use super::{Response, ResponseSettings};
use crate::error::Error;
use crate::platform::Instant;
use crate::scene::Pair;
use crate::serialised::finite;
use crate::tracer::{Settings, TraceError, Tracer};
use serde::{Deserialize, Serialize};

/// The accuracy of a response's figures, and the limits of the effort for it.
///
/// Waves are traced in rounds. Each round has as many waves as the errors of the round before require. The last round
/// is the result, and it equals a response with the same number of late waves
/// ([`ResponseSettings::late_waves`]).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Accuracy {
    /// The standard error of EDT, T20 and T30 as a share of the time, 0.001 to 0.05: 0.02 by default. The standard
    /// errors of the other figures are in proportion to the just noticeable differences: 0.2 dB for C50, C80 and G,
    /// 0.01 for D50 and 2 ms for Ts with 0.02.
    pub share: f64,
    /// Maximum number of waves. By default their number times the iterations is at most 100 million, which takes about
    /// 10 s in a room without users' fields on two cores.
    pub most_waves: Option<u32>,
    /// Seconds after which no further round begins; no limit by default. The result then depends on the speed of the
    /// machine. A round takes as long as its waves need.
    #[serde(serialize_with = "finite")]
    pub time_limit_s: Option<f64>,
}

impl Default for Accuracy {
    fn default() -> Accuracy {
        Accuracy {
            share: 0.02,
            most_waves: None,
            time_limit_s: None,
        }
    }
}

/// The range of [`Accuracy::share`]. Errors common to all waves exceed the lower limit in many rooms, and the upper
/// limit is just noticeable.
const SHARES: std::ops::RangeInclusive<f64> = 0.001..=0.05;

/// Number of waves of the first round. In rooms its errors predict the number of waves that the accuracy takes.
const FIRST_WAVES: u32 = 1 << 14;

/// Maximum product of waves and iterations in a round. Closed-form rooms take about 10 million per second on two cores.
const MOST_FLIGHTS: u64 = 100_000_000;

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

impl Accuracy {
    /// The accuracy with this standard error of decay times, as a share of the time.
    #[must_use]
    pub fn new(share: f64) -> Accuracy {
        Accuracy {
            share,
            ..Accuracy::default()
        }
    }

    /// Sets the maximum number of waves.
    #[must_use]
    pub fn with_most_waves(mut self, waves: u32) -> Accuracy {
        self.most_waves = Some(waves);
        self
    }

    /// Sets the time in seconds after which no further round begins.
    #[must_use]
    pub fn with_time_limit(mut self, seconds: f64) -> Accuracy {
        self.time_limit_s = Some(seconds);
        self
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`Error::Trace`] with the name, the range and the value.
    pub fn validate(&self) -> Result<(), Error> {
        let bad = |what, must: &str, value: String| {
            let must = must.to_owned();
            Err(TraceError::BadSetting { what, must, value }.into())
        };
        if !SHARES.contains(&self.share) {
            let must = "0.001 to 0.05 (0.1 % to 5 %)";
            return bad("accuracy of figures", must, self.share.to_string());
        }
        if self
            .time_limit_s
            .is_some_and(|limit| limit.is_nan() || limit <= 0.0)
        {
            let value = self.time_limit_s.unwrap_or_default().to_string();
            return bad("time limit in seconds", "above 0", value);
        }
        match self.most_waves {
            Some(waves) => Ok(Settings::default().with_waves(waves).validate()?),
            None => Ok(()),
        }
    }

    /// The maximum number of waves that fly this number of iterations.
    fn most_waves(&self, iterations: u32) -> u32 {
        let by_flights = MOST_FLIGHTS / u64::from(iterations.max(1));
        let by_flights = by_flights.clamp(FIRST_WAVES.into(), Settings::MAX_WAVES.into());
        self.most_waves.unwrap_or(by_flights as u32)
    }
}

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
