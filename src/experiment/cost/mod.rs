//! What each surface and each option costs, and what could be left out at which error.
//!
//! Everything is measured in pairs: a frame with all in it beside a frame that is changed in
//! one thing, in turns, of the same waves, a seed a run. What the change saves is the median
//! of the pairs' differences. What it changes is set against what another seed changes: less
//! than that cannot be heard, for any frame has it.

mod advice;
mod change;
mod document;
mod options;
mod pair;
mod shader;
mod surfaces;

pub use change::{Change, Noise, Size};
pub use options::OptionRow;
pub use pair::Timing;
pub use shader::{Feature, ShaderReport};
pub use surfaces::{MOST_SURFACES, SurfaceRow, Verdict};

use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{Frame, Settings, Tracer};
use pair::{Case, pair};
use serde::Serialize;

/// Frames, a seed each, that the noise is taken from.
const NOISE_SEEDS: u32 = 8;

/// What to run.
#[derive(Clone, Debug)]
pub struct CostOptions {
    /// Pairs of frames for each row, a seed each; at least 1.
    pub runs: u32,
}

impl Default for CostOptions {
    fn default() -> CostOptions {
        CostOptions { runs: 9 }
    }
}

/// What everything costs.
#[derive(Clone, Debug, Serialize)]
pub struct CostReport {
    /// The scene's name.
    pub scene: String,
    /// The renderer's name.
    pub renderer: String,
    /// How the times of passes were taken.
    pub clock: String,
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Iterations of every wave.
    pub iterations: u32,
    /// The first seed; each run takes the next one.
    pub seed: u32,
    /// Name of the start directions.
    pub directions: String,
    /// Pairs of frames for each row.
    pub runs: u32,
    /// The march of everything beside everything: what the clock makes of no difference.
    pub control: Timing,
    /// The same of the whole frame.
    pub control_total: Timing,
    /// What another seed changes.
    pub noise: Noise,
    /// Waves that were followed to see what they meet.
    pub followed: u32,
    /// Whether there are so many surfaces that they are taken by kind.
    pub by_kind: bool,
    /// In the order of the scene.
    pub surfaces: Vec<SurfaceRow>,
    /// Settings, each changed alone.
    pub options: Vec<OptionRow>,
    /// What is in the shader.
    pub shader: ShaderReport,
    /// What follows from it, in sentences.
    pub advice: Vec<String>,
}

/// Measures a scene as it stands, at these settings. `progress` is called with rows done and
/// rows in all.
///
/// # Errors
/// Those of [`Tracer::frame`].
pub fn measure(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    options: &CostOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<CostReport, Error> {
    // A whole frame first: what cannot be traced is told before anything is changed.
    tracer.frame(scene, settings)?;
    let rows = surfaces::rows(scene);
    let variants = options::variants(settings);
    let total = (rows.len() + variants.len() + 1) as u64;
    let mut done = 0;
    let mut step = || {
        done += 1;
        progress(done, total);
    };
    let base = Case { scene, settings };
    let runs = options.runs.max(1);
    let control = pair(tracer, base, base, runs)?;
    // Of no difference nothing is beyond noise.
    let (march, total_time) = (control.march(f64::INFINITY), control.total(f64::INFINITY));
    let seeded = seeded_frames(tracer, base)?;
    let noise = Noise::of(&seeded, settings.waves);
    let bench = Bench {
        base,
        runs,
        control_percent: march.own_noise_percent(),
        control_total_percent: total_time.own_noise_percent(),
        noise: &noise,
    };
    step();
    let met = surfaces::met(tracer, base, &rows)?;
    let followed = met.followed;
    let surfaces = surfaces::measure(tracer, &bench, &rows, &met, &mut step)?;
    let option_rows = options::measure(tracer, &bench, variants, &mut step)?;
    let mut report = CostReport {
        scene: scene.name.clone(),
        renderer: tracer.context().renderer().to_owned(),
        clock: tracer.clock_name().to_owned(),
        profile: settings.profile().to_string(),
        waves: settings.waves,
        iterations: settings.iterations,
        seed: settings.seed,
        directions: settings.directions.to_string(),
        runs,
        control: march,
        control_total: total_time,
        followed,
        by_kind: scene.surfaces.len() > MOST_SURFACES,
        surfaces,
        options: option_rows,
        shader: ShaderReport::of(scene, settings),
        advice: Vec::new(),
        noise,
    };
    report.advice = advice::sentences(&report);
    Ok(report)
}

/// What every row is measured against.
struct Bench<'a> {
    base: Case<'a>,
    runs: u32,
    /// What the clock makes of no difference, of the march and of the whole frame.
    control_percent: f64,
    control_total_percent: f64,
    noise: &'a Noise,
}

fn seeded_frames(tracer: &mut Tracer, base: Case) -> Result<Vec<Frame>, Error> {
    let seed = |run| base.settings.seed.wrapping_add(run);
    let frame = |run| {
        let settings = base.settings.clone().with_seed(seed(run));
        tracer.frame(base.scene, &settings)
    };
    (0..NOISE_SEEDS).map(frame).collect()
}
