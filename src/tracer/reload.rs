//! A scene that is reloaded when its files change.

use super::field_trial::Trial;
use super::programs::{march_text, structure};
use super::{Settings, Tracer};
use crate::error::Error;
use crate::scene::{Scene, SceneError, SceneWatch};

/// A scene that is read again when its files change. A new scene replaces the last one only if it
/// can be traced: until then, and after an error, the last good scene stays. It is replaced as a
/// whole, so that no frame sees half a change.
pub struct Reloading {
    watch: SceneWatch,
    scene: Scene,
    /// A new scene, while its fields are tried.
    trying: Option<(Scene, Trial)>,
    /// Programs that are drawn with the scene in addition to the tracer's.
    others: Vec<ProgramOf>,
}

/// The text of a fragment shader of a scene.
type ProgramOf = fn(&Scene) -> String;

impl Reloading {
    /// Reads a scene, checks it with the tracer, and follows its files from now on.
    ///
    /// # Errors
    /// As [`Scene::load`] and [`Tracer::check`]: there is no earlier scene to keep.
    pub fn open(
        name_or_file: &str,
        tracer: &mut Tracer,
        settings: &Settings,
    ) -> Result<Reloading, Error> {
        let (watch, scene) = SceneWatch::open(name_or_file)?;
        Reloading::new(watch, scene, tracer, settings)
    }

    /// As [`Reloading::open`], for a scene that `load` reads from the file and the files that it
    /// names.
    ///
    /// # Errors
    /// The errors of `load`, and as [`Tracer::check`].
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

    /// Looks at the files; to be called between frames, as often as one likes. A new scene
    /// is checked and its programs are compiled here, so that the next frame does not wait;
    /// while its fields are tried in a [child](super::FieldTrial), nothing waits either, and
    /// nothing has changed.
    ///
    /// Returns whether there is a new scene.
    ///
    /// # Errors
    /// As [`Reloading::open`], once after each change that leaves no scene that can be traced; the last scene is kept.
    pub fn poll(&mut self, tracer: &mut Tracer, settings: &Settings) -> Result<bool, Error> {
        let Some(scene) = self.tried(settings)? else {
            return Ok(false);
        };
        tracer.check(&scene, settings)?;
        self.scene = scene;
        Ok(true)
    }

    /// A new scene whose fields have been tried.
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

    /// The last good scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The files that are followed; none for a built-in scene.
    pub fn files(&self) -> impl Iterator<Item = &std::path::Path> {
        self.watch.files()
    }
}

/// Begins to try a scene's fields, together with the tracer's program and others.
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

/// A scene that is opened while another one continues: the trial of its fields does not block.
pub struct Opening {
    reloading: Reloading,
    trial: Option<Trial>,
}

impl Opening {
    /// Reads a scene and begins to try its fields, in the tracer's program and in `others`.
    ///
    /// # Errors
    /// As [`Scene::load`], and [`Error::Trace`] for a field that is rejected at once.
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

    /// Whether its fields are being tried.
    pub fn is_tried(&self) -> bool {
        self.trial.is_some()
    }

    /// Whether the fields can be used, once known; known immediately if there are no fields to try.
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

    /// Follows the scene's files from now on. The tracer has not checked it yet.
    pub fn follow(self) -> Reloading {
        self.reloading
    }
}
