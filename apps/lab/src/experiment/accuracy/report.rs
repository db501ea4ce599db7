//! The results of the experiment as plain data, for CSV, JSON, SVG and tables.

use super::surface_counts::SurfaceCounts;
use crate::stats::quantiles;
use serde::Serialize;

/// All measurements.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyReport {
    /// The renderer's name.
    pub renderer: String,
    /// The kind of clock that measured the times of the passes.
    pub clock: String,
    /// Whether all combinations of settings were run.
    pub full: bool,
    /// Number of seeds for each panning error.
    pub seeds: u32,
    /// Wall-clock time of the whole run, in seconds.
    pub seconds: f64,
    /// Maximum panning error of [`SceneReport::recommendation`].
    pub stated_error: f64,
    /// The scenes, in the requested order.
    pub scenes: Vec<SceneReport>,
    /// The project's own targets; empty if their scenes were not requested.
    pub targets: Vec<Target>,
    /// Impulse responses; empty if they were not requested.
    pub responses: Vec<ResponseRow>,
}

/// An impulse response compared with image sources. Each error is the largest over the bands; `None` if no band has the
/// figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResponseRow {
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Median time of a response, in milliseconds.
    pub milliseconds: f64,
    /// Relative error of the reverberation time.
    pub t30_error: Option<f64>,
    /// Relative error of the early decay time.
    pub edt_error: Option<f64>,
    /// Error of clarity, in decibels.
    pub c80_error_db: Option<f64>,
    /// Error of strength, in decibels.
    pub g_error_db: Option<f64>,
    /// Number of bands with a reverberation time.
    pub t30_bands: usize,
}

/// The results of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// The scene's name.
    pub scene: String,
    /// The numbers of surfaces by kind of intersection.
    pub surfaces: SurfaceCounts,
    /// Whether the exact waves are traced in samples of a user's field. The errors then include those of the samples.
    pub reference_is_sampled: bool,
    /// The panning in the limit of many waves, for each number of iterations.
    pub limits: Vec<Limit>,
    /// The growth of errors at curved surfaces.
    pub chaos: Chaos,
    /// One row per setting.
    pub rows: Vec<Row>,
    /// The decrease of the panning error with the number of waves.
    pub slopes: Vec<Slope>,
    /// The fastest row whose error does not exceed the stated error.
    pub recommendation: Option<Recommendation>,
    /// The row with the smallest panning error.
    pub best: Option<Recommendation>,
}

/// The panning of the exact geometry, from two lattices of directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// Number of iterations of every wave.
    pub iterations: u32,
    /// Number of directions in both lattices together.
    pub directions: u64,
    /// Mean panning of the two lattices.
    pub pan: f64,
    /// Half of the difference between the two lattices.
    pub uncertainty: f64,
    /// Share of all waves that are heard.
    pub heard: f64,
}

/// Exponential growth of small errors, measured on exact waves.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Chaos {
    /// Number of pairs of waves that were traced.
    pub pairs: u64,
    /// Number of iterations of each wave.
    pub iterations: u32,
    /// Number of pairs whose two waves met the same surfaces.
    pub same_sequence: u64,
    /// Geometric mean of the factor by which the separation grows from one curved surface to the next. `None` if no
    /// wave meets two curved surfaces.
    pub growth: Option<f64>,
    /// Number of curved surfaces met before a rounding error has grown to a centimetre.
    pub horizon: Option<f64>,
    /// Separations at the first, second and further curved surfaces.
    pub steps: Vec<ChaosStep>,
}

/// Waves at their n-th curved surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChaosStep {
    /// The number n of the curved surface, counted from 1.
    pub curved_hits: u32,
    /// Number of pairs that reached the surface.
    pub pairs: u64,
    /// Geometric mean of the separation of a pair divided by its initial angle, in metres per radian.
    pub separation: f64,
    /// Geometric mean of the growth of the separation since the previous curved surface.
    pub growth: Option<f64>,
}

/// One setting in one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The difference of the settings from the profile's defaults.
    pub label: String,
    /// The values of the swept settings.
    pub case: CaseReport,
    /// Median times.
    pub speed: Speed,
    /// Each wave compared with its exact twin.
    pub waves: WaveErrors,
    /// The panning compared with its limit.
    pub panning: PanningError,
}

/// The values of a row's swept settings.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CaseReport {
    /// Name of the profile.
    pub profile: String,
    /// Minimum distance in metres; `None` if the profile has none.
    pub min_distance: Option<f32>,
    /// Number of marches of each wave.
    pub iterations: u32,
    /// Number of waves.
    pub waves: u32,
    /// Name of the start directions.
    pub directions: String,
    /// Whether all iterations run in one pass.
    pub fused: bool,
    /// Whether the panning is summed on the GPU.
    pub sum_on_gpu: bool,
}

