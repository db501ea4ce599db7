//! A frame in steps: begin, advance, and poll or wait.
//!
//! *Begin* checks the input and draws the waves at the source. *Advance* traces the waves for about the given time, by
//! drawing the rows of the march passes that fit in this time. After the last pass it draws the panning pass, and
//! requests a copy of the result in a pixel buffer. *Poll* and *wait* read the copy once a fence signals that it is
//! complete, and sum its values.
//!
//! [`Tracer::frame`] runs the three steps in a row. The result is the same, bit for bit, for every division of a frame
//! and for any drawing between the parts.

use super::frame::in_milliseconds;
use super::prepared::PreparedFrame;
use super::read_back::ReadBack;
use super::throughput::Progress;
use super::{Frame, Milliseconds, Settings, TraceError, Tracer, Waves};
use crate::error::Error;
use crate::gl::glow;
use crate::platform::Instant;
use crate::scene::{IntoPair, Pair};

/// A frame that was begun and is not yet collected.
pub(super) struct FrameUnderWay {
    pub prepared: PreparedFrame,
    pub progress: Progress,
    pub read_back: ReadBack,
    /// Milliseconds spent on the request of the result; `None` until all passes are drawn.
    asking: Option<f64>,
}

impl FrameUnderWay {
    /// Whether all passes are drawn, so that only the result is missing.
    pub fn is_drawn(&self) -> bool {
        self.asking.is_some()
    }
}

/// The contribution of each wave of a frame to either ear, in a texture. It can be used for drawing with the tracer's
/// context. This context is the caller's own if it was made by [`Context::from_glow`](crate::gl::Context::from_glow).
///
/// Wave number n is the texel (n mod `width`, n / `width`) of four floats. The first two are the shares to the left and
/// to the right. Their sum is 1 for a heard wave, and both are 0 for any other wave. The other two floats are used only
/// by this crate. Texels beyond the last wave must be ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameTexture {
    /// GL's name of the texture: `TEXTURE_2D` of `RGBA32F`, with one level, unfiltered, clamped to its edge. The tracer
    /// owns the texture and draws to it. The texture holds this frame until the next call of the tracer, and is deleted
    /// with the tracer at the latest.
    pub texture: glow::Texture,
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Number of waves.
    pub waves: u32,
}

