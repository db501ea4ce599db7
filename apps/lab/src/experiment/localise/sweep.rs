//! Runs the observer model on all scenes and settings.

use super::listen::{LoadedSound, converge, facings, listen};
use super::observer::{Levels, Observer, Side, azimuth_deg, direct_distance, lateral_deg};
use super::report::{Cell, FacingReport, LimitReport, LocaliseReport, SceneReport};
use super::statistics::{CONFIDENCE, LEAST_DRAWN, Pair, RESAMPLES, Share, figures};
use super::{LocaliseOptions, plateaus};
use crate::stats::mean;
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, Tracer};
use std::time::Instant;

/// The state shared by all trials.
pub(super) struct Run<'a> {
    tracer: &'a mut Tracer,
    pub(super) options: &'a LocaliseOptions,
    sounds: Vec<LoadedSound>,
    largest_difference: f64,
    done: u64,
    progress: &'a mut dyn FnMut(u64, u64),
}

/// The observer's answers to one frame.
pub(super) struct Answers {
    /// One answer per sound, in degrees, by the observer that knows the distance.
    pub(super) told: Vec<f64>,
    /// The answer to the first sound by the observer that does not know the distance.
    pub(super) blind: Option<f64>,
    /// Number of waves that arrived.
    pub(super) hits: u64,
}

/// One frame for one facing of the listener.
struct Trial {
    source_deg: f64,
    limit_deg: f64,
    hits: u64,
    /// One answer per sound, in degrees.
    answers: Vec<f64>,
}

/// Runs the experiment. `progress` receives the number of completed steps and the total.
///
/// # Errors
/// [`Error::Audio`] for a sound that cannot be loaded; errors of [`Tracer::frame`].
pub fn run(
    tracer: &mut Tracer,
    options: &LocaliseOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<LocaliseReport, Error> {
    let began = Instant::now();
    let sounds = options
        .sounds
        .iter()
        .map(|spec| LoadedSound::new(spec, options.sound_seconds));
    let mut run = Run {
        sounds: sounds.collect::<Result<_, _>>()?,
        tracer,
        options,
        largest_difference: 0.0,
        done: 0,
        progress,
    };
    let mut open = Vec::new();
    for case in &options.open {
        open.push(run.open(case)?);
    }
    let mut scenes = Vec::new();
    for scene in &options.scenes {
        scenes.push(run.scene(scene)?);
    }
    let largest_difference_of_sounds_deg = run.largest_difference;
    Ok(LocaliseReport {
        renderer: tracer.context().renderer().to_owned(),
        law: options.law.to_string(),
        seeds: options.seeds,
        seconds: began.elapsed().as_secs_f64(),
        confidence: CONFIDENCE,
        rough: (options.seeds as usize) < LEAST_DRAWN,
        resamples: RESAMPLES,
        centre_deg: super::CENTRE_DEG,
        left_out: options.left_out(),
        plateaus: plateaus::find(&scenes),
        open,
        scenes,
        largest_difference_of_sounds_deg,
    })
}

impl Run<'_> {
    pub(super) fn step(&mut self) {
        self.done += 1;
        (self.progress)(self.done, self.options.steps());
    }

    /// Traces one frame, and returns the observer's answers to it.
    pub(super) fn hear(&mut self, scene: &Scene, settings: &Settings) -> Result<Answers, Error> {
        let law = self.options.law;
        let heard = listen(self.tracer, scene, settings)?;
        let observer = Observer::new(scene, law);
        let levels = |sound: &LoadedSound| Levels::of(&sound.mixed(heard.pan, law));
        let levels: Vec<Levels> = self.sounds.iter().map(levels).collect();
        let told = levels.iter().map(|&levels| observer.answer_deg(levels));
        let told: Vec<f64> = told.collect();
        let first = told.first().copied().unwrap_or(0.0);
        let differences = told.iter().map(|other| (other - first).abs());
        self.largest_difference = differences.fold(self.largest_difference, f64::max);
        let blind = levels
            .first()
            .map(|&of| Observer::blind(law).answer_deg(of));
        let hits = heard.hits;
        Ok(Answers { told, blind, hits })
    }

    fn scene(&mut self, scene: &Scene) -> Result<SceneReport, Error> {
        let scenes = facings(scene);
        let mut reports = Vec::new();
        for facing in &scenes {
            reports.push(self.facing(facing)?);
        }
        let mut cells = Vec::new();
        for settings in self.options.settings() {
            let mut trials = Vec::new();
            for (index, (facing, report)) in scenes.iter().zip(&reports).enumerate() {
                // Each trial has its own seed, so that no two trials use the same waves.
                let first = 1 + index as u32 * self.options.seeds;
                for seed in first..first + self.options.seeds {
                    let seeded = settings.clone().with_seed(seed);
                    let heard = self.hear(facing, &seeded)?;
                    trials.push(Trial {
                        source_deg: report.lateral_deg,
                        limit_deg: report.limit_deg(settings.iterations),
                        hits: heard.hits,
                        answers: heard.told,
                    });
                }
            }
            for (index, sound) in self.sounds.iter().enumerate() {
                cells.push(cell(&sound.name, &settings, &trials, index));
            }
            self.step();
        }
        Ok(SceneReport {
            scene: scene.name.clone(),
            distance_m: direct_distance(scene),
            radius_m: scene.listeners[0].radius.into(),
            mean_side: Observer::new(scene, self.options.law).mean_side(),
            facings: reports,
            cells,
        })
    }

    fn facing(&mut self, scene: &Scene) -> Result<FacingReport, Error> {
        let observer = Observer::new(scene, self.options.law);
        let mut limits = Vec::new();
        for &iterations in &self.options.iterations {
            let found = converge(self.tracer, scene, iterations, self.options.limit)?;
            limits.push(LimitReport {
                iterations,
                pan: found.pan,
                uncertainty: found.uncertainty,
                lateral_deg: observer.lateral_deg(found.pan),
                heard: found.heard,
            });
        }
        self.step();
        Ok(FacingReport {
            yaw_deg: f64::from(scene.listeners[0].yaw).to_degrees(),
            azimuth_deg: azimuth_deg(scene),
            lateral_deg: lateral_deg(scene),
            limits,
        })
    }
}

