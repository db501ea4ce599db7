//! The experiment with test subjects: a page that plays the sounds and records the answers.
//!
//! One HTML file contains everything: the sounds (16 bits), a plan and a view for each facing of the listener, and the
//! data to be saved with every answer. The page works without a network. The gaze points upwards on the plan, as the
//! listener faces the screen, and the plan does not show the source. The view is lit from behind the listener, so that
//! the light does not reveal the source.
//!
//! The numbers of the trials depend only on the form's seed and the number of trials, so that a number reveals nothing
//! about its trial. The page computes the order of a session from the form's seed and an order seed. The order seed is
//! either the form's ([`FormOptions::order_seed`]) or random for each session. Both the order and the order seed are
//! saved with the answers. Answers are locked once given.
//!
//! The folder of the page also contains the same sounds as WAV files (16 bits, which every browser can play), named by
//! the numbers of the trials, and `experiment.json`, which describes all trials.

mod encode;
mod page;
mod plan;

use super::answers::StimulusInfo;
use super::listen::{LoadedSound, facings, listen};
use super::observer::{Levels, Observer, azimuth_deg, lateral_deg};
use super::{combined, pairs};
use echomarch::Error;
use echomarch::audio::{PanningLaw, SoundSpec};
use echomarch::internals::file_output::{OutputError, write_inside};
use echomarch::internals::sampling::Random;
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings, Tracer};
pub use plan::Plan;
use serde::Serialize;
use std::io;
use std::path::{Path, PathBuf};

/// Maximum size of the sounds embedded in the page, in bytes of 16-bit WAV. Larger sets of sounds stay in separate
/// files.
const MOST_EMBEDDED: usize = 48 << 20;

/// The contents of the form: every combination of the following values, with each facing of each scene.
#[derive(Clone, Debug)]
pub struct FormOptions {
    /// The rooms.
    pub scenes: Vec<Scene>,
    /// The sounds that the source plays.
    pub sounds: Vec<SoundSpec>,
    /// The algorithms.
    pub profiles: Vec<Profile>,
    /// Numbers of waves.
    pub waves: Vec<u32>,
    /// Numbers of iterations.
    pub iterations: Vec<u32>,
    /// Seed of the trial numbers, of the session orders, and of the waves' start directions.
    pub seed: u32,
    /// Seed of the order of the trials, used in every session; `None` for a random order in each session.
    pub order_seed: Option<u32>,
    /// Length of each sound in seconds.
    pub seconds: f64,
    /// The panning law.
    pub law: PanningLaw,
}

impl FormOptions {
    /// Number of trials in the form.
    pub fn trials(&self) -> usize {
        const FACINGS: usize = 3;
        let settings = self.profiles.len() * self.waves.len() * self.iterations.len();
        FACINGS * self.scenes.len() * self.sounds.len() * settings
    }
}

/// One trial.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// The trial's number, from 1. The number is independent of the trial's position in the order of a session.
    pub number: usize,
    /// The sound and its setting.
    pub stimulus: StimulusInfo,
    /// Index of the trial's plan, from 0.
    pub plan: usize,
    /// File name of the sound, in the folder of the page.
    pub file: String,
}

/// A form that has not been written yet.
#[derive(Debug)]
pub struct Form {
    /// The form's identifier, which differs between forms with different trials.
    pub experiment: String,
    /// Seed of the trial numbers, of the session orders, and of the waves' start directions.
    pub seed: u32,
    /// Seed of the order of the trials, used in every session; `None` for a random order in each session.
    pub order_seed: Option<u32>,
    /// The trials, ordered by number.
    pub trials: Vec<Trial>,
    /// Whether the sounds are embedded in the page.
    pub embedded: bool,
    renderer: String,
    law: PanningLaw,
    sounds: Vec<LoadedSound>,
    plans: Vec<Plan>,
}

/// The content of `experiment.json`.
#[derive(Serialize)]
struct Key<'a> {
    experiment: &'a str,
    seed: u32,
    order_seed: Option<u32>,
    renderer: &'a str,
    trials: &'a [Trial],
}

