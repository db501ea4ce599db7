//! Pictures: the listener's view, and the plan of a scene with its waves.
//!
//! [`first_person`] sphere traces the view from the listener's position along its gaze direction;
//! [`slice()`] cuts the scene at a height and shows it from above, x to the right and z downwards,
//! as figure 10 of the thesis does, optionally with the paths of waves. Both are fragment shaders
//! (`glsl/view/`) around the same distance function that the waves march through (`src/kernel`), so
//! a picture shows exactly the surfaces that a wave meets. `tiny-skia` draws what has no distance
//! function (paths, marks) on top.
//!
//! # Cost
//! Each picture compiles its program and draws it once, in bands of rows. A view takes four rays
//! per pixel, each with at most 384 evaluations and two shadows of at most 64 each: on Mesa's
//! llvmpipe one to three seconds for 960 × 540 pixels, on a graphics card milliseconds. A slice
//! takes five evaluations per pixel. Paths cost one read-back per iteration.

mod error;
mod font;
mod live_view;
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
#[doc(hidden)]
pub use live_view::{Drawn, View, shader_text as view_text};
#[doc(hidden)]
pub use map::{MapOptions, map};
pub use plan::Bounds;
pub use png::save_png;
#[doc(hidden)]
pub use png::save_png_inside;
pub use shader::{Kind, shader_text};
pub use slice::{SliceOptions, slice};
#[doc(hidden)]
pub use view::SOURCE_SHARE;
pub use view::{ViewOptions, first_person};
