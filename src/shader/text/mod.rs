//! The shader text of a scene.
//!
//! The text contains only the shapes and operators that occur in the scene. An evaluation is written once per surface
//! if surfaces are unrolled, and once per kind if there are many. There are three texts, for the different needs of the
//! algorithms:
//!
//! - [`distance_parts`]: the signed distance to all objects (the march of `thesis`, pictures);
//! - [`directed_parts`]: the distance to the objects that can be hit ahead, and its gradient;
//! - [`closed_form_parts`]: the intersection of a line with each surface, without a march.

mod closed_form;
mod distance;
pub(super) mod field;
mod fields_ahead;
mod link;
mod reflect;
mod scene_text;
mod surface_names;

pub use closed_form::closed_form_parts;
pub use distance::{directed_parts, distance_parts};
pub(crate) use field::{CheckedGradient, USER_FILE, shown_name, user_sources};
pub(super) use link::library;
#[cfg(glsl_at_run_time)]
pub(crate) use link::read_at_run_time;
pub(crate) use link::source;
pub use link::{Part, Source, file_name, fill, join, link, parts};
pub use scene_text::ListenerText;
pub(crate) use scene_text::Text;
#[doc(hidden)]
pub use surface_names::is_marched;
pub(super) use surface_names::{Marched, Named};
