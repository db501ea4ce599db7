//! Lists of vectors that shaders read by index: in a texture buffer in OpenGL, in the rows of a texture in ES 3.0,
//! which has no texture buffers.

use glam::Vec4;
use glow::HasContext;

use super::caller_state::SCRATCH_UNIT;
use super::{Api, Context, GpuError, Program, Texture, texture};

/// A list of vectors: a buffer in OpenGL (`samplerBuffer`), or rows of a texture (`sampler2D`) in ES, which has no
/// texture buffers. Buffers are faster to read because they have neither rows nor levels. The list grows as needed and
/// is uploaded again only after a change.
#[derive(Debug)]
pub struct DataList {
    store: Store,
    values: Vec<Vec4>,
}

#[derive(Debug)]
enum Store {
    Buffer(TexelBuffer),
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
            Api::Gl | Api::OsMesa => Store::Buffer(TexelBuffer::new(context)?),
        };
        let values = Vec::new();
        Ok(DataList { store, values })
    }

    /// Sets the values of the list.
    ///
    /// # Errors
    /// [`GpuError`] if they do not fit.
    pub fn set(&mut self, new: &[Vec4]) -> Result<(), GpuError> {
        if self.values == new {
            return Ok(());
        }
        match &mut self.store {
            Store::Rows(texture) => texture.set(new)?,
            Store::Buffer(buffer) => buffer.set(&floats(new))?,
        }
        new.clone_into(&mut self.values);
        Ok(())
    }

    /// Binds the list to a texture unit and to the program's uniform `name`, if the program has one.
    pub fn bind(&self, program: &Program, name: &str, unit: u32) {
        match &self.store {
            Store::Rows(texture) => program.set_texture(name, unit, texture.texture()),
            Store::Buffer(buffer) if program.has_uniform(name) => {
                buffer.bind(unit);
                program.set_i32(name, unit as i32);
            }
            Store::Buffer(_) => (),
        }
    }
}

/// A list of vectors in rows of equal width, as a float texture. It grows as needed.
#[derive(Debug)]
pub struct DataTexture {
    context: Context,
    width: usize,
    texture: Texture,
}

impl DataTexture {
    /// An empty list in rows of `width` vectors.
    ///
    /// # Errors
    /// [`GpuError`] when the texture cannot be made.
    pub fn new(context: &Context, width: usize) -> Result<DataTexture, GpuError> {
        Ok(DataTexture {
            context: context.clone(),
            width,
            texture: Texture::new(context, width as u32, 1)?,
        })
    }

    /// Sets the values of the texture.
    ///
    /// # Errors
    /// [`GpuError`] if they do not fit.
    pub fn set(&mut self, values: &[Vec4]) -> Result<(), GpuError> {
        let rows = values.len().div_ceil(self.width).max(1);
        if rows > self.texture.height() as usize {
            self.texture = Texture::new(&self.context, self.width as u32, rows as u32)?;
        }
        let texels = 4 * self.width * self.texture.height() as usize;
        let mut floats = floats(values);
        floats.resize(texels, 0.0);
        self.texture.upload(&floats)
    }

    /// The texture to bind.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }
}

/// A buffer of vectors, and the texture through which a `samplerBuffer` reads them.
///
/// Dropping it frees both.
#[derive(Debug)]
struct TexelBuffer {
    context: Context,
    buffer: glow::Buffer,
    texture: glow::Texture,
    /// The driver's limit on the number of vectors.
    limit: usize,
    /// Number of vectors allocated.
    capacity: usize,
}

impl TexelBuffer {
    /// An empty buffer.
    ///
    /// # Errors
    /// GL errors.
    pub fn new(context: &Context) -> Result<TexelBuffer, GpuError> {
        let gl = context.gl();
        let failed = GpuError::not_created("a buffer of texels");
        // SAFETY: the context is current.
        let buffer = unsafe { gl.create_buffer() }.map_err(&failed)?;
        // SAFETY: the context is current; without a texture the buffer is not used again.
        let texture = unsafe {
            gl.create_texture()
                .inspect_err(|_| gl.delete_buffer(buffer))
        };
        let mut made = TexelBuffer {
            context: context.clone(),
            buffer,
            texture: texture.map_err(&failed)?,
            // SAFETY: the context is current.
            limit: unsafe { gl.get_parameter_i32(glow::MAX_TEXTURE_BUFFER_SIZE) } as usize,
            capacity: 0,
        };
        made.set(&[0.0; 4])?;
        made.bind(SCRATCH_UNIT);
        // SAFETY: the context is current and owns the texture and buffer.
        unsafe { gl.tex_buffer(glow::TEXTURE_BUFFER, glow::RGBA32F, Some(buffer)) };
        context.check("a buffer of texels")?;
        Ok(made)
    }

    /// Writes `floats` to the beginning of the buffer, four per vector.
    ///
    /// # Errors
    /// [`GpuError::TextureTooLarge`] above the driver's limit, and GL errors.
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
        let bytes = texture::of_floats(floats);
        // SAFETY: the context is current and owns the buffer.
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
        texture::bind(self.context.gl(), unit, glow::TEXTURE_BUFFER, self.texture);
    }
}

impl Drop for TexelBuffer {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns the texture and buffer, which are not used again.
        self.context.free(|gl| unsafe {
            gl.delete_texture(self.texture);
            gl.delete_buffer(self.buffer);
        });
    }
}

/// The floats of the vectors, in order.
fn floats(values: &[Vec4]) -> Vec<f32> {
    values.iter().flat_map(|v| v.to_array()).collect()
}
