//! The accuracy of a response's figures, and the limits of the effort for it.

use crate::error::Error;
use crate::serialised::finite;
use crate::tracer::{Settings, TraceError};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The accuracy of a response's figures, and the limits of the effort for it.
///
/// Waves are traced in rounds. The errors of a round determine the number of waves of the next round. The last round
/// is the result. Rounds also continue until 200 independent waves arrive after the end of each decay, because the errors
/// of fewer waves may be too small. Where surfaces scatter in all bands and the source radiates evenly, a part of the waves
/// ends after the first sixth of the record ([`onset_waves`](super::Response::onset_waves)), and a round adds its waves to
/// those of the rounds before. Otherwise the result equals a response with the same number of late waves
/// ([`late_waves`](super::ResponseSettings::late_waves)).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Accuracy {
    /// The standard error of EDT, T20 and T30 as a share of the time, 0.001 to 0.05: 0.02 by default. The standard
    /// errors of the other figures are in proportion to the just noticeable differences: 0.2 dB for C50, C80 and G,
    /// 0.01 for D50, and 2 ms or 2 % for Ts, whichever is more, with 0.02.
    pub share: f64,
    /// Maximum number of waves. By default waves times iterations are at most 100 million, where a wave that ends earlier
    /// counts as the part of a wave that it flies. This takes about 10 s in a room without users' fields on two
    /// cores.
    pub most_waves: Option<u32>,
    /// Time limit in seconds; no limit by default. A round has no more waves than fit the remaining time, predicted from
    /// the rounds before. The first round is always completed. The result depends on the speed of the
    /// machine.
    #[serde(serialize_with = "finite")]
    pub time_limit_s: Option<f64>,
}

/// Why no further round follows for a listener.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) enum Ended {
    /// No kind of waves that can grow reduces the errors further.
    NothingOpen,
    /// The maximum number of waves.
    Waves(u32),
    /// The maximum product of waves and iterations.
    Flights,
    /// The time limit.
    Time,
    /// The maximum number of rounds.
    Rounds,
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const MILLION: u64 = 1_000_000;
        match self {
            Ended::NothingOpen => {
                write!(f, "more waves do not reduce the noise of early arrivals")
            }
            Ended::Waves(waves) => write!(f, "the limit of {waves} waves ended the rounds"),
            Ended::Flights => write!(
                f,
                "the limit of {} million waves times iterations ended the rounds",
                MOST_FLIGHTS / MILLION
            ),
            Ended::Time => write!(f, "the time limit ended the rounds"),
            Ended::Rounds => write!(f, "the greatest number of rounds is reached"),
        }
    }
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

/// Maximum product of waves and iterations in a round. Closed-form rooms take about 10 million per second on two cores.
const MOST_FLIGHTS: u64 = 100_000_000;

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

    /// Sets the time limit in seconds.
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
            let must = "a share of 0.001 to 0.05 (0.1 % to 5 %)";
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

    /// The maximum number of waves, however far they fly.
    pub(super) fn most_waves_asked(&self) -> u32 {
        self.most_waves.unwrap_or(Settings::MAX_WAVES)
    }

    /// The limit that holds for waves that fly this number of iterations.
    pub(super) fn limit_of_waves(&self, iterations: u32) -> Ended {
        match self.most_waves {
            None if self.most_waves(iterations, 0) < Settings::MAX_WAVES => Ended::Flights,
            _ => Ended::Waves(self.most_waves_asked()),
        }
    }

    /// The maximum number of waves that fly this number of iterations: at least `least` without a limit of waves.
    pub(super) fn most_waves(&self, iterations: u32, least: u32) -> u32 {
        let by_flights = MOST_FLIGHTS / u64::from(iterations.max(1));
        let by_flights = by_flights.clamp(least.into(), Settings::MAX_WAVES.into());
        self.most_waves.unwrap_or(by_flights as u32)
    }
}
