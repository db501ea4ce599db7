//! Frames that are begun now and collected later.
//!
//! A frame begun returns as soon as its passes are asked for. What it heard is copied into
//! a pixel buffer, and a fence tells when it is there: so that whoever draws pictures in
//! between is never held up by a read-back, and hears of a frame one picture late at the
//! most.

use super::super::frame::in_milliseconds;
use super::super::{
    Counts, Frame, Grid, Milliseconds, Panning, Settings, TraceError, panning, sum,
};
use super::parts::{Pace, Parts};
use super::{Job, Tracer};
use crate::error::Error;
use crate::gpu::{AsyncRead, Context, Marks};
use crate::scene::Scene;
use std::time::Instant;

/// What is kept between the beginning of a frame and its end, and from one to the next.
pub(super) struct Pending {
    /// Whether a frame is being begun: its passes are then not waited for.
    pub(super) beginning: bool,
    pub(super) marks: Marks,
    /// A frame of which not all parts are drawn, and how fast they are.
    pub(super) parts: Option<Parts>,
    pub(super) pace: Pace,
    /// What was heard, and the passes where they were summed on the GPU.
    reads: Option<[AsyncRead; 2]>,
    pub(super) begun: Option<Begun>,
    heard: Vec<f32>,
    passes: Vec<f32>,
}

/// A frame under way.
#[derive(Clone, Copy)]
pub(super) struct Begun {
    pub(super) at: Instant,
    /// Milliseconds of the march, if it was drawn in parts; on a graphics card without those
    /// of the last call.
    pub(super) in_parts: Option<f64>,
    grid: Grid,
    summed: bool,
    are_evaluations: bool,
}

impl Pending {
    pub fn new(context: &Context) -> Pending {
        Pending {
            beginning: false,
            marks: Marks::new(context),
            parts: None,
            pace: Pace::new(context),
            reads: None,
            begun: None,
            heard: Vec::new(),
            passes: Vec::new(),
        }
    }

    /// Forgets the frame under way.
    pub fn give_up(&mut self) {
        (self.begun, self.parts) = (None, None);
    }

    pub fn is_beginning(&self) -> bool {
        self.beginning
    }

    /// Whether everything of the frame is there, after a wait for it if asked.
    fn arrive(&mut self, begun: Begun, wait: bool) -> Result<bool, Error> {
        let Some([heard, passes]) = &mut self.reads else {
            return Err(TraceError::NothingTraced.into());
        };
        // The passes were asked for first, so that they are there when the rest is.
        let is_there = if wait {
            heard.wait(&mut self.heard)?
        } else {
            heard.poll(&mut self.heard)?
        };
        if !is_there {
            return Ok(false);
        }
        if begun.summed {
            passes.wait(&mut self.passes)?;
        }
        Ok(true)
    }

    fn sum(&self, begun: Begun) -> (Panning, Counts) {
        if begun.summed {
            return sum::totals(&self.heard, &self.passes, begun.grid, begun.are_evaluations);
        }
        let of_waves = &self.heard[..4 * begun.grid.waves as usize];
        panning::sum(of_waves, begun.are_evaluations)
    }
}

/// Frames without waiting.
impl Tracer {
    /// Begins a frame of the scene as it stands, and returns without waiting for it: on a
    /// graphics card at once. [`Tracer::frame_poll`] and [`Tracer::frame_wait`] give its
    /// result. A frame begun before and not yet collected is given up.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_begin(&mut self, scene: &Scene, settings: &Settings) -> Result<(), Error> {
        let _entered = self.context.enter()?;
        self.pending.give_up();
        let begun = self.without_waiting(|tracer| tracer.begin(scene, settings))?;
        self.pending.begun = Some(begun);
        Ok(())
    }

    /// Whether a frame was begun and not yet collected.
    pub fn is_frame_pending(&self) -> bool {
        self.pending.begun.is_some() || self.pending.parts.is_some()
    }

    /// The frame begun, if it is there; `None` where it is not yet, or none was begun.
    ///
    /// Its `read_back` is the time of the copy and the sum on the CPU, its `total` the
    /// time since it was begun.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn frame_poll(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        self.collect(false)
    }

    /// Waits for the frame begun, after tracing what is left of one in parts; `None` where
    /// none was begun.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn frame_wait(&mut self) -> Result<Option<Frame>, Error> {
        let _entered = self.context.enter()?;
        while !self.frame_go_on(f64::INFINITY)? {}
        self.collect(true)
    }

    fn begin(&mut self, scene: &Scene, settings: &Settings) -> Result<Begun, Error> {
        let job = self.prepare(scene, settings)?;
        self.pending.marks.restart()?;
        self.initialise(&job)?;
        self.pending.marks.mark()?;
        self.march_all(&job)?;
        self.pending.marks.mark()?;
        self.pan(&job)?;
        self.pending.marks.mark()?;
        self.begin_reading(&job)
    }

    pub(super) fn begin_reading(&mut self, job: &Job) -> Result<Begun, Error> {
        let Some(targets) = &self.targets else {
            return Err(TraceError::NothingTraced.into());
        };
        let grid = targets.grid;
        if self.pending.reads.is_none() {
            let read = || AsyncRead::new(&self.context);
            self.pending.reads = Some([read()?, read()?]);
        }
        let Some([heard, passes]) = &mut self.pending.reads else {
            return Err(TraceError::NothingTraced.into());
        };
        let sum = targets.sum.as_ref().filter(|_| job.settings.sum_on_gpu);
        match sum {
            Some(sum) => {
                sum.draw(&self.context, &targets.contributions, grid)?;
                passes.begin(sum.last(), 1, 1, 1)?;
                heard.begin(sum.last(), 0, 1, 1)?;
            }
            None => heard.begin(&targets.pan, 0, grid.width, grid.height)?,
        }
        Ok(Begun {
            at: job.began,
            in_parts: None,
            grid,
            summed: sum.is_some(),
            are_evaluations: job.settings.count_evaluations,
        })
    }

    fn collect(&mut self, wait: bool) -> Result<Option<Frame>, Error> {
        // After an error it is not asked for again.
        let Some(begun) = self.pending.begun.take() else {
            return Ok(None);
        };
        let reading = Instant::now();
        if !self.pending.arrive(begun, wait)? {
            self.pending.begun = Some(begun);
            return Ok(None);
        }
        let (panning, counts) = self.pending.sum(begun);
        let read_back = in_milliseconds(reading.elapsed());
        let parts = self.pending.marks.milliseconds();
        let part = |index: usize| parts.get(index).copied().unwrap_or_default();
        // Between initialise and pan of a frame in parts lie pictures too.
        let march = match begun.in_parts {
            Some(spent) => spent + self.pending.pace.take(),
            None => part(1),
        };
        Ok(Some(Frame {
            panning,
            counts,
            milliseconds: Milliseconds {
                initialise: part(0),
                march,
                pan: part(2),
                read_back,
                total: in_milliseconds(begun.at.elapsed()),
            },
        }))
    }
}