/// Median times of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Speed {
    /// Wall-clock time of a whole frame, in milliseconds.
    pub total_ms: f64,
    /// Time of the frame's march passes, in milliseconds.
    pub march_ms: f64,
    /// Throughput of whole frames, in millions of waves × iterations per second.
    pub million_per_second: f64,
    /// Evaluations of the distance ÷ flights of waves. Evaluations for normals count only in `thesis`.
    pub evaluations_per_flight: f64,
    /// Number of frames over which the medians are taken.
    pub frames: u32,
}

/// The comparison of waves with the exact waves of the same start directions.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WaveErrors {
    /// Number of compared waves.
    pub compared: u64,
    /// Number of flights of these waves. A wave makes one flight per iteration until it is heard or dead. The thesis'
    /// algorithm continues to march dead waves, and these flights also count.
    pub flights: u64,
    /// Share of waves whose final status differs.
    pub status_differs: f64,
    /// Share of waves that met different objects or ended with a different status.
    pub sequence_differs: f64,
    /// Number of waves without a finite end point (NaN or infinite).
    pub not_finite: u64,
    /// Distances between the end points in metres, over all waves with an exact end point.
    pub end: Quantiles,
    /// The distances of `end`, only for waves that meet at most as many curved surfaces as the horizon.
    pub end_within_horizon: Quantiles,
    /// Share of waves that meet more curved surfaces than the horizon.
    pub beyond_horizon: f64,
    /// Number of waves heard after 0, 1, 2 … reflections. Waves that `thesis` hears after their death count in its
    /// panning, but not here. (This profile continues to march dead waves.)
    pub hits: Vec<u64>,
    /// Number of exact waves heard after 0, 1, 2 … reflections.
    pub exact_hits: Vec<u64>,
}

impl WaveErrors {
    /// The largest difference between hits and exact hits over all orders of reflection.
    pub fn largest_hit_difference(&self) -> u64 {
        let pairs = self.hits.iter().zip(&self.exact_hits);
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    }
}

/// The distribution of a distance, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The maximum.
    pub max: f64,
}

impl Quantiles {
    /// Computes the quantiles of the given distances; 0 if there are none.
    pub fn of(distances: Vec<f64>) -> Quantiles {
        let [median, p99, max] = quantiles(distances, [0.5, 0.99, 1.0]);
        Quantiles { median, p99, max }
    }
}

/// The panning over all seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PanningError {
    /// Mean over the seeds.
    pub mean: f64,
    /// The mean minus the limit of many waves.
    pub limit_bias: f64,
    /// Mean difference from the exact panning of the same start directions.
    pub twin_bias: f64,
    /// Number of seeds in the twin bias. The first seeds are used.
    pub twin_seeds: u32,
    /// Standard error of the twin bias.
    pub twin_bias_error: f64,
    /// Standard deviation over the seeds, estimated with n − 1.
    pub spread: f64,
    /// Root mean square difference from the limit.
    pub rms: f64,
    /// 1 ÷ (mean square difference from the limit × seconds per frame).
    pub efficiency: f64,
    /// Relative difference between the arrivals summed on the GPU and those summed on the CPU; `None` for rows that do
    /// not sum on the GPU.
    pub sum_error: Option<f64>,
}

/// The decrease of the panning error for one set of directions.
#[derive(Clone, Debug, Serialize)]
pub struct Slope {
    /// Name of the directions.
    pub directions: String,
    /// The points, sorted by number of waves.
    pub points: Vec<SlopePoint>,
    /// Exponent of the number of waves, fitted to the points. The exponent is −0.5 for independent directions, and
    /// `None` for fewer than two fitted points.
    pub slope: Option<f64>,
    /// Standard error of the exponent; `None` for fewer than three fitted points.
    pub standard_error: Option<f64>,
}

/// The error at one number of waves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlopePoint {
    /// Number of waves.
    pub waves: u32,
    /// Root mean square panning error over the seeds.
    pub rms: f64,
    /// Expected number of heard waves, computed from the limit's share of heard waves.
    pub heard: f64,
    /// Whether the fit includes this point, that is, whether at least 10 heard waves are expected.
    pub fitted: bool,
}

/// A recommended row.
#[derive(Clone, Debug, Serialize)]
pub struct Recommendation {
    /// The row's name.
    pub label: String,
    /// The row's settings.
    pub case: CaseReport,
    /// Time of the row's frames, in milliseconds.
    pub total_ms: f64,
    /// The row's root mean square panning error.
    pub rms: f64,
}

/// One of the project's own targets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// The measured quantity, with its scene and profile.
    pub what: String,
    /// The measured value.
    pub measured: f64,
    /// The bound; `None` for a figure without a target.
    pub bound: Option<f64>,
    /// Whether the bound is a minimum instead of a maximum.
    pub at_least: bool,
    /// Whether the measured value satisfies the bound; `None` without a bound.
    pub met: Option<bool>,
}
