//! Textures that a pass writes to, and reading them back.

use glow::{HasContext, PixelPackData};

use super::pass::Target;
use super::{Context, GpuError, Texture, bytes};

/// A framebuffer over one or more textures of one size (every driver allows four): output 0 of the fragment shader goes
/// to the first texture, and so on.
///
/// It does not own the textures; keep them as long as it is used. Dropping it frees the framebuffer.
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
        let framebuffer = unsafe { gl.create_framebuffer() }.map_err(|code| GpuError::Gl {
            what: "a framebuffer".into(),
            code,
        })?;
        let target = RenderTarget {
            context: context.clone(),
            framebuffer,
            attachments: textures.len(),
            width,
            height,
        };
        let points: Vec<u32> = (glow::COLOR_ATTACHMENT0..).take(textures.len()).collect();
        // SAFETY: the context is current, and framebuffer and textures its own.
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

    /// All texels of one attachment, bit for bit: four floats per texel, row by row, texel (0, 0) first. Waits for the
    /// drawing before it.
    ///
    /// # Errors
    /// [`GpuError::ReadOutOfRange`], and what GL reports.
    pub fn read(&self, attachment: usize) -> Result<Vec<f32>, GpuError> {
        let mut texels = Vec::new();
        self.read_into(attachment, self.width, self.height, &mut texels)?;
        Ok(texels)
    }

    /// Reads the first `width` texels of each of the first `rows` rows, as [`read`](RenderTarget::read) does; the
    /// vector is resized to 4 × width × rows and its memory reused. After an error its values are meaningless.
    ///
    /// # Errors
    /// [`GpuError::ReadOutOfRange`], and what GL reports.
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
            let slice = PixelPackData::Slice(Some(bytes::of_floats_mut(texels)));
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
        self.context.check("the read-back of a texture")
    }

    /// Selects the attachment for reading, if it has enough texels.
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
        // SAFETY: the context is current, and the framebuffer its own.
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
        // SAFETY: the context is current, and the framebuffer its own and not used again.
        self.context
            .free(|gl| unsafe { gl.delete_framebuffer(self.framebuffer) });
    }
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
        // No status: an error, or no context.
        0 => {
            context.check("a framebuffer")?;
            "GL gives no status".into()
        }
        other => format!("status 0x{other:04X}"),
    };
    Err(GpuError::IncompleteFramebuffer { reason })
}
