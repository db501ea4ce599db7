//! Scores the answers of test subjects against the source's position and lateral angle.
//!
//! A click on the plan can have any azimuth, but levels determine only the lateral angle. The error is therefore
//! computed from the azimuth folded to the front, and the number of clicks behind is reported separately. Confidence
//! intervals and spread are computed over persons ([`figures_of_people`]), because the answers of one person are not
//! independent. Sounds in which no wave was heard form a separate group, because they are in the middle wherever their
//! source is. Several files of one session count as one session. Answers are locked once given, so that later files
//! only add answers to earlier files. Two files that contradict each other are rejected.

use super::answers::{Answer, AnswersError, Session, StimulusInfo, TrialAnswer};
use super::observer::{Side, folded_deg};
use super::statistics::{ErrorFigures, Pair, figures_of_people};
use crate::stats::mean;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The scored answers of all sessions.
#[derive(Clone, Debug, Serialize)]
pub struct ScoreReport {
    /// One entry per session, in the order given.
    pub sessions: Vec<SessionLine>,
    /// The groups, in this order: all answers to heard sounds; the answers for each scene, sound, law and setting; all
    /// answers to sounds in which no wave was heard.
    pub groups: Vec<Group>,
    /// Notes on the files.
    pub notes: Vec<String>,
}

/// The files of a session, its identifiers and its counts.
#[derive(Clone, Debug, Serialize)]
pub struct SessionLine {
    /// The files from which the session was read.
    pub files: Vec<String>,
    /// The form's identifier.
    pub experiment: String,
    /// The session's identifier.
    pub session: String,
    /// The person's code.
    pub participant: String,
    /// Number of answered trials.
    pub answered: usize,
    /// Number of trials in the form.
    pub trials: usize,
}

/// The figures of one group of answers.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// Name of the scene; empty in a group over all scenes.
    pub scene: String,
    /// Name of the sound; empty in a group over all sounds.
    pub sound: String,
    /// Name of the panning law; empty in a group over all laws.
    pub law: String,
    /// Name of the profile; empty in a group over all profiles.
    pub profile: String,
    /// Number of waves; `None` in a group over all numbers.
    pub waves: Option<u32>,
    /// Number of iterations; `None` in a group over all numbers.
    pub iterations: Option<u32>,
    /// Whether at least one wave was heard in these sounds.
    pub heard: bool,
    /// Number of answers.
    pub answers: usize,
    /// Number of persons, distinguished by their codes. Each session without a code counts as one person.
    pub people: usize,
    /// Errors of the folded clicks relative to the lateral angle of the source.
    pub source: Option<ErrorFigures>,
    /// Errors of the folded clicks relative to the observer's answers to the same sounds.
    pub observer: Option<ErrorFigures>,
    /// Numbers of answers, with one row per side of the source and one column per chosen side, in the order left,
    /// centre, right.
    pub confusion: [[u32; 3]; 3],
    /// Share of answers in which the chosen side is the side of the click.
    pub side_is_clicked: f64,
    /// Share of clicks behind the listener.
    pub clicked_behind: f64,
    /// Mean confidence, 1 to 5.
    pub confidence: f64,
}

/// A session and the files from which it was merged.
struct Merged {
    files: Vec<PathBuf>,
    session: Session,
}

/// An answered trial.
#[derive(Clone, Copy)]
struct Answered<'a> {
    person: &'a str,
    stimulus: &'a StimulusInfo,
    answer: &'a Answer,
}

/// Reads and scores answer files.
///
/// # Errors
/// [`AnswersError`] for the first file that cannot be used.
pub fn score(files: &[PathBuf]) -> Result<ScoreReport, AnswersError> {
    let mut notes = Vec::new();
    let merged = merge(files, &mut notes)?;
    let all: Vec<Answered> = merged.iter().flat_map(|of| answered(&of.session)).collect();
    let line = |of: &Merged| SessionLine {
        files: of
            .files
            .iter()
            .map(|file| file.display().to_string())
            .collect(),
        experiment: of.session.experiment.clone(),
        session: of.session.session.clone(),
        participant: of.session.participant.clone(),
        answered: of.session.answered(),
        trials: of.session.trials.len(),
    };
    let sessions: Vec<SessionLine> = merged.iter().map(line).collect();
    for line in sessions.iter().filter(|line| line.answered < line.trials) {
        let (session, open) = (&line.session, line.trials - line.answered);
        notes.push(format!(
            "session {session} was interrupted: {open} of {} trials are not answered",
            line.trials
        ));
    }
    note_experiments(&sessions, &mut notes);
    let (heard, silent): (Vec<Answered>, Vec<Answered>) =
        all.into_iter().partition(|of| of.stimulus.hits > 0);
    let mut groups = Vec::new();
    groups.extend(group(&heard, None));
    for kind in kinds(&heard) {
        let of = |answer: &&Answered| key(answer.stimulus) == key(kind);
        let alike: Vec<Answered> = heard.iter().filter(of).copied().collect();
        groups.extend(group(&alike, Some(kind)));
    }
    groups.extend(group(&silent, None));
    Ok(ScoreReport {
        sessions,
        groups,
        notes,
    })
}

/// Adds a note if the answers are to different forms: answers with equal settings are pooled.
fn note_experiments(sessions: &[SessionLine], notes: &mut Vec<String>) {
    let mut forms: Vec<&str> = sessions.iter().map(|of| of.experiment.as_str()).collect();
    forms.sort_unstable();
    forms.dedup();
    if forms.len() > 1 {
        notes.push(format!(
            "the sessions are of {} different forms ({}), whose sounds differ: what has the same \
             settings is taken together",
            forms.len(),
            forms.join(", ")
        ));
    }
}

