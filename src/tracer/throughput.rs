//! The number of rows of waves that can be drawn in a given time.
//!
//! The number is predicted from the previous rows. The CPU waits for software renderers, so the time of their rows is
//! known at once. On a graphics card, the time of all rows of a call is queried in the next call, one picture later,
//! when the rows are normally complete.

use super::{Grid, Settings};
use crate::gl::{GpuError, GpuTimer, Program};
use std::rc::Rc;

/// Maximum increase of the throughput from one part to the next. It prevents that a part that was fast by chance is
/// followed by a part that takes far too long.
const MOST_FASTER: f64 = 4.0;

/// Minimum time of rows in milliseconds. It prevents a division by zero if the clock did not advance.
const LEAST_MILLISECONDS: f64 = 1e-6;

/// The progress of a frame's march.
pub(super) struct Progress {
    /// Iterations of all passes.
    iterations: u32,
    /// Iterations not yet assigned to a pass.
    left: u32,
    /// Iterations of the current pass; 0 when all passes are drawn.
    pub iterations_in_pass: u32,
    /// Rows of the current pass that are drawn.
    pub rows: u32,
    /// Milliseconds spent on all calls. On a graphics card the last call is not included. `None` before the first call.
    spent: Option<f64>,
    iterations_per_pass: u32,
}

impl Progress {
    pub fn new(settings: &Settings, iterations_per_pass: u32) -> Progress {
        let mut progress = Progress {
            iterations: settings.iterations,
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

    /// The share of the march that is drawn, 0 to 1: drawn rows times iterations, divided by all rows times iterations.
    /// `height` is the number of rows.
    pub fn share(&self, height: u32) -> f64 {
        let in_pass = f64::from(self.iterations_in_pass);
        let rows_to_do = f64::from(height.saturating_sub(self.rows));
        let all = f64::from(height) * f64::from(self.iterations);
        let to_do = f64::from(height) * f64::from(self.left) + rows_to_do * in_pass;
        1.0 - to_do / all.max(1.0)
    }

    /// Milliseconds spent on the march.
    pub fn spent(&self) -> f64 {
        self.spent.unwrap_or_default()
    }

    pub fn spend(&mut self, milliseconds: f64) {
        *self.spent.get_or_insert_default() += milliseconds;
    }

    /// Adds the time of the previous call. Before the first call of a frame this time is ignored, because the previous
    /// call belonged to another frame.
    pub fn last_call_took(&mut self, milliseconds: f64) {
        self.spent = Some(self.spent.map_or(0.0, |spent| spent + milliseconds));
    }
}

/// The rate at which one program draws rows on one grid.
pub(super) struct Throughput {
    timer: GpuTimer,
    of: Option<(Rc<Program>, Grid)>,
    /// Milliseconds per row and iteration; `None` before the first part.
    milliseconds: Option<f64>,
    /// Rows times iterations of a call on a graphics card whose time has not been queried yet.
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

    /// The name of the timer.
    pub fn timer_name(&self) -> &'static str {
        self.timer.name()
    }

    /// Discards the measured rate if it is that of another program or another grid.
    pub fn select(&mut self, program: &Rc<Program>, grid: Grid) {
        let is_same = |(known, of): &(Rc<Program>, Grid)| Rc::ptr_eq(known, program) && *of == grid;
        if !self.of.as_ref().is_some_and(is_same) {
            self.of = Some((Rc::clone(program), grid));
            (self.milliseconds, self.untaken) = (None, None);
        }
    }

    /// The number of rows of `iterations` that fit in a time. `None` before the first measurement. For an infinite
    /// time, the number covers all rows.
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

    /// Milliseconds of the last call on a graphics card, or 0 if its time was already queried. Waits for the call to
    /// end.
    pub fn take(&mut self) -> f64 {
        let Some(work) = self.untaken.take() else {
            return 0.0;
        };
        let took: f64 = self.timer.milliseconds().iter().sum();
        self.learn(took, work);
        took
    }

    /// Begins a call.
    pub fn begin_call(&mut self) -> Result<(), GpuError> {
        self.timer.restart()
    }

    /// Ends a part of `work` rows times iterations. Returns its time in milliseconds, or `None` if the timer does not
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

    /// Predicted milliseconds for `work` rows times iterations.
    pub fn foreseen(&self, work: f64) -> f64 {
        self.milliseconds.unwrap_or_default() * work
    }

    /// Ends a call of `work` rows times iterations in total.
    pub fn end_call(&mut self, work: f64) -> Result<(), GpuError> {
        if !self.timer.waits() {
            self.timer.mark()?;
            self.untaken = Some(work);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the prediction of a frame's time: the drawn share grows evenly with the rows, from pass to pass.
    #[test]
    fn the_share_counts_rows_of_all_passes() {
        const HEIGHT: u32 = 10;
        let settings = Settings::hybrid().with_waves(100).with_iterations(5);
        let mut progress = Progress::new(&settings, 2);
        let mut shares = Vec::new();
        while !progress.is_over() {
            progress.rows = HEIGHT / 2;
            shares.push(progress.share(HEIGHT));
            progress.next_pass();
            shares.push(progress.share(HEIGHT));
        }
        let expected = [0.2, 0.4, 0.6, 0.8, 0.9, 1.0];
        let is_near = |(share, expected): (&f64, &f64)| (share - expected).abs() < 1e-12;
        assert!(shares.iter().zip(&expected).all(is_near), "{shares:?}");
    }
}
