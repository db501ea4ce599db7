//! Pictures: what the listener sees, and the plan of a scene with the waves in it.
//!
//! [`first_person`] sphere traces the view from the listener's place and gaze; [`slice()`]
//! cuts the scene at a height and looks down on it, x to the right and z downwards, as
//! figure 10 of the thesis does, with the paths of waves on request. Both are fragment
//! shaders (`glsl/view/`) around the very distance function that the waves march
//! through (`src/kernel`), so that a picture shows what a wave meets and no
//! model of it; what has no distance (paths, marks) is drawn over it by `tiny-skia`.
//!
//! # Cost
//! Each picture compiles its program and draws it once, in bands of rows. A view takes
//! four rays a pixel, of at most 384 evaluations and two shadows of at most 64 each: on
//! Mesa's llvmpipe one to three seconds for 960 × 540 pixels, on a graphics card
//! milliseconds. A slice takes five evaluations a pixel. Paths cost a read-back for each
//! iteration.

mod error;
mod font;
#[cfg(feature = "experiment")]
mod map;
mod marks;
mod names;
mod path_legend;
mod plan;
mod png;
mod scale_bar;
mod shader;
mod slice;
mod view;
mod wave_paths;

pub use error::PictureError;
pub use image::RgbaImage;
#[cfg(feature = "experiment")]
pub(crate) use map::{MapOptions, map};
pub use plan::Bounds;
pub use png::save_png;
#[cfg(feature = "experiment")]
pub(crate) use png::save_png_inside;
pub use shader::{Kind, shader_text};
pub use slice::{SliceOptions, slice};
#[cfg(feature = "walkthrough")]
pub(crate) use view::SOURCE_SHARE;
pub use view::{ViewOptions, first_person};
