//! A scene as shader text.
//!
//! Only the shapes and operators that occur in the scene are in the text: one evaluation a
//! surface, unrolled, or for many surfaces one a kind. Three texts can be had, by what a wave
//! needs to know:
//!
//! - [`distance_parts`]: the signed distance to everything (the thesis' march, pictures);
//! - [`directed_parts`]: the distance to what can be met ahead, and its gradient;
//! - [`closed_form_parts`]: where a line intersects each surface, without a march.

mod closed_form;
mod directed;
mod distance;
pub(super) mod field;
pub(super) mod fields_ahead;
mod library;
mod link;
mod listener;
mod materials;
mod over_kinds;
mod records;
mod reflect;
pub(super) mod scene_text;
mod shader_source;
pub(super) mod surface_names;
mod user;

pub use closed_form::closed_form_parts;
pub use directed::directed_parts;
pub use distance::distance_parts;
pub(crate) use field::shown_name;
pub(in crate::kernel) use library::library;
pub use link::{Part, link, parts};
pub use listener::ListenerText;
pub use materials::materials_parts;
#[cfg(glsl_at_run_time)]
pub(crate) use shader_source::read_at_run_time;
pub(crate) use shader_source::source;
pub use shader_source::{Source, file_name, join};
pub(crate) use user::{USER_FILE, user_sources};
