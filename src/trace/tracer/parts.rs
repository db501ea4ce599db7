//! Frames whose waves are traced a part at a time.
//!
//! A frame that takes longer than a picture may is spread over several pictures: each call
//! draws as many rows of waves as fit the time that it is given, in the order of the passes.
//! What comes of it is bit for bit what the frame in one piece gives, as of the moment when
//! it was begun.
//!
//! How many rows fit is foreseen from those before. Software renderers are waited for, so
//! that their time is measured at once; on a graphics card the time of all parts of a call is
//! asked for in the next one, a picture later, when they should long be over.

use super::super::{Grid, Settings};
use super::{Job, Tracer};
use crate::error::Error;
use crate::gpu::{Context, GpuError, Marks, Program};
use crate::scene::Scene;
use std::rc::Rc;
use std::time::Instant;

/// By how many times the pace may seem to rise from one part to the next: one that was
/// quick by chance shall not be followed by one that takes far too long.
const MOST_FASTER: f64 = 4.0;

/// A frame of which not all parts are drawn.
pub(super) struct Parts {
    scene: Scene,
    settings: Settings,
    progress: Progress,
}

/// How far a frame has come.
#[derive(Clone, Copy)]
struct Progress {
    began: Instant,
    /// Iterations that are not in any pass yet.
    left: u32,
    /// Iterations of the pass under way; 0 when all passes are over.
    in_pass: u32,
    /// Rows of it that are drawn.
    rows: u32,
    /// Milliseconds spent on all parts so far; on a graphics card without those of the last
    /// call.
    spent: f64,
}

/// How fast rows are drawn, by one program on one grid.
pub(super) struct Pace {
    marks: Marks,
    of: Option<(Rc<Program>, Grid)>,
    /// Milliseconds of a row of one iteration; none before the first part.
    milliseconds: Option<f64>,
    /// Rows times iterations of a call on a graphics card, whose time is not taken yet.
    marked: Option<f64>,
}

impl Pace {
    pub fn new(context: &Context) -> Pace {
        Pace {
            marks: Marks::new(context),
            of: None,
            milliseconds: None,
            marked: None,
        }
    }

    /// Forgets what is known of another program, or of rows of another length.
    fn be_of(&mut self, program: &Rc<Program>, grid: Grid) {
        let is_same = |(known, of): &(Rc<Program>, Grid)| Rc::ptr_eq(known, program) && *of == grid;
        if !self.of.as_ref().is_some_and(is_same) {
            self.of = Some((Rc::clone(program), grid));
            (self.milliseconds, self.marked) = (None, None);
        }
    }

    /// Rows of so many iterations that fit a time; `first` where nothing is known yet.
    fn rows(&self, iterations: u32, milliseconds: f64, first: u32) -> u32 {
        match self.milliseconds {
            None => first,
            Some(row) => (milliseconds / (row * f64::from(iterations)).max(1e-6)) as u32,
        }
    }

    fn learn(&mut self, took: f64, work: f64) {
        let least = self.milliseconds.map_or(0.0, |old| old / MOST_FASTER);
        self.milliseconds = Some((took / work).max(least));
    }

    /// Milliseconds of a call on a graphics card, if that was not asked before. Waits for the
    /// call, unless it is over.
    pub fn take(&mut self) -> f64 {
        let Some(work) = self.marked.take() else {
            return 0.0;
        };
        let took: f64 = self.marks.milliseconds().iter().sum();
        self.learn(took, work);
        took
    }

    /// Milliseconds of a part just drawn, of so many rows times iterations: measured where
    /// marks wait, else foreseen.
    fn end_part(&mut self, work: f64) -> Result<f64, GpuError> {
        if !self.marks.wait() {
            return Ok(self.milliseconds.unwrap_or_default() * work);
        }
        self.marks.mark()?;
        let took = self
            .marks
            .milliseconds()
            .last()
            .copied()
            .unwrap_or_default();
        self.learn(took, work);
        Ok(took)
    }

    /// The end of a call, of so many rows times iterations in all.
    fn end_call(&mut self, work: f64) -> Result<(), GpuError> {
        if !self.marks.wait() {
            self.marks.mark()?;
            self.marked = Some(work);
        }
        Ok(())
    }
}

