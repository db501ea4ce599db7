//! The answers of a test subject as saved by the form, in JSON, from a complete or an interrupted session.
//!
//! A file is either read completely, or rejected with an error that states the problem. A trial without an answer
//! counts as unanswered.

use super::observer::Side;
use crate::text::{check_name, in_a_line};
use echomarch::internals::file_input::{InputError, read_text};
use echomarch::tracer::Settings;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Maximum number of trials in a form.
pub const MOST_TRIALS: usize = 999;

/// The value of `format` in an answer file.
pub const FORMAT: &str = "echomarch-localise-answers";

/// The only version that is accepted. Since version 2, each session has its own order of trials.
pub const VERSION: u32 = 2;

/// Maximum size of an answer file in bytes. A form of 999 trials gives about one megabyte.
const LARGEST_FILE: u64 = 16 << 20;

/// The highest confidence, which means certain. The lowest is 1, a guess.
pub const MOST_CONFIDENT: u32 = 5;

/// The saved answers of one person in one session, possibly merged from several saves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Session {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// The form's identifier, which is the same for all people with that form.
    pub experiment: String,
    /// The session's identifier, chosen by the form when the session began.
    pub session: String,
    /// A code chosen by the person; may be empty.
    pub participant: String,
    /// Start time of the session, in ISO 8601.
    pub started: String,
    /// Time of saving, in ISO 8601.
    pub saved: String,
    /// The seed from which the page computed the order of the trials; `None` in files saved before seeds were stored.
    #[serde(default)]
    pub order_seed: Option<u32>,
    /// The numbers of the trials, in the order in which the person heard them.
    pub order: Vec<u32>,
    /// Every trial of the form, ordered by number.
    pub trials: Vec<TrialAnswer>,
}

/// A trial, with the person's answer if there is one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialAnswer {
    /// The trial's number in the form, from 1.
    pub number: u32,
    /// The sound that was played.
    pub stimulus: StimulusInfo,
    /// The answer; `None` if the trial is unanswered.
    pub answer: Option<Answer>,
}

/// A sound in a setting, and the direction of its source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StimulusInfo {
    /// Name of the scene.
    pub scene: String,
    /// The rotation of the listener in the world, in degrees.
    pub yaw_deg: f64,
    /// Name of the sound.
    pub sound: String,
    /// Name of the panning law.
    pub law: String,
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Number of iterations.
    pub iterations: u32,
    /// Seed of the waves.
    pub seed: u32,
    /// Panning value of the frame.
    pub pan: f64,
    /// Number of waves that arrived.
    pub hits: u64,
    /// The azimuth of the source in degrees, positive to the right of the gaze, −180 … 180.
    pub source_azimuth_deg: f64,
    /// The lateral angle of the source, which determines the levels, in degrees, −90 … 90.
    pub source_lateral_deg: f64,
    /// The answer of the [`Observer`](super::Observer) to the same sound, in degrees.
    pub observer_lateral_deg: f64,
}

/// A person's answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// The position clicked in the plan, in metres to the right of the listener.
    pub right_m: f64,
    /// The position clicked in the plan, in metres ahead of the listener.
    pub ahead_m: f64,
    /// The azimuth of the click in degrees, positive to the right of the gaze, −180 … 180.
    pub azimuth_deg: f64,
    /// The side that the person chose.
    pub side: Side,
    /// Confidence from 1 (a guess) to [`MOST_CONFIDENT`] (certain).
    pub confidence: u32,
    /// Number of times the sound was played.
    pub plays: u32,
    /// Seconds from the first playback to the answer, without the time in which the trial was not shown.
    pub seconds: f64,
    /// Time of the answer, in ISO 8601.
    pub answered: String,
}

/// The reason why an answer file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnswersError {
    /// The file cannot be read.
    #[error("cannot read the answers {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: InputError,
    },
    /// The file is not JSON, or has missing or unknown fields.
    #[error(
        "{} contains no answers of the form: {}",
        path.display(),
        in_a_line(&source.to_string())
    )]
    Json {
        /// The file.
        path: PathBuf,
        /// The error of the JSON reader.
        source: serde_json::Error,
    },
    /// The file has another format or version.
    #[error(
        "{} is {format:?}, version {version}: answers are {FORMAT:?}, version {VERSION}",
        path.display()
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// The format that the file declares.
        format: String,
        /// The version that the file declares.
        version: u32,
    },
    /// A value is invalid.
    #[error("{}: {what}", path.display())]
    Bad {
        /// The file.
        path: PathBuf,
        /// The field, its value, and the valid values.
        what: String,
    },
    /// Two files of one session contradict each other.
    #[error(
        "{} and {} are of one session ({session}) and differ in trial {number}: give only one of them",
        first.display(),
        second.display()
    )]
    Contradiction {
        /// The first file.
        first: PathBuf,
        /// The second file.
        second: PathBuf,
        /// The session's identifier.
        session: String,
        /// The trial's number, from 1.
        number: u32,
    },
}

