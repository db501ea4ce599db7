//! Studies: sweeps and maps of any size. A study is divided into shards, which any machine can compute and which are
//! joined afterwards.
//!
//! A [`Study`] is a RON file that lists scenes with named values, times, positions of source and listener, settings and
//! seeds, and the results to keep. Its *points* are all combinations of these values. Points are numbered from 0 in a
//! fixed order: the seed changes fastest, then the listener, the source, the settings, the time, the named values, and
//! the scene. All callers compute a point with the same function ([`Worker`]).
//!
//! # Shards
//! Points are assigned to shards in blocks of [`BLOCK`] in round-robin order, which balances the work. A [`Shard`] is
//! one file with one line per point. During the computation the file has a temporary name and grows by one point at a
//! time. It can be continued after any interruption, and gets its final name when it is complete. [`join`](join())
//! combines the shards. It rejects damaged shards, and shards of another study, version or renderer.
//!
//! # Determinism
//! On one renderer, the result of a point depends only on the study. Rows contain no time, machine name or order of
//! computation. The joined tables therefore have the same bytes, however the study was divided and run.

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

/// Number of consecutive points that are assigned to a shard at a time. The block is small, so that shards have equal
/// shares of the expensive parts of a study. The block is larger than one, so that consecutive points of a shard share
/// a scene.
pub const BLOCK: u64 = 16;

/// A study that has been read and checked.
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
    /// Number of points for each variant of a scene.
    each: u64,
    points: u64,
}

/// A scene with the axes of its named values.
#[derive(Clone, Debug)]
struct SceneAxis {
    scene: Scene,
    values: BTreeMap<String, Numbers>,
    /// Number of variants of all earlier scenes.
    first: u64,
    end: u64,
}

/// Settings, with a label if they are a case of the accuracy experiment.
#[derive(Clone, Debug)]
struct Case {
    label: Option<String>,
    settings: Settings,
}

/// The results to keep for each point.
#[derive(Clone, Debug)]
struct Kept {
    pan: bool,
    counts: bool,
    exact: bool,
    response: Option<(ResponseSettings, ResponseColumns)>,
}

impl Study {
    /// Reads a study file and its scenes. The paths of the scenes are relative to the folder of the study file.
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

    /// The study's name, or the name of its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of points.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// SHA-256, as hexadecimal digits, over everything that determines the results except the program and the renderer:
    /// the content of the study, and the texts of its scenes and their files. Layout, comments and the folders of the
    /// files are excluded.
    pub fn hash(&self) -> &str {
        &self.hash
    }
}

/// The name and version of the renderer, which must be equal in all shards to be joined.
pub fn renderer_of(tracer: &Tracer) -> String {
    let context = tracer.context();
    format!("{}; {}", context.renderer(), context.version())
}

/// The program's version as written in shards.
const VERSION: &str = env!("CARGO_PKG_VERSION");
