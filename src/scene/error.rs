//! Errors of scenes.
//!
//! The messages are written where the check is: the syntax of a file in `crate::ron_error` and `scene/file/hints.rs`; a
//! number's range in `scene/shape/parameter.rs` and `scene/notation/numbers.rs`; a shape in `scene/shape/check.rs` and
//! its own file; names, materials and the scene as a whole in `scene/check/`; what is too large for a renderer in
//! `kernel/structure.rs`.

use crate::file_input::{InputError, MalformedText};
use std::path::{Path, PathBuf};

/// The reason why a scene cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The name is neither a built-in scene nor an existing file.
    #[error(
        "there is no scene {name:?}: neither a file nor one of the built-in scenes ({builtin}){}",
        nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    Unknown {
        /// The requested value.
        name: String,
        /// The names of the built-in scenes, separated by commas.
        builtin: String,
        /// The built-in scene with a similar name, or a file with this name and an ending, if there
        /// is one.
        nearest: Option<String>,
    },
    /// The file cannot be read.
    #[error("cannot read the scene file {}: {source}{}", path.display(), may_be_meant(source, path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: InputError,
    },
    /// The text is not a scene; its origin is the file's path, or `scene` for other text.
    #[error(transparent)]
    Malformed(MalformedText),
    /// A scene file in that folder has no path by which it could name this one as its base.
    #[error("{} has no path that a scene file in the folder {} can name", base.display(), folder.display())]
    NoBase {
        /// The folder of the other file.
        folder: PathBuf,
        /// The scene file.
        base: PathBuf,
    },
    /// A file that the scene names cannot be used.
    #[error("{origin}: {why}")]
    Attached {
        /// The scene file, or the name used for the scene's text.
        origin: String,
        /// The file and the error.
        why: String,
    },
    /// The scene is invalid at a time of its key frames, and not before.
    #[error("at {seconds} s, {refused}")]
    At {
        /// The time, at a key or between two.
        seconds: f64,
        /// The error at that time.
        refused: Box<SceneError>,
    },
    /// The scene has no surfaces.
    #[error("scene {scene:?} has no surfaces: there is nothing for a wave to meet")]
    Empty {
        /// The scene's name.
        scene: String,
    },
    /// An invalid field.
    #[error("scene {scene:?}: {surface}: {why}")]
    BadField {
        /// The scene's name.
        scene: String,
        /// The surface.
        surface: String,
        /// The error, and how to correct it.
        why: String,
    },
    /// A driver of a number that does not exist.
    #[error(
        "scene {scene:?}: {surface} has no number {parameter:?} that could be driven; it has: {known}"
    )]
    UnknownParameter {
        /// The scene's name.
        scene: String,
        /// The surface.
        surface: String,
        /// The requested value.
        parameter: String,
        /// The existing names.
        known: String,
    },
    /// A named value that the scene does not use.
    #[error(
        "scene {scene:?} has no value named {name:?}; it has: {known}{}",
        nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    UnknownValue {
        /// The scene's name.
        scene: String,
        /// The requested value.
        name: String,
        /// The existing names.
        known: String,
        /// A similar name, if there is one.
        nearest: Option<String>,
    },
    /// The scene does not have a source or listener of this number.
    #[error("scene {scene:?} has no {what} number {number}: it has {count}, counted from 0")]
    NoSuchNumber {
        /// The scene's name.
        scene: String,
        /// `source` or `listener`.
        what: &'static str,
        /// The requested number, from 0.
        number: usize,
        /// Number of existing ones.
        count: usize,
    },
    /// A room has no wall of this number.
    #[error(
        "a room has no wall number {wall}: they are counted from 0, {}",
        super::WALL_NAMES.join(", ")
    )]
    NoSuchWall {
        /// The requested number, from 0.
        wall: usize,
    },
    /// Two sources or two listeners have the same name.
    #[error("scene {scene:?}: two of the {what} are called {name:?}")]
    SameName {
        /// The scene's name.
        scene: String,
        /// `sources` or `listeners`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// The name of a source or a listener is the number of another that has no name.
    #[error(
        "scene {scene:?}: one of the {what} is called {name:?}, which is the number of another that has no name: name that one too"
    )]
    NameIsNumber {
        /// The scene's name.
        scene: String,
        /// `sources` or `listeners`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A number outside its valid range.
    #[error("scene {scene:?}: {what} must be {must}, not {value}")]
    BadNumber {
        /// The scene's name.
        scene: String,
        /// Name of the value, with its unit.
        what: String,
        /// Its valid range.
        must: &'static str,
        /// The given value.
        value: String,
    },
}

/// A clause that suggests a built-in scene for a missing file.
fn may_be_meant(why: &InputError, path: &Path) -> String {
    match why {
        InputError::Io(error) if error.kind() == std::io::ErrorKind::NotFound => {
            super::builtin::built_in_of(path)
        }
        _ => String::new(),
    }
}

impl SceneError {
    /// The same error with a time; an error that already has a time stays as it is.
    pub fn at(self, seconds: f64) -> SceneError {
        match self {
            SceneError::At { .. } => self,
            refused => SceneError::At {
                seconds,
                refused: Box::new(refused),
            },
        }
    }
}
