//! Pictures: the listener's view, and the plan of a scene with its waves.
//!
//! [`first_person`] sphere traces the view from the listener's position along its viewing direction. [`slice()`] cuts
//! the scene at a height and shows it from above, x to the right and z downwards, as in figure 10 of the thesis,
//! optionally with the paths of waves. Both are fragment shaders (`glsl/view/`) with the same distance function that
//! the waves march through (`src/shader`), so a picture shows exactly the surfaces that a wave hits. `tiny-skia` draws
//! everything that has no distance function (paths, marks) on top.
//!
//! # Cost
//! Each picture compiles its program and draws once, in bands of rows. A view takes four rays per pixel, each with at
//! most 384 evaluations and two shadow rays of at most 64 evaluations each: one to three seconds for 960 × 540 pixels
//! on Mesa's llvmpipe, milliseconds on a graphics card. A slice takes five evaluations per pixel. Paths take one
//! read-back per iteration.

use crate::file_output::{OutputError, write_inside, write_whole};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::path::Path;

mod labels;
mod map;
mod marks;
mod plan;
mod slice;
mod view;

pub use image::RgbaImage;
#[doc(hidden)]
pub use map::{MapOptions, map};
pub use plan::Bounds;
pub use slice::{Kind, SliceOptions, shader_text, slice};
#[doc(hidden)]
pub use view::{Drawn, SOURCE_SHARE, View, view_text};
pub use view::{ViewOptions, first_person};

/// Error when a picture cannot be drawn or saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// A side is zero, or above the renderer's limit.
    #[error(
        "a picture of {width} × {height} pixels cannot be drawn: each side must be 1 to {limit} on this renderer"
    )]
    Size {
        /// Width requested, in pixels.
        width: u32,
        /// Requested height, or the height computed from the bounds, in pixels.
        height: u32,
        /// Longest side allowed.
        limit: u32,
    },
    /// An impossible field of view for a flat picture.
    #[error("the field of view must be above 0° and below 180°: {degrees}°")]
    FieldOfView {
        /// The given value, in degrees.
        degrees: f32,
    },
    /// A region of the world without area.
    #[error("the bounds of a slice must be finite and have an area: {what}")]
    Bounds {
        /// The given bounds or height.
        what: String,
    },
    /// The pixels could not be encoded as a file.
    #[error("the picture cannot be encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] OutputError),
}

impl PictureError {
    fn size([width, height]: [u32; 2], limit: u32) -> PictureError {
        PictureError::Size {
            width,
            height,
            limit,
        }
    }

    /// Whether the user's request caused the error.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Size { .. } | Self::FieldOfView { .. } | Self::Bounds { .. } => true,
            Self::Encode(_) => false,
            Self::Write(error) => error.is_bad_input(),
        }
    }
}

/// Writes a picture as PNG, atomically.
///
/// # Errors
/// [`PictureError::Encode`], and [`PictureError::Write`] with the path.
pub fn save_png(path: &Path, picture: &RgbaImage) -> Result<(), PictureError> {
    let bytes = png(picture)?;
    write_whole(path, |out| out.write_all(&bytes))?;
    Ok(())
}

/// Like [`save_png`], for a file that the program itself named, in a folder that the user named: a link is rejected.
#[doc(hidden)]
pub fn save_png_inside(path: &Path, picture: &RgbaImage) -> Result<(), PictureError> {
    let bytes = png(picture)?;
    write_inside(path, |out| out.write_all(&bytes))?;
    Ok(())
}

fn png(picture: &RgbaImage) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(
        picture.as_raw(),
        picture.width(),
        picture.height(),
        ExtendedColorType::Rgba8,
    )?;
    Ok(bytes)
}
