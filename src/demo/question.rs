//! The localisation experiment in the window: where does it come from?
//!
//! One stands still, facing the screen as the thesis' test persons did (section 4.1), sees the
//! room without its source, plays the sound as often as one likes, and answers on a plan
//! with the gaze upwards. What is heard is traced anew in every frame, with the settings of
//! the trial.

use super::app::App;
use super::keys::Action;
use super::overlay::Asked;
use super::state::World;
use crate::experiment::localise::sitting::{Put, Sitting, SittingError, now, settings_of};
use crate::experiment::localise::{Answer, MOST_CONFIDENT, Side};
use glam::DVec2;
use std::time::{Duration, Instant};
use winit::keyboard::KeyCode;

/// How far an arrow key moves the mark, as a share of the plan's width.
const STEP: f64 = 0.04;

/// A sitting, and the trial under way.
#[derive(Debug)]
pub struct Question {
    sitting: Sitting,
    /// The index of the trial under way; none when all are answered.
    trial: Option<usize>,
    /// What is marked so far.
    pub draft: Draft,
    /// How long the sound plays each time.
    length: Duration,
    plays: u32,
    first_played: Option<Instant>,
    plays_until: Option<Instant>,
}

/// An answer that is not locked yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Draft {
    /// The mark, in metres to the right of the listener and ahead.
    pub mark: Option<DVec2>,
    /// From which side it seems to come.
    pub side: Option<Side>,
    /// 1, a guess, to [`MOST_CONFIDENT`], certain.
    pub confidence: Option<u32>,
}

impl Question {
    /// The first open trial of a sitting, whose sounds play for `seconds` each time.
    pub fn new(sitting: Sitting, seconds: f64) -> Question {
        Question {
            trial: sitting.next(),
            sitting,
            draft: Draft::default(),
            length: Duration::from_secs_f64(seconds),
            plays: 0,
            first_played: None,
            plays_until: None,
        }
    }

    /// The trial under way.
    pub fn put(&self) -> Option<Put<'_>> {
        self.sitting.trial(self.trial?)
    }

    /// Trials that are answered, and all.
    pub fn progress(&self) -> [usize; 2] {
        self.sitting.progress()
    }

    /// Whether every answer is in the file.
    pub fn is_saved(&self) -> bool {
        self.sitting.is_saved()
    }

    /// Where the answers are kept.
    pub fn file(&self) -> String {
        self.sitting.file().display().to_string()
    }

    /// How often the sound of this trial was played.
    pub fn plays(&self) -> u32 {
        self.plays
    }

    /// Whether it plays now.
    pub fn is_playing(&self) -> bool {
        self.plays_until.is_some_and(|end| Instant::now() < end)
    }

    /// What an answer still lacks, for people; nothing when it can be locked.
    pub fn missing(&self) -> Vec<&'static str> {
        let draft = &self.draft;
        let lacks = [
            (self.plays == 0, "play it"),
            (self.direction().is_none(), "mark the plan"),
            (draft.side.is_none(), "choose a side"),
            (draft.confidence.is_none(), "say how sure you are"),
        ];
        lacks
            .into_iter()
            .filter_map(|(lacks, what)| lacks.then_some(what))
            .collect()
    }

    /// The mark, unless it is on the listener, where it has no direction.
    fn direction(&self) -> Option<DVec2> {
        let radius = self.put()?.plan.radius;
        self.draft.mark.filter(|mark| mark.length() > radius)
    }

    /// Writes what could not be written before.
    ///
    /// # Errors
    /// [`SittingError`] when it still cannot.
    pub fn finish(&mut self) -> Result<(), SittingError> {
        match self.sitting.is_saved() {
            true => Ok(()),
            false => self.sitting.save(),
        }
    }

    fn play(&mut self) {
        let now = Instant::now();
        self.plays += 1;
        self.first_played.get_or_insert(now);
        self.plays_until = Some(now + self.length);
    }

    /// Moves the mark, or puts it ahead of the listener if there is none.
    fn nudge(&mut self, by: DVec2) {
        let Some(put) = self.put() else {
            return;
        };
        let (min, max, radius) = (put.plan.min, put.plan.max, put.plan.radius);
        let step = STEP * (max.x - min.x);
        let moved = match self.draft.mark {
            Some(mark) => mark + step * by,
            None => DVec2::new(0.0, 2.0 * radius),
        };
        self.draft.mark = Some(moved.clamp(min, max));
    }

    /// The answer, once nothing is missing.
    fn answer(&self) -> Option<Answer> {
        let mark = self.direction()?;
        Some(Answer {
            right_m: mark.x,
            ahead_m: mark.y,
            azimuth_deg: mark.x.atan2(mark.y).to_degrees(),
            side: self.draft.side?,
            confidence: self.draft.confidence?,
            plays: self.plays,
            seconds: self.first_played?.elapsed().as_secs_f64(),
            answered: now(),
        })
    }

    fn go_on(&mut self) {
        self.trial = self.sitting.next();
        self.draft = Draft::default();
        (self.plays, self.first_played, self.plays_until) = (0, None, None);
    }
}

