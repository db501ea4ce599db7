//! Pictures as PNG files.

use super::PictureError;
use crate::file_output::write_inside;
use crate::file_output::write_whole;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbaImage};
use std::path::Path;

/// Writes a picture as PNG, atomically.
///
/// # Errors
/// [`PictureError::Encode`], and [`PictureError::Write`] with the path.
pub fn save_png(path: &Path, picture: &RgbaImage) -> Result<(), PictureError> {
    let bytes = png(picture)?;
    write_whole(path, |out| out.write_all(&bytes))?;
    Ok(())
}

/// As [`save_png`], for a file in a folder, named by the program itself: a link is rejected.
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
