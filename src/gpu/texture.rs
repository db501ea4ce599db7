//! Textures of four 32-bit floats per texel.

use glow::{HasContext, PixelUnpackData};

use super::texture_units::{self, SCRATCH_UNIT};
use super::{Context, GpuError, bytes};

/// A texture of four 32-bit floats per texel (RGBA32F), read without filtering and clamped to its edge.
///
/// Dropping it frees it.
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
    /// A side of zero or above [`max_texture_size`](super::Limits::max_texture_size), or no memory: 16 bytes per texel.
    pub fn new(context: &Context, width: u32, height: u32) -> Result<Texture, GpuError> {
        check_size(context, width, height)?;
        let gl = context.gl();
        // SAFETY: the context is current.
        let texture = unsafe { gl.create_texture() }.map_err(|code| GpuError::Gl {
            what: "a texture".into(),
            code,
        })?;
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
    /// [`GpuError::DataSize`] where the length is not 4 × width × height, and what GL reports.
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
                PixelUnpackData::Slice(Some(bytes::of_floats(texels))),
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
        texture_units::bind(self.context.gl(), unit, glow::TEXTURE_2D, self.texture);
    }
}

impl Drop for Texture {
    fn drop(&mut self) {
        // SAFETY: the context is current, and the texture its own and not used again.
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
