//! Measures the cost of each surface and option, and the error caused by leaving it out.
//!
//! Everything is measured in pairs of a complete frame and a frame with one change. The two frames of a pair run in
//! turns and have the same start directions; each pair has its own seed. The saving is the median of the differences
//! between the frames of a pair. The audible change is compared with the effect of another seed. A smaller change is
//! inaudible, because every frame contains that much noise.
//!
//! The cost of all marched surfaces together is measured as in the window (`FieldsCost`).

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

use echomarch::Error;
use echomarch::internals::fields_cost::FieldsCost;
use echomarch::scene::Scene;
use echomarch::tracer::{Frame, Settings, Tracer};
use pair::{Case, pair};
use serde::Serialize;

/// Number of frames for measuring the noise, each with a different seed.
const NOISE_SEEDS: u32 = 8;

/// The options of a run.
#[derive(Clone, Debug)]
pub struct CostOptions {
    /// Number of pairs of frames per row, at least 1; each pair has its own seed.
    pub runs: u32,
}

impl Default for CostOptions {
    fn default() -> CostOptions {
        CostOptions { runs: 9 }
    }
}

/// The results of the cost experiment.
#[derive(Clone, Debug, Serialize)]
pub struct CostReport {
    /// The scene's name.
    pub scene: String,
    /// The renderer's name.
    pub renderer: String,
    /// The kind of clock that measured the times of the passes.
    pub clock: String,
    /// Name of the profile.
    pub profile: String,
    /// Number of waves.
    pub waves: u32,
    /// Iterations of every wave.
    pub iterations: u32,
    /// The first seed. Each run uses the next seed.
    pub seed: u32,
    /// Name of the start directions.
    pub directions: String,
    /// Number of pairs of frames per row.
    pub runs: u32,
    /// March times of the complete frame compared with itself: the noise of the clock.
    pub control: Timing,
    /// Total times of the complete frame compared with itself.
    pub control_total: Timing,
    /// The effect of another seed.
    pub noise: Noise,
    /// The cost of the marched surfaces together; `None` for a scene without them.
    pub fields: Option<FieldsCost>,
    /// Number of waves traced to find which surfaces they meet.
    pub followed: u32,
    /// Whether the rows group surfaces by kind, because there are too many for one row each.
    pub by_kind: bool,
    /// The rows of the surfaces, in the order of the scene.
    pub surfaces: Vec<SurfaceRow>,
    /// The rows of the settings. Each row changes one setting.
    pub options: Vec<OptionRow>,
    /// The contents of the scene's march shader.
    pub shader: ShaderReport,
    /// The conclusions, as sentences.
    pub advice: Vec<String>,
}

/// Measures a scene in its current state, with these settings. `progress` receives the number of completed rows and the
/// total.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn measure(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    options: &CostOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<CostReport, Error> {
    // Traces a whole frame first, so that an invalid scene fails before the measurements begin.
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
    // The control pair has no change, so its difference is always within the noise.
    let (march, total_time) = (control.march(f64::INFINITY), control.total(f64::INFINITY));
    let seeded = seeded_frames(tracer, base)?;
    let noise = Noise::of(&seeded, settings.waves);
    let fields = FieldsCost::measure(tracer, scene, settings, runs, &|| true)?;
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
        fields,
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

/// The complete scene and settings, with which every row is compared.
struct Bench<'a> {
    base: Case<'a>,
    runs: u32,
    /// Noise of the clock for the march and for the whole frame, in percent.
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
