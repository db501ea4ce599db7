//! What the experiment with the observer finds, as plain data.

use super::statistics::ErrorFigures;
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
    /// Share of resampled medians in an interval.
    pub confidence: f64,
    /// Drawings of the bootstrap.
    pub resamples: usize,
    /// Lateral angles up to this are the centre, in degrees.
    pub centre_deg: f64,
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
    /// Iterations: 1 hears the straight way alone, more also the ground.
    pub iterations: u32,
    /// How far the source is, in metres.
    pub distance_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// Over all azimuths.
    pub all: ErrorFigures,
    /// An entry an azimuth.
    pub azimuths: Vec<OpenAzimuth>,
}

/// The observer with the source in one direction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OpenAzimuth {
    /// Where the source is, in degrees.
    pub azimuth_deg: f64,
    /// How the answers are.
    pub error: ErrorFigures,
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
    /// The same as far as levels can tell it.
    pub lateral_deg: f64,
    /// The best any panning by level can do.
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
    /// Share of the trials in which no wave arrived: their answer is the middle.
    pub unheard: f64,
    /// Waves that arrived, mean over the trials.
    pub hits: f64,
    /// Against the straight way to the source.
    pub source: ErrorFigures,
    /// Against the converged panning of `hybrid` after as many iterations.
    pub limit: ErrorFigures,
    /// Trials: rows the side of the source, columns the side answered, each left, centre,
    /// right.
    pub confusion: [[u32; 3]; 3],
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
    /// The truth: `source` (the straight way) or `limit` (the converged panning).
    pub against: &'static str,
    /// What grows: `waves` or `iterations`.
    pub along: &'static str,
    /// The other of the two, which does not.
    pub fixed: u32,
    /// The smallest count from which the median error stays within the interval of the
    /// largest count's, or below it, with more than half of the trials hearing something;
    /// none if that is not so at the largest.
    pub count: Option<u32>,
    /// The count with the smallest median error, of those that hear something in more than
    /// half of their trials.
    pub best: Option<u32>,
    /// The largest count there was.
    pub largest: u32,
    /// Median error at the largest count, with its interval, in degrees.
    pub error: ErrorFigures,
}
