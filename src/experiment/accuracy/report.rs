//! What the experiment returns: plain data, written as CSV, JSON, SVG and tables.

use super::surface_counts::SurfaceCounts;
use crate::stats::quantiles;
use serde::Serialize;

/// All that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyReport {
    /// The renderer's name.
    pub renderer: String,
    /// How the times of passes were taken.
    pub clock: String,
    /// Whether the whole product of settings was run.
    pub full: bool,
    /// Turns of the start directions that each panning error is taken over.
    pub seeds: u32,
    /// Wall time of everything, in seconds.
    pub seconds: f64,
    /// The panning error that [`SceneReport::recommendation`] stays below.
    pub stated_error: f64,
    /// In the order they were requested.
    pub scenes: Vec<SceneReport>,
    /// The project's own targets; empty when their scenes were not requested.
    pub targets: Vec<Target>,
    /// Impulse responses; empty when they were not requested.
    pub responses: Vec<ResponseRow>,
}

/// An impulse response against image sources: of each figure the largest error over the bands, `None`
/// where no band has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResponseRow {
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Median time of a response.
    pub milliseconds: f64,
    /// Of the reverberation time, as a share.
    pub t30_error: Option<f64>,
    /// Of the early decay time, as a share.
    pub edt_error: Option<f64>,
    /// Of clarity, in decibels.
    pub c80_error_db: Option<f64>,
    /// Of strength, in decibels.
    pub g_error_db: Option<f64>,
    /// Bands that have a reverberation time.
    pub t30_bands: usize,
}

/// One scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// The scene's name.
    pub scene: String,
    /// How its surfaces are met.
    pub surfaces: SurfaceCounts,
    /// The panning in the limit of many waves, by iterations.
    pub limits: Vec<Limit>,
    /// How errors grow at curved surfaces.
    pub chaos: Chaos,
    /// A row for each setting.
    pub rows: Vec<Row>,
    /// How the panning error falls with the number of waves.
    pub slopes: Vec<Slope>,
    /// The fastest row below the stated error.
    pub recommendation: Option<Recommendation>,
    /// The row of the least panning error.
    pub best: Option<Recommendation>,
}

/// The exact geometry's panning, from two lattices of directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limit {
    /// Iterations of every wave.
    pub iterations: u32,
    /// Directions of both lattices together.
    pub directions: u64,
    /// Mean of the two.
    pub pan: f64,
    /// Half of what they differ by.
    pub uncertainty: f64,
    /// Share of all waves that are heard.
    pub heard: f64,
}

/// Exponential growth of small errors, measured on exact waves.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Chaos {
    /// Pairs of waves that were followed.
    pub pairs: u64,
    /// Iterations of each.
    pub iterations: u32,
    /// Pairs whose two waves met the same surfaces.
    pub same_sequence: u64,
    /// What a separation is multiplied by from one curved surface to the next: the
    /// geometric mean. `None` where no wave meets two.
    pub growth: Option<f64>,
    /// Curved surfaces met before a rounding error has grown to a centimetre.
    pub horizon: Option<f64>,
    /// Separation at the n-th curved surface.
    pub steps: Vec<ChaosStep>,
}

/// Waves at their n-th curved surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChaosStep {
    /// n, from 1.
    pub curved_hits: u32,
    /// Pairs that got there.
    pub pairs: u64,
    /// Geometric mean of their separation over the angle they started with, in metres
    /// a radian.
    pub separation: f64,
    /// Geometric mean of what it was multiplied by since the curved surface before.
    pub growth: Option<f64>,
}

/// One setting in one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What is changed from the profile's defaults.
    pub label: String,
    /// The settings, as they are swept.
    pub case: CaseReport,
    /// Speed.
    pub speed: Speed,
    /// Each wave against its exact twin.
    pub waves: WaveErrors,
    /// The panning against its limit.
    pub panning: PanningError,
}

/// The settings of a row that are swept.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CaseReport {
    /// Name of the profile.
    pub profile: String,
    /// Metres; `None` where the profile has none.
    pub min_distance: Option<f32>,
    /// Marches of each wave.
    pub iterations: u32,
    /// Number of waves.
    pub waves: u32,
    /// How the start directions are chosen.
    pub directions: String,
    /// Whether normals are exact, not differences.
    pub exact_normals: bool,
    /// Whether waves are projected onto surfaces.
    pub projection: bool,
    /// Whether all iterations run in one pass.
    pub fused: bool,
    /// Whether the panning is summed on the GPU.
    pub sum_on_gpu: bool,
}

