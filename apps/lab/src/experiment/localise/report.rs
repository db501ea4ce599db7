//! The results of the observer experiment, as plain data.

use super::statistics::{ErrorFigures, Figure, Share};
use serde::Serialize;

/// The results of the whole experiment.
#[derive(Clone, Debug, Serialize)]
pub struct LocaliseReport {
    /// The renderer's name in OpenGL.
    pub renderer: String,
    /// Name of the panning law, from panning values to levels.
    pub law: String,
    /// Number of frames per setting and facing, each with a different seed.
    pub seeds: u32,
    /// Duration of the run, in seconds.
    pub seconds: f64,
    /// The nominal coverage of the intervals; see `rough`.
    pub confidence: f64,
    /// Whether there are too few seeds for intervals of that coverage.
    pub rough: bool,
    /// Number of resamples of the bootstrap.
    pub resamples: usize,
    /// Largest lateral angle, in degrees, that counts as the centre.
    pub centre_deg: f64,
    /// Settings of the rooms that were too large to run, as pairs of waves and iterations.
    pub left_out: Vec<(u32, u32)>,
    /// The results of the observer in the open, where the observer must be right.
    pub open: Vec<OpenReport>,
    /// The results in the rooms.
    pub scenes: Vec<SceneReport>,
    /// For each figure, the number of waves or iterations beyond which a larger number does not
    /// help.
    pub plateaus: Vec<Plateau>,
    /// The largest difference between the answers to two sounds with the same panning value, in
    /// degrees.
    pub largest_difference_of_sounds_deg: f64,
}

/// The results of the observer in the open with one setting.
#[derive(Clone, Debug, Serialize)]
pub struct OpenReport {
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Number of iterations: 1 gives only the straight path, more iterations also include
    /// reflections from the ground if there is one.
    pub iterations: u32,
    /// Whether there is a reflecting ground.
    pub ground: bool,
    /// Distance of the source, in metres.
    pub distance_m: f64,
    /// *m* of the observer that knows the distance.
    pub mean_side: f64,
    /// *m* of the observer that does not know the distance.
    pub blind_mean_side: f64,
    /// The errors over all azimuths; none without hits.
    pub all: Option<ErrorFigures>,
    /// The errors over all azimuths of the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
    /// One entry per azimuth.
    pub azimuths: Vec<OpenDirection>,
    /// One entry per direction with the same lateral angle: ahead, behind, above.
    pub alike: Vec<OpenDirection>,
}

/// The results of the observer with the source in one direction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct OpenDirection {
    /// Azimuth of the source in degrees, positive to the right of the gaze.
    pub azimuth_deg: f64,
    /// Elevation of the source above the ears, in degrees.
    pub elevation_deg: f64,
    /// Lateral angle of the source in degrees, which determines the levels.
    pub lateral_deg: f64,
    /// The mean answer, in degrees; none without hits.
    pub answer_deg: Option<f64>,
    /// The errors of the answers; none without hits.
    pub error: Option<ErrorFigures>,
    /// The errors of the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
}

/// The results in one room.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// The room's name.
    pub scene: String,
    /// Straight distance from the listener to the source, in metres.
    pub distance_m: f64,
    /// The listener's radius, in metres.
    pub radius_m: f64,
    /// *m* of the observer.
    pub mean_side: f64,
    /// The results for each facing of the listener.
    pub facings: Vec<FacingReport>,
    /// One entry per sound and setting.
    pub cells: Vec<Cell>,
}

/// One facing of the listener.
#[derive(Clone, Debug, Serialize)]
pub struct FacingReport {
    /// The listener's turn in the world, in degrees.
    pub yaw_deg: f64,
    /// Azimuth of the source in degrees, positive to the right of the gaze.
    pub azimuth_deg: f64,
    /// Lateral angle of the source in degrees, which determines the levels.
    pub lateral_deg: f64,
    /// The converged panning of `hybrid`, one entry per number of iterations.
    pub limits: Vec<LimitReport>,
}

/// The converged panning of `hybrid` after a number of iterations.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LimitReport {
    /// Number of iterations.
    pub iterations: u32,
    /// The panning value.
    pub pan: f64,
    /// The standard error of the panning value.
    pub uncertainty: f64,
    /// The observer's answer to the panning value, in degrees.
    pub lateral_deg: f64,
    /// Share of waves that are heard.
    pub heard: f64,
}

/// The results for one sound and setting, over all facings and seeds.
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
    /// Number of trials: facings × seeds.
    pub trials: u32,
    /// Share of the trials in which no wave arrived. These trials count only in the hits and in the
    /// last column of the confusion table.
    pub unheard: f64,
    /// Number of waves that arrived, averaged over the trials.
    pub hits: f64,
    /// Errors relative to the straight direction of the source; none without hits.
    pub source: Option<ErrorFigures>,
    /// Errors relative to the converged panning of `hybrid` after the same number of iterations.
    pub limit: Option<ErrorFigures>,
    /// Numbers of trials: one row per side of the source, one column per side answered (both left,
    /// centre, right). The last column counts trials in which no wave was heard.
    pub confusion: [[u32; 4]; 3],
    /// Share of the heard trials with the right side answered; none without hits.
    pub side_right: Option<Share>,
}

/// The number of waves or iterations beyond which a larger number does not help.
#[derive(Clone, Debug, Serialize)]
pub struct Plateau {
    /// Name of the scene.
    pub scene: String,
    /// Name of the sound.
    pub sound: String,
    /// Name of the profile.
    pub profile: String,
    /// The figure: the median error relative to the `source` (the straight direction) or to the
    /// `limit` (the converged panning), or the `spread`.
    pub of: &'static str,
    /// The number that varies: `waves` or `iterations`.
    pub along: &'static str,
    /// The other number, which is fixed.
    pub fixed: u32,
    /// The smallest number from which on every figure is as good as the figure at the largest
    /// number: within the upper end of its interval or within the audible angle of it, and with
    /// more than half of the trials heard. None if the largest number has no such figure. The
    /// largest number itself if no smaller number qualifies; the beginning of the plateau is then
    /// unknown.
    pub count: Option<u32>,
    /// The number with the smallest figure, among numbers with more than half of their trials
    /// heard.
    pub least: Option<u32>,
    /// The largest number measured.
    pub largest: u32,
    /// The figure at the largest number, in degrees; none without hits.
    pub there: Option<Figure>,
}

impl Plateau {
    /// The plateau's number in words: the number, `not by` and the largest number, or `none`.
    pub fn told(&self) -> String {
        match self.count {
            None => "none".to_owned(),
            Some(count) if count == self.largest => format!("not by {count}"),
            Some(count) => count.to_string(),
        }
    }
}
