//! A list of vectors that shaders read by index.

use super::{Context, GpuError, Texture};
use glam::Vec4;

/// A list of vectors in rows of equal width, as a float texture. It grows as needed and is sent again only when it has
/// changed.
#[derive(Debug)]
pub struct DataTexture {
    context: Context,
    width: usize,
    texture: Texture,
    values: Vec<Vec4>,
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
            values: Vec::new(),
        })
    }

    /// Sets the values of the texture.
    ///
    /// # Errors
    /// [`GpuError`] if they do not fit.
    pub fn set(&mut self, values: &[Vec4]) -> Result<(), GpuError> {
        if self.values == values {
            return Ok(());
        }
        let rows = values.len().div_ceil(self.width).max(1);
        if rows > self.texture.height() as usize {
            self.texture = Texture::new(&self.context, self.width as u32, rows as u32)?;
        }
        let texels = 4 * self.width * self.texture.height() as usize;
        let mut floats: Vec<f32> = values.iter().flat_map(|v| v.to_array()).collect();
        floats.resize(texels, 0.0);
        self.texture.upload(&floats)?;
        self.values.clear();
        self.values.extend_from_slice(values);
        Ok(())
    }

    /// The texture to bind.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }
}
