//! What can go wrong with a picture.

use crate::file_output::OutputError;

/// A picture that cannot be made or kept.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// A side is zero, or above what the renderer can draw.
    #[error(
        "a picture of {width} × {height} pixels cannot be drawn: each side must be 1 to {limit} on this renderer"
    )]
    Size {
        /// Width requested, in pixels.
        width: u32,
        /// Height requested, or that follows from the bounds, in pixels.
        height: u32,
        /// The longest side allowed.
        limit: u32,
    },
    /// A field of view that no flat picture has.
    #[error("the field of view must be above 0° and below 180°: {degrees}°")]
    FieldOfView {
        /// The value given, in degrees.
        degrees: f32,
    },
    /// A part of the world that has no area.
    #[error("the bounds of a slice must be finite and have an area: {what}")]
    Bounds {
        /// The bounds or the height given.
        what: String,
    },
    /// The pixels could not be turned into a file's bytes.
    #[error("the picture cannot be encoded: {0}")]
    Encode(#[from] image::ImageError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] OutputError),
}

impl PictureError {
    /// Whether the request is to blame.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Size { .. } | Self::FieldOfView { .. } | Self::Bounds { .. } => true,
            Self::Encode(_) => false,
            Self::Write(error) => error.is_bad_input(),
        }
    }
}
