//! The thesis' experiments, reports and studies.
//!
//! | module | contents |
//! | --- | --- |
//! | [`experiment`] | the thesis' experiments, and measurements of accuracy, cost and hard cases |
//! | [`report`] | tables and documents, for people, and as CSV and JSON |
//! | [`study`] | sweeps and maps, in shards that can be computed on any machine and joined |
//! | [`text`] | untrusted text, made safe for terminals, CSV and pages |

pub mod experiment;
pub mod report;
pub mod study;
pub mod text;

/// Returns the scene with only its first source and its first listener. An experiment or a study traces one such pair.
pub fn of_first_pair(mut scene: echomarch::Scene) -> echomarch::Scene {
    scene.sources.truncate(1);
    scene.listeners.truncate(1);
    scene
}

/// Mean, median and quantiles, defined once for all reports.
pub mod stats {
    pub use echomarch::internals::sampling::{mean, median, quantiles};
}
