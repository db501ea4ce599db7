//! The thesis' experiments, reports and studies.
//!
//! | module | contents |
//! | --- | --- |
//! | [`experiment`] | the thesis' experiments, and what accuracy costs |
//! | [`report`] | tables and documents, for people and for programs |
//! | [`study`] | sweeps and maps in shards that are computed anywhere and joined |
//! | [`text`] | untrusted text on terminals, in CSV and in pages |

pub mod experiment;
pub mod report;
pub mod study;
pub mod text;

/// Mean, median and quantiles: one definition for every report.
pub mod stats {
    pub use echomarch::internals::sampling::{mean, median, quantiles};
}
