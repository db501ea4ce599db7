//! The results of the experiment with the observer, as plain data.

use super::statistics::{ErrorFigures, Figure, Share};
use serde::Serialize;

/// The whole experiment.
#[derive(Clone, Debug, Serialize)]
pub struct LocaliseReport {
    /// The renderer's name in OpenGL.
    pub renderer: String,
    /// The law from panning values to levels.
    pub law: String,
    /// Number of frames per setting and facing, each with its own seed.
    pub seeds: u32,
    /// Duration of the run, in seconds.
    pub seconds: f64,
    /// The nominal coverage of the intervals; see `rough`.
    pub confidence: f64,
    /// Whether there are too few seeds for intervals of that coverage.
    pub rough: bool,
    /// Number of resamples of the bootstrap.
    pub resamples: usize,
    /// Lateral angles up to this are the centre, in degrees.
    pub centre_deg: f64,
    /// Settings of the rooms that were too large, as waves and iterations.
    pub left_out: Vec<(u32, u32)>,
    /// The observer in the open, where it has to be right.
    pub open: Vec<OpenReport>,
    /// The rooms.
    pub scenes: Vec<SceneReport>,
    /// The numbers of waves or iterations above which more do not help.
    pub plateaus: Vec<Plateau>,
    /// The largest difference between the answers to two sounds with the same panning value, in
    /// degrees.
    pub largest_difference_of_sounds_deg: f64,
}

/// The observer in the open with one setting.
#[derive(Clone, Debug, Serialize)]
pub struct OpenReport {
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Number of iterations: 1 gives only the straight path, more also the ground if there is one.
    pub iterations: u32,
    /// Whether there is a ground that reflects.
    pub ground: bool,
    /// Distance of the source, in metres.
    pub distance_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// *m* of the observer that does not know the distance.
    pub blind_mean_side: f64,
    /// The figures over all azimuths; none without hits.
    pub all: Option<ErrorFigures>,
    /// The same for the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
    /// One entry per azimuth.
    pub azimuths: Vec<OpenDirection>,
    /// One entry per direction with the same lateral angle: ahead, behind, above.
    pub alike: Vec<OpenDirection>,
}

/// The observer with the source in one direction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OpenDirection {
    /// Azimuth of the source, right of the gaze, in degrees.
    pub azimuth_deg: f64,
    /// Elevation of the source above the ears, in degrees.
    pub elevation_deg: f64,
    /// Its lateral angle, which levels determine, in degrees.
    pub lateral_deg: f64,
    /// The mean answer, in degrees; none without hits.
    pub answer_deg: Option<f64>,
    /// The errors of the answers; none without hits.
    pub error: Option<ErrorFigures>,
    /// The same for the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
}

/// One room.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// Its name.
    pub scene: String,
    /// Straight distance from the listener to the source, in metres.
    pub distance_m: f64,
    /// The listener's radius, in metres.
    pub radius_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// The turns of the listener.
    pub facings: Vec<FacingReport>,
    /// One entry per sound and setting.
    pub cells: Vec<Cell>,
}

/// One facing of the listener.
#[derive(Clone, Debug, Serialize)]
pub struct FacingReport {
    /// The listener's turn in the world, in degrees.
    pub yaw_deg: f64,
    /// Azimuth of the source, right of the gaze, in degrees.
    pub azimuth_deg: f64,
    /// Its lateral angle, which levels determine.
    pub lateral_deg: f64,
    /// The converged panning of `hybrid`, one entry per number of iterations.
    pub limits: Vec<LimitReport>,
}

/// The converged panning of `hybrid` after a number of iterations.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LimitReport {
    /// Number of iterations.
    pub iterations: u32,
    /// Panning value.
    pub pan: f64,
    /// Its standard error.
    pub uncertainty: f64,
    /// The observer's answer to it, in degrees.
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
    /// Number of waves.
    pub waves: u32,
    /// Number of iterations.
    pub iterations: u32,
    /// Facings × seeds.
    pub trials: u32,
    /// Share of the trials in which no wave arrived. They count only in the hits and in the last
    /// column of the confusion.
    pub unheard: f64,
    /// Waves that arrived, mean over the trials.
    pub hits: f64,
    /// Errors against the straight direction of the source; none without hits.
    pub source: Option<ErrorFigures>,
    /// Errors against the converged panning of `hybrid` after the same number of iterations.
    pub limit: Option<ErrorFigures>,
    /// Numbers of trials: rows are the side of the source, columns the side answered, each left,
    /// centre, right; the last column counts trials in which nothing was heard.
    pub confusion: [[u32; 4]; 3],
    /// Share of the heard trials with the right side; none without hits.
    pub side_right: Option<Share>,
}

/// The number above which more do not help.
#[derive(Clone, Debug, Serialize)]
pub struct Plateau {
    /// Name of the scene.
    pub scene: String,
    /// Name of the sound.
    pub sound: String,
    /// Name of the profile.
    pub profile: String,
    /// The figure: the median error against the `source` (the straight direction) or the `limit`
    /// (the converged panning), or the `spread`.
    pub of: &'static str,
    /// The number that grows: `waves` or `iterations`.
    pub along: &'static str,
    /// The other number, which is fixed.
    pub fixed: u32,
    /// The smallest number from which on every figure is within the upper end of the largest
    /// number's interval, or within the audible angle of it, with more than half of the trials
    /// heard. None if the largest does not satisfy this; the largest itself if no smaller number
    /// does, so that the beginning of the plateau is unknown.
    pub count: Option<u32>,
    /// The number with the smallest figure, of those with more than half of their trials heard.
    pub least: Option<u32>,
    /// The largest number measured.
    pub largest: u32,
    /// The figure at the largest number, in degrees; none without hits.
    pub there: Option<Figure>,
}

impl Plateau {
    /// The number in words: a number, `not by` the largest, or `none`.
    pub fn told(&self) -> String {
        match self.count {
            None => "none".to_owned(),
            Some(count) if count == self.largest => format!("not by {count}"),
            Some(count) => count.to_string(),
        }
    }
}
