//! Arrivals: every crossing of the listener's sphere by every wave, with its energy.
//! [`Tracer::arrivals`](super::Tracer::arrivals) returns them. Several listeners may share the waves of a source: each
//! has a [`Detector`].
//!
//! The listener is transparent here. A pass (`glsl/arrivals/`) traces the waves of a *block* through a *chunk* of
//! iterations, and writes a record for each crossing, up to a maximum number of records per wave. The used records are
//! read back and processed here in `f64` while the next chunk is drawn. If a wave has more crossings than records, it is
//! entered in a list and drawn again from the start of the chunk, and the crossings already recorded are skipped.
//! Blending is off, so the same input gives the same bits.
//!
//! | file | contents |
//! | --- | --- |
//! | `events.rs` | the energy that a wave keeps after reflections |
//! | `settings.rs` | settings, the waves to follow and their starts, and counts |
//! | `detectors.rs` | the spheres in which crossings are counted |
//! | `volume.rs` | the open volume of a sphere |
//! | `targets.rs` | textures, and their read-back |
//! | `passages.rs` | the parts of waves that continue through solids |
//! | `block.rs` | the waves of a block: their progress, places and energies |
//! | `replay.rs` | the computation of arrivals from records |
//! | `resampling.rs` | waves of about equal energy |
//! | `../arrival_run.rs` | the program and the constant data of a trace |
//! | `../arrival_passes.rs` | the passes |

mod block;
mod detectors;
mod events;
mod passages;
mod replay;
mod resampling;
mod settings;
mod targets;
mod volume;

pub(super) use block::{Block, Listed};
pub(crate) use detectors::Detector;
pub(super) use detectors::{OpenVolumes, compiled_detectors, most_detectors};
pub(super) use events::EventTable;
pub(crate) use passages::{FarEnd, SolidHit, Transmitting};
pub(super) use passages::{
    LEAST_GENERATION, MOST_GENERATIONS, MOST_PASSAGES, PASSAGE_SHARE, Passage, kept,
    kept_beside_waves, loudest, thinned,
};
pub(super) use replay::{DetectorDensity, Replay};
pub(super) use resampling::ITERATIONS_BEFORE_RESAMPLING;
pub(crate) use resampling::{early_band_groups, resampled_band_groups};
pub use settings::{ArrivalCounts, ArrivalSettings};
pub(crate) use settings::{Followed, Start, WavesToFollow};
pub(super) use targets::{ArrivalTargets, LISTED_AT_MOST, listed_rows};
pub(crate) use volume::{Limits, MOST_LIMITS, NO_LIMITS};

/// Number of waves in a block. They are followed together through all their chunks. Their textures take 60 MB, and they
/// occupy every core of a large graphics card.
pub(super) const WAVES_IN_BLOCK: u32 = 1 << 18;

/// Iterations in a chunk, if loops and records allow this number. Writing the results of a chunk costs about as much as
/// ten iterations in an empty room.
pub(super) const ITERATIONS_IN_CHUNK: u32 = 64;

/// Maximum recorded crossings of a wave in a chunk, if the driver has enough outputs. A wave crosses a listener of
/// common size about once in 64 iterations. In one of two hundred chunks it has five crossings or more.
pub(super) const RECORDS: u32 = 4;
