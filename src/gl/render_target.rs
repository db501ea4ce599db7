//! Textures that passes write to: single, in pairs and alternating; their read-back; and full-screen passes.

use std::ops::Range;

use glow::{HasContext, PixelPackData};

use super::texture::of_floats_mut;
use super::{Context, GpuError, Program, Texture};

/// A framebuffer that a pass can draw into.
pub trait Target {
    /// GL's name for the framebuffer in the context that draws the pass; `None` is the window's framebuffer.
    fn framebuffer(&self) -> Option<glow::Framebuffer>;
}

/// Runs the program once for each texel of the lower left `width` × `height` texels of the target, where
/// `gl_FragCoord.xy` is the texel's index plus a half. Uses the uniforms and textures set last. Returns before the
/// drawing is done.
///
/// The program must not read a texture that the target writes to.
///
/// # Errors
/// GL errors, in debug builds: see `Context::debug_check`.
pub fn full_screen_pass(
    context: &Context,
    program: &Program,
    target: &impl Target,
    width: u32,
    height: u32,
) -> Result<(), GpuError> {
    prepare(context, program, target, width, height);
    draw(context, program)
}

/// Like [`full_screen_pass`], for a band of rows, so that a large pass can be drawn in parts: the system may stop a
/// single draw call that takes a graphics card several seconds. Rows from `height` on are left out.
///
/// # Errors
/// GL errors, in debug builds: see `Context::debug_check`.
pub fn full_screen_pass_rows(
    context: &Context,
    program: &Program,
    target: &impl Target,
    width: u32,
    height: u32,
    rows: Range<u32>,
) -> Result<(), GpuError> {
    let end = rows.end.min(height);
    if rows.start >= end {
        return Ok(());
    }
    prepare(context, program, target, width, height);
    context.set_scissor(0, rows.start, width, end - rows.start);
    context.set_scissor_test(true);
    let drawn = draw(context, program);
    context.set_scissor_test(false);
    // SAFETY: the context is current. The flush keeps a driver from submitting several bands as one batch.
    unsafe { context.gl().flush() };
    drawn
}

/// Sets all the state that a pass depends on, regardless of earlier drawing.
fn prepare(context: &Context, program: &Program, target: &impl Target, width: u32, height: u32) {
    debug_assert!(
        context.is_same(program.context()),
        "program \"{}\" belongs to another context",
        program.label()
    );
    context.set_viewport(width, height);
    context.set_scissor_test(false);
    let gl = context.gl();
    // SAFETY: the context is current and owns program, framebuffer and vertex array.
    unsafe {
        gl.bind_framebuffer(glow::FRAMEBUFFER, target.framebuffer());
        for test in [
            glow::DEPTH_TEST,
            glow::STENCIL_TEST,
            glow::BLEND,
            glow::DITHER,
            glow::CULL_FACE,
        ] {
            gl.disable(test);
        }
        gl.color_mask(true, true, true, true);
        gl.bind_vertex_array(Some(context.vertex_array()));
        gl.use_program(Some(program.raw()));
    }
}

fn draw(context: &Context, program: &Program) -> Result<(), GpuError> {
    // SAFETY: the context is current; the vertex shader reads no attribute.
    unsafe { context.gl().draw_arrays(glow::TRIANGLES, 0, 3) };
    context.debug_check(program.label())
}

/// A framebuffer over one or more textures of one size (every driver allows four): output 0 of the fragment shader goes
/// to the first texture, and so on.
///
/// The target does not own the textures; keep them as long as the target is used. Dropping the target frees the
/// framebuffer.
#[derive(Debug)]
pub struct RenderTarget {
    context: Context,
    framebuffer: glow::Framebuffer,
    attachments: usize,
    width: u32,
    height: u32,
}

