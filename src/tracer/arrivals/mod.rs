//! Arrivals: every crossing of the listener's sphere by every wave, with its energy.
//! [`Tracer::arrivals`](super::Tracer::arrivals) returns them.
//!
//! The listener is transparent here. A pass (`glsl/arrivals/`) traces the waves of a *block* through a
//! *chunk* of iterations and writes a record for each crossing, up to a maximum number for each wave.
//! These outputs are read back and processed here in `f64` while the next chunk is drawn. A wave that
//! crosses more often than there are records is drawn again from the chunk's start, as an entry of a
//! list, and its earlier crossings are skipped. Blending is off: the same input gives the same bits.
//!
//! | file | contents |
//! | --- | --- |
//! | `events.rs` | what reflections leave of a wave's energy |
//! | `settings.rs` | settings, which waves are followed and how they start, counts |
//! | `volume.rs` | the open volume of the listener's sphere |
//! | `targets.rs` | textures, and their read-back |
//! | `replay.rs` | from records to arrivals |
//! | `../tracer/arrival_passes.rs` | the passes |

mod events;
mod replay;
mod settings;
mod targets;
mod volume;

pub(super) use events::EventTable;
pub(super) use replay::{Block, Listed, Replay};
pub use settings::{ArrivalCounts, ArrivalSettings};
pub(crate) use settings::{Followed, Start, WavesToFollow};
pub(super) use targets::{ArrivalTargets, LISTED_AT_MOST, listed_rows};
pub(super) use volume::open_volume;

/// Waves followed at once, through all their chunks: 60 MB of textures, and enough for every core
/// of a large graphics card.
pub(super) const WAVES_IN_BLOCK: u32 = 1 << 18;

/// Iterations in a chunk if loops and records allow it: writing a chunk's results costs about as
/// much as ten iterations in an empty room.
pub(super) const ITERATIONS_IN_CHUNK: u32 = 64;

/// Maximum recorded crossings of a wave in a chunk, if the driver has enough outputs. A wave
/// crosses a listener of common size about once in 64 iterations, and five times or more in one of
/// two hundred chunks.
pub(super) const RECORDS: u32 = 4;
