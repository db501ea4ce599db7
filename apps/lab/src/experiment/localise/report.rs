//! The results of the experiment with the observer model, as plain data.

use super::statistics::{ErrorFigures, Figure, Share};
use serde::Serialize;

/// The results of the whole experiment.
#[derive(Clone, Debug, Serialize)]
pub struct LocaliseReport {
    /// The OpenGL renderer's name.
    pub renderer: String,
    /// Name of the panning law.
    pub law: String,
    /// Number of frames per setting and facing, each with a different seed.
    pub seeds: u32,
    /// Duration of the run, in seconds.
    pub seconds: f64,
    /// The nominal coverage of the confidence intervals; see `rough`.
    pub confidence: f64,
    /// Whether there are too few seeds for intervals of that coverage.
    pub rough: bool,
    /// Number of resamples of the bootstrap.
    pub resamples: usize,
    /// Largest lateral angle, in degrees, that counts as the centre.
    pub centre_deg: f64,
    /// Settings of the rooms that were too large to run, as pairs of waves and iterations.
    pub left_out: Vec<(u32, u32)>,
    /// The results in the open, where the answers of the observer must be right.
    pub open: Vec<OpenReport>,
    /// The results in the rooms.
    pub scenes: Vec<SceneReport>,
    /// For each figure, the number of waves or iterations beyond which a larger number gives no improvement.
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
    /// Number of iterations. One iteration gives only the direct path. More iterations include reflections from the
    /// ground, if there is one.
    pub iterations: u32,
    /// Whether there is a reflecting ground.
    pub ground: bool,
    /// Distance of the source, in metres.
    pub distance_m: f64,
    /// *m* of the observer that knows the distance.
    pub mean_side: f64,
    /// *m* of the observer that does not know the distance.
    pub blind_mean_side: f64,
    /// The errors over all azimuths; `None` if no wave was heard.
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
    /// The mean answer, in degrees; `None` if no wave was heard.
    pub answer_deg: Option<f64>,
    /// The errors of the answers; `None` if no wave was heard.
    pub error: Option<ErrorFigures>,
    /// The errors of the observer that does not know the distance.
    pub blind: Option<ErrorFigures>,
}

/// The results in one room.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// The room's name.
    pub scene: String,
    /// Distance from the listener to the source, in metres.
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
    /// The rotation of the listener in the world, in degrees.
    pub yaw_deg: f64,
    /// Azimuth of the source in degrees, positive to the right of the gaze.
    pub azimuth_deg: f64,
    /// Lateral angle of the source in degrees, which determines the levels.
    pub lateral_deg: f64,
    /// The converged panning of `hybrid`, for each number of iterations.
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
    /// Share of the trials in which no wave arrived. These trials count only in `hits` and in the last column of the
    /// confusion table.
    pub unheard: f64,
    /// Number of waves that arrived, averaged over the trials.
    pub hits: f64,
    /// Errors relative to the true direction of the source; `None` if no wave was heard.
    pub source: Option<ErrorFigures>,
    /// Errors relative to the converged panning of `hybrid` after the same number of iterations.
    pub limit: Option<ErrorFigures>,
    /// Numbers of trials, with one row per side of the source and one column per answered side, in the order left,
    /// centre, right. A further last column counts trials in which no wave was heard.
    pub confusion: [[u32; 4]; 3],
    /// Share of the heard trials in which the answered side was right; `None` if no wave was heard.
    pub side_right: Option<Share>,
}

/// The number of waves or iterations beyond which a larger number gives no improvement.
#[derive(Clone, Debug, Serialize)]
pub struct Plateau {
    /// Name of the scene.
    pub scene: String,
    /// Name of the sound.
    pub sound: String,
    /// Name of the profile.
    pub profile: String,
    /// The name of the figure: the median error relative to the `source` (the true direction) or to the `limit` (the
    /// converged panning), or the `spread`.
    pub of: &'static str,
    /// The number that varies: `waves` or `iterations`.
    pub along: &'static str,
    /// The other number, which is fixed.
    pub fixed: u32,
    /// The smallest number from which on every figure is as good as the figure at the largest number. A figure is as
    /// good if more than half of the trials are heard and it is within the upper end of the interval or within the
    /// audible angle. `None` if the largest number has no such figure. If no smaller number qualifies, `count` is the
    /// largest number, and the beginning of the plateau is unknown.
    pub count: Option<u32>,
    /// The number with the smallest figure, among those numbers with which more than half of the trials are heard.
    pub least: Option<u32>,
    /// The largest number measured.
    pub largest: u32,
    /// The figure at the largest number, in degrees; `None` if no wave was heard.
    pub there: Option<Figure>,
}

impl Plateau {
    /// The number of the plateau as text: the number, `not by` and the largest number, or `none`.
    pub fn told(&self) -> String {
        match self.count {
            None => "none".to_owned(),
            Some(count) if count == self.largest => format!("not by {count}"),
            Some(count) => count.to_string(),
        }
    }
}
