//! Pairs of textures that passes read and write in turn.

use super::pass::Target;
use super::{Context, GpuError, RenderTarget, Texture};

/// Two textures of one size, and the target that writes both: eight floats per element.
#[derive(Debug)]
pub struct TexturePair {
    /// Output 0 of the fragment shader.
    pub first: Texture,
    /// Output 1 of the fragment shader.
    pub second: Texture,
    /// Writes to both, and reads both back: attachments 0 and 1.
    pub target: RenderTarget,
}

impl TexturePair {
    /// Creates a pair of `width` × `height` texels each, with undefined values.
    ///
    /// # Errors
    /// The errors of [`Texture::new`] and [`RenderTarget::new`].
    pub fn new(context: &Context, width: u32, height: u32) -> Result<TexturePair, GpuError> {
        let first = Texture::new(context, width, height)?;
        let second = Texture::new(context, width, height)?;
        let target = RenderTarget::new(context, &[&first, &second])?;
        Ok(TexturePair {
            first,
            second,
            target,
        })
    }
}

impl Target for TexturePair {
    fn framebuffer(&self) -> Option<glow::Framebuffer> {
        self.target.framebuffer()
    }
}

/// Two texture pairs: a pass reads the current one and writes to the next, then they [`flip`](PingPong::flip).
#[derive(Debug)]
pub struct PingPong {
    pairs: [TexturePair; 2],
    current: usize,
}

impl PingPong {
    /// Creates two pairs of `width` × `height` texels: 64 bytes per texel in total.
    ///
    /// # Errors
    /// The errors of [`TexturePair::new`].
    pub fn new(context: &Context, width: u32, height: u32) -> Result<PingPong, GpuError> {
        let pairs = [
            TexturePair::new(context, width, height)?,
            TexturePair::new(context, width, height)?,
        ];
        Ok(PingPong { pairs, current: 0 })
    }

    /// The pair to read from.
    pub fn current(&self) -> &TexturePair {
        &self.pairs[self.current]
    }

    /// The pair to write to.
    pub fn next(&self) -> &TexturePair {
        &self.pairs[1 - self.current]
    }

    /// Makes the pair just written the current one.
    pub fn flip(&mut self) {
        self.current = 1 - self.current;
    }
}
