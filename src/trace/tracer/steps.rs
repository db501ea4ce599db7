//! A frame in steps: begin, advance, and poll or wait.
//!
//! *Begin* checks the input and draws the waves at the source. *Advance* traces them for about
//! the time that it is given: as many rows of a pass as fit, in the order of the passes. After
//! the last one it draws the panning pass, and requests a copy of the result in a pixel buffer.
//! *Poll* and *wait* take the copy, when a fence signals that it is complete, and sum it.
//!
//! [`Tracer::frame`] is the three in a row. The result does not depend on how a frame was
//! divided, or on what was drawn in between, bit for bit.

use super::super::frame::in_milliseconds;
use super::super::{
    Counts, Frame, Grid, Milliseconds, Panning, Settings, TraceError, gpu_sum, panning,
};
use super::prepared::PreparedFrame;
use super::throughput::Progress;
use super::{Targets, Tracer, Waves};
use crate::error::Error;
use crate::gpu::{AsyncRead, Context, GpuError, GpuTimer};
use crate::platform::Instant;
use crate::scene::Scene;

/// A frame begun and not yet collected.
pub(super) struct FrameUnderWay {
    pub prepared: PreparedFrame,
    pub progress: Progress,
    pub read_back: ReadBack,
    /// Milliseconds that it took to ask for the result; none while not all passes are drawn.
    asking: Option<f64>,
}

/// What measures a frame and brings its result back; kept from one frame to the next.
pub(super) struct ReadBack {
    /// Four marks: around initialise, and around pan. Between the two others may draw.
    timer: GpuTimer,
    /// What each wave gives, or the sum.
    heard: AsyncRead,
    /// The counts of passes where they are summed on the GPU.
    passes: AsyncRead,
}

impl FrameUnderWay {
    /// Whether all passes are drawn, so that only the result is missing.
    pub fn is_drawn(&self) -> bool {
        self.asking.is_some()
    }
}

impl ReadBack {
    fn new(context: &Context) -> Result<ReadBack, GpuError> {
        Ok(ReadBack {
            timer: GpuTimer::new(context),
            heard: AsyncRead::new(context)?,
            passes: AsyncRead::new(context)?,
        })
    }

    /// Requests the result of a frame whose passes are all drawn.
    fn ask(&mut self, context: &Context, targets: &Targets, on_gpu: bool) -> Result<(), Error> {
        let grid = targets.grid;
        if !on_gpu {
            return Ok(self.heard.begin(&targets.pan, 0, grid.width, grid.height)?);
        }
        let sum = targets.sum.as_ref().ok_or(TraceError::NothingTraced)?;
        sum.draw(context, &targets.contributions, grid)?;
        // The passes are asked for first, so that they are there when the rest is.
        self.passes.begin(sum.last(), 1, 1, 1)?;
        Ok(self.heard.begin(sum.last(), 0, 1, 1)?)
    }

    /// The sum of what came back, if it is there, after waiting if requested: computed on the CPU, or
    /// on the GPU, as set in the settings.
    fn sum(
        &mut self,
        settings: &Settings,
        grid: Grid,
        wait: bool,
    ) -> Result<Option<(Panning, Counts)>, GpuError> {
        let are_evaluations = settings.count_evaluations;
        if !settings.sum_on_gpu {
            let floats = 4 * grid.waves as usize;
            let sum = |texels: &[f32]| panning::sum(&texels[..floats], are_evaluations);
            return take(&mut self.heard, wait, sum);
        }
        let Some(heard) = take(&mut self.heard, wait, <[f32]>::to_vec)? else {
            return Ok(None);
        };
        self.passes
            .wait(|passes| gpu_sum::totals(&heard, passes, grid, are_evaluations))
    }

    /// Milliseconds of initialise and pan. Waits until both are done.
    fn initialise_and_pan(&self) -> [f64; 2] {
        let between = self.timer.milliseconds();
        [0, 2].map(|part| between.get(part).copied().unwrap_or_default())
    }
}

/// The result of a read-back, after waiting if requested.
fn take<T>(
    from: &mut AsyncRead,
    wait: bool,
    read: impl FnOnce(&[f32]) -> T,
) -> Result<Option<T>, GpuError> {
    if wait {
        from.wait(read)
    } else {
        from.poll(read)
    }
}

/// Frames in steps.
impl Tracer {
    /// Begins a frame of the scene in its current state. [`frame_advance`](Tracer::frame_advance)
    /// traces its waves, [`frame_poll`](Tracer::frame_poll) or
    /// [`frame_wait`](Tracer::frame_wait) gives its result, so that drawing in between is never
    /// blocked. On a graphics card nothing here waits for the card.
    ///
    /// A frame begun before and not yet collected is given up. So is this one by any other
    /// frame of this tracer before all of it is drawn.
    ///
    /// ```
    /// use echomarch::gpu::Context;
    /// use echomarch::{Scene, Settings, Tracer};
    ///
    /// # fn main() -> Result<(), echomarch::Error> {
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let mut scene = Scene::builtin("corner")?;
    /// let settings = Settings::default().with_waves(4096);
    /// for _picture in 0..3 {
    ///     if !tracer.is_frame_pending() {
    ///         scene.source.position.x += 0.1;
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
    /// As [`Tracer::frame`].
    pub fn frame_begin(&mut self, scene: &Scene, settings: &Settings) -> Result<(), Error> {
        let _entered = self.context.enter()?;
        self.begin(scene, settings, Waves::Dropped)
    }