impl Session {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`AnswersError`] with the file's name.
    pub fn read(path: &Path) -> Result<Session, AnswersError> {
        let text = read_text(path, LARGEST_FILE).map_err(|source| AnswersError::Read {
            path: path.to_owned(),
            source,
        })?;
        let session: Session =
            serde_json::from_str(&text).map_err(|source| AnswersError::Json {
                path: path.to_owned(),
                source,
            })?;
        if session.format != FORMAT || session.version != VERSION {
            return Err(AnswersError::Format {
                path: path.to_owned(),
                format: session.format,
                version: session.version,
            });
        }
        session.check().map_err(|what| AnswersError::Bad {
            path: path.to_owned(),
            what,
        })?;
        Ok(session)
    }

    /// Number of answered trials.
    pub fn answered(&self) -> usize {
        let answered = self.trials.iter().filter(|trial| trial.answer.is_some());
        answered.count()
    }

    fn check(&self) -> Result<(), String> {
        if self.trials.is_empty() {
            return Err("it has no trials".to_owned());
        }
        if self.trials.len() > MOST_TRIALS {
            let count = self.trials.len();
            return Err(format!("{count} trials: a form has at most {MOST_TRIALS}"));
        }
        named("experiment", &self.experiment)?;
        named("session", &self.session)?;
        named("participant", &self.participant)?;
        named("started", &self.started)?;
        named("saved", &self.saved)?;
        let mut order = self.order.clone();
        order.sort_unstable();
        if !order.iter().copied().eq(1..=self.trials.len() as u32) {
            let count = self.trials.len();
            return Err(format!(
                "order must contain each number from 1 to {count} once"
            ));
        }
        if self.session.is_empty() {
            return Err("session must not be empty".to_owned());
        }
        for (index, trial) in self.trials.iter().enumerate() {
            let number = trial.number;
            if number as usize != index + 1 {
                let place = index + 1;
                return Err(format!("trial {number} is in the place of trial {place}"));
            }
            let told = |what: String| format!("trial {number}: {what}");
            trial.stimulus.check().map_err(told)?;
            if let Some(answer) = &trial.answer {
                answer.check().map_err(told)?;
            }
        }
        Ok(())
    }
}

impl StimulusInfo {
    fn check(&self) -> Result<(), String> {
        let mut settings = Settings::default().with_waves(self.waves);
        settings = settings.with_iterations(self.iterations);
        settings.validate().map_err(|error| error.to_string())?;
        named("scene", &self.scene)?;
        named("sound", &self.sound)?;
        named("law", &self.law)?;
        named("profile", &self.profile)?;
        within("yaw_deg", self.yaw_deg, f64::MAX)?;
        within("pan", self.pan, 1.0)?;
        within("source_azimuth_deg", self.source_azimuth_deg, 180.0)?;
        within("source_lateral_deg", self.source_lateral_deg, 90.0)?;
        within("observer_lateral_deg", self.observer_lateral_deg, 90.0)
    }
}

impl Answer {
    fn check(&self) -> Result<(), String> {
        named("answered", &self.answered)?;
        within("right_m", self.right_m, f64::MAX)?;
        within("ahead_m", self.ahead_m, f64::MAX)?;
        within("azimuth_deg", self.azimuth_deg, 180.0)?;
        within("seconds", self.seconds, f64::MAX)?;
        if self.seconds < 0.0 {
            return Err(format!("seconds must be 0 or more, not {}", self.seconds));
        }
        if self.plays == 0 {
            return Err("plays must be 1 or more, not 0".to_owned());
        }
        // A click at the listener has no direction.
        const LEAST_M: f64 = 0.001;
        if self.right_m.hypot(self.ahead_m) <= LEAST_M {
            return Err("the click is at the listener".to_owned());
        }
        // Numbers are saved with fewer digits than they are computed with, so this tolerance allows for rounding.
        const ROUNDING_DEG: f64 = 1.0;
        let clicked = self.right_m.atan2(self.ahead_m).to_degrees();
        let off = (clicked - self.azimuth_deg).rem_euclid(360.0);
        if off.min(360.0 - off) > ROUNDING_DEG {
            let azimuth = self.azimuth_deg;
            return Err(format!(
                "azimuth_deg is {azimuth}, but the click is at {clicked:.1}"
            ));
        }
        if !(1..=MOST_CONFIDENT).contains(&self.confidence) {
            let confidence = self.confidence;
            return Err(format!(
                "confidence must be 1 to {MOST_CONFIDENT}, not {confidence}"
            ));
        }
        Ok(())
    }
}

fn named(what: &str, name: &str) -> Result<(), String> {
    check_name(name).map_err(|why| format!("{what} {why}"))
}

fn within(what: &str, value: f64, most: f64) -> Result<(), String> {
    // Rounding may have increased the last digit.
    if value.is_finite() && value.abs() - most <= 1e-6 {
        return Ok(());
    }
    Err(match most {
        f64::MAX => format!("{what} must be finite, not {value}"),
        _ => format!("{what} must be -{most} to {most}, not {value}"),
    })
}
