//! The input of the GPU: shader text, data and program keys, derived from a scene and settings.
//!
//! A scene reaches the GPU only through [`CompiledScene`], which has these parts:
//!
//! | input | output | where |
//! | --- | --- | --- |
//! | the shapes and operators of a scene, and which of their numbers move | layout, assets and key of the text | `structure`, `layout` |
//! | the structure, and the algorithm | the text of a distance, of a march or of closed forms | `text` |
//! | the text of the scene, and settings | the text of a whole pass | `pass_texts`, `arrivals_shader` |
//! | the numbers of a scene, and its listener | uniforms, relative to the listener, with covered faces extended | `origin_rebasing`, `covered_faces` |
//! | height images, many surfaces, materials | the data that shaders read by index, with cells and their lists | `scene_data`, `cells`, `materials` |
//! | the loops of the text, and the lists of cells | iterations of a pass and steps of a march | `turn_budget` |
//!
//! This module does not use OpenGL: [`crate::tracer`] compiles the texts and sends the numbers.
//!
//! Everything that the shader reads relative to the listener is a uniform, because it changes when the listener moves:
//! the positions of surfaces and listener, and also the sizes of basic shapes, which share vectors with the positions
//! and change when covered faces are extended. The numbers of fields are literals, except numbers that are driven. The
//! text therefore depends only on the [`StructureKey`], and moving objects never recompiles a shader.
//!
//! If there are many surfaces, the text contains only their kinds (`layout`). The surfaces are then in cells, and the
//! lists of cells and the values of surfaces are in the scene's data.

mod arrivals_shader;
mod cells;
mod compiled_scene;
mod covered_faces;
mod distinct_materials;
mod layout;
mod materials;
mod mesh_data;
mod origin_rebasing;
mod pass_texts;
mod scene_data;
mod structure;
mod text;
mod turn_budget;

pub(crate) use arrivals_shader::{ArrivalsText, WORD_BITS, arrivals_text};
pub use cells::Lists;
pub(crate) use compiled_scene::CompiledScene;
pub(crate) use distinct_materials::materials_met;
pub use layout::Layout;
pub use materials::Materials;
pub(crate) use materials::{Spread, band_groups, common_scattering, least_scattering};
pub(crate) use origin_rebasing::OriginRebasing;
pub use pass_texts::Directions;
#[cfg(feature = "picture")]
pub(crate) use pass_texts::first_person;
#[cfg(feature = "picture")]
pub(crate) use pass_texts::picture_text;
pub(crate) use pass_texts::{
    AlgorithmText, MarchText, StartOrderText, first_sum_text, further_sum_text, in_order_text,
    initialise_text, march_text, pan_text, whole_frame_text,
};
pub(crate) use scene_data::DATA_WIDTH;
pub use structure::Structure;
pub(crate) use structure::StructureKey;
pub use text::is_marched;
#[cfg(glsl_at_run_time)]
pub(crate) use text::read_at_run_time;
#[cfg(feature = "picture")]
pub(crate) use text::source;
pub(crate) use text::{
    CheckedGradient, Source, USER_FILE, file_name, join, shown_name, user_sources,
};
#[doc(hidden)]
pub use turn_budget::Budget;
pub(crate) use turn_budget::{LoopsAsked, MAX_STEPS};

#[cfg(test)]
mod tests;
