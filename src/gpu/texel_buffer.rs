//! A list of vectors in a buffer, for OpenGL; ES 3.0 has no texture buffers.

use super::texture_units::{self, SCRATCH_UNIT};
use super::{Context, GpuError, bytes};
use glam::Vec4;
use glow::HasContext;

/// A buffer of vectors, and the texture through which a `samplerBuffer` reads them.
///
/// Dropping it frees both.
#[derive(Debug)]
pub(super) struct TexelBuffer {
    context: Context,
    buffer: glow::Buffer,
    texture: glow::Texture,
    /// Maximum vectors that the driver allows.
    limit: usize,
    /// Vectors allocated.
    capacity: usize,
}

impl TexelBuffer {
    /// An empty buffer.
    ///
    /// # Errors
    /// What GL reports.
    pub fn new(context: &Context) -> Result<TexelBuffer, GpuError> {
        let gl = context.gl();
        let failed = |code| GpuError::Gl {
            what: "a buffer of texels".into(),
            code,
        };
        // SAFETY: the context is current.
        let buffer = unsafe { gl.create_buffer() }.map_err(failed)?;
        // SAFETY: the context is current; without a texture the buffer is not used again.
        let texture = unsafe {
            gl.create_texture()
                .inspect_err(|_| gl.delete_buffer(buffer))
        };
        let mut made = TexelBuffer {
            context: context.clone(),
            buffer,
            texture: texture.map_err(failed)?,
            // SAFETY: the context is current.
            limit: unsafe { gl.get_parameter_i32(glow::MAX_TEXTURE_BUFFER_SIZE) } as usize,
            capacity: 0,
        };
        made.set(&[0.0; 4])?;
        made.bind(SCRATCH_UNIT);
        // SAFETY: the context is current, and texture and buffer are its own.
        unsafe { gl.tex_buffer(glow::TEXTURE_BUFFER, glow::RGBA32F, Some(buffer)) };
        context.check("a buffer of texels")?;
        Ok(made)
    }

    /// Writes these floats to the beginning of the buffer, four per vector.
    ///
    /// # Errors
    /// [`GpuError::TextureTooLarge`] above the driver's limit, and what GL reports.
    pub fn set(&mut self, floats: &[f32]) -> Result<(), GpuError> {
        let vectors = floats.len() / 4;
        if vectors > self.limit {
            return Err(GpuError::TextureTooLarge {
                width: vectors as u32,
                height: 1,
                limit: self.limit as u32,
            });
        }
        let gl = self.context.gl();
        let bytes = bytes::of_floats(floats);
        // SAFETY: the context is current, and the buffer its own.
        unsafe {
            gl.bind_buffer(glow::TEXTURE_BUFFER, Some(self.buffer));
            match vectors > self.capacity {
                true => gl.buffer_data_u8_slice(glow::TEXTURE_BUFFER, bytes, glow::DYNAMIC_DRAW),
                false => gl.buffer_sub_data_u8_slice(glow::TEXTURE_BUFFER, 0, bytes),
            }
            gl.bind_buffer(glow::TEXTURE_BUFFER, None);
        }
        self.capacity = self.capacity.max(vectors);
        self.context.check("the upload of a buffer of texels")
    }

    /// Binds the texture to a unit.
    pub fn bind(&self, unit: u32) {
        texture_units::bind(self.context.gl(), unit, glow::TEXTURE_BUFFER, self.texture);
    }
}

impl Drop for TexelBuffer {
    fn drop(&mut self) {
        // SAFETY: the context is current; texture and buffer are its own and not used again.
        self.context.free(|gl| unsafe {
            gl.delete_texture(self.texture);
            gl.delete_buffer(self.buffer);
        });
    }
}

/// The floats of the vectors, in order.
pub(super) fn floats(values: &[Vec4]) -> Vec<f32> {
    values.iter().flat_map(|v| v.to_array()).collect()
}
