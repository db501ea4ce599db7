//! What can be wrong with a study, its shards, and joining them.

use super::shard::{NoShard, Shard};
use crate::file_input::{InputError, MalformedText};
use crate::file_output::OutputError;
use std::io;
use std::path::{Path, PathBuf};

/// A study that cannot be run or joined, and why.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The study file cannot be read.
    #[error("cannot read the study file {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: InputError,
    },
    /// The text is not a study.
    #[error(transparent)]
    Malformed(MalformedText),
    /// A field of the study file that makes no sense.
    #[error("{origin}: {place} must be {must}, not {value}")]
    BadField {
        /// File path, or what stands for it.
        origin: String,
        /// Which field, as `scenes[1].values."width"`, counted from 1.
        place: String,
        /// What it has to be, with its unit.
        must: String,
        /// What it is.
        value: String,
    },
    /// A scene of the study that cannot be used.
    #[error("{origin}: {place}: {source}")]
    Scene {
        /// File path, or what stands for it.
        origin: String,
        /// Which field of the study.
        place: String,
        /// What is wrong with the scene.
        source: Box<crate::scene::SceneError>,
    },
    /// A point that cannot be computed.
    #[error("point {index} ({what}): {source}")]
    Point {
        /// Its number, counted from 0.
        index: u64,
        /// Where in the study it is.
        what: String,
        /// Why.
        source: Box<crate::Error>,
    },
    /// Text that names no shard.
    #[error(transparent)]
    NoShard(#[from] NoShard),
    /// A shard's file that cannot be gone on with, or taken.
    #[error("{}: {why}", path.display())]
    BadShard {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// Another process works on the shard.
    #[error("shard {shard} is being worked on by another process: {} is locked", path.display())]
    Busy {
        /// Which.
        shard: Shard,
        /// Its working file.
        path: PathBuf,
    },
    /// Shards that are no whole study.
    #[error("the shards in {} are not joined: {}", folder.display(), problems.join("; "))]
    NotWhole {
        /// Where they lie.
        folder: PathBuf,
        /// Every shard that is missing or wrong, and how.
        problems: Vec<String>,
    },
    /// A renderer other than the one that was demanded.
    #[error("the renderer is {renderer:?}, and {wanted:?} is demanded")]
    OtherRenderer {
        /// The renderer that was found.
        renderer: String,
        /// What its name must hold.
        wanted: String,
    },
    /// A map of what is no map.
    #[error("no map can be drawn: {why}")]
    NoMap {
        /// Why.
        why: String,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl StudyError {
    /// A file at `path` that could not be written.
    pub(super) fn output(path: &Path, source: io::Error) -> StudyError {
        let path = path.to_owned();
        OutputError { path, source }.into()
    }

    /// Whether what was given is to blame (the program then exits with 2, else with 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            StudyError::Point { source, .. } => source.is_bad_input(),
            StudyError::Output(error) => error.is_bad_input(),
            StudyError::Busy { .. } => false,
            _ => true,
        }
    }
}
