//! Textures of four 32-bit floats per texel, the units that they are bound to, and the bytes that GL takes and returns.

use std::borrow::Cow;

use glow::{HasContext, PixelUnpackData};

use super::caller_state::{SCRATCH_UNIT, UNITS};
use super::{Context, GpuError};

/// A texture of four 32-bit floats per texel (RGBA32F), read without filtering and clamped to its edge.
///
/// Dropping the texture frees it.
#[derive(Debug)]
pub struct Texture {
    context: Context,
    texture: glow::Texture,
    width: u32,
    height: u32,
}

impl Texture {
    /// Creates a texture of `width` × `height` texels with undefined values.
    ///
    /// # Errors
    /// A side of zero or above [`max_texture_size`](super::Limits::max_texture_size), or too little memory for 16 bytes
    /// per texel.
    pub fn new(context: &Context, width: u32, height: u32) -> Result<Texture, GpuError> {
        check_size(context, width, height)?;
        let gl = context.gl();
        // SAFETY: the context is current.
        let texture = unsafe { gl.create_texture() }.map_err(GpuError::not_created("a texture"))?;
        let texture = Texture {
            context: context.clone(),
            texture,
            width,
            height,
        };
        texture.bind(SCRATCH_UNIT);
        // SAFETY: the context is current, and no data are given.
        unsafe {
            for (name, value) in [
                (glow::TEXTURE_MIN_FILTER, glow::NEAREST),
                (glow::TEXTURE_MAG_FILTER, glow::NEAREST),
                (glow::TEXTURE_WRAP_S, glow::CLAMP_TO_EDGE),
                (glow::TEXTURE_WRAP_T, glow::CLAMP_TO_EDGE),
                (glow::TEXTURE_MAX_LEVEL, 0),
            ] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, value as i32);
            }
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                glow::RGBA32F as i32,
                width as i32,
                height as i32,
                0,
                glow::RGBA,
                glow::FLOAT,
                PixelUnpackData::Slice(None),
            );
        }
        context.check(&format!("a texture of {width} × {height} texels"))?;
        Ok(texture)
    }

    /// Fills the whole texture, bit for bit: four floats per texel, row by row, texel (0, 0) first.
    ///
    /// # Errors
    /// [`GpuError::DataSize`] if the length is not 4 × width × height, and GL errors.
    pub fn upload(&self, texels: &[f32]) -> Result<(), GpuError> {
        let expected = 4 * self.width as usize * self.height as usize;
        if texels.len() != expected {
            return Err(GpuError::DataSize {
                expected,
                found: texels.len(),
            });
        }
        self.bind(SCRATCH_UNIT);
        // SAFETY: the context is current, and the data have the size of the texture.
        unsafe {
            self.context.gl().tex_sub_image_2d(
                glow::TEXTURE_2D,
                0,
                0,
                0,
                self.width as i32,
                self.height as i32,
                glow::RGBA,
                glow::FLOAT,
                PixelUnpackData::Slice(Some(of_floats(texels))),
            );
        }
        self.context.check("the upload of a texture")
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// GL's name for the texture.
    pub(crate) fn raw(&self) -> glow::Texture {
        self.texture
    }

    /// Binds the texture to a unit.
    pub(super) fn bind(&self, unit: u32) {
        bind(self.context.gl(), unit, glow::TEXTURE_2D, self.texture);
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns the texture, which is not used again.
        self.context
            .free(|gl| unsafe { gl.delete_texture(self.texture) });
    }
}

/// Checks that the driver allows a texture or a picture of that size.
pub(super) fn check_size(context: &Context, width: u32, height: u32) -> Result<(), GpuError> {
    let limit = context.limits().max_texture_size;
    if width == 0 || height == 0 {
        Err(GpuError::TextureEmpty { width, height })
    } else if width > limit || height > limit {
        Err(GpuError::TextureTooLarge {
            width,
            height,
            limit,
        })
    } else {
        Ok(())
    }
}

/// Binds a texture of the context to a unit.
pub(super) fn bind(gl: &glow::Context, unit: u32, target: u32, texture: glow::Texture) {
    debug_assert!(
        UNITS.contains(&unit),
        "texture unit {unit} of a caller is not restored"
    );
    // SAFETY: the context is current; the texture belongs to it and has that target.
    unsafe {
        gl.active_texture(glow::TEXTURE0 + unit);
        gl.bind_texture(target, Some(texture));
    }
}

/// Returns the floats as bytes in memory order.
pub(super) fn of_floats(floats: &[f32]) -> &[u8] {
    // SAFETY: f32 has no padding, u8 needs no alignment, and the length in bytes is that of the same slice.
    unsafe { std::slice::from_raw_parts(floats.as_ptr().cast(), size_of_val(floats)) }
}

/// Returns the floats as mutable bytes.
pub(super) fn of_floats_mut(floats: &mut [f32]) -> &mut [u8] {
    // SAFETY: as above; in addition, every bit pattern is a valid f32, so any bytes may be written.
    unsafe { std::slice::from_raw_parts_mut(floats.as_mut_ptr().cast(), size_of_val(floats)) }
}

/// Returns bytes in memory order as floats, without an incomplete float at the end. Copies the bytes if they are not
/// aligned for floats.
pub(super) fn as_floats(bytes: &[u8]) -> Cow<'_, [f32]> {
    // SAFETY: every bit pattern is a valid f32.
    match unsafe { bytes.align_to::<f32>() } {
        ([], floats, _) => Cow::Borrowed(floats),
        _ => bytes
            .as_chunks()
            .0
            .iter()
            .map(|four| f32::from_ne_bytes(*four))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects read-backs with drivers that map a buffer at any address.
    #[test]
    fn bytes_at_any_address_are_the_same_floats() {
        let floats = [1.5_f32, -2.0, 1e30];
        let aligned = as_floats(of_floats(&floats));
        assert!(matches!(aligned, Cow::Borrowed(_)));
        let mut shifted = [0; 16];
        let start = usize::from(shifted.as_ptr().addr() % 4 == 0);
        shifted[start..start + 12].copy_from_slice(of_floats(&floats));
        let unaligned = as_floats(&shifted[start..start + 12]);
        assert!(matches!(unaligned, Cow::Owned(_)));
        assert_eq!((&aligned[..], &unaligned[..]), (&floats[..], &floats[..]));
    }
}
