//! Studies: sweeps and maps of any size, in shards that are computed anywhere and joined.
//!
//! A [`Study`] is a file (RON) that describes scenes with their named values, times, positions of source and listener,
//! settings and seeds, and which results to keep. Its *points* are all combinations of these, numbered from 0 in a
//! fixed order: the seed changes first, then the listener, the source, the settings, the time, the named values, the
//! scene. All callers compute a point with one function ([`Worker`]).
//!
//! # Shards
//! Points are distributed in blocks of [`BLOCK`] in round-robin order, so that expensive points are balanced. A
//! [`Shard`] is one file with one line per point. While it is computed it has another name, grows by a point at a time,
//! and continues after any interruption; it gets its final name when it is complete. [`join`](join()) puts shards
//! together, and rejects shards that are damaged, or of another study, version or renderer.
//!
//! # Determinism
//! On one renderer a point depends only on the study. Rows contain no time, machine or order of computation, so the
//! joined tables are the same bytes however the study was cut and run.

mod axes;
mod build;
mod check;
mod columns;
mod count;
mod empty;
mod error;
mod file;
mod hash;
mod join;
mod lines;
mod map;
mod other_processes;
#[cfg(feature = "parquet")]
mod parquet_file;
mod points;
mod read_shard;
mod row_form;
mod shard;
mod tables;
#[cfg(test)]
mod tests;
mod work;
mod work_place;
mod worker;

pub use count::{Estimate, estimate};
pub use empty::EmptyCells;
pub use error::StudyError;
pub use join::{Joined, join};
pub use map::{check_map_files, check_maps, draw_map};
pub use other_processes::{begun, rows_in};
pub use shard::{MOST_SHARDS, NoShard, Shard};
pub use work::compute;
pub use worker::Worker;

use columns::ResponseColumns;
use echomarch::response::ResponseSettings;
use echomarch::scene::Scene;
use echomarch::tracer::{Settings, Tracer};
use file::{Numbers, Places, Seeds};
use std::collections::BTreeMap;
use std::path::Path;

/// Number of neighbouring points assigned to a shard at a time: few, so that cheap and expensive parts of a study are
/// balanced; more than one, so that a shard's neighbouring points have a scene in common.
pub const BLOCK: u64 = 16;

/// A study that was read and checked.
#[derive(Clone, Debug)]
pub struct Study {
    name: String,
    hash: String,
    variants: Vec<SceneAxis>,
    times: Option<Numbers>,
    settings: Vec<Case>,
    sources: Places,
    listeners: Places,
    listener_radius: Option<f32>,
    seeds: Seeds,
    keep: Kept,
    /// Number of points of one variant of a scene.
    each: u64,
    points: u64,
}

/// A scene with the axes of its named values.
#[derive(Clone, Debug)]
struct SceneAxis {
    scene: Scene,
    values: BTreeMap<String, Numbers>,
    /// Number of variants of the scenes before it.
    first: u64,
    end: u64,
}

/// Settings, with a name if they are a case of `accuracy`.
#[derive(Clone, Debug)]
struct Case {
    label: Option<String>,
    settings: Settings,
}

/// The results that are kept of a point.
#[derive(Clone, Debug)]
struct Kept {
    pan: bool,
    counts: bool,
    exact: bool,
    response: Option<(ResponseSettings, ResponseColumns)>,
}

impl Study {
    /// Reads a study file, and the scenes that it names from its folder.
    ///
    /// ```no_run
    /// use echomarch_lab::study::{Shard, Study, Worker, compute, join};
    /// # use echomarch::{Tracer, gl::Context};
    /// let study = Study::from_file("study.ron".as_ref())?;
    /// let tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let mut worker = Worker::new(&study, tracer);
    /// compute(&mut worker, Shard::WHOLE, "out".as_ref(), &mut |_| ())?;
    /// let joined = join(&study, "out".as_ref(), &mut |_, _| ())?;
    /// assert_eq!(joined.points, study.points());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`StudyError::Unreadable`], [`StudyError::Malformed`] with line and column,
    /// [`StudyError::BadField`] with the field and its range, [`StudyError::Scene`].
    pub fn from_file(path: &Path) -> Result<Study, StudyError> {
        build::from_file(path)
    }

    /// The study's name, or that of its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// SHA-256 in hexadecimal digits of everything that determines the results, except program and renderer: the
    /// content of the study, and the texts of its scenes and their files. Layout, comments and folders of files are not
    /// included.
    pub fn hash(&self) -> &str {
        &self.hash
    }
}

/// The renderer's name and version, which must be equal in all joined shards.
pub fn renderer_of(tracer: &Tracer) -> String {
    let context = tracer.context();
    format!("{}; {}", context.renderer(), context.version())
}

/// The program's version as written in shards.
const VERSION: &str = env!("CARGO_PKG_VERSION");
