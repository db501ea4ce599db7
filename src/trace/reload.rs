//! A scene that follows its files while it is traced.

use super::{Settings, Tracer};
use crate::error::Error;
use crate::scene::{Scene, SceneError, SceneWatch};

/// A scene that is read again when its files change, and only taken when it can be traced:
/// until then, and after an error, the last good one stays. It is taken as a whole, so that no
/// frame sees half a change.
pub struct Reloading {
    watch: SceneWatch,
    scene: Scene,
}

/// What a look at the files has brought.
#[derive(Debug)]
#[must_use]
pub enum Reload {
    /// Nothing new.
    Unchanged,
    /// There is a new scene.
    Taken,
    /// The files have changed, but make no scene that can be traced: the last one stays.
    Kept(Error),
}

impl Reloading {
    /// Reads a scene, checks it with the tracer, and follows its files from now on.
    ///
    /// # Errors
    /// As [`Scene::load`] and [`Tracer::check`]: at first there is no scene to keep.
    pub fn open(
        name_or_file: &str,
        tracer: &mut Tracer,
        settings: &Settings,
    ) -> Result<Reloading, Error> {
        let (watch, scene) = SceneWatch::open(name_or_file)?;
        Reloading::new(watch, scene, tracer, settings)
    }

    /// As [`Reloading::open`], for a scene that `load` reads from the file and what it names.
    ///
    /// # Errors
    /// Those of `load`, and as [`Tracer::check`].
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
        Ok(Reloading { watch, scene })
    }

    /// Looks at the files; to be called between frames, as often as one likes. A new scene
    /// is checked and its programs are compiled here, so that the next frame does not wait.
    pub fn poll(&mut self, tracer: &mut Tracer, settings: &Settings) -> Reload {
        let Some(read) = self.watch.poll() else {
            return Reload::Unchanged;
        };
        let checked = read.map_err(Error::from).and_then(|scene| {
            tracer.check(&scene, settings)?;
            Ok(scene)
        });
        match checked {
            Ok(scene) => {
                self.scene = scene;
                Reload::Taken
            }
            Err(error) => Reload::Kept(error),
        }
    }

    /// The last good scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The files that are followed; none of a built-in scene.
    pub fn files(&self) -> impl Iterator<Item = &std::path::Path> {
        self.watch.files()
    }
}
