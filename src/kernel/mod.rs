//! What the GPU receives: from a scene and settings to shader text, data and key.
//!
//! | it takes | it gives | where |
//! | --- | --- | --- |
//! | the structure of a scene: shapes, operators, what moves | the text of a distance, of a march or of closed forms | `text` |
//! | and the algorithm | the text of a whole pass, and the key of its program | `passes`, `structure`, `program_key` |
//! | the numbers of a scene, and its listener | uniforms, relative to the listener, with covered faces extended | `origin_rebasing`, `surface_values`, `covered_faces` |
//! | height images, and many surfaces | the data that shaders read by index, with cells and their lists | `data`, `cells`, `layout` |
//! | | turns of the loops in the text | `loop_turns` |
//!
//! It knows no OpenGL: [`crate::trace`] compiles the texts and sends the numbers.
//!
//! What the shader reads relative to the listener is a uniform, for it changes with every step
//! of the listener: where surfaces and the listener are, and, for they lie in the same vectors
//! and are extended into each other, the sizes of basic shapes. The numbers of fields are
//! literals, but for those that a driver moves. So the text depends on the [`Structure`] alone,
//! and moving things never compiles a shader again.
//!
//! Of many surfaces only their kinds are in the text (`layout`): they lie in cells, whose
//! lists, like the surfaces' values, are in the scene's data.

mod arrivals_shader;
mod assets;
mod band_groups;
mod cell_record;
mod cells;
mod covered_faces;
mod data;
mod layout;
mod loop_turns;
mod materials;
mod origin_rebasing;
mod passes;
mod program_key;
mod signature;
mod size_check;
mod structure;
mod surface_values;
mod text;

pub(crate) use arrivals_shader::{ArrivalsText, WORD_BITS, arrivals_text, material_values};
pub(crate) use band_groups::band_groups;
pub use cells::Lists;
pub(crate) use cells::SceneCells;
pub(crate) use data::{CellData, DATA_WIDTH, scene_data};
pub use layout::Layout;
pub(crate) use loop_turns::{Loops, loops};
pub use materials::Materials;
pub(crate) use origin_rebasing::{OriginRebasing, RebasedScene};
pub use passes::Directions;
#[cfg(feature = "picture")]
pub(crate) use passes::first_person;
pub use passes::is_marched;
pub(crate) use passes::{
    AlgorithmText, MarchText, first_sum_text, further_sum_text, initialise_text, march_text,
    marches_fields, pan_text, whole_frame_text,
};
pub(crate) use program_key::Key;
pub(crate) use size_check::check;
pub use structure::{Structure, structure};
pub(crate) use surface_values::uniform_count;
#[cfg(glsl_at_run_time)]
pub(crate) use text::read_at_run_time;
#[cfg(feature = "picture")]
pub(crate) use text::source;
pub(crate) use text::{Source, USER_FILE, file_name, join, shown_name, user_sources};
#[cfg(any(test, feature = "picture"))]
pub(crate) use text::{distance_parts, link};

#[cfg(test)]
mod tests;
