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
mod directions;
mod error;
mod field_trial;
mod frame;
mod gpu_sum;
mod heard_search;
mod loop_budget;
mod panning;
mod programs;
mod reload;
mod renderer_limits;
mod scene_data;
mod scene_program;
mod settings;
mod tracer;
mod user_fields;
mod waves;

pub use crate::kernel::Directions;
pub use arrivals::{ArrivalCounts, ArrivalSettings};
pub(crate) use arrivals::{Followed, Start, WavesToFollow};
pub use error::TraceError;
#[cfg(not(target_arch = "wasm32"))]
pub use field_trial::answer_field_trial;
pub use field_trial::{FieldTrial, TrialCommand};
pub use frame::{Frame, Milliseconds};
#[doc(hidden)]
pub use heard_search::{HeardSearch, MostKept};
#[doc(hidden)]
pub use loop_budget::Budget;
pub use panning::{Counts, Panning};
#[doc(hidden)]
pub use programs::{Pass, shader_text};
#[doc(hidden)]
pub use reload::Opening;
pub use reload::{Reload, Reloading};
#[cfg(feature = "picture")]
#[doc(hidden)]
pub use renderer_limits::check_surfaces;
#[cfg(feature = "picture")]
#[doc(hidden)]
pub use scene_data::SceneData;
#[cfg(feature = "picture")]
#[doc(hidden)]
pub use scene_program::compile as compile_with_scene;
pub use settings::{
    Algorithm, HybridOptions, MAX_ITERATIONS, MAX_WAVES, MarchOptions, Profile, Settings,
    ThesisOptions,
};
#[doc(hidden)]
pub use settings::{MARCHES_PER_PASS, MarchVariant};
pub(crate) use settings::{MAX_COPY_STEPS, MAX_FIELD_STEPS, MAX_STEPS};
pub use tracer::{FrameTexture, HeardPaths, Tracer};
#[cfg(feature = "picture")]
#[doc(hidden)]
pub use user_fields::UserFields;
pub(crate) use waves::Grid;
pub use waves::{Fate, Wave};
#[cfg(test)]
pub(crate) use waves::{STATUS_DEAD, STATUS_LISTENER, STATUS_STARTED};

#[cfg(test)]
mod tests;
