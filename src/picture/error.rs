//! Errors of pictures.

use crate::file_output::OutputError;

/// A picture that cannot be drawn or saved.
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
        /// Requested height, or the one that follows from the bounds, in pixels.
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
    /// A part of the world without area.
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
    /// Whether the request is at fault.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Size { .. } | Self::FieldOfView { .. } | Self::Bounds { .. } => true,
            Self::Encode(_) => false,
            Self::Write(error) => error.is_bad_input(),
        }
    }
}