/// Times of a row: medians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Speed {
    /// A whole frame by the wall clock, milliseconds.
    pub total_ms: f64,
    /// Its march passes, milliseconds.
    pub march_ms: f64,
    /// Millions of waves × iterations in a second of whole frames.
    pub million_per_second: f64,
    /// Evaluations of the distance ÷ (waves × iterations), those of normals included.
    pub evaluations_per_segment: f64,
    /// Frames that the medians are of.
    pub frames: u32,
}

/// Every wave against the exact one of the same start direction.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WaveErrors {
    /// Waves compared.
    pub compared: u64,
    /// Share that ended with another status.
    pub status_differs: f64,
    /// Share that met other objects, or ended with another status.
    pub sequence_differs: f64,
    /// Waves that ended nowhere (NaN or infinite).
    pub not_finite: u64,
    /// Metres between the ends, over all waves that truly end somewhere.
    pub end: Quantiles,
    /// The same over the waves that meet no more curved surfaces than the horizon.
    pub end_within_horizon: Quantiles,
    /// Share of waves that meet more.
    pub beyond_horizon: f64,
    /// Waves heard after 0, 1, 2 … reflections, before they died: those that `thesis` hears
    /// after that (it marches the dead on) count in its panning, but not here.
    pub hits: Vec<u64>,
    /// The same, exact.
    pub exact_hits: Vec<u64>,
}

impl WaveErrors {
    /// The largest difference of hits in any order.
    pub fn largest_hit_difference(&self) -> u64 {
        let pairs = self.hits.iter().zip(&self.exact_hits);
        pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    }
}

/// A distribution, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Half are below.
    pub median: f64,
    /// 99 of 100 are below.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Quantiles {
    /// Of these distances; 0 for none.
    pub fn of(distances: Vec<f64>) -> Quantiles {
        let [median, p99, max] = quantiles(distances, [0.5, 0.99, 1.0]);
        Quantiles { median, p99, max }
    }
}

/// The panning over the seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PanningError {
    /// Mean over the seeds.
    pub mean: f64,
    /// The mean less the limit of many waves.
    pub limit_bias: f64,
    /// Mean difference from the exact panning of the same start directions.
    pub twin_bias: f64,
    /// Seeds that the twin bias is taken over, the first ones.
    pub twin_seeds: u32,
    /// Standard error of the twin bias.
    pub twin_bias_error: f64,
    /// Standard deviation over the seeds, estimated with one less than there are.
    pub spread: f64,
    /// Root of the mean square difference from the limit.
    pub rms: f64,
    /// 1 ÷ (mean square difference from the limit × seconds a frame).
    pub efficiency: f64,
    /// Relative difference of the loudness summed on the GPU from that summed on the
    /// CPU; `None` for rows that do not sum on the GPU.
    pub sum_error: Option<f64>,
}

/// How the panning error of one set of directions falls.
#[derive(Clone, Debug, Serialize)]
pub struct Slope {
    /// Name of the directions.
    pub directions: String,
    /// By number of waves.
    pub points: Vec<SlopePoint>,
    /// Exponent of the number of waves: −0.5 for independent directions. Through the
    /// points that are fitted; `None` for fewer than two.
    pub slope: Option<f64>,
    /// Standard error of the exponent; `None` for fewer than three points.
    pub standard_error: Option<f64>,
}

/// The error at one number of waves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlopePoint {
    /// Number of waves.
    pub waves: u32,
    /// Root mean square panning error over the seeds.
    pub rms: f64,
    /// Waves of them that are heard, by the limit's share.
    pub heard: f64,
    /// Whether the exponent is fitted through this point: where 10 waves are heard.
    pub fitted: bool,
}

/// A row worth choosing.
#[derive(Clone, Debug, Serialize)]
pub struct Recommendation {
    /// What it is called.
    pub label: String,
    /// Its settings.
    pub case: CaseReport,
    /// Its time for a frame, in milliseconds.
    pub total_ms: f64,
    /// Its panning error.
    pub rms: f64,
}

/// A figure that the project sets itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// What is measured, and on what.
    pub what: String,
    /// What was found.
    pub measured: f64,
    /// What it is compared with; `None` for a figure without a target.
    pub bound: Option<f64>,
    /// Whether it has to be at least the bound, else at most.
    pub at_least: bool,
    /// Whether it is.
    pub met: Option<bool>,
}
