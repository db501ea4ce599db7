//! The thesis' experiments, reports and studies.
//!
//! | module | contents |
//! | --- | --- |
//! | [`experiment`] | the thesis' experiments, and the cost of accuracy |
//! | [`report`] | tables and documents, for people and for programs |
//! | [`study`] | sweeps and maps in shards that are computed anywhere and joined |
//! | [`text`] | untrusted text on terminals, in CSV and in pages |

pub mod experiment;
pub mod report;
pub mod study;
pub mod text;

/// Returns the scene with only its first source and its first listener: an experiment or a study traces one such pair.
pub fn of_first_pair(mut scene: echomarch::Scene) -> echomarch::Scene {
    scene.sources.truncate(1);
    scene.listeners.truncate(1);
    scene
}

/// Mean, median and quantiles, defined once for all reports.
pub mod stats {
    pub use echomarch::internals::sampling::{mean, median, quantiles};
}
