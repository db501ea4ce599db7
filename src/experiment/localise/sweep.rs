//! Runs the observer through scenes and settings.

use super::listen::{LoadedSound, converge, facings, listen, source_at};
use super::observer::{Levels, Observer, Side, azimuth_deg, direct_distance, lateral_deg};
use super::report::{
    Cell, FacingReport, LimitReport, LocaliseReport, OpenAzimuth, OpenReport, SceneReport,
};
use super::statistics::{CONFIDENCE, Pair, RESAMPLES, figures, mean};
use super::{LocaliseOptions, OPEN_DISTANCE_M, plateaus};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{Settings, Tracer};
use std::time::Instant;

/// What the trials need all the time.
struct Run<'a> {
    tracer: &'a mut Tracer,
    options: &'a LocaliseOptions,
    sounds: Vec<LoadedSound>,
    largest_difference: f64,
    done: u64,
    progress: &'a mut dyn FnMut(u64, u64),
}

/// One frame of one facing.
struct Trial {
    source_deg: f64,
    limit_deg: f64,
    hits: u64,
    /// An answer a sound, in degrees.
    answers: Vec<f64>,
}

/// Runs the experiment. `progress` is called with steps done and steps in all.
///
/// # Errors
/// [`Error::Audio`] for a sound that cannot be had; those of [`Tracer::frame`].
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
    for settings in &options.open {
        open.push(run.open(settings)?);
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
        resamples: RESAMPLES,
        centre_deg: super::CENTRE_DEG,
        plateaus: plateaus::find(&scenes),
        open,
        scenes,
        largest_difference_of_sounds_deg,
    })
}

impl Run<'_> {
    fn step(&mut self) {
        self.done += 1;
        (self.progress)(self.done, self.options.steps());
    }

    /// The answers to one frame, a sound each, and how many waves it heard.
    fn hear(&mut self, scene: &Scene, settings: &Settings) -> Result<(Vec<f64>, u64), Error> {
        let law = self.options.law;
        let heard = listen(self.tracer, scene, settings)?;
        let observer = Observer::new(scene, law);
        let answer =
            |sound: &LoadedSound| observer.answer_deg(Levels::of(&sound.mixed(heard.pan, law)));
        let answers: Vec<f64> = self.sounds.iter().map(answer).collect();
        let first = answers.first().copied().unwrap_or(0.0);
        let differences = answers.iter().map(|other| (other - first).abs());
        self.largest_difference = differences.fold(self.largest_difference, f64::max);
        Ok((answers, heard.hits))
    }

    fn open(&mut self, settings: &Settings) -> Result<OpenReport, Error> {
        let field = Scene::builtin("open-field")?;
        let mut azimuths = Vec::new();
        let mut all = Vec::new();
        for &azimuth_deg in &self.options.azimuths_deg {
            let scene = source_at(&field, azimuth_deg, OPEN_DISTANCE_M);
            let mut pairs = Vec::new();
            for seed in 1..=self.options.seeds {
                let (answers, _) = self.hear(&scene, &settings.clone().with_seed(seed))?;
                pairs.extend(answers.first().map(|&answer_deg| Pair {
                    truth_deg: lateral_deg(&scene),
                    answer_deg,
                }));
            }
            let error = figures(&pairs);
            azimuths.push(OpenAzimuth { azimuth_deg, error });
            all.extend(pairs);
        }
        self.step();
        let there = source_at(&field, 0.0, OPEN_DISTANCE_M);
        Ok(OpenReport {
            profile: settings.profile.to_string(),
            waves: settings.waves,
            iterations: settings.iterations,
            distance_m: OPEN_DISTANCE_M,
            mean_side: Observer::new(&there, self.options.law).mean_side(),
            all: figures(&all),
            azimuths,
        })
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
                // No two trials share their waves.
                let first = 1 + index as u32 * self.options.seeds;
                for seed in first..first + self.options.seeds {
                    let seeded = settings.clone().with_seed(seed);
                    let (answers, hits) = self.hear(facing, &seeded)?;
                    trials.push(Trial {
                        source_deg: report.lateral_deg,
                        limit_deg: report.limit_deg(settings.iterations),
                        hits,
                        answers,
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
            radius_m: scene.listener.radius.into(),
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
            yaw_deg: f64::from(scene.listener.yaw).to_degrees(),
            azimuth_deg: azimuth_deg(scene),
            lateral_deg: lateral_deg(scene),
            limits,
        })
    }
}

impl FacingReport {
    /// The converged answer after so many iterations, in degrees; the middle if it was not
    /// looked for.
    fn limit_deg(&self, iterations: u32) -> f64 {
        let of = self.limits.iter().find(|of| of.iterations == iterations);
        of.map_or(0.0, |of| of.lateral_deg)
    }
}

fn cell(sound: &str, settings: &Settings, trials: &[Trial], index: usize) -> Cell {
    let pairs = |truth: fn(&Trial) -> f64| -> Vec<Pair> {
        let pair = |trial: &Trial| Pair {
            truth_deg: truth(trial),
            answer_deg: trial.answers[index],
        };
        trials.iter().map(pair).collect()
    };
    let source = pairs(|trial| trial.source_deg);
    let mut confusion = [[0; 3]; 3];
    for pair in &source {
        confusion[Side::of(pair.truth_deg) as usize][Side::of(pair.answer_deg) as usize] += 1;
    }
    Cell {
        sound: sound.to_owned(),
        profile: settings.profile.to_string(),
        waves: settings.waves,
        iterations: settings.iterations,
        trials: trials.len() as u32,
        unheard: mean(
            trials
                .iter()
                .map(|trial| f64::from(u8::from(trial.hits == 0))),
        ),
        hits: mean(trials.iter().map(|trial| trial.hits as f64)),
        limit: figures(&pairs(|trial| trial.limit_deg)),
        source: figures(&source),
        confusion,
    }
}
