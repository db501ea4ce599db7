//! What the experiment with the observer finds, as plain data.

use super::statistics::{ErrorFigures, Figure, Share};
use serde::Serialize;

/// The whole experiment.
#[derive(Clone, Debug, Serialize)]
pub struct LocaliseReport {
    /// OpenGL's name for the renderer.
    pub renderer: String,
    /// How panning values become levels.
    pub law: String,
    /// Frames of each setting and facing, a seed each.
    pub seeds: u32,
    /// How long it took, in seconds.
    pub seconds: f64,
    /// What the intervals are to hold: see `rough`.
    pub confidence: f64,
    /// Whether there are fewer seeds than an interval of that name takes.
    pub rough: bool,
    /// Drawings of the bootstrap.
    pub resamples: usize,
    /// Lateral angles up to this are the centre, in degrees.
    pub centre_deg: f64,
    /// Settings of the rooms that were too large, as waves and iterations.
    pub left_out: Vec<(u32, u32)>,
    /// The observer in the open, where it has to be right.
    pub open: Vec<OpenReport>,
    /// The rooms.
    pub scenes: Vec<SceneReport>,
    /// Where more waves or iterations stop helping.
    pub plateaus: Vec<Plateau>,
    /// The most that answers to the same panning value and two sounds differ by, in degrees.
    pub largest_difference_of_sounds_deg: f64,
}

/// The observer in the open with one setting.
#[derive(Clone, Debug, Serialize)]
pub struct OpenReport {
    /// Name of the profile.
    pub profile: String,
    /// Waves.
    pub waves: u32,
    /// Iterations: 1 hears the straight way alone, more also the ground if there is one.
    pub iterations: u32,
    /// Whether there is a ground that reflects.
    pub ground: bool,
    /// How far the source is, in metres.
    pub distance_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// *m* of the observer that does not know the distance.
    pub blind_mean_side: f64,
    /// Over all azimuths; none if nothing is heard.
    pub all: Option<ErrorFigures>,
    /// The same of the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
    /// An entry an azimuth.
    pub azimuths: Vec<OpenDirection>,
    /// An entry a direction that has the lateral angle of the others: ahead, behind, above.
    pub alike: Vec<OpenDirection>,
}

/// The observer with the source in one direction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OpenDirection {
    /// Where the source is, right of the gaze, in degrees.
    pub azimuth_deg: f64,
    /// Where it is, above the ears, in degrees.
    pub elevation_deg: f64,
    /// What levels determine of that, in degrees.
    pub lateral_deg: f64,
    /// The mean answer, in degrees; none if nothing is heard.
    pub answer_deg: Option<f64>,
    /// How the answers are; none if nothing is heard.
    pub error: Option<ErrorFigures>,
    /// The same of the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
}

/// One room.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// Its name.
    pub scene: String,
    /// Straight from listener to source, in metres.
    pub distance_m: f64,
    /// The listener's radius, in metres.
    pub radius_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// How the listener is turned.
    pub facings: Vec<FacingReport>,
    /// An entry a sound and setting.
    pub cells: Vec<Cell>,
}

/// One way for the listener to face.
#[derive(Clone, Debug, Serialize)]
pub struct FacingReport {
    /// The listener's turn in the world, in degrees.
    pub yaw_deg: f64,
    /// Straight to the source, right of the gaze, in degrees.
    pub azimuth_deg: f64,
    /// The same as far as levels determine it.
    pub lateral_deg: f64,
    /// The converged panning of `hybrid`, an entry a count of iterations.
    pub limits: Vec<LimitReport>,
}

/// The converged panning of `hybrid` after so many iterations.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LimitReport {
    /// Iterations.
    pub iterations: u32,
    /// Panning value.
    pub pan: f64,
    /// Its standard error.
    pub uncertainty: f64,
    /// What the observer takes it for, in degrees.
    pub lateral_deg: f64,
    /// Share of the waves that are heard.
    pub heard: f64,
}

/// One sound and setting, over all facings and seeds.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// Name of the sound.
    pub sound: String,
    /// Name of the profile.
    pub profile: String,
    /// Waves.
    pub waves: u32,
    /// Iterations.
    pub iterations: u32,
    /// Facings × seeds.
    pub trials: u32,
    /// Share of the trials in which no wave arrived. They are in no other figure but the hits
    /// and the last column of the confusion.
    pub unheard: f64,
    /// Waves that arrived, mean over the trials.
    pub hits: f64,
    /// Against the straight way to the source; none if nothing is heard.
    pub source: Option<ErrorFigures>,
    /// Against the converged panning of `hybrid` after as many iterations.
    pub limit: Option<ErrorFigures>,
    /// Trials: rows the side of the source, columns the side answered, each left, centre,
    /// right; the last column those in which nothing was heard.
    pub confusion: [[u32; 4]; 3],
    /// Share of the heard trials with the right side; none if nothing is heard.
    pub side_right: Option<Share>,
}

/// From where on more does not help.
#[derive(Clone, Debug, Serialize)]
pub struct Plateau {
    /// Name of the scene.
    pub scene: String,
    /// Name of the sound.
    pub sound: String,
    /// Name of the profile.
    pub profile: String,
    /// Of which figure: the median error against the `source` (the straight way) or the
    /// `limit` (the converged panning), or the `spread`.
    pub of: &'static str,
    /// What grows: `waves` or `iterations`.
    pub along: &'static str,
    /// The other of the two, which does not.
    pub fixed: u32,
    /// The smallest count from which on every figure is within the upper end of the largest
    /// count's interval, or within the audible angle of it, with more than half of the trials
    /// hearing something. None if that is not so at the largest; the largest itself if the
    /// plateau does not begin before it, so that nothing is known of where it does.
    pub count: Option<u32>,
    /// The count with the smallest figure, of those that hear something in more than half of
    /// their trials.
    pub least: Option<u32>,
    /// The largest count there was.
    pub largest: u32,
    /// The figure at the largest count, in degrees; none if nothing is heard there.
    pub there: Option<Figure>,
}

impl Plateau {
    /// The count in words: a number, `not by` the largest, or `none`.
    pub fn told(&self) -> String {
        match self.count {
            None => "none".to_owned(),
            Some(count) if count == self.largest => format!("not by {count}"),
            Some(count) => count.to_string(),
        }
    }
}