    /// Traces the frame begun for about so many milliseconds, one row of waves at least;
    /// without end for [`f64::INFINITY`]. Whether all of it is drawn now, so that
    /// [`Tracer::frame_poll`] will give it.
    ///
    /// # Errors
    /// [`TraceError::NoFrameBegun`] where no frame was begun, or it was collected or given up since;
    /// [`TraceError::BadSetting`] for a time that is negative or no number;
    /// [`Error::Gpu`] when the renderer fails; the frame is then given up.
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

    /// The frame begun, if it is there; `None` where it is not yet, or none was begun.
    ///
    /// Its `read_back` is the time of the copy and the sum, its `total` the time since it was
    /// begun.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails; the frame is then given up.
    pub fn frame_poll(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        self.collect(false)
    }

    /// Traces what is left of the frame begun, and waits for it; `None` where none was begun.
    ///
    /// # Errors
    /// As [`Tracer::frame_poll`].
    pub fn frame_wait(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        self.advance(f64::INFINITY)?;
        self.collect(true)
    }

    /// Whether a frame was begun and not yet collected.
    pub fn is_frame_pending(&self) -> bool {
        self.under_way.is_some()
    }

    /// Milliseconds spent so far on the march of a frame begun; `None` without one, and when
    /// all of it is drawn.
    pub fn frame_marching_for(&self) -> Option<f64> {
        let marching = self.under_way.as_ref().filter(|frame| !frame.is_drawn());
        marching.map(|frame| frame.progress.spent())
    }

    /// Begin, advance and wait in a row. A frame that was begun before, and is drawn, can be
    /// collected afterwards.
    pub(super) fn frame_at_once(
        &mut self,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<Frame, Error> {
        self.begin(scene, settings, Waves::Dropped)?;
        self.frame_to_its_end()
    }

    /// What is left of the frame begun.
    pub(super) fn frame_to_its_end(&mut self) -> Result<Frame, Error> {
        self.advance(f64::INFINITY)?;
        Ok(self.collect(true)?.ok_or(TraceError::NothingTraced)?)
    }

    /// Does something with frames of its own, and leaves a frame that is drawn as it was.
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
        scene: &Scene,
        settings: &Settings,
        keep: Waves,
    ) -> Result<(), Error> {
        let prepared = self.prepare(scene, settings, keep)?;
        self.give_up();
        let mut read_back = match self.spare.take() {
            Some(read_back) => read_back,
            None => ReadBack::new(&self.context)?,
        };
        self.throughput
            .select(prepared.programs.march(), prepared.grid);
        read_back.timer.restart()?;
        self.initialise(&prepared)?;
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

    /// Forgets the frame in progress, but keeps what it was read back with.
    pub(super) fn give_up(&mut self) {
        if let Some(frame) = self.under_way.take() {
            self.spare = Some(frame.read_back);
        }
    }

    fn advance(&mut self, milliseconds: f64) -> Result<bool, Error> {
        // After an error there is none.
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

    /// Draws rows of waves, one at least, until so many milliseconds are used up or all
    /// passes are drawn.
    pub(super) fn march_for(
        &mut self,
        frame: &mut FrameUnderWay,
        milliseconds: f64,
    ) -> Result<(), Error> {
        let FrameUnderWay {
            prepared, progress, ..
        } = frame;
        // Tracers that share the program set its uniforms too.
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
            self.march_rows(prepared, iterations, progress.rows..progress.rows + rows)?;
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
        self.pan(&frame.prepared)?;
        frame.read_back.timer.mark()?;
        let asking = Instant::now();
        let on_gpu = frame.prepared.settings.sum_on_gpu;
        frame
            .read_back
            .ask(&self.context, self.targets()?, on_gpu)?;
        frame.asking = Some(in_milliseconds(asking.elapsed()));
        Ok(())
    }

    fn collect(&mut self, wait: bool) -> Result<Option<Frame>, Error> {
        // After an error there is none.
        let Some(mut frame) = self.under_way.take_if(|frame| frame.is_drawn()) else {
            return Ok(None);
        };
        if wait {
            // For the passes, which are no part of the read-back.
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
    use crate::gpu::ContextOptions;

    /// Protects graphics cards, whose timers do not wait, where none is at hand: a frame in one
    /// call or in many is the same frame, and without any time each call draws one row. Software
    /// renderers have timestamp queries too, though with wrong times.
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
        tracer.spare = Some(ReadBack {
            timer: by_query(),
            ..ReadBack::new(&context).unwrap()
        });
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
