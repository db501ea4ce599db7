//! What can be wrong with a scene.
//!
//! The sentences are written where the check is: the syntax of a file in `crate::ron_error` and `scene/file/hints.rs`; a
//! number's range in `scene/shape/parameter.rs` and `scene/notation/numbers.rs`; a shape in `scene/shape/check.rs` and
//! its own file; names, materials and the scene as a whole in `scene/check/`; what is too large for a renderer in
//! `kernel/structure.rs`.

use crate::file_input::{InputError, MalformedText};
use std::path::{Path, PathBuf};

/// A scene that cannot be used, and why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a built-in name nor a file that exists.
    #[error(
        "there is no scene {name:?}: neither a file nor one of the built-in scenes ({builtin}){}",
        nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean {name}?"))
    )]
    Unknown {
        /// The requested value.
        name: String,
        /// The names there are, separated by commas.
        builtin: String,
        /// The built-in scene whose name is nearly that one, or a file that is called so but for its
        /// ending, if there is one.
        nearest: Option<String>,
    },
    /// The file cannot be read.
    #[error("cannot read the scene file {}: {source}{}", path.display(), may_be_meant(source, path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: InputError,
    },
    /// The text is not a scene; its origin is the file's path, or `scene` for text that came from elsewhere.
    #[error(transparent)]
    Malformed(MalformedText),
    /// A scene file has no path that a file in that folder could name as its base.
    #[error("{} has no path that a scene file in the folder {} can name", base.display(), folder.display())]
    NoBase {
        /// Where the other file is to lie.
        folder: PathBuf,
        /// The scene file.
        base: PathBuf,
    },
    /// A file that the scene names cannot be used.
    #[error("{origin}: {why}")]
    Attached {
        /// The scene file, or what stands for it.
        origin: String,
        /// What is wrong, with the file.
        why: String,
    },
    /// What is rejected at a time of its key frames, and not before.
    #[error("at {seconds} s, {refused}")]
    At {
        /// The time, of a key or between two.
        seconds: f64,
        /// What is wrong there.
        refused: Box<SceneError>,
    },
    /// No surface at all.
    #[error("scene {scene:?} has no surfaces: there is nothing for a wave to meet")]
    Empty {
        /// The scene's name.
        scene: String,
    },
    /// A field that cannot be.
    #[error("scene {scene:?}: {surface}: {why}")]
    BadField {
        /// The scene's name.
        scene: String,
        /// Which surface.
        surface: String,
        /// What is wrong, and what would be right.
        why: String,
    },
    /// A driver of a number that is not there.
    #[error(
        "scene {scene:?}: {surface} has no number {parameter:?} that could be driven; it has: {known}"
    )]
    UnknownParameter {
        /// The scene's name.
        scene: String,
        /// Which surface.
        surface: String,
        /// The requested value.
        parameter: String,
        /// The names there are.
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
        /// The names there are.
        known: String,
        /// The name that is nearly that one, if there is one.
        nearest: Option<String>,
    },
    /// A source or a listener by a number that none has.
    #[error("scene {scene:?} has no {what} number {number}: it has {count}, counted from 0")]
    NoSuchNumber {
        /// The scene's name.
        scene: String,
        /// `source` or `listener`.
        what: &'static str,
        /// The requested number, from 0.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A wall that no room has.
    #[error(
        "a room has no wall number {wall}: they are counted from 0, {}",
        super::WALL_NAMES.join(", ")
    )]
    NoSuchWall {
        /// The requested number, from 0.
        wall: usize,
    },
    /// Two sources or two listeners of one name.
    #[error("scene {scene:?}: two of the {what} are called {name:?}")]
    SameName {
        /// The scene's name.
        scene: String,
        /// `sources` or `listeners`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A source or a listener is called by the number of another, which has no name of its own.
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
    /// A number that is invalid at its place.
    #[error("scene {scene:?}: {what} must be {must}, not {value}")]
    BadNumber {
        /// The scene's name.
        scene: String,
        /// Which value, with its unit.
        what: String,
        /// What it has to be.
        must: &'static str,
        /// What it is.
        value: String,
    },
}

/// A clause on what may be meant by a file that is not there.
fn may_be_meant(why: &InputError, path: &Path) -> String {
    match why {
        InputError::Io(error) if error.kind() == std::io::ErrorKind::NotFound => {
            super::builtin::built_in_of(path)
        }
        _ => String::new(),
    }
}

impl SceneError {
    /// The same with a time; an error that has its time already stays.
    pub(crate) fn at(self, seconds: f64) -> SceneError {
        match self {
            SceneError::At { .. } => self,
            refused => SceneError::At {
                seconds,
                refused: Box::new(refused),
            },
        }
    }
}
