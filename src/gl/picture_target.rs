//! A render target with eight bits per channel, for pictures.

use glow::HasContext;

use super::render_target::{Target, check_complete, read_rgba8};
use super::texture::check_size;
use super::{Context, GpuError};

/// A render target of red, green, blue and opacity with eight bits each, for pictures.
///
/// Dropping the picture frees it.
#[derive(Debug)]
pub struct Picture {
    context: Context,
    framebuffer: glow::Framebuffer,
    pixels: glow::Renderbuffer,
    width: u32,
    height: u32,
}

impl Picture {
    /// Creates a picture of `width` × `height` pixels with undefined colours.
    ///
    /// # Errors
    /// The errors of [`Texture::new`](super::Texture::new). Takes 4 bytes per pixel.
    pub fn new(context: &Context, width: u32, height: u32) -> Result<Picture, GpuError> {
        check_size(context, width, height)?;
        let failed = GpuError::not_created("a picture");
        let gl = context.gl();
        // SAFETY: the context is current.
        let framebuffer = unsafe { gl.create_framebuffer() }.map_err(&failed)?;
        // SAFETY: the context is current; the framebuffer is deleted if its renderbuffer cannot be created.
        let pixels = unsafe {
            gl.create_renderbuffer()
                .inspect_err(|_| gl.delete_framebuffer(framebuffer))
                .map_err(&failed)?
        };
        let picture = Picture {
            context: context.clone(),
            framebuffer,
            pixels,
            width,
            height,
        };
        // SAFETY: the context is current; framebuffer and renderbuffer belong to it.
        unsafe {
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(pixels));
            gl.renderbuffer_storage(glow::RENDERBUFFER, glow::RGBA8, width as i32, height as i32);
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            let point = glow::COLOR_ATTACHMENT0;
            gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, point, glow::RENDERBUFFER, Some(pixels));
        }
        context.check(&format!("a picture of {width} × {height} pixels"))?;
        check_complete(context)?;
        Ok(picture)
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Draws the picture over the whole window or canvas of the given size in pixels, stretched with smooth edges.
    ///
    /// # Errors
    /// GL errors, in debug builds.
    pub fn show(&self, width: u32, height: u32) -> Result<(), GpuError> {
        let gl = self.context.gl();
        // SAFETY: the context is current and owns the framebuffer.
        unsafe {
            gl.disable(glow::SCISSOR_TEST);
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(self.framebuffer));
            gl.read_buffer(glow::COLOR_ATTACHMENT0);
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, None);
            gl.blit_framebuffer(
                0,
                0,
                self.width as i32,
                self.height as i32,
                0,
                0,
                width as i32,
                height as i32,
                glow::COLOR_BUFFER_BIT,
                glow::LINEAR,
            );
            // Leaves no framebuffer of this crate bound for reading.
            gl.bind_framebuffer(glow::FRAMEBUFFER, None);
        }
        self.context.debug_check("the picture in the window")
    }

    /// Reads all pixels, four bytes each, the top row (the highest `gl_FragCoord.y`) first, as in image files. Waits
    /// for earlier drawing.
    ///
    /// # Errors
    /// GL errors.
    pub fn read_rgba8(&self) -> Result<Vec<u8>, GpuError> {
        let framebuffer = Some(self.framebuffer);
        read_rgba8(
            &self.context,
            framebuffer,
            self.width,
            self.height,
            "a picture",
        )
    }
}

impl Target for Picture {
    fn framebuffer(&self) -> Option<glow::Framebuffer> {
        Some(self.framebuffer)
    }
}

impl Drop for Picture {
    fn drop(&mut self) {
        // SAFETY: the context is current and owns both objects, which are not used again.
        self.context.free(|gl| unsafe {
            gl.delete_framebuffer(self.framebuffer);
            gl.delete_renderbuffer(self.pixels);
        });
    }
}