fn merge(files: &[PathBuf], notes: &mut Vec<String>) -> Result<Vec<Merged>, AnswersError> {
    let mut all: Vec<Merged> = Vec::new();
    for file in files {
        let session = Session::read(file)?;
        let same = |of: &&mut Merged| {
            (&of.session.experiment, &of.session.session) == (&session.experiment, &session.session)
        };
        let Some(known) = all.iter_mut().find(same) else {
            let files = vec![file.clone()];
            all.push(Merged { files, session });
            continue;
        };
        known.add(file, session)?;
        let files: Vec<String> = known
            .files
            .iter()
            .map(|f| f.display().to_string())
            .collect();
        let session = &known.session.session;
        notes.push(format!(
            "{} are of one session, {session}, and count once",
            files.join(" and ")
        ));
    }
    Ok(all)
}

impl Merged {
    fn add(&mut self, file: &Path, other: Session) -> Result<(), AnswersError> {
        let contradiction = |number| AnswersError::Contradiction {
            first: self.files[0].clone(),
            second: file.to_path_buf(),
            session: other.session.clone(),
            number,
        };
        if self.session.trials.len() != other.trials.len() {
            let shorter = self.session.trials.len().min(other.trials.len());
            return Err(contradiction(shorter as u32 + 1));
        }
        let mut orders = self.session.order.iter().zip(&other.order);
        if let Some((_, &number)) = orders.find(|(mine, its)| mine != its) {
            return Err(contradiction(number));
        }
        for (mine, its) in self.session.trials.iter_mut().zip(&other.trials) {
            if mine.stimulus != its.stimulus || differ(mine, its) {
                return Err(contradiction(its.number));
            }
            if mine.answer.is_none() {
                mine.answer.clone_from(&its.answer);
            }
        }
        self.files.push(file.to_path_buf());
        Ok(())
    }
}

fn differ(one: &TrialAnswer, other: &TrialAnswer) -> bool {
    match (&one.answer, &other.answer) {
        (Some(one), Some(other)) => one != other,
        _ => false,
    }
}

fn answered(session: &Session) -> impl Iterator<Item = Answered<'_>> {
    let person = match session.participant.as_str() {
        "" => session.session.as_str(),
        code => code,
    };
    session.trials.iter().filter_map(move |trial| {
        Some(Answered {
            person,
            stimulus: &trial.stimulus,
            answer: trial.answer.as_ref()?,
        })
    })
}

fn key(of: &StimulusInfo) -> (&str, &str, &str, &str, u32, u32) {
    let names = (&of.scene, &of.sound, &of.law, &of.profile);
    (names.0, names.1, names.2, names.3, of.waves, of.iterations)
}

/// One stimulus of each kind, sorted.
fn kinds<'a>(all: &[Answered<'a>]) -> Vec<&'a StimulusInfo> {
    let mut kinds: Vec<&StimulusInfo> = all.iter().map(|of| of.stimulus).collect();
    kinds.sort_by(|a, b| key(a).cmp(&key(b)));
    kinds.dedup_by(|a, b| key(a) == key(b));
    kinds
}

/// Groups the answers by person.
fn people<'a>(answers: &[Answered<'a>]) -> Vec<Vec<Answered<'a>>> {
    let mut people: Vec<Vec<Answered>> = Vec::new();
    for answer in answers {
        match people.iter_mut().find(|of| of[0].person == answer.person) {
            Some(person) => person.push(*answer),
            None => people.push(vec![*answer]),
        }
    }
    people
}

/// The figures of the answers of one kind, or of all answers; `None` if there are no answers.
fn group(answers: &[Answered], kind: Option<&StimulusInfo>) -> Option<Group> {
    let first = answers.first()?;
    let people = people(answers);
    let errors = |truth: fn(&StimulusInfo) -> f64| {
        let pair = |of: &Answered| Pair {
            truth_deg: truth(of.stimulus),
            answer_deg: folded_deg(of.answer.azimuth_deg),
        };
        let of_person = |answers: &Vec<Answered>| answers.iter().map(pair).collect();
        figures_of_people(&people.iter().map(of_person).collect::<Vec<Vec<Pair>>>())
    };
    let share = |is: fn(&Answered) -> bool| {
        let count = answers.iter().filter(|answer| is(answer)).count();
        count as f64 / answers.len() as f64
    };
    let mut confusion = [[0; 3]; 3];
    for of in answers {
        confusion[Side::of(of.stimulus.source_lateral_deg) as usize][of.answer.side as usize] += 1;
    }
    let name = |of: fn(&StimulusInfo) -> &String| kind.map_or_else(String::new, |k| of(k).clone());
    let confidence = answers.iter().map(|of| f64::from(of.answer.confidence));
    Some(Group {
        scene: name(|kind| &kind.scene),
        sound: name(|kind| &kind.sound),
        law: name(|kind| &kind.law),
        profile: name(|kind| &kind.profile),
        waves: kind.map(|kind| kind.waves),
        iterations: kind.map(|kind| kind.iterations),
        heard: first.stimulus.hits > 0,
        answers: answers.len(),
        people: people.len(),
        source: errors(|of| of.source_lateral_deg),
        observer: errors(|of| of.observer_lateral_deg),
        confusion,
        side_is_clicked: share(|of| Side::of(folded_deg(of.answer.azimuth_deg)) == of.answer.side),
        clicked_behind: share(|of| is_behind(of.answer.azimuth_deg)),
        confidence: mean(confidence).unwrap_or(0.0),
    })
}

fn is_behind(azimuth_deg: f64) -> bool {
    azimuth_deg.abs() > 90.0
}
