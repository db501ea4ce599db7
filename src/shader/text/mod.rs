//! A scene as shader text.
//!
//! Only the shapes and operators that occur in the scene are in the text: one evaluation per
//! surface if surfaces are unrolled, or one per kind if there are many. There are three texts, by
//! the information that a wave needs:
//!
//! - [`distance_parts`]: the signed distance to all objects (the thesis' march, pictures);
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
