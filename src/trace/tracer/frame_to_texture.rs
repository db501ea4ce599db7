//! Frames whose result stays on the GPU.

use super::super::{Settings, TraceError};
use super::{Tracer, Waves};
use crate::error::Error;
use crate::gpu::glow;
use crate::scene::Scene;

/// The contribution of each wave of a frame to either ear, as a texture: for drawing with the tracer's context, which
/// [`Context::from_glow`](crate::gpu::Context::from_glow) makes one of the caller's own.
///
/// Wave number n is the texel (n mod `width`, n / `width`), of four floats: shares to the left and to the right, which are 0
/// for a wave that is not heard, else 1 together; two more that this crate alone uses. Texels beyond the last wave
/// are to be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameTexture {
    /// GL's name for the texture: `TEXTURE_2D` of `RGBA32F`, with one level, not filtered, clamped to its edge. The tracer
    /// owns it and draws to it: it holds this frame until the next call of the tracer, and goes with it at the latest.
    pub texture: glow::Texture,
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Waves.
    pub waves: u32,
}

impl Tracer {
    /// Traces one frame as [`Tracer::frame`] does, and leaves its result where it is: nothing is read back. On a graphics
    /// card nothing is waited for.
    ///
    /// ```
    /// use echomarch::gpu::Context;
    /// use echomarch::{Scene, Settings, Tracer};
    ///
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let settings = Settings::default().with_waves(4096);
    /// let result = tracer.frame_to_texture(&Scene::builtin("corner")?, &settings)?;
    /// assert_eq!(result.width * result.height, result.waves);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_to_texture(
        &mut self,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<FrameTexture, Error> {
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            tracer.begin(scene, settings, Waves::Dropped)?;
            let drawn = tracer.draw_to_its_end();
            tracer.give_up();
            drawn?;
            let targets = tracer.targets()?;
            Ok(FrameTexture {
                texture: targets.contributions.raw(),
                width: targets.grid.width,
                height: targets.grid.height,
                waves: targets.grid.waves,
            })
        })
    }

    /// All passes of the frame begun, without asking for its result.
    fn draw_to_its_end(&mut self) -> Result<(), Error> {
        let mut frame = self.under_way.take().ok_or(TraceError::NothingTraced)?;
        self.march_for(&mut frame, f64::INFINITY)?;
        self.pan(&frame.prepared)?;
        self.under_way = Some(frame);
        Ok(())
    }
}
