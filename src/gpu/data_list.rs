//! A long list of vectors that shaders read by index.

use super::texel_buffer::{TexelBuffer, floats};
use super::{Api, Context, DataTexture, GpuError, Program};
use glam::Vec4;

/// A list of vectors: a buffer in OpenGL (`samplerBuffer`); in ES, which has no such buffers, rows of a texture
/// (`sampler2D`). Buffers are faster to read since they have neither rows nor levels. The list grows as needed and is
/// sent again only when it has changed.
#[derive(Debug)]
pub struct DataList {
    store: Store,
}

#[derive(Debug)]
enum Store {
    Buffer {
        buffer: TexelBuffer,
        values: Vec<Vec4>,
    },
    Rows(DataTexture),
}

impl DataList {
    /// Creates an empty list; a list in a texture has rows of `width` vectors.
    ///
    /// # Errors
    /// [`GpuError`] if it cannot be created.
    pub fn new(context: &Context, width: usize) -> Result<DataList, GpuError> {
        let store = match context.api() {
            Api::Gles => Store::Rows(DataTexture::new(context, width)?),
            Api::Gl | Api::OsMesa => Store::Buffer {
                buffer: TexelBuffer::new(context)?,
                values: Vec::new(),
            },
        };
        Ok(DataList { store })
    }

    /// Sets the values of the list.
    ///
    /// # Errors
    /// [`GpuError`] if they do not fit.
    pub fn set(&mut self, new: &[Vec4]) -> Result<(), GpuError> {
        match &mut self.store {
            Store::Rows(texture) => texture.set(new),
            Store::Buffer { values, .. } if values == new => Ok(()),
            Store::Buffer { buffer, values } => {
                buffer.set(&floats(new))?;
                new.clone_into(values);
                Ok(())
            }
        }
    }

    /// Binds the list to a unit and to the program's uniform of that name, if it has one.
    pub fn bind(&self, program: &Program, name: &str, unit: u32) {
        match &self.store {
            Store::Rows(texture) => program.set_texture(name, unit, texture.texture()),
            Store::Buffer { buffer, .. } if program.has_uniform(name) => {
                buffer.bind(unit);
                program.set_i32(name, unit as i32);
            }
            Store::Buffer { .. } => (),
        }
    }
}
