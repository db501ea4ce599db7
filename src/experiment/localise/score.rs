//! What test persons answered, set beside where the source is and what levels can tell.
//!
//! A click on the plan has an azimuth all around; levels tell only its lateral angle. So the
//! error is that of the azimuth folded to the front, and how many clicks lie behind is told
//! apart. Several files of one session are one session: answers are locked once given, so
//! later files only add to earlier ones; two that contradict each other are refused.

use super::answers::{Answer, AnswersError, Session, StimulusInfo, TrialAnswer};
use super::observer::{Side, folded_deg};
use super::statistics::{ErrorFigures, Pair, figures, mean};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// All answers, scored.
#[derive(Clone, Debug, Serialize)]
pub struct ScoreReport {
    /// An entry a session, in the order given.
    pub sessions: Vec<SessionLine>,
    /// All answers together, then those of each scene, sound and setting.
    pub groups: Vec<Group>,
    /// What was noticed about the files.
    pub notes: Vec<String>,
}

/// One session.
#[derive(Clone, Debug, Serialize)]
pub struct SessionLine {
    /// The files that it was read from.
    pub files: Vec<String>,
    /// Which form.
    pub experiment: String,
    /// Which session.
    pub session: String,
    /// The person's code.
    pub participant: String,
    /// Trials with an answer.
    pub answered: usize,
    /// Trials in the form.
    pub trials: usize,
}

/// Answers of a kind.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// Name of the scene; empty for all.
    pub scene: String,
    /// Name of the sound; empty for all.
    pub sound: String,
    /// Name of the profile; empty for all.
    pub profile: String,
    /// Waves; none for all.
    pub waves: Option<u32>,
    /// Iterations; none for all.
    pub iterations: Option<u32>,
    /// How many.
    pub answers: usize,
    /// Folded clicks against the lateral angle of the source.
    pub source: ErrorFigures,
    /// Folded clicks against what the observer answers to the same sounds.
    pub observer: ErrorFigures,
    /// Rows the side of the source, columns the side ticked, each left, centre, right.
    pub confusion: [[u32; 3]; 3],
    /// Share of the answers whose ticked side is the click's.
    pub side_is_clicked: f64,
    /// Share of clicks that are behind when the source is ahead, or the other way round.
    pub front_back_confused: f64,
    /// Mean confidence, 1 to 5.
    pub confidence: f64,
}

/// A session with the files that it came from.
struct Merged {
    files: Vec<PathBuf>,
    session: Session,
}

/// An answered trial.
type Answered<'a> = (&'a StimulusInfo, &'a Answer);

/// Reads and scores files of answers.
///
/// # Errors
/// [`AnswersError`] for the first file that cannot be taken.
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
            "session {session} was broken off: {open} of {} trials are not answered",
            line.trials
        ));
    }
    let mut groups = Vec::new();
    if !all.is_empty() {
        groups.push(group(&all, None));
    }
    for kind in kinds(&all) {
        let of = |answer: &&Answered| key(answer.0) == key(kind);
        let alike: Vec<Answered> = all.iter().filter(of).copied().collect();
        groups.push(group(&alike, Some(kind)));
    }
    Ok(ScoreReport {
        sessions,
        groups,
        notes,
    })
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
    let trials = session.trials.iter();
    trials.filter_map(|trial| Some((&trial.stimulus, trial.answer.as_ref()?)))
}

fn key(of: &StimulusInfo) -> (&str, &str, &str, u32, u32) {
    (&of.scene, &of.sound, &of.profile, of.waves, of.iterations)
}

/// One stimulus of each kind, in order of the kinds.
fn kinds<'a>(all: &[Answered<'a>]) -> Vec<&'a StimulusInfo> {
    let mut kinds: Vec<&StimulusInfo> = all.iter().map(|answer| answer.0).collect();
    kinds.sort_by(|a, b| key(a).cmp(&key(b)));
    kinds.dedup_by(|a, b| key(a) == key(b));
    kinds
}

/// The figures of some answers: of one kind, or of all.
fn group(answers: &[Answered], kind: Option<&StimulusInfo>) -> Group {
    let pairs = |truth: fn(&StimulusInfo) -> f64| -> Vec<Pair> {
        let pair = |&(stimulus, answer): &Answered| Pair {
            truth_deg: truth(stimulus),
            answer_deg: folded_deg(answer.azimuth_deg),
        };
        answers.iter().map(pair).collect()
    };
    let share = |is: fn(&Answered) -> bool| {
        mean(answers.iter().map(|answer| f64::from(u8::from(is(answer)))))
    };
    let mut confusion = [[0; 3]; 3];
    for (stimulus, answer) in answers {
        confusion[Side::of(stimulus.source_lateral_deg) as usize][answer.side as usize] += 1;
    }
    let name = |of: fn(&StimulusInfo) -> &String| kind.map_or_else(String::new, |k| of(k).clone());
    Group {
        scene: name(|kind| &kind.scene),
        sound: name(|kind| &kind.sound),
        profile: name(|kind| &kind.profile),
        waves: kind.map(|kind| kind.waves),
        iterations: kind.map(|kind| kind.iterations),
        answers: answers.len(),
        source: figures(&pairs(|of| of.source_lateral_deg)),
        observer: figures(&pairs(|of| of.observer_lateral_deg)),
        confusion,
        side_is_clicked: share(|(_, answer)| {
            Side::of(folded_deg(answer.azimuth_deg)) == answer.side
        }),
        front_back_confused: share(|(stimulus, answer)| {
            is_behind(stimulus.source_azimuth_deg) != is_behind(answer.azimuth_deg)
        }),
        confidence: mean(
            answers
                .iter()
                .map(|(_, answer)| f64::from(answer.confidence)),
        ),
    }
}

fn is_behind(azimuth_deg: f64) -> bool {
    azimuth_deg.abs() > 90.0
}