/// Frames in steps.
impl Tracer {
    /// Begins a frame of the pair in its current state. [`frame_advance`](Tracer::frame_advance) traces its waves, and
    /// [`frame_poll`](Tracer::frame_poll) or [`frame_wait`](Tracer::frame_wait) returns its result. Other drawing can
    /// take place between these calls. On a graphics card this function does not wait for the card.
    ///
    /// Drops a frame that was begun before and is not yet collected. Any other frame of this tracer drops the new
    /// frame, unless all passes of the new frame are drawn.
    ///
    /// ```
    /// use echomarch::gl::Context;
    /// use echomarch::{Scene, Settings, Tracer};
    ///
    /// # fn main() -> Result<(), echomarch::Error> {
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let mut scene = Scene::builtin("corner")?;
    /// let settings = Settings::default().with_waves(4096);
    /// for _picture in 0..3 {
    ///     if !tracer.is_frame_pending() {
    ///         scene.sources[0].position.x += 0.1;
    ///         tracer.frame_begin(&scene, &settings)?;
    ///     }
    ///     // For 4 ms of each picture.
    ///     tracer.frame_advance(4.0)?;
    ///     if let Some(frame) = tracer.frame_poll()? {
    ///         println!("pan {:.3}", frame.panning.pan());
    ///     }
    /// }
    /// // What is left of the last one, if anything is.
    /// tracer.frame_wait()?;
    /// assert!(!tracer.is_frame_pending());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn frame_begin<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
    ) -> Result<(), Error> {
        let pair = pair.chosen()?;
        let _entered = self.context.enter()?;
        self.begin(pair, settings, Waves::Dropped)
    }

    /// Traces the current frame for about this time in milliseconds, but at least one row of waves. For
    /// [`f64::INFINITY`] there is no time limit. Returns whether all passes of the frame are drawn, so that
    /// [`Tracer::frame_poll`] will return its result.
    ///
    /// # Errors
    /// [`TraceError::NoFrameBegun`] if no frame was begun, or the frame was already collected or dropped;
    /// [`TraceError::BadSetting`] for a time that is negative or not a number; [`Error::Gpu`] if the renderer fails,
    /// which drops the frame.
    pub fn frame_advance(&mut self, milliseconds: f64) -> Result<bool, Error> {
        if milliseconds.is_nan() || milliseconds < 0.0 {
            return Err(Error::from(TraceError::BadSetting {
                what: "time of a frame in milliseconds",
                must: "0 or more".to_owned(),
                value: milliseconds.to_string(),
            }));
        }
        if self.under_way.is_none() {
            return Err(TraceError::NoFrameBegun.into());
        }
        let _entered = self.context.enter()?;
        self.advance(milliseconds)
    }

    /// Returns the current frame if it is complete, and `None` if it is not complete or no frame was begun.
    ///
    /// In its times, `read_back` is the time of the copy and the sum, and `total` the time since the begin of the
    /// frame.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the renderer fails, which drops the frame.
    pub fn frame_poll(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        self.collect(false)
    }

    /// Traces the rest of the current frame, and waits for its result; `None` if no frame was begun.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame_poll`].
    pub fn frame_wait(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        self.advance(f64::INFINITY)?;
        self.collect(true)
    }

    /// Whether a frame was begun and is not yet collected.
    pub fn is_frame_pending(&self) -> bool {
        self.under_way.is_some()
    }

    /// Milliseconds spent on the march of the current frame; `None` if no frame was begun, or if all passes of the
    /// frame are drawn.
    pub fn frame_marching_for(&self) -> Option<f64> {
        let marching = self.under_way.as_ref().filter(|frame| !frame.is_drawn());
        marching.map(|frame| frame.progress.spent())
    }

    /// The share of the current frame's march that is drawn, 0 to 1. [`frame_marching_for`](Tracer::frame_marching_for)
    /// returns its time, but on a graphics card this time does not yet include the rows of the last call. The share is
    /// `None` if the time is.
    #[doc(hidden)]
    pub fn frame_share_marched(&self) -> Option<f64> {
        let marching = self.under_way.as_ref().filter(|frame| !frame.is_drawn());
        marching.map(|frame| frame.progress.share(frame.prepared.grid.height))
    }

    /// Traces one frame as [`Tracer::frame`] does, and leaves its result on the GPU, without a read-back. On a graphics
    /// card this function does not wait for the card.
    ///
    /// ```
    /// use echomarch::gl::Context;
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
    /// The errors of [`Tracer::frame`].
    pub fn frame_to_texture<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
    ) -> Result<FrameTexture, Error> {
        self.frame_to_texture_of(pair.chosen()?, settings)
    }

    fn frame_to_texture_of(
        &mut self,
        pair: Pair,
        settings: &Settings,
    ) -> Result<FrameTexture, Error> {
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            tracer.begin(pair, settings, Waves::Dropped)?;
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

    /// Begins a frame, traces all of it and waits for the result. A frame that was begun before can still be collected
    /// afterwards if all of its passes are drawn.
    pub(super) fn frame_at_once(
        &mut self,
        pair: Pair,
        settings: &Settings,
    ) -> Result<Frame, Error> {
        self.begin(pair, settings, Waves::Dropped)?;
        self.frame_to_its_end()
    }

    /// Traces the rest of the current frame, and returns its result.
    pub(super) fn frame_to_its_end(&mut self) -> Result<Frame, Error> {
        self.advance(f64::INFINITY)?;
        Ok(self.collect(true)?.ok_or(TraceError::NothingTraced)?)
    }

    /// Draws all passes of the current frame, without a request for the result.
    fn draw_to_its_end(&mut self) -> Result<(), Error> {
        let mut frame = self.under_way.take().ok_or(TraceError::NothingTraced)?;
        self.march_for(&mut frame, f64::INFINITY)?;
        self.targets()?.pan(&frame.prepared)?;
        self.under_way = Some(frame);
        Ok(())
    }

    /// Runs a function that traces other frames. A current frame whose passes are all drawn is preserved.
    pub(super) fn aside<T>(
        &mut self,
        what: impl FnOnce(&mut Tracer) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let mut drawn = self.under_way.take_if(|frame| frame.is_drawn());
        if let Some(frame) = &mut drawn {
            frame.progress.spend(self.throughput.take());
        }
        let done = what(self);
        if drawn.is_some() {
            self.give_up();
            self.under_way = drawn;
        }
        done
    }

    pub(super) fn begin(
        &mut self,
        pair: Pair,
        settings: &Settings,
        keep: Waves,
    ) -> Result<(), Error> {
        let prepared = self.prepare(pair, settings, keep)?;
        self.give_up();
        let mut read_back = match self.spare.take() {
            Some(read_back) => read_back,
            None => ReadBack::new(&self.context)?,
        };
        self.throughput
            .select(prepared.programs.march(), prepared.grid);
        read_back.timer.restart()?;
        self.targets()?.initialise(&prepared)?;
        read_back.timer.mark()?;
        let iterations_per_pass = prepared.budget.iterations_per_pass;
        self.under_way = Some(FrameUnderWay {
            progress: Progress::new(&prepared.settings, iterations_per_pass),
            prepared,
            read_back,
            asking: None,
        });
        Ok(())
    }

    /// Drops the current frame unless all of its passes are drawn. The result of a fully drawn frame is in other
    /// textures.
    pub(super) fn give_up_marching(&mut self) {
        if self.frame_marching_for().is_some() {
            self.give_up();
        }
    }

    /// Drops the current frame, but keeps its timer and read-back.
    pub(super) fn give_up(&mut self) {
        if let Some(frame) = self.under_way.take() {
            self.spare = Some(frame.read_back);
        }
    }

    fn advance(&mut self, milliseconds: f64) -> Result<bool, Error> {
        // After an error no frame is current.
        let Some(mut frame) = self.under_way.take() else {
            return Ok(true);
        };
        if !frame.is_drawn() {
            self.march_for(&mut frame, milliseconds)?;
        }
        if !frame.is_drawn() && frame.progress.is_over() {
            self.pan_and_ask(&mut frame)?;
        }
        let is_drawn = frame.is_drawn();
        self.under_way = Some(frame);
        Ok(is_drawn)
    }

    /// Draws rows of waves, at least one row, until the time in milliseconds is used up or all passes are drawn.
    pub(super) fn march_for(
        &mut self,
        frame: &mut FrameUnderWay,
        milliseconds: f64,
    ) -> Result<(), Error> {
        let FrameUnderWay {
            prepared, progress, ..
        } = frame;
        // Other tracers that share the program may have set its uniforms.
        self.set_march_uniforms(prepared);
        progress.last_call_took(self.throughput.take());
        self.throughput.begin_call()?;
        let (mut left, mut work) = (milliseconds, 0.0);
        while !progress.is_over() {
            let iterations = progress.iterations_in_pass;
            let is_first = work == 0.0;
            let fit = match self.throughput.rows(iterations, left) {
                Some(rows) => rows,
                None if is_first => prepared.first_rows(iterations),
                None => 0,
            };
            if !is_first && fit == 0 {
                break;
            }
            let rows = fit.clamp(1, prepared.grid.height - progress.rows);
            let rows_drawn = progress.rows..progress.rows + rows;
            self.targets()?
                .march_rows(prepared, &self.scene, iterations, rows_drawn)?;
            let part = f64::from(rows) * f64::from(iterations);
            match self.throughput.end_part(part)? {
                Some(took) => {
                    progress.spend(took);
                    left -= took;
                }
                None => left -= self.throughput.foreseen(part),
            }
            work += part;
            progress.rows += rows;
            if progress.rows == prepared.grid.height {
                self.flip();
                progress.next_pass();
            }
        }
        Ok(self.throughput.end_call(work)?)
    }

    fn pan_and_ask(&mut self, frame: &mut FrameUnderWay) -> Result<(), Error> {
        frame.read_back.timer.mark()?;
        self.targets()?.pan(&frame.prepared)?;
        frame.read_back.timer.mark()?;
        let asking = Instant::now();
        let on_gpu = frame.prepared.settings.sum_on_gpu;
        self.targets()?.ask(&mut frame.read_back, on_gpu)?;
        frame.asking = Some(in_milliseconds(asking.elapsed()));
        Ok(())
    }

    fn collect(&mut self, wait: bool) -> Result<Option<Frame>, Error> {
        // After an error no frame is current.
        let Some(mut frame) = self.under_way.take_if(|frame| frame.is_drawn()) else {
            return Ok(None);
        };
        if wait {
            // Waits for the passes here, because their time is not part of the read-back's time.
            frame.read_back.initialise_and_pan();
        }
        let reading = Instant::now();
        let PreparedFrame { settings, grid, .. } = &frame.prepared;
        let Some((panning, counts)) = frame.read_back.sum(settings, *grid, wait)? else {
            self.under_way = Some(frame);
            return Ok(None);
        };
        let read_back = frame.asking.unwrap_or_default() + in_milliseconds(reading.elapsed());
        frame.progress.spend(self.throughput.take());
        let [initialise, pan] = frame.read_back.initialise_and_pan();
        let milliseconds = Milliseconds {
            initialise,
            march: frame.progress.spent(),
            pan,
            read_back,
            total: in_milliseconds(frame.prepared.began.elapsed()),
        };
        self.spare = Some(frame.read_back);
        Ok(Some(Frame {
            panning,
            counts,
            milliseconds,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::throughput::Throughput;
    use super::*;
    use crate::Scene;
    use crate::gl::{Context, ContextOptions, GpuTimer};

    /// Tests, on machines without a graphics card, the timer of graphics cards, which does not wait. A frame in one
    /// call equals a frame in many calls, and a call with a time of 0 draws one row. Software renderers have timestamp
    /// queries too, but with wrong times.
    #[test]
    fn a_timer_that_does_not_wait_changes_no_frame() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let (scene, settings) = (
            Scene::builtin("corner").unwrap(),
            Settings::default().with_waves(1000),
        );
        let mut waiting = Tracer::new(&context).unwrap();
        let expected = waiting.frame(&scene, &settings).unwrap();
        let by_query = || GpuTimer::of_kind(&context, true);
        let mut tracer = Tracer::new(&context).unwrap();
        tracer.throughput = Throughput::new(by_query());
        let mut read_back = ReadBack::new(&context).unwrap();
        read_back.timer = by_query();
        tracer.spare = Some(read_back);
        let whole = tracer.frame(&scene, &settings).unwrap();
        assert_eq!(
            (whole.panning, whole.counts),
            (expected.panning, expected.counts)
        );
        tracer.frame_begin(&scene, &settings).unwrap();
        let under_way = tracer.under_way.as_ref().unwrap();
        let per_pass = under_way.prepared.budget.iterations_per_pass;
        let passes = settings.iterations.div_ceil(per_pass);
        let rows = passes * under_way.prepared.grid.height;
        for row in 1..=rows {
            assert!(tracer.frame_poll().unwrap().is_none());
            assert_eq!(tracer.frame_advance(0.0).unwrap(), row == rows);
        }
        let parts = tracer.frame_wait().unwrap().unwrap();
        assert_eq!(
            (parts.panning, parts.counts),
            (expected.panning, expected.counts)
        );
    }
}
