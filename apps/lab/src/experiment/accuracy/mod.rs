//! Speed against error: the cost and the error of each profile and option.
//!
//! # Method
//! Every [`Case`] (settings with a name) runs in every scene and yields a [`Row`]:
//!
//! - *Waves*: each wave is compared with the exact wave ([`ExactScene`](crate::geometry::ExactScene), closed form in
//!   `f64`) that has the same start direction, its *twin*: final status, surfaces met, distance between the end points
//!   in metres. At most [`Plan::compared_waves`] waves of seed 1 are compared; further waves have the same
//!   distribution. If the twin dies, the wave has no end point and no error. If the wave dies but its twin survives,
//!   the wave counts with its own end point.
//! - *Panning*: over at least 16 seeds, the panning is compared with that of the twins (twin bias), and with the limit
//!   of many waves (limit bias, mean square error, efficiency). A frame without arrivals has the panning 0, which
//!   counts.
//! - *Speed*: medians of the same frames. The frames of all cases with the same number of waves run in turns, after one
//!   warm-up frame for each case. Evaluations of the distance are counted in an additional frame, and divided by the
//!   flights of its waves. The thesis' algorithm continues to march dead waves; their flights and evaluations count.
//!
//! The limit is the exact panning over two Fibonacci lattices of directions. Half of the difference between the
//! lattices is its uncertainty. The documentation of `chaos` explains how chaos is distinguished from error, and the
//! documentation of `panning_error` defines the efficiency.
//!
//! # Deviations from the thesis
//! Sjöberg (2011) measures only time and judges the sound by ear.

mod chaos;
mod columns;
mod directions;
mod document;
mod gyroid;
mod measure;
mod panning_error;
mod plan;
mod plot;
mod recommend;
mod report;
mod responses;
mod surface_counts;
mod sweep;
mod targets;
mod truth;

pub use directions::{lattice, slope};
pub use gyroid::{GYROID, gyroid};
pub use plan::{DEFAULT_SCENES, Plan, ROOMS};
pub use recommend::{ITERATIONS as COMPARED_ITERATIONS, pareto_front};
pub use report::{
    AccuracyReport, CaseReport, Chaos, ChaosStep, Limit, PanningError, Quantiles, Recommendation,
    ResponseRow, Row, SceneReport, Slope, SlopePoint, Speed, Target, WaveErrors,
};
pub use surface_counts::SurfaceCounts;
pub use sweep::{Case, ITERATIONS, MIN_DISTANCES, full, quick, short};

use echomarch::Error;
use echomarch::internals::fields_cost;
use echomarch::scene::Scene;
use echomarch::tracer::{Directions, Settings, Tracer};
use std::time::Instant;
use truth::Truth;

/// The options of a run.
#[derive(Clone, Debug)]
pub struct AccuracyOptions {
    /// The scenes with their cases.
    pub plans: Vec<Plan>,
    /// Whether to run all combinations of settings.
    pub full: bool,
    /// Number of frames per case, each with a different seed: at least 2, and 16 for reliable figures.
    pub seeds: u32,
    /// The panning error that the recommended setting must not exceed.
    pub stated_error: f64,
    /// Whether to measure the project's own performance targets.
    pub targets: bool,
    /// Whether to measure impulse responses.
    pub responses: bool,
}

impl AccuracyOptions {
    /// Changes one setting at a time. The default scenes take about four minutes on two cores.
    pub fn quick(scenes: Vec<Scene>) -> AccuracyOptions {
        AccuracyOptions {
            plans: scenes.into_iter().map(Plan::quick).collect(),
            full: false,
            seeds: 16,
            stated_error: 0.02,
            targets: false,
            responses: false,
        }
    }

    /// Runs all combinations of settings, which takes hours.
    pub fn full(scenes: Vec<Scene>) -> AccuracyOptions {
        AccuracyOptions {
            plans: scenes.into_iter().map(Plan::full).collect(),
            full: true,
            ..AccuracyOptions::quick(Vec::new())
        }
    }

    /// Number of calls of [`Progress::step`] per scene.
    fn steps(&self, plan: &Plan) -> u64 {
        let groups = by_waves(&plan.cases).len() as u64;
        let slopes = 2 * plan.slope_waves.len() as u64;
        2 + plan.cases.len() as u64 + groups * (u64::from(self.seeds) + 1) + slopes
    }
}

/// The progress of the run.
struct Progress<'a> {
    done: u64,
    total: u64,
    report: &'a mut dyn FnMut(u64, u64),
}

impl Progress<'_> {
    fn step(&mut self) {
        self.done += 1;
        (self.report)(self.done, self.total);
    }
}

/// Runs the experiment. `progress` receives the number of completed steps and the total.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn run(
    tracer: &mut Tracer,
    options: &AccuracyOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<AccuracyReport, Error> {
    let began = Instant::now();
    let steps = options.plans.iter().map(|plan| options.steps(plan));
    let mut progress = Progress {
        done: 0,
        total: steps.sum::<u64>()
            + u64::from(options.targets)
            + u64::from(options.responses) * responses::STEPS,
        report: progress,
    };
    let mut scenes = Vec::new();
    for plan in &options.plans {
        scenes.push(run_scene(tracer, plan, options, &mut progress)?);
    }
    let mut targets = Vec::new();
    if options.targets {
        targets = targets::measure(tracer, &scenes)?;
        progress.step();
    }
    let mut responses = Vec::new();
    if options.responses {
        responses = responses::measure(tracer, &mut || progress.step())?;
    }
    Ok(AccuracyReport {
        renderer: tracer.context().renderer().to_owned(),
        clock: tracer.clock_name().to_owned(),
        full: options.full,
        seeds: options.seeds,
        seconds: began.elapsed().as_secs_f64(),
        stated_error: options.stated_error,
        scenes,
        targets,
        responses,
    })
}

