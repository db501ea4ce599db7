//! The built-in scenes, read from the files in
//! `examples/scenes/`.

use super::{Scene, SceneError};
use std::path::{Path, PathBuf};

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        &[$((
            $name,
            include_str!(concat!("../../examples/scenes/", $name, ".ron")),
        )),*]
    };
}

/// Names and texts of the built-in scenes.
const BUILTIN: &[(&str, &str)] = built_in![
    "corner",
    "obstacles",
    "open-field",
    "open-pillars",
    "shoebox",
    "whispering-gallery",
    "parabolic-mirrors",
    "colonnade",
    "cave",
    "morphing-room",
    "menger",
    "glasshouse",
];

/// The GLSL fields that the built-in scenes name.
pub(super) const FIELDS: &[(&str, &str)] = &[(
    "menger.glsl",
    include_str!("../../examples/scenes/menger.glsl"),
)];

/// Whether a field's text is one of those built into the program.
pub(super) fn is_own_text(text: &str) -> bool {
    FIELDS.iter().any(|(_, own)| *own == text)
}

/// The names that [`Scene::builtin`] knows.
pub const BUILTIN_NAMES: [&str; BUILTIN.len()] = {
    let mut names = [""; BUILTIN.len()];
    let mut index = 0;
    while index < BUILTIN.len() {
        names[index] = BUILTIN[index].0;
        index += 1;
    }
    names
};

impl Scene {
    /// A built-in scene by its name (see [`BUILTIN_NAMES`]).
    ///
    /// ```
    /// let corner = echomarch::Scene::builtin("corner")?;
    /// assert_eq!(corner.surfaces.len(), 2);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Unknown`] for any other name.
    pub fn builtin(name: &str) -> Result<Scene, SceneError> {
        match BUILTIN.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => {
                Scene::from_embedded(text, &format!("built-in scene {name}"), FIELDS)
            }
            None => Err(unknown(name, None)),
        }
    }

    /// The RON text of a built-in scene.
    pub fn builtin_text(name: &str) -> Option<&'static str> {
        let known = BUILTIN.iter().find(|(known, _)| *known == name);
        known.map(|(_, text)| *text)
    }

    /// Loads a built-in scene by its name, or else a scene file.
    ///
    /// A name is looked up among the built-in scenes first; `./corner` is a file.
    ///
    /// # Errors
    /// [`SceneError`]: unknown, unreadable, malformed, or no scene to be heard.
    pub fn load(name_or_file: &str) -> Result<Scene, SceneError> {
        Scene::load_in(name_or_file, Path::new(""))
    }

    /// Loads a scene as [`Scene::load`] does, with file names relative to `folder`.
    pub fn load_in(name_or_file: &str, folder: &Path) -> Result<Scene, SceneError> {
        match named(name_or_file, Some(folder)) {
            Named::BuiltIn(scene) => scene,
            Named::File(path) => Scene::from_file(&path),
            Named::Unknown(error) => Err(error),
        }
    }
}

/// The scene, file or error that a scene's name leads to.
pub(super) enum Named {
    BuiltIn(Result<Scene, SceneError>),
    File(PathBuf),
    Unknown(SceneError),
}

/// Looks up the name of a built-in scene, or else of a file in a folder; without a folder, no file
/// is looked up.
pub(super) fn named(name: &str, folder: Option<&Path>) -> Named {
    if BUILTIN_NAMES.contains(&name) {
        return Named::BuiltIn(Scene::builtin(name));
    }
    let Some(folder) = folder else {
        return Named::Unknown(unknown(name, None));
    };
    let (path, place) = (Path::new(name), folder.join(name));
    let looks_like_a_file = path.extension().is_some() || path.components().count() > 1;
    if looks_like_a_file || place.exists() {
        return Named::File(place);
    }
    Named::Unknown(unknown(name, Some(folder)))
}

fn unknown(name: &str, folder: Option<&Path>) -> SceneError {
    let file = || folder.and_then(|folder| file_of(name, folder));
    SceneError::Unknown {
        name: name.to_owned(),
        builtin: BUILTIN_NAMES.join(", "),
        nearest: nearest(name).map(str::to_owned).or_else(file),
    }
}

/// A scene file whose name without the ending is `name`: in the folder, or among the examples of a
/// checkout.
fn file_of(name: &str, folder: &Path) -> Option<String> {
    let file = format!("{name}.ron");
    let example = format!("examples/scenes/{file}");
    let mut known = [file, example].into_iter();
    known.find(|file| folder.join(file).is_file())
}

/// The built-in scene whose name is closest to `name`, or that has it as a word or a beginning.
fn nearest(name: &str) -> Option<&'static str> {
    let plain = name.to_lowercase().replace([' ', '_'], "-");
    let has = |known: &&str| {
        let is_part = plain.len() >= 3 && known.starts_with(&plain);
        is_part || known.split('-').any(|word| word == plain)
    };
    let mistyped = crate::text::nearest(name, BUILTIN_NAMES);
    mistyped.or_else(|| BUILTIN_NAMES.into_iter().find(has))
}

/// A clause that suggests the built-in scene with the name of a missing file, or an empty text.
pub(super) fn built_in_of(path: &Path) -> String {
    let is_alone = path.components().count() == 1;
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let known = stem.and_then(|stem| BUILTIN_NAMES.into_iter().find(|known| *known == stem));
    match known.filter(|_| is_alone) {
        Some(name) => format!("; the built-in scene is called {name}"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects files from editors that put a byte-order mark before the text.
    #[test]
    fn a_byte_order_mark_is_no_part_of_the_scene() {
        let marked = format!("\u{feff}{}", BUILTIN[0].1);
        let scene = Scene::from_ron(&marked, "marked").unwrap();
        assert_eq!(scene, Scene::builtin(BUILTIN[0].0).unwrap());
    }

    /// For a mistyped name the nearest one is suggested, if any is near.
    #[test]
    fn a_name_that_is_nearly_right_is_suggested() {
        for (typed, meant) in [
            ("cornr", Some("corner")),
            ("Corner", Some("corner")),
            ("conrer", Some("corner")),
            ("obstacle", Some("obstacles")),
            ("open_field", Some("open-field")),
            ("openfield", Some("open-field")),
            ("whispering", Some("whispering-gallery")),
            ("mirrors", Some("parabolic-mirrors")),
            ("trumpet", None),
            ("x", None),
        ] {
            assert_eq!(nearest(typed), meant, "{typed}");
            let told = Scene::load(typed).unwrap_err().to_string();
            let is_asked = told.contains("did you mean");
            assert_eq!(is_asked, meant.is_some(), "{told}");
            assert!(meant.is_none_or(|meant| told.contains(meant)), "{told}");
        }
    }

    /// Protects every file in `examples/scenes/` that ships as a built-in scene.
    #[test]
    fn built_in_scenes_load_without_a_warning() {
        for name in BUILTIN_NAMES {
            let scene = Scene::builtin(name).unwrap();
            assert_eq!(scene.name, name);
            assert_eq!(scene.warnings(), vec![], "{name}");
        }
    }
}