/// Frames in parts.
impl Tracer {
    /// Begins a frame of the scene as it stands, whose waves [`Tracer::frame_go_on`] traces a
    /// part at a time. A frame begun before and not yet collected is given up, and so is this
    /// one by any other frame before its last part is drawn.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_begin_in_parts(
        &mut self,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(), Error> {
        let _entered = self.context.enter()?;
        self.pending.give_up();
        let job = self.prepare(scene, settings)?;
        let grid = self.targets()?.grid;
        self.pending.pace.be_of(&job.march, grid);
        self.pending.marks.restart()?;
        self.without_waiting(|tracer| tracer.initialise(&job))?;
        self.pending.marks.mark()?;
        let in_pass = job.budget.iterations_per_pass.min(settings.iterations);
        let progress = Progress {
            began: job.began,
            left: settings.iterations - in_pass,
            in_pass,
            rows: 0,
            spent: 0.0,
        };
        self.pending.parts = Some(Parts {
            scene: scene.clone(),
            settings: settings.clone(),
            progress,
        });
        Ok(())
    }

    /// Goes on with a frame in parts for about so many milliseconds, one part at the least;
    /// whether all of it is drawn now, so that [`Tracer::frame_poll`] will give it. Without
    /// such a frame there is nothing to draw.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_go_on(&mut self, milliseconds: f64) -> Result<bool, Error> {
        let _entered = self.context.enter()?;
        let Some(Parts {
            scene,
            settings,
            mut progress,
        }) = self.pending.parts.take()
        else {
            return Ok(true);
        };
        let job = self.prepare(&scene, &settings)?;
        self.draw_parts(&job, &mut progress, milliseconds)?;
        if progress.in_pass > 0 {
            self.pending.parts = Some(Parts {
                scene,
                settings,
                progress,
            });
            return Ok(false);
        }
        self.pending.marks.mark()?;
        self.without_waiting(|tracer| tracer.pan(&job))?;
        self.pending.marks.mark()?;
        let mut begun = self.begin_reading(&job)?;
        begun.at = progress.began;
        begun.in_parts = Some(progress.spent);
        self.pending.begun = Some(begun);
        Ok(true)
    }

    /// Milliseconds spent so far on a frame in parts of which not all is drawn.
    pub fn spent_in_parts(&self) -> Option<f64> {
        self.pending
            .parts
            .as_ref()
            .map(|parts| parts.progress.spent)
    }

    /// Whether a frame in parts was begun, of which not all is drawn.
    pub fn is_frame_in_parts(&self) -> bool {
        self.pending.parts.is_some()
    }

    fn draw_parts(
        &mut self,
        job: &Job,
        progress: &mut Progress,
        milliseconds: f64,
    ) -> Result<(), Error> {
        progress.spent += self.pending.pace.take();
        let Grid { width, height, .. } = self.targets()?.grid;
        self.pending.pace.marks.restart()?;
        let (mut left, mut work) = (milliseconds, 0.0);
        while progress.in_pass > 0 {
            let iterations = progress.in_pass;
            let is_first = work == 0.0;
            let first = job.first_rows(width, iterations);
            let fit = self.pending.pace.rows(iterations, left, first);
            if !is_first && (fit == 0 || self.pending.pace.milliseconds.is_none()) {
                break;
            }
            let rows = fit.max(1).min(height - progress.rows);
            let band = progress.rows..progress.rows + rows;
            self.without_waiting(|tracer| tracer.march_rows(job, iterations, band))?;
            let part = f64::from(rows) * f64::from(iterations);
            let took = self.pending.pace.end_part(part)?;
            if self.pending.pace.marks.wait() {
                progress.spent += took;
            }
            left -= took;
            work += part;
            progress.rows += rows;
            if progress.rows == height {
                self.flip();
                progress.rows = 0;
                progress.in_pass = job.budget.iterations_per_pass.min(progress.left);
                progress.left -= progress.in_pass;
            }
        }
        Ok(self.pending.pace.end_call(work)?)
    }

    /// Does something whose passes are not waited for.
    pub(super) fn without_waiting<T>(
        &mut self,
        what: impl FnOnce(&mut Tracer) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.pending.beginning = true;
        let done = what(self);
        self.pending.beginning = false;
        done
    }
}
