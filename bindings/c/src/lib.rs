//! The C interface of [`echomarch::simulator`].
//!
//! Handles are pointers to boxes that C cannot look into. Every function takes null, and numbers that are not finite,
//! and returns an [`EchomarchStatus`]. A panic does not cross the boundary: [`call::guard`] is the only way in. The
//! functions of audio callbacks, [`echomarch_mix_process`] and [`echomarch_ears_process`], neither allocate, free nor
//! lock, so they leave no text of an error.

mod call;
mod handle;
mod objects;
mod results;
mod sound;
#[cfg(test)]
mod tests;
mod values;

pub use call::{EchomarchStatus, echomarch_status_text};
pub use handle::{
    EchomarchSettings, EchomarchSimulator, echomarch_default_settings, echomarch_simulator_error,
    echomarch_simulator_free, echomarch_simulator_new, echomarch_simulator_renderer,
};
pub use objects::{
    echomarch_add_scene, echomarch_add_source, echomarch_add_surface, echomarch_enable_source,
    echomarch_enable_surface, echomarch_place_listener, echomarch_place_source,
    echomarch_place_surface, echomarch_remove_source, echomarch_remove_surface,
    echomarch_set_material, echomarch_set_source, echomarch_set_surface, echomarch_turn_head,
};
pub use results::{
    EchomarchEcho, EchomarchState, EchomarchUpdate, echomarch_commit, echomarch_state,
    echomarch_update, echomarch_would_compile,
};
pub use sound::{
    EchomarchEars, EchomarchFill, EchomarchFormat, EchomarchMix, echomarch_default_format,
    echomarch_ears_free, echomarch_ears_new, echomarch_ears_process, echomarch_mix_free,
    echomarch_mix_new, echomarch_mix_process,
};
pub use values::{ECHOMARCH_BANDS, ECHOMARCH_NO_ID, EchomarchPose};