impl FacingReport {
    /// The observer's answer to the converged panning after the given number of iterations, in degrees; 0 if that
    /// panning was not computed.
    fn limit_deg(&self, iterations: u32) -> f64 {
        let of = self.limits.iter().find(|of| of.iterations == iterations);
        of.map_or(0.0, |of| of.lateral_deg)
    }
}

/// Index of the last column of a confusion table, which counts trials without hits.
const NOTHING: usize = 3;

/// The figures of one sound in one setting. Silence does not count as an answer. If it counted as the middle, it would
/// be right for a source ahead.
fn cell(sound: &str, settings: &Settings, trials: &[Trial], index: usize) -> Cell {
    let heard = || trials.iter().filter(|trial| trial.hits > 0);
    let errors = |truth: fn(&Trial) -> f64| {
        let pair = |trial: &Trial| Pair {
            truth_deg: truth(trial),
            answer_deg: trial.answers[index],
        };
        figures(&heard().map(pair).collect::<Vec<Pair>>())
    };
    let mut confusion = [[0; 4]; 3];
    for trial in trials {
        let said = match trial.hits {
            0 => NOTHING,
            _ => Side::of(trial.answers[index]) as usize,
        };
        confusion[Side::of(trial.source_deg) as usize][said] += 1;
    }
    let right = (0..NOTHING).map(|side| confusion[side][side]).sum();
    let all = trials.len() as u32;
    let unheard = all - heard().count() as u32;
    Cell {
        sound: sound.to_owned(),
        profile: settings.profile().to_string(),
        waves: settings.waves,
        iterations: settings.iterations,
        trials: all,
        unheard: f64::from(unheard) / f64::from(all.max(1)),
        hits: mean(trials.iter().map(|trial| trial.hits as f64)).unwrap_or(0.0),
        limit: errors(|trial| trial.limit_deg),
        source: errors(|trial| trial.source_deg),
        confusion,
        side_right: Share::of(right, all - unheard),
    }
}