/// What a key asks for while a question is put.
pub fn asked(key: KeyCode) -> Option<Asked> {
    let nudge = |x, y| Some(Asked::Nudge(DVec2::new(x, y)));
    match key {
        KeyCode::Space => Some(Asked::Play),
        KeyCode::Enter | KeyCode::NumpadEnter => Some(Asked::Lock),
        KeyCode::KeyA => Some(Asked::Side(Side::Left)),
        KeyCode::KeyW => Some(Asked::Side(Side::Centre)),
        KeyCode::KeyD => Some(Asked::Side(Side::Right)),
        KeyCode::ArrowLeft => nudge(-1.0, 0.0),
        KeyCode::ArrowRight => nudge(1.0, 0.0),
        KeyCode::ArrowUp => nudge(0.0, 1.0),
        KeyCode::ArrowDown => nudge(0.0, -1.0),
        KeyCode::Digit1 => Some(Asked::Confidence(1)),
        KeyCode::Digit2 => Some(Asked::Confidence(2)),
        KeyCode::Digit3 => Some(Asked::Confidence(3)),
        KeyCode::Digit4 => Some(Asked::Confidence(4)),
        KeyCode::Digit5 => Some(Asked::Confidence(MOST_CONFIDENT)),
        _ => None,
    }
}

/// Whether a key's usual action makes no difference to the direction that is heard, nor to
/// what is answered.
pub fn is_harmless(action: &Action) -> bool {
    matches!(
        action,
        Action::Volume(_) | Action::Screenshot | Action::Quit
    )
}

impl App {
    /// Stands where the trial under way is put, with its settings and its sound.
    pub fn stand(&mut self) {
        let Some(put) = self.question.as_ref().and_then(Question::put) else {
            return;
        };
        self.world = World::of(put.room.clone());
        self.choices.settings = settings_of(put.stimulus);
        if let Ok(law) = put.stimulus.law.parse() {
            self.choices.chosen_law = Some(law);
        }
        let sound = put.stimulus.sound.clone();
        // It is loaded while nothing is heard.
        if let Err(reason) = self.speaker.set_sound(&sound) {
            self.say(reason);
        }
        self.choices.sound = sound;
        self.heard = None;
        self.begins_anew = true;
        self.scale_control.forget();
    }

    /// Does what was asked for while a question is put.
    pub fn ask(&mut self, asked: Asked) {
        let Some(question) = self.question.as_mut().filter(|q| q.trial.is_some()) else {
            return;
        };
        match asked {
            // What is not heard cannot be answered.
            Asked::Play if !self.sound.is_heard => {
                let text = format!("nothing can be heard: {}", self.sound.text);
                self.say(text);
            }
            Asked::Play => {
                question.play();
                let sound = self.choices.sound.clone();
                if let Err(reason) = self.speaker.set_sound(&sound) {
                    self.say(reason);
                }
            }
            Asked::Mark(mark) => question.draft.mark = Some(mark),
            Asked::Nudge(by) => question.nudge(by),
            Asked::Side(side) => question.draft.side = Some(side),
            Asked::Confidence(confidence) => question.draft.confidence = Some(confidence),
            Asked::Lock => self.lock(),
        }
    }

    /// Keeps the answer and goes on, if nothing is missing.
    fn lock(&mut self) {
        let Some(question) = &mut self.question else {
            return;
        };
        let missing = question.missing();
        let (Some(trial), Some(answer), true) =
            (question.trial, question.answer(), missing.is_empty())
        else {
            let text = format!("first {}", missing.join(", "));
            self.say(text);
            return;
        };
        // What cannot be written now is written with the next answer, or at the end.
        let written = question.sitting.lock(trial, answer);
        question.go_on();
        self.stand();
        if let Err(error) = written {
            self.say(error.to_string());
        }
    }
}
