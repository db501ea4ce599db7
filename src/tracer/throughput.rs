//! How many rows of waves fit a time.
//!
//! It is foreseen from the rows before. Software renderers are waited for, so that their time
//! is measured at once; on a graphics card the time of all rows of a call is requested in the
//! next one, a picture later, when they should long be over.

use super::{Grid, Settings};
use crate::gl::{GpuError, GpuTimer, Program};
use std::rc::Rc;

/// By how many times the throughput may seem to rise from one part to the next: one that was
/// quick by chance shall not be followed by one that takes far too long.
const MOST_FASTER: f64 = 4.0;

/// Milliseconds that rows are taken to need at least: no division by zero where the clock
/// did not move.
const LEAST_MILLISECONDS: f64 = 1e-6;

/// How far the march of a frame has come.
pub(super) struct Progress {
    /// Iterations that are not in any pass yet.
    left: u32,
    /// Iterations of the pass in progress; 0 when all passes are done.
    pub iterations_in_pass: u32,
    /// Rows of it that are drawn.
    pub rows: u32,
    /// Milliseconds spent on all calls, on a graphics card without the last one; none
    /// before the first call.
    spent: Option<f64>,
    iterations_per_pass: u32,
}

impl Progress {
    pub fn new(settings: &Settings, iterations_per_pass: u32) -> Progress {
        let mut progress = Progress {
            left: settings.iterations,
            iterations_in_pass: 0,
            rows: 0,
            spent: None,
            iterations_per_pass,
        };
        progress.next_pass();
        progress
    }

    /// Whether all passes are drawn.
    pub fn is_over(&self) -> bool {
        self.iterations_in_pass == 0
    }

    pub fn next_pass(&mut self) {
        self.rows = 0;
        self.iterations_in_pass = self.iterations_per_pass.min(self.left);
        self.left -= self.iterations_in_pass;
    }

    /// Milliseconds spent.
    pub fn spent(&self) -> f64 {
        self.spent.unwrap_or_default()
    }

    pub fn spend(&mut self, milliseconds: f64) {
        *self.spent.get_or_insert_default() += milliseconds;
    }

    /// Adds the time of the call before this one; before the first one that was another frame's.
    pub fn last_call_took(&mut self, milliseconds: f64) {
        self.spent = Some(self.spent.map_or(0.0, |spent| spent + milliseconds));
    }
}

/// How fast rows are drawn, by one program on one grid.
pub(super) struct Throughput {
    timer: GpuTimer,
    of: Option<(Rc<Program>, Grid)>,
    /// Milliseconds of a row of one iteration; none before the first part.
    milliseconds: Option<f64>,
    /// Rows times iterations of a call on a graphics card, whose time is not taken yet.
    untaken: Option<f64>,
}

impl Throughput {
    pub fn new(timer: GpuTimer) -> Throughput {
        Throughput {
            timer,
            of: None,
            milliseconds: None,
            untaken: None,
        }
    }

    /// How the times are taken.
    pub fn timer_name(&self) -> &'static str {
        self.timer.name()
    }

    /// Forgets what is known of another program, or of rows of another length.
    pub fn select(&mut self, program: &Rc<Program>, grid: Grid) {
        let is_same = |(known, of): &(Rc<Program>, Grid)| Rc::ptr_eq(known, program) && *of == grid;
        if !self.of.as_ref().is_some_and(is_same) {
            self.of = Some((Rc::clone(program), grid));
            (self.milliseconds, self.untaken) = (None, None);
        }
    }

    /// Rows of `iterations` that fit a time: `None` before the first measurement, and all rows for a
    /// time without end.
    pub fn rows(&self, iterations: u32, milliseconds: f64) -> Option<u32> {
        if milliseconds == f64::INFINITY {
            return Some(u32::MAX);
        }
        let row = self.milliseconds? * f64::from(iterations);
        Some((milliseconds / row.max(LEAST_MILLISECONDS)) as u32)
    }

    fn learn(&mut self, took: f64, work: f64) {
        let least = self.milliseconds.map_or(0.0, |old| old / MOST_FASTER);
        self.milliseconds = Some((took / work).max(least));
    }

    /// Milliseconds of the last call on a graphics card, if that was not queried before. Waits for
    /// the call, unless it has ended.
    pub fn take(&mut self) -> f64 {
        let Some(work) = self.untaken.take() else {
            return 0.0;
        };
        let took: f64 = self.timer.milliseconds().iter().sum();
        self.learn(took, work);
        took
    }

    /// A call begins.
    pub fn begin_call(&mut self) -> Result<(), GpuError> {
        self.timer.restart()
    }

    /// Ends a part of `work` rows times iterations. Returns its milliseconds, or none if the timer does not
    /// wait.
    pub fn end_part(&mut self, work: f64) -> Result<Option<f64>, GpuError> {
        if !self.timer.waits() {
            return Ok(None);
        }
        self.timer.mark()?;
        let took = self.timer.milliseconds();
        let took = took.last().copied().unwrap_or_default();
        self.learn(took, work);
        Ok(Some(took))
    }

    /// Milliseconds that `work` rows times iterations should take.
    pub fn foreseen(&self, work: f64) -> f64 {
        self.milliseconds.unwrap_or_default() * work
    }

    /// The end of a call, of `work` rows times iterations in all.
    pub fn end_call(&mut self, work: f64) -> Result<(), GpuError> {
        if !self.timer.waits() {
            self.timer.mark()?;
            self.untaken = Some(work);
        }
        Ok(())
    }
}
