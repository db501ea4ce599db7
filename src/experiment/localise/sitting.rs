//! The experiment in the window: one person's sitting with the trials of a form.
//!
//! The trials are those of the page, and so is the file of answers: `score` reads both. An
//! answer is in the file the moment that it is locked. A file that is there already is taken
//! up where it was broken off; nothing in it is ever replaced.

use super::answers::{Answer, AnswersError, FORMAT, Session, StimulusInfo, TrialAnswer, VERSION};
use super::form::{Form, Plan};
use super::random::Random;
use crate::output::{OutputError, write_whole};
use crate::scene::Scene;
use crate::trace::{Profile, Settings};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::PathBuf;
use std::time::SystemTime;

/// One person's answers to a form, and where they are kept.
#[derive(Debug)]
pub struct Sitting {
    form: Form,
    session: Session,
    file: PathBuf,
    saved: bool,
}

/// One trial, as it is put to a person.
#[derive(Clone, Copy, Debug)]
pub struct Put<'a> {
    /// Its number, from 1: not its place in the order.
    pub number: u32,
    /// What is heard.
    pub stimulus: &'a StimulusInfo,
    /// The room, as the listener faces it.
    pub room: &'a Scene,
    /// The plan to answer on.
    pub plan: &'a Plan,
}

/// A sitting that cannot be begun or taken up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SittingError {
    /// The file is there and holds no answers.
    #[error(transparent)]
    Answers(#[from] AnswersError),
    /// The file is there and holds answers to other trials.
    #[error(
        "{} holds answers to the trials {theirs}, not {ours}: choose another file, or the options \
         that it was begun with",
        file.display()
    )]
    Other {
        /// The file.
        file: PathBuf,
        /// Its form.
        theirs: String,
        /// The form that was asked for.
        ours: String,
    },
    /// The file is there and holds the answers of somebody else.
    #[error(
        "{} holds the answers of {theirs:?}, not of {ours:?}: choose another file",
        file.display()
    )]
    Somebody {
        /// The file.
        file: PathBuf,
        /// The code in it.
        theirs: String,
        /// The code that was asked for.
        ours: String,
    },
    /// Somebody else has written the file since it was taken up.
    #[error("{} holds other answers by now, and is left alone", file.display())]
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl Sitting {
    /// Takes up what is in `file`, or begins a sitting that is kept there from the first answer
    /// on. `participant` is a code; empty it is nobody's, or that of the file. `order_seed` gives
    /// the order of the trials of a sitting that begins; without it each sitting has its own.
    ///
    /// # Errors
    /// [`SittingError`].
    pub fn open(
        form: Form,
        file: PathBuf,
        participant: &str,
        order_seed: Option<u64>,
    ) -> Result<Sitting, SittingError> {
        crate::output::check_file(&file)?;
        let session = match file.exists() {
            false => begun(&form, participant, order_seed),
            true => Session::read_own(&file)?,
        };
        if session.experiment != form.experiment || session.trials.len() != form.trials.len() {
            return Err(SittingError::Other {
                file,
                theirs: session.experiment,
                ours: form.experiment,
            });
        }
        if !participant.is_empty() && session.participant != participant {
            return Err(SittingError::Somebody {
                file,
                theirs: session.participant,
                ours: participant.to_owned(),
            });
        }
        Ok(Sitting {
            form,
            session,
            file,
            saved: true,
        })
    }

    /// The next trial without an answer, in this sitting's order: its index.
    pub fn next(&self) -> Option<usize> {
        let order = self.session.order.iter();
        let trials = order.filter_map(|&number| (number as usize).checked_sub(1));
        let is_open = |&index: &usize| {
            let trial = self.session.trials.get(index);
            trial.is_some_and(|trial| trial.answer.is_none())
        };
        trials.into_iter().find(is_open)
    }

    /// Trials that are answered, and all.
    pub fn progress(&self) -> [usize; 2] {
        [self.session.answered(), self.session.trials.len()]
    }

    /// Where the answers are kept.
    pub fn file(&self) -> &std::path::Path {
        &self.file
    }

    /// A trial, by its index: one less than its number.
    pub fn trial(&self, index: usize) -> Option<Put<'_>> {
        let trial = self.session.trials.get(index)?;
        let place = self.form.trials.get(index)?.plan;
        Some(Put {
            number: trial.number,
            stimulus: &trial.stimulus,
            room: self.form.rooms.get(place)?,
            plan: self.form.plan(place)?,
        })
    }

    /// Keeps the answer to a trial that has none, and writes the file.
    ///
    /// # Errors
    /// [`SittingError`]; the answer is kept all the same, and written with the next one.
    pub fn lock(&mut self, index: usize, answer: Answer) -> Result<(), SittingError> {
        if let Some(trial) = self.session.trials.get_mut(index) {
            trial.answer.get_or_insert(answer);
            self.saved = false;
        }
        self.save()
    }

    /// Writes the file, unless it holds answers by now that would be lost.
    ///
    /// # Errors
    /// [`SittingError`].
    pub fn save(&mut self) -> Result<(), SittingError> {
        if self.file.exists() && self.would_lose(&Session::read_own(&self.file)?) {
            return Err(SittingError::Changed {
                file: self.file.clone(),
            });
        }
        self.session.saved = now();
        write_whole(&self.file, |out| {
            Ok(serde_json::to_writer_pretty(out, &self.session)?)
        })?;
        self.saved = true;
        Ok(())
    }

    /// Whether that session has answers which this one has not.
    fn would_lose(&self, there: &Session) -> bool {
        let said = |session: &Session| -> Vec<Option<String>> {
            let answers = session.trials.iter().map(|trial| trial.answer.as_ref());
            let times = answers.map(|answer| answer.map(|answer| answer.answered.clone()));
            times.collect()
        };
        let is_lost =
            |(there, here): (Option<String>, Option<String>)| there.is_some() && there != here;
        there.session != self.session.session
            || said(there)
                .into_iter()
                .zip(said(&self.session))
                .any(is_lost)
    }

    /// Whether every answer is in the file.
    pub fn is_saved(&self) -> bool {
        self.saved
    }
}

/// A sitting without any answer.
fn begun(form: &Form, participant: &str, order_seed: Option<u64>) -> Session {
    let trials = form.trials.iter().map(|trial| TrialAnswer {
        number: trial.number as u32,
        stimulus: trial.stimulus.clone(),
        answer: None,
    });
    let started = now();
    // Another name for every sitting, and another order unless it is asked for.
    let id = RandomState::new().build_hasher().finish();
    let mut order: Vec<u32> = (1..=form.trials.len() as u32).collect();
    Random::new(order_seed.unwrap_or(id)).shuffle(&mut order);
    Session {
        format: FORMAT.to_owned(),
        version: VERSION,
        experiment: form.experiment.clone(),
        session: format!("{id:016x}"),
        order,
        participant: participant.to_owned(),
        saved: started.clone(),
        started,
        trials: trials.collect(),
    }
}

/// The time in ISO 8601.
pub fn now() -> String {
    humantime::format_rfc3339_millis(SystemTime::now()).to_string()
}

/// How the waves of a trial are traced; the usual way for a profile that is none.
pub fn settings_of(stimulus: &StimulusInfo) -> Settings {
    let profile = stimulus.profile.parse::<Profile>();
    profile
        .map_or_else(|_| Settings::default(), Settings::of)
        .with_seed(stimulus.seed)
        .with_waves(stimulus.waves)
        .with_iterations(stimulus.iterations)
}
