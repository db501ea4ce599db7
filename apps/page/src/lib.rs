//! The Rust interface of the page: passes numbers and text between JavaScript and `echomarch`.
//!
//! | struct | runs in | task |
//! | --- | --- | --- |
//! | [`Page`] | the page | walks, traces frames, draws the picture and the plan |
//! | [`EarsOfPage`] | a worker with its own canvas | traces full listening |
//! | [`MixOfPage`] | a worker | mixes the responses into blocks of samples |

mod ears;
mod mix;
mod page;

pub use ears::{EarsOfPage, HeardByPage};
pub use mix::MixOfPage;
pub use page::{Page, PlanOfPage};

use echomarch::auralisation::Listen;
use echomarch::response::PathKind;
use echomarch::{Profile, Scene, Settings};
use std::fmt::Display;
use wasm_bindgen::prelude::*;

/// The names of the built-in scenes.
#[wasm_bindgen]
pub fn scenes() -> Vec<String> {
    Scene::BUILTIN_NAMES.map(str::to_owned).to_vec()
}

/// The names of the kinds of exact paths.
#[wasm_bindgen]
pub fn path_kinds() -> Vec<String> {
    PathKind::ALL.map(|kind| kind.name().to_owned()).to_vec()
}

/// The text of a built-in scene.
#[wasm_bindgen]
pub fn scene_text(name: &str) -> Option<String> {
    Scene::builtin_text(name).map(str::to_owned)
}

/// The name that a scene has in its text; `None` if it has none, or if the text is invalid.
#[wasm_bindgen]
pub fn scene_name(text: &str) -> Option<String> {
    let scene = Scene::from_ron(text, "").ok()?;
    Some(scene.name).filter(|name| !name.is_empty())
}

/// Converts a panic to a JavaScript error with the same message. The page and the workers show that message.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| {
        wasm_bindgen::throw_str(&panic.to_string())
    }));
}

/// Converts an error to a JavaScript error.
fn thrown(error: impl Display) -> JsError {
    JsError::new(&error.to_string())
}

/// Reads a scene from its text. The scene is called `name` if the text contains no name.
fn scene(text: &str, name: &str) -> Result<Scene, JsError> {
    let mut scene = Scene::from_ron(text, name).map_err(thrown)?;
    if scene.name.is_empty() {
        scene.name = name.to_owned();
    }
    Ok(scene)
}

fn profile(name: &str) -> Result<Profile, JsError> {
    name.parse().map_err(thrown)
}

fn listen(name: &str) -> Result<Listen, JsError> {
    name.parse::<Listen>().map_err(thrown)
}

fn settings(of: &str, waves: u32, iterations: u32) -> Result<Settings, JsError> {
    let settings = Settings::new(profile(of)?);
    Ok(settings.with_waves(waves).with_iterations(iterations))
}