fn run_scene(
    tracer: &mut Tracer,
    plan: &Plan,
    options: &AccuracyOptions,
    progress: &mut Progress,
) -> Result<SceneReport, Error> {
    let scene = &plan.scene;
    let mut truth = Truth::new(scene, plan.limit_directions)?;
    let iterations = plan.cases.iter().map(|case| case.settings.iterations);
    let most = iterations.clone().max().unwrap_or(1);
    truth.find_limits(most.max(COMPARED_ITERATIONS));
    progress.step();
    let pairs = lattice(plan.chaos_pairs, false);
    let chaos = chaos::measure(scene, &truth.exact, &pairs, most);
    progress.step();
    let mut rows = vec![None; plan.cases.len()];
    for group in by_waves(&plan.cases) {
        let cases: Vec<Case> = group.iter().map(|&i| plan.cases[i].clone()).collect();
        let measured = run_group(
            tracer,
            &mut truth,
            &chaos,
            plan,
            &cases,
            options.seeds,
            progress,
        )?;
        for (index, row) in group.into_iter().zip(measured) {
            rows[index] = Some(row);
        }
    }
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    let slopes = run_slopes(tracer, &mut truth, plan, options.seeds, progress)?;
    let mut limits: Vec<u32> = iterations.collect();
    limits.sort_unstable();
    limits.dedup();
    Ok(SceneReport {
        scene: scene.name.clone(),
        surfaces: SurfaceCounts::of(scene),
        reference_is_sampled: scene.user_fields().any(|field| !field.has_cpu()),
        limits: limits.iter().map(|&i| truth.limit(i)).collect(),
        chaos,
        recommendation: recommend::fastest(&rows, options.stated_error),
        best: recommend::best(&rows),
        rows,
        slopes,
    })
}

/// Returns the exact panning, in `f64`, of the waves that start in a frame of `scene` with these settings.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn exact_pan(tracer: &mut Tracer, scene: &Scene, settings: &Settings) -> Result<f64, Error> {
    // This function needs no limit of many waves.
    let mut truth = Truth::new(scene, 0)?;
    truth.pan_of_twins(tracer, settings, settings.iterations)
}

/// Groups the indices of the cases by number of waves. A change of the number of waves creates new textures, and their
/// creation time would be measured.
fn by_waves(cases: &[Case]) -> Vec<Vec<usize>> {
    let mut groups: Vec<(u32, Vec<usize>)> = Vec::new();
    for (index, case) in cases.iter().enumerate() {
        let waves = case.settings.waves;
        match groups.iter_mut().find(|group| group.0 == waves) {
            Some(group) => group.1.push(index),
            None => groups.push((waves, vec![index])),
        }
    }
    groups.into_iter().map(|group| group.1).collect()
}

fn run_group(
    tracer: &mut Tracer,
    truth: &mut Truth,
    chaos: &Chaos,
    plan: &Plan,
    cases: &[Case],
    seeds: u32,
    progress: &mut Progress,
) -> Result<Vec<Row>, Error> {
    let mut waves = Vec::new();
    for case in cases {
        let few = case.settings.clone();
        let few = few.with_waves(case.settings.waves.min(plan.compared_waves));
        let errors = measure::wave_errors(tracer, truth, chaos, &few)?;
        let evaluations = fields_cost::evaluations(tracer, truth.scene, &few)?;
        let evaluations = evaluations as f64 / errors.flights.max(1) as f64;
        let summed = case.settings.sum_on_gpu;
        let sum_error = summed.then(|| panning_error::sum_error(tracer, truth, &case.settings));
        waves.push((errors, evaluations, sum_error.transpose()?));
        progress.step();
    }
    let step = &mut || progress.step();
    let mut frames = panning_error::run_in_turns(tracer, truth, cases, seeds, step)?;
    panning_error::find_twins(tracer, truth, cases, plan.twin_seeds, &mut frames)?;
    progress.step();
    let measured = cases.iter().zip(waves).zip(frames);
    let row = |((case, (errors, evaluations, sum_error)), frames): (
        (&Case, _),
        panning_error::Frames,
    )| {
        let mut speed = frames.speed(&case.settings);
        speed.evaluations_per_flight = evaluations;
        let mut panning = frames.panning(truth.limit(case.settings.iterations).pan);
        panning.sum_error = sum_error;
        Row {
            label: case.label.clone(),
            case: case.report(truth.scene),
            speed,
            waves: errors,
            panning,
        }
    };
    Ok(measured.map(row).collect())
}

/// Measures how the panning error of `hybrid` falls with the number of waves.
fn run_slopes(
    tracer: &mut Tracer,
    truth: &mut Truth,
    plan: &Plan,
    seeds: u32,
    progress: &mut Progress,
) -> Result<Vec<Slope>, Error> {
    let base = Settings::hybrid().with_iterations(COMPARED_ITERATIONS);
    let limit = truth.limit(COMPARED_ITERATIONS);
    let mut slopes = Vec::new();
    for directions in [Directions::Random, Directions::Fibonacci] {
        let mut points = Vec::new();
        for &waves in &plan.slope_waves {
            let settings = base.clone().with_waves(waves).with_directions(directions);
            let case = Case {
                label: String::new(),
                settings: settings.with_sum_on_gpu(true),
            };
            let frames = panning_error::run_in_turns(tracer, truth, &[case], seeds, &mut || ())?;
            points.push((waves, frames[0].mean_square(limit.pan).sqrt()));
            progress.step();
        }
        slopes.push(directions::fitted(directions, &points, limit.heard));
    }
    Ok(slopes)
}
