//! The read-back of a frame's result. The panning texture is summed on the CPU, or on the GPU block by block until one
//! texel is left.
//!
//! The thesis reads the whole texture back and sums on the CPU. A sum on the GPU returns one texel per target. It is
//! computed in `f32`, block by block, so its relative error stays below 64 roundings, 4e-6, per pass (1e-7 was
//! measured: docs/accuracy.md). Counts of waves are exact. Counts of marches and evaluations are exact up to 2^24 and
//! rounded above.

use super::programs::{Programs, WavePass};
use super::{Counts, Grid, Panning, Settings, frame};
use crate::error::Error;
use crate::gl::{
    AsyncRead, Context, GpuError, GpuTimer, Program, RenderTarget, Texture, TexturePair,
    full_screen_pass,
};
use std::rc::Rc;

/// The timer of a frame, and the read-back of its result. Both are kept from one frame to the next.
pub(super) struct ReadBack {
    /// Four marks: before and after *initialise*, and before and after *pan*. Other drawing is possible between the two
    /// pairs.
    pub timer: GpuTimer,
    /// The contribution of each wave, or the sum.
    heard: AsyncRead,
    /// The counts of marches, if they are summed on the GPU.
    passes: AsyncRead,
}

impl ReadBack {
    pub fn new(context: &Context) -> Result<ReadBack, GpuError> {
        Ok(ReadBack {
            timer: GpuTimer::new(context),
            heard: AsyncRead::new(context)?,
            passes: AsyncRead::new(context)?,
        })
    }

    /// Requests the contributions of all waves, to be summed on the CPU.
    pub fn ask(&mut self, pan: &RenderTarget, grid: Grid) -> Result<(), Error> {
        Ok(self.heard.begin(pan, 0..1, grid.width, grid.height)?)
    }

    /// Requests the result of a sum on the GPU whose passes are drawn.
    pub fn ask_sum(&mut self, sum: &GpuSum) -> Result<(), Error> {
        // The counts of marches are requested first, so that they are complete when the contributions are.
        self.passes.begin(sum.last(), 1..2, 1, 1)?;
        Ok(self.heard.begin(sum.last(), 0..1, 1, 1)?)
    }

    /// The sum of all contributions, computed on the CPU or on the GPU as the settings state. Waits for the result if
    /// `wait` is set; otherwise returns `None` if it is not available yet.
    pub fn sum(
        &mut self,
        settings: &Settings,
        grid: Grid,
        wait: bool,
    ) -> Result<Option<(Panning, Counts)>, GpuError> {
        let are_evaluations = settings.count_evaluations;
        if !settings.sum_on_gpu {
            let floats = 4 * grid.waves as usize;
            let sum = |texels: &[f32]| frame::sum(&texels[..floats], are_evaluations);
            return take(&mut self.heard, wait, sum);
        }
        let Some(heard) = take(&mut self.heard, wait, <[f32]>::to_vec)? else {
            return Ok(None);
        };
        self.passes
            .wait(|passes| totals(&heard, passes, grid, are_evaluations))
    }

    /// Milliseconds of *initialise* and *pan*. Waits until both are complete.
    pub fn initialise_and_pan(&self) -> [f64; 2] {
        let between = self.timer.milliseconds();
        [0, 2].map(|part| between.get(part).copied().unwrap_or_default())
    }
}

/// The result of a read-back. Waits for the result if `wait` is set.
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

/// Side of a block in texels: 64 texels are summed to one texel.
const BLOCK: u32 = 8;

/// The programs of the sum, and the textures of each pass. The textures of the last pass have one texel.
pub(super) struct GpuSum {
    first: Rc<Program>,
    further: Rc<Program>,
    levels: Vec<TexturePair>,
}

impl GpuSum {
    pub fn new(context: &Context, programs: &mut Programs, grid: Grid) -> Result<GpuSum, Error> {
        let first = programs.of_waves(context, WavePass::FirstSum)?;
        let further = programs.of_waves(context, WavePass::FurtherSum)?;
        let (mut width, mut height) = (grid.width, grid.height);
        let mut levels = Vec::new();
        loop {
            (width, height) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
            levels.push(TexturePair::new(context, width, height)?);
            if width == 1 && height == 1 {
                return Ok(GpuSum {
                    first,
                    further,
                    levels,
                });
            }
        }
    }

    /// Draws all passes of the sum over the panning texture.
    pub fn draw(
        &self,
        context: &Context,
        contributions: &Texture,
        grid: Grid,
    ) -> Result<(), Error> {
        let program = &self.first;
        program.set_texture("uContributions", 0, contributions);
        program.set_u32("uWaveCount", grid.waves);
        program.set_u32("uGridWidth", grid.width);
        program.set_i32("uBlock", BLOCK as i32);
        let size = |level: &TexturePair| (level.target.width(), level.target.height());
        let (width, height) = size(&self.levels[0]);
        full_screen_pass(context, program, &self.levels[0], width, height)?;
        let program = &self.further;
        program.set_i32("uBlock", BLOCK as i32);
        for pair in self.levels.windows(2) {
            program.set_texture("uHeard", 0, &pair[0].first);
            program.set_texture("uPasses", 1, &pair[0].second);
            let (width, height) = size(&pair[1]);
            full_screen_pass(context, program, &pair[1], width, height)?;
        }
        Ok(())
    }

    /// The target of one texel with the sums of contributions and counts.
    pub fn last(&self) -> &RenderTarget {
        &self.levels[self.levels.len() - 1].target
    }
}

/// The sums, from the last texel of both textures.
fn totals(heard: &[f32], passes: &[f32], grid: Grid, are_evaluations: bool) -> (Panning, Counts) {
    let panning = Panning {
        left: f64::from(heard[0]),
        right: f64::from(heard[1]),
    };
    let mut counts = Counts {
        listener_hits: heard[2] as u64,
        dead: heard[3] as u64,
        not_finite: passes[3] as u64,
        ..Counts::default()
    };
    let ended = counts.listener_hits + counts.dead + counts.not_finite;
    counts.travelling = u64::from(grid.waves) - ended;
    if are_evaluations {
        counts.evaluations = passes[2] as u64;
    } else {
        counts.zero_length_passes = passes[0] as u64;
        counts.step_limit_reached = passes[1] as u64;
    }
    (panning, counts)
}
