//! The grammar of scene files: every shape, operator and driver as text and as data, the settings of the sound, and
//! errors with their positions.

mod files;
mod motion;
mod refusals;
mod rooms;
mod shapes;
mod sound;

use echomarch::{Scene, Shape};

/// A scene with one surface. `surface` is the text of the surface's fields.
fn text(surface: &str) -> String {
    format!(
        "Scene(\n    surfaces: [Surface({surface})],\n    source: Source(position: (0, 50, 0)),\n    listener: Listener(position: (0, 60, 0), radius: 1),\n)\n"
    )
}

fn scene(surface: &str) -> Scene {
    let text = text(surface);
    Scene::from_ron(&text, "text").unwrap_or_else(|error| panic!("{surface}: {error}"))
}

fn shape(shape: &str) -> Shape {
    scene(&format!("shape: {shape}")).surfaces.remove(0).shape
}

fn refusal(surface: &str) -> String {
    let error = Scene::from_ron(&text(surface), "text").expect_err(surface);
    let sentence = error.to_string();
    assert!(!sentence.contains('\n'), "{sentence}");
    sentence
}
