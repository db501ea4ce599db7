//! Errors of studies, of their shards, and of joining shards.

use super::shard::{NoShard, Shard};
use echomarch::internals::file_input::{InputError, MalformedText};
use echomarch::internals::file_output::OutputError;
use std::io;
use std::path::{Path, PathBuf};

/// The reason why a study cannot be run or joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The study file cannot be read.
    #[error("cannot read the study file {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: InputError,
    },
    /// The text is not a valid study.
    #[error(transparent)]
    Malformed(MalformedText),
    /// A field of the study file is invalid.
    #[error("{origin}: {place} must be {must}, not {value}")]
    BadField {
        /// The path of the file, or a name that represents it.
        origin: String,
        /// The field, such as `scenes[1].values."width"`, counted from 1.
        place: String,
        /// The valid values, with their unit.
        must: String,
        /// The given value.
        value: String,
    },
    /// A scene of the study cannot be used.
    #[error("{origin}: {place}: {source}")]
    Scene {
        /// The path of the file, or a name that represents it.
        origin: String,
        /// The field of the study that contains the scene.
        place: String,
        /// The scene's error.
        source: Box<echomarch::scene::SceneError>,
    },
    /// A point cannot be computed.
    #[error("point {index} ({what}): {source}")]
    Point {
        /// The point's number, counted from 0.
        index: u64,
        /// The point's scene, settings and other axes.
        what: String,
        /// The reason.
        source: Box<echomarch::Error>,
    },
    /// The text does not name a shard.
    #[error(transparent)]
    NoShard(#[from] NoShard),
    /// The file of a shard cannot be continued or joined.
    #[error("{}: {why}", path.display())]
    BadShard {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// Another process is computing the shard.
    #[error("shard {shard} is being worked on by another process: {} is locked", path.display())]
    Busy {
        /// The shard.
        shard: Shard,
        /// The working file of the shard.
        path: PathBuf,
    },
    /// The shards do not form the whole study.
    #[error("the shards in {} are not joined: {}", folder.display(), problems.join("; "))]
    NotWhole {
        /// The folder of the shards.
        folder: PathBuf,
        /// One reason for every shard that is missing or rejected.
        problems: Vec<String>,
    },
    /// The renderer is not the required one.
    #[error("the renderer is {renderer:?}, but {wanted:?} is required")]
    OtherRenderer {
        /// Name of the renderer found.
        renderer: String,
        /// The text that the name of the renderer must contain.
        wanted: String,
    },
    /// A map cannot be drawn.
    #[error("no map can be drawn: {why}")]
    NoMap {
        /// The reason.
        why: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl StudyError {
    /// Returns the error for a file at `path` that cannot be written.
    pub(super) fn output(path: &Path, source: io::Error) -> StudyError {
        OutputError::new(path, source).into()
    }

    /// Whether the error was caused by the input. The program then exits with 2, otherwise with 1.
    pub fn is_bad_input(&self) -> bool {
        match self {
            StudyError::Point { source, .. } => source.is_bad_input(),
            StudyError::Output(error) => error.is_bad_input(),
            StudyError::Busy { .. } => false,
            _ => true,
        }
    }
}
