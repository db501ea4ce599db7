//! A scene that is reloaded when its files change.

use super::field_trial::Trial;
use super::programs::{march_text, structure};
use super::{Settings, Tracer};
use crate::error::Error;
use crate::scene::{Scene, SceneError, SceneWatch};

/// A scene that is read again when its files change. A new scene replaces the current one only if it can be traced.
/// Until then, and after an error, the current scene stays. The scene is replaced as a whole, so that no frame has a
/// part of a change.
pub struct Reloading {
    watch: SceneWatch,
    scene: Scene,
    /// A new scene, while its fields are tried.
    trying: Option<(Scene, Trial)>,
    /// Programs that are drawn with the scene in addition to the tracer's own programs.
    others: Vec<ProgramOf>,
}

/// The text of a fragment shader of a scene.
type ProgramOf = fn(&Scene) -> String;

impl Reloading {
    /// Reads a scene, checks it with the tracer, and watches its files from now on.
    ///
    /// # Errors
    /// The errors of [`Scene::load`] and [`Tracer::check`], because there is no earlier scene to keep.
    pub fn open(
        name_or_file: &str,
        tracer: &mut Tracer,
        settings: &Settings,
    ) -> Result<Reloading, Error> {
        let (watch, scene) = SceneWatch::open(name_or_file)?;
        Reloading::new(watch, scene, tracer, settings)
    }

    /// Like [`Reloading::open`], but `load` reads the scene from the file and from the files that it names.
    ///
    /// # Errors
    /// The errors of `load` and of [`Tracer::check`].
    pub fn open_with(
        name_or_file: &str,
        load: impl Fn() -> Result<Scene, SceneError> + 'static,
        tracer: &mut Tracer,
        settings: &Settings,
    ) -> Result<Reloading, Error> {
        let (watch, scene) = SceneWatch::open_with(name_or_file, load)?;
        Reloading::new(watch, scene, tracer, settings)
    }

    fn new(
        watch: SceneWatch,
        scene: Scene,
        tracer: &mut Tracer,
        settings: &Settings,
    ) -> Result<Reloading, Error> {
        tracer.check(&scene, settings)?;
        Ok(Reloading {
            watch,
            scene,
            trying: None,
            others: Vec::new(),
        })
    }

    /// Looks for changes of the files. Call this function between frames, as often as wanted. A new scene is checked
    /// and its programs are compiled here, so that the next frame does not wait. While the fields of the new scene are
    /// tried in a [child process](super::FieldTrial), the call does not wait, and the current scene stays.
    ///
    /// Returns whether a new scene has replaced the current one.
    ///
    /// # Errors
    /// The errors of [`Reloading::open`], once after each change after which the scene cannot be traced. The current
    /// scene is then kept.
    pub fn poll(&mut self, tracer: &mut Tracer, settings: &Settings) -> Result<bool, Error> {
        let Some(scene) = self.tried(settings)? else {
            return Ok(false);
        };
        tracer.check(&scene, settings)?;
        self.scene = scene;
        Ok(true)
    }

    /// A new scene whose fields have been tried, if there is one.
    fn tried(&mut self, settings: &Settings) -> Result<Option<Scene>, Error> {
        if let Some(read) = self.watch.poll() {
            // The scene that was being tried is outdated.
            self.trying = None;
            let scene = read?;
            let Some(trial) = begin_trial(&scene, settings, &self.others)? else {
                return Ok(Some(scene));
            };
            self.trying = Some((scene, trial));
        }
        let Some((scene, mut trial)) = self.trying.take() else {
            return Ok(None);
        };
        match trial.poll() {
            Some(ended) => ended.map(|()| Some(scene)),
            None => {
                self.trying = Some((scene, trial));
                Ok(None)
            }
        }
    }

    /// The current scene: the last one that can be traced.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The files that are watched; none for a built-in scene.
    pub fn files(&self) -> impl Iterator<Item = &std::path::Path> {
        self.watch.files()
    }
}

/// Begins a trial of a scene's fields in the tracer's program and in `others`.
fn begin_trial(
    scene: &Scene,
    settings: &Settings,
    others: &[ProgramOf],
) -> Result<Option<Trial>, Error> {
    scene.validate()?;
    let structure = structure(scene, settings);
    structure.check(scene)?;
    let mut programs = vec![march_text(scene, &structure, settings)];
    programs.extend(others.iter().map(|program| program(scene)));
    let programs: Vec<&str> = programs.iter().map(String::as_str).collect();
    Trial::begin(scene, &programs)
}

/// A scene that is opened while another scene is in use. The trial of its fields does not block.
pub struct Opening {
    reloading: Reloading,
    trial: Option<Trial>,
}

impl Opening {
    /// Reads a scene, and begins a trial of its fields in the tracer's program and in `others`.
    ///
    /// # Errors
    /// The errors of [`Scene::load`]; [`Error::Trace`] for a field that is rejected without a trial.
    pub fn begin(
        name_or_file: &str,
        settings: &Settings,
        others: &[ProgramOf],
    ) -> Result<Opening, Error> {
        let (watch, scene) = SceneWatch::open(name_or_file)?;
        Ok(Opening {
            trial: begin_trial(&scene, settings, others)?,
            reloading: Reloading {
                watch,
                scene,
                trying: None,
                others: others.to_vec(),
            },
        })
    }

    /// The scene as it was read.
    pub fn scene(&self) -> &Scene {
        self.reloading.scene()
    }

    /// Whether the trial of its fields is in progress.
    pub fn is_tried(&self) -> bool {
        self.trial.is_some()
    }

    /// Whether the fields can be used; `None` while this is unknown. It is known immediately if there are no fields to
    /// try.
    pub fn poll(&mut self) -> Option<Result<(), Error>> {
        let Some(trial) = &mut self.trial else {
            return Some(Ok(()));
        };
        let ended = trial.poll()?;
        self.trial = None;
        Some(ended)
    }

    /// Waits for the result of the trial.
    ///
    /// # Errors
    /// [`Error::Trace`] for a field that cannot be used.
    pub fn wait(&mut self) -> Result<(), Error> {
        self.trial.take().map_or(Ok(()), Trial::wait)
    }

    /// Watches the scene's files from now on. The tracer has not yet checked the scene.
    pub fn follow(self) -> Reloading {
        self.reloading
    }
}