impl RenderTarget {
    /// Creates a target over these textures.
    ///
    /// # Errors
    /// [`GpuError::IncompleteFramebuffer`] if there are none, their sizes differ, or the driver cannot draw into them
    /// or into this number of textures.
    pub fn new(context: &Context, textures: &[&Texture]) -> Result<RenderTarget, GpuError> {
        let incomplete = |reason: String| GpuError::IncompleteFramebuffer { reason };
        let size = |texture: &Texture| (texture.width(), texture.height());
        let (width, height) = textures
            .first()
            .map(|first| size(first))
            .unwrap_or_default();
        let at_most = context.limits().most_outputs() as usize;
        if textures.is_empty() || textures.len() > at_most {
            return Err(incomplete(format!(
                "{} textures, not 1 to {at_most}",
                textures.len()
            )));
        }
        if textures
            .iter()
            .any(|texture| size(texture) != (width, height))
        {
            return Err(incomplete("its textures differ in size".into()));
        }
        let gl = context.gl();
        // SAFETY: the context is current.
        let framebuffer =
            unsafe { gl.create_framebuffer() }.map_err(GpuError::not_created("a framebuffer"))?;
        let target = RenderTarget {
            context: context.clone(),
            framebuffer,
            attachments: textures.len(),
            width,
            height,
        };
        let points: Vec<u32> = (glow::COLOR_ATTACHMENT0..).take(textures.len()).collect();
        // SAFETY: the context is current and owns the framebuffer and textures.
        unsafe {
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            for (point, texture) in points.iter().zip(textures) {
                gl.framebuffer_texture_2d(
                    glow::FRAMEBUFFER,
                    *point,
                    glow::TEXTURE_2D,
                    Some(texture.raw()),
                    0,
                );
            }
            gl.draw_buffers(&points);
        }
        check_complete(context)?;
        context.check("a framebuffer")?;
        Ok(target)
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Reads all texels of one attachment, bit for bit: four floats per texel, row by row, texel (0, 0) first. Waits
    /// for earlier drawing.
    ///
    /// # Errors
    /// [`GpuError::ReadOutOfRange`], and GL errors.
    pub fn read(&self, attachment: usize) -> Result<Vec<f32>, GpuError> {
        let mut texels = Vec::new();
        self.read_into(attachment, self.width, self.height, &mut texels)?;
        Ok(texels)
    }

    /// Reads the first `width` texels of each of the first `rows` rows, as [`read`](RenderTarget::read) does; `texels`
    /// is resized to 4 × width × rows and its memory reused. After an error its values are meaningless.
    ///
    /// # Errors
    /// [`GpuError::ReadOutOfRange`], and GL errors.
    pub fn read_into(
        &self,
        attachment: usize,
        width: u32,
        rows: u32,
        texels: &mut Vec<f32>,
    ) -> Result<(), GpuError> {
        self.select_for_reading(attachment, width, rows)?;
        texels.resize(4 * width as usize * rows as usize, 0.0);
        let gl = self.context.gl();
        // SAFETY: the context is current, and the slice has room for exactly the requested texels; rows of 16 bytes per
        // texel need no padding.
        unsafe {
            let slice = PixelPackData::Slice(Some(of_floats_mut(texels)));
            gl.read_pixels(
                0,
                0,
                width as i32,
                rows as i32,
                glow::RGBA,
                glow::FLOAT,
                slice,
            );
        }
        self.context.check_and_wait("the read-back of a texture")
    }

    /// Selects the attachment for reading, after checking that it has enough texels.
    pub(super) fn select_for_reading(
        &self,
        attachment: usize,
        width: u32,
        rows: u32,
    ) -> Result<(), GpuError> {
        if attachment >= self.attachments || width > self.width || rows > self.height {
            return Err(GpuError::ReadOutOfRange {
                attachment,
                width,
                rows,
                attachments: self.attachments,
                target_width: self.width,
                target_height: self.height,
            });
        }
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the framebuffer.
        unsafe {
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffer));
            gl.read_buffer(glow::COLOR_ATTACHMENT0 + attachment as u32);
        }
        Ok(())
    }
}

impl Target for RenderTarget {
    fn framebuffer(&self) -> Option<glow::Framebuffer> {
        Some(self.framebuffer)
    }
}

impl Drop for RenderTarget {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns the framebuffer, which is not used again.
        self.context
            .free(|gl| unsafe { gl.delete_framebuffer(self.framebuffer) });
    }
}

/// Reads the pixels of a framebuffer, or of a window: four bytes each, the top row (the highest `gl_FragCoord.y`)
/// first, as in image files. Waits for earlier drawing.
#[cfg(any(test, feature = "picture", feature = "window"))]
pub(super) fn read_rgba8(
    context: &Context,
    framebuffer: Option<glow::Framebuffer>,
    width: u32,
    height: u32,
    what: &str,
) -> Result<Vec<u8>, GpuError> {
    let row = 4 * width as usize;
    let mut pixels = vec![0; row * height as usize];
    if pixels.is_empty() {
        return Ok(pixels);
    }
    let gl = context.gl();
    let source = match framebuffer {
        Some(_) => glow::COLOR_ATTACHMENT0,
        None => glow::BACK,
    };
    // SAFETY: the context is current, and the slice has room for all pixels; rows of 4 bytes per pixel need no padding.
    unsafe {
        gl.bind_framebuffer(glow::READ_FRAMEBUFFER, framebuffer);
        gl.read_buffer(source);
        let slice = PixelPackData::Slice(Some(&mut pixels));
        let (width, height) = (width as i32, height as i32);
        gl.read_pixels(0, 0, width, height, glow::RGBA, glow::UNSIGNED_BYTE, slice);
    }
    context.check_and_wait(&format!("the read-back of {what}"))?;
    Ok(pixels.rchunks_exact(row).flatten().copied().collect())
}

/// Checks that the bound framebuffer can be drawn into.
pub(super) fn check_complete(context: &Context) -> Result<(), GpuError> {
    // SAFETY: the context is current.
    let status = unsafe { context.gl().check_framebuffer_status(glow::FRAMEBUFFER) };
    let reason = match status {
        glow::FRAMEBUFFER_COMPLETE => return Ok(()),
        glow::FRAMEBUFFER_INCOMPLETE_ATTACHMENT => "GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT".into(),
        glow::FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT => {
            "GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT".into()
        }
        glow::FRAMEBUFFER_UNSUPPORTED => "GL_FRAMEBUFFER_UNSUPPORTED".into(),
        // Zero is not a status: GL reported an error, or no context is current.
        0 => {
            context.check("a framebuffer")?;
            "GL gives no status".into()
        }
        other => format!("status 0x{other:04X}"),
    };
    Err(GpuError::IncompleteFramebuffer { reason })
}

/// Two textures of one size, and the target that writes both: eight floats per element.
#[derive(Debug)]
pub struct TexturePair {
    /// Output 0 of the fragment shader.
    pub first: Texture,
    /// Output 1 of the fragment shader.
    pub second: Texture,
    /// Writes to both textures, and reads them back as attachments 0 and 1.
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

/// Two texture pairs: a pass reads the current pair and writes to the next, then [`flip`](PingPong::flip) exchanges
/// them.
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

    /// Makes the pair written last the current pair.
    pub fn flip(&mut self) {
        self.current = 1 - self.current;
    }
}
