//! From a scene and settings to a frame: sphere tracing on the GPU.
//!
//! One frame runs as in figure 6 of the thesis:
//!
//! 1. *initialise*: one texel = one wave, at the source, in its own direction;
//! 2. *march*, once an iteration: every wave to the next object, the two texture
//!    pairs swapping roles;
//! 3. *pan*: what each wave that reached the listener gives to either side;
//! 4. one read-back of that one texture, summed on the CPU to a [`Panning`].
//!
//! The state of a wave never leaves the GPU in between. Departures from the thesis
//! are documented where they are made, in `glsl/`, and together in `docs/thesis.md`.

mod arrivals;
mod error;
mod field_trial;
mod frame;
mod gpu_scene;
mod programs;
mod reload;
mod settings;
mod tracer;
mod user_fields;
mod waves;

#[doc(hidden)]
pub use crate::kernel::Budget;
pub use crate::kernel::Directions;
pub use arrivals::{ArrivalCounts, ArrivalSettings};
pub(crate) use arrivals::{Followed, Start, WavesToFollow};
pub use error::TraceError;
#[cfg(not(target_arch = "wasm32"))]
pub use field_trial::answer_field_trial;
pub use field_trial::{FieldTrial, TrialCommand};
pub use frame::{Counts, Frame, Milliseconds, Panning};
#[cfg(feature = "picture")]
pub(crate) use gpu_scene::GpuScene;
#[doc(hidden)]
pub use programs::{Pass, shader_text};
#[doc(hidden)]
pub use reload::Opening;
pub use reload::{Reload, Reloading};
pub use settings::{
    Algorithm, HybridOptions, MAX_ITERATIONS, MAX_WAVES, MarchOptions, Profile, Settings,
    ThesisOptions,
};
#[doc(hidden)]
pub use settings::{MARCHES_PER_PASS, MarchVariant};
pub use tracer::{FrameTexture, HeardPaths, Tracer};
#[doc(hidden)]
pub use tracer::{HeardSearch, MostKept};
pub(crate) use waves::Grid;
pub use waves::{Fate, Wave};
#[cfg(test)]
pub(crate) use waves::{STATUS_DEAD, STATUS_LISTENER, STATUS_STARTED};

#[cfg(test)]
mod tests;