/// Traces every trial and draws every plan. `progress` receives the number of completed steps and
/// the total.
///
/// # Errors
/// [`Error::Audio`] for a sound that cannot be loaded, [`Error::Picture`], and errors of [`Tracer::frame`].
pub fn build(
    tracer: &mut Tracer,
    options: &FormOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Form, Error> {
    let sounds = options.sounds.iter();
    let sounds: Result<Vec<_>, _> = sounds
        .map(|spec| LoadedSound::new(spec, options.seconds))
        .collect();
    let sounds = sounds?;
    let rooms: Vec<Scene> = options.scenes.iter().flat_map(facings).collect();
    let total = (rooms.len() + options.trials() / sounds.len().max(1)) as u64;
    let settings = combined(
        &options.profiles,
        pairs(&options.waves, &options.iterations),
    );
    let seeded = settings.into_iter().map(|it| it.with_seed(options.seed));
    let settings: Vec<Settings> = seeded.collect();
    let (mut done, mut plans, mut stimuli) = (0, Vec::new(), Vec::new());
    for (index, room) in rooms.iter().enumerate() {
        plans.push(Plan::new(tracer.context(), room)?);
        done += 1;
        progress(done, total);
        for settings in &settings {
            let heard = stimuli_of(tracer, room, settings, &sounds, options.law)?;
            stimuli.extend(heard.into_iter().map(|stimulus| (index, stimulus)));
            done += 1;
            progress(done, total);
        }
    }
    Random::new(options.seed.into()).shuffle(&mut stimuli);
    let trial = |(index, (plan, stimulus)): (usize, (usize, StimulusInfo))| Trial {
        number: index + 1,
        stimulus,
        plan,
        file: format!("sounds/{:03}.wav", index + 1),
    };
    let trials: Vec<Trial> = stimuli.into_iter().enumerate().map(trial).collect();
    let samples: usize = sounds.iter().map(|sound| sound.mono.len()).sum();
    let bytes = 4 * samples * trials.len() / sounds.len().max(1);
    Ok(Form {
        experiment: encode::fingerprint(&trials),
        seed: options.seed,
        order_seed: options.order_seed,
        embedded: bytes <= MOST_EMBEDDED,
        trials,
        renderer: tracer.context().renderer().to_owned(),
        law: options.law,
        sounds,
        plans,
    })
}

/// The stimuli of one frame, with every sound.
fn stimuli_of(
    tracer: &mut Tracer,
    room: &Scene,
    settings: &Settings,
    sounds: &[LoadedSound],
    law: PanningLaw,
) -> Result<Vec<StimulusInfo>, Error> {
    let heard = listen(tracer, room, settings)?;
    let observer = Observer::new(room, law);
    let stimulus = |sound: &LoadedSound| StimulusInfo {
        scene: room.name.clone(),
        yaw_deg: f64::from(room.listeners[0].yaw).to_degrees(),
        sound: sound.name.clone(),
        law: law.to_string(),
        profile: settings.profile().to_string(),
        waves: settings.waves,
        iterations: settings.iterations,
        seed: settings.seed,
        pan: heard.pan,
        hits: heard.hits,
        source_azimuth_deg: azimuth_deg(room),
        source_lateral_deg: lateral_deg(room),
        observer_lateral_deg: observer.answer_deg(Levels::of(&sound.mixed(heard.pan, law))),
    };
    Ok(sounds.iter().map(stimulus).collect())
}

/// The reason why a form cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder already contains files, which are not overwritten.
    #[error(
        "the folder {} is not empty: a form never replaces files, choose another",
        folder.display()
    )]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Creates the folder, and checks that it is empty and writable. Call it before the form is built.
///
/// # Errors
/// [`WriteError`], which contains the folder.
pub fn prepare(folder: &Path) -> Result<(), WriteError> {
    echomarch::internals::file_output::prepare_folder(folder)?;
    let cannot_list = |source: io::Error| OutputError::new(folder, source);
    let mut entries = std::fs::read_dir(folder).map_err(cannot_list)?;
    match entries.next() {
        None => Ok(()),
        Some(_) => Err(WriteError::NotEmpty {
            folder: folder.to_owned(),
        }),
    }
}

impl Form {
    /// The page as HTML.
    ///
    /// # Errors
    /// An error occurs if a sound cannot be encoded as WAV.
    pub fn html(&self) -> io::Result<String> {
        page::html(self)
    }

    /// Writes the page, the sounds and `experiment.json` into an empty folder.
    ///
    /// # Errors
    /// [`WriteError`]. If the folder is not empty, nothing is written.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        prepare(folder)?;
        let sounds = folder.join("sounds");
        echomarch::internals::file_output::prepare_folder_inside(&sounds)?;
        for trial in &self.trials {
            write_inside(&folder.join(&trial.file), |out| {
                out.write_all(&encode::wav_16(&self.samples(trial))?)
            })?;
        }
        let key = Key {
            experiment: &self.experiment,
            seed: self.seed,
            order_seed: self.order_seed,
            renderer: &self.renderer,
            trials: &self.trials,
        };
        write_inside(&folder.join("experiment.json"), |out| {
            Ok(serde_json::to_writer_pretty(out, &key)?)
        })?;
        // The page is written last, so that it exists only if all the files that it needs exist.
        write_inside(&folder.join("form.html"), |out| {
            out.write_all(self.html()?.as_bytes())
        })?;
        Ok(())
    }

    /// The interleaved left and right samples of a trial.
    fn samples(&self, trial: &Trial) -> Vec<f32> {
        let stimulus = &trial.stimulus;
        let sound = self
            .sounds
            .iter()
            .find(|sound| sound.name == stimulus.sound);
        sound.map_or_else(Vec::new, |sound| sound.mixed(stimulus.pan, self.law))
    }
}
