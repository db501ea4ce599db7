//! The scene of a subcommand: its arguments, its loading, and its warnings.

use super::exit::BadInput;
use super::numbers::real;
use super::options::Common;
use clap::Args;
use echomarch::Error;
use echomarch::internals::shader::{Layout, Lists};
use echomarch::scene::{Scene, SceneError};

/// Maximum number of warnings printed for one scene. If a scene has more, the number of further warnings is printed.
const MOST_WARNINGS: usize = 8;

/// Number of surfaces above which compilation of a scene's shader takes seconds (docs/scene-format.md).
const MANY_SURFACES: usize = 64;

/// A scene and its named values.
#[derive(Args, Clone, Debug)]
pub struct SceneArguments {
    /// Built-in scene or scene file
    #[arg(id = "scene", value_name = "SCENE")]
    pub name_or_file: String,
    /// Set a named value of the scene in the unit of its file (metres, degrees); repeatable
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = name_and_value)]
    pub set: Vec<(String, f32)>,
}

impl SceneArguments {
    /// Loads the scene, sets its named values, and checks it again.
    pub fn load(&self) -> Result<Scene, SceneError> {
        let mut scene = Scene::load(&self.name_or_file)?;
        for (name, value) in &self.set {
            scene.set_value(name, *value)?;
        }
        if !self.set.is_empty() {
            scene.check()?;
        }
        Ok(scene)
    }
}

fn name_and_value(said: &str) -> Result<(String, f32), String> {
    let Some((name, value)) = said.rsplit_once('=') else {
        return Err("it must be NAME=VALUE".to_owned());
    };
    match real::<f32>(value.trim()) {
        Ok(number) if number.is_finite() => Ok((name.trim().to_owned(), number)),
        _ => Err(format!("{value:?} is not a finite number")),
    }
}

/// A scene at a point in time on its paths.
#[derive(Args, Debug)]
pub struct SceneAtTime {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Time in seconds on the paths of source, listener and surfaces [default: initial positions]. In a scene without
    /// motion, the option has no effect and causes a warning
    #[arg(long, allow_negative_numbers = true, value_name = "SECONDS", value_parser = real::<f64>)]
    time: Option<f64>,
}

impl Common {
    /// Loads a scene and prints its warnings.
    pub fn scene(&self, name_or_file: &str) -> Result<Scene, Error> {
        Ok(self.told(Scene::load(name_or_file)?))
    }

    /// Loads a scene, sets its named values, and prints the remaining warnings.
    pub fn scene_with_values(&self, arguments: &SceneArguments) -> Result<Scene, Error> {
        Ok(self.told(arguments.load()?))
    }

    /// Loads the scene, sets its named values and the time on its paths.
    pub fn scene_at_time(&self, arguments: &SceneAtTime) -> anyhow::Result<Scene> {
        let Some(seconds) = arguments.time else {
            return Ok(self.scene_with_values(&arguments.scene)?);
        };
        if !(seconds.is_finite() && seconds >= 0.0) {
            let text = format!("--time must be finite and 0 or more, not {seconds}");
            return Err(BadInput(text).into());
        }
        let loaded = arguments.scene.load().map_err(Error::from)?;
        let scene = loaded.at(seconds);
        if loaded.duration() == 0.0 && scene == loaded {
            let name = &scene.name;
            self.note(&format!(
                "warning: {name}: nothing moves, --time has no effect"
            ));
        }
        let possible = scene.validate().map_err(|refused| refused.at(seconds));
        possible.map_err(Error::from)?;
        Ok(self.told(scene))
    }

    /// Prints the warnings of a loaded scene, and returns the scene.
    fn told(&self, scene: Scene) -> Scene {
        self.warn_when_known(&scene, false);
        self.note_many(&scene);
        scene
    }

    /// Prints a note if the scene has so many surfaces that its shaders compile slowly.
    fn note_many(&self, scene: &Scene) {
        let unrolled = Layout::of(&scene.surfaces, Lists::Lines).unrolled.len();
        if unrolled > MANY_SURFACES {
            self.note(&format!(
                "note: {unrolled} surfaces are not in cells: compiling their shader the first time can take long"
            ));
        }
    }

    /// Prints the warnings of a scene after the tracer has checked it, except those that were printed when it was
    /// loaded. Only the tracer can check users' fields.
    pub fn warn_checked(&self, scene: &Scene) {
        self.warn_when_known(scene, true);
    }

    fn warn_when_known(&self, scene: &Scene, is_checked: bool) {
        if is_checked == scene.user_fields().next().is_some() {
            self.warn(scene);
        }
    }

    /// Prints the warnings of a scene in its current state.
    pub fn warn(&self, scene: &Scene) {
        let warnings = scene.warnings();
        for warning in warnings.iter().take(MOST_WARNINGS) {
            self.note(&format!("warning: {}: {warning}", scene.name));
        }
        if let Some(more) = warnings.len().checked_sub(MOST_WARNINGS + 1) {
            self.note(&format!("warning: {}: and {} more", scene.name, more + 1));
        }
    }
}
