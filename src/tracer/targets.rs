//! The textures of a frame, and the passes that draw to them. No pass waits for the GPU. The callers measure the times.

use super::gpu_scene::GpuScene;
use super::order_table::OrderTable;
use super::prepared::{EVALUATIONS_PER_DRAW, FramePrograms, PreparedFrame};
use super::read_back::{GpuSum, ReadBack};
use super::start_order::Starts;
use super::waves::start_texels;
use super::{Grid, TraceError};
use crate::error::Error;
use crate::gl::{
    Context, GpuError, PingPong, Program, RenderTarget, Target, Texture, full_screen_pass_rows,
};
use glam::Vec3;
use std::ops::Range;

/// Maximum waves in one draw call. A larger frame is drawn in bands of rows, so that a graphics card's watchdog does
/// not mistake a long pass for a hang.
const WAVES_PER_DRAW: u64 = 1 << 20;

/// The textures for one number of waves.
pub(super) struct Targets {
    context: Context,
    pub grid: Grid,
    /// The texture pairs, created for the first frame with several passes.
    pairs: Option<PingPong>,
    /// The contributions of the waves, in their order.
    pub contributions: Texture,
    pub pan: RenderTarget,
    /// The contributions in the order of starts, for frames that are drawn as one pass. Created for the first such
    /// frame whose starts are sorted.
    unordered: Option<(Texture, RenderTarget)>,
    /// The order of starts of the last frame with sorted starts, kept for the next frame.
    order: Option<OrderTable>,
    /// Whether the starts of the current waves are sorted.
    are_sorted: bool,
    /// Created for the first frame that is summed on the GPU.
    pub sum: Option<GpuSum>,
}

impl Targets {
    pub fn new(context: &Context, grid: Grid) -> Result<Targets, GpuError> {
        let contributions = Texture::new(context, grid.width, grid.height)?;
        Ok(Targets {
            context: context.clone(),
            grid,
            pairs: None,
            pan: RenderTarget::new(context, &[&contributions])?,
            contributions,
            unordered: None,
            order: None,
            are_sorted: false,
            sum: None,
        })
    }

    /// Creates the texture pairs, unless they exist.
    pub fn provide_pairs(&mut self) -> Result<(), GpuError> {
        if self.pairs.is_none() {
            let Grid { width, height, .. } = self.grid;
            self.pairs = Some(PingPong::new(&self.context, width, height)?);
        }
        Ok(())
    }

    /// Creates the texture for contributions in the order of starts, if `is_needed` is set and the texture does not
    /// exist.
    pub fn provide_unordered(&mut self, is_needed: bool) -> Result<(), GpuError> {
        if is_needed && self.unordered.is_none() {
            let texture = Texture::new(&self.context, self.grid.width, self.grid.height)?;
            let target = RenderTarget::new(&self.context, &[&texture])?;
            self.unordered = Some((texture, target));
        }
        Ok(())
    }

    /// Sorts the starts of the next waves. With `None`, waves start in the order of their numbers.
    pub fn sort_starts(&mut self, starts: Option<Starts>) -> Result<(), GpuError> {
        self.are_sorted = starts.is_some();
        if let Some(starts) = starts {
            let (known, size) = (self.order.take(), (self.grid, self.grid.height));
            let table = OrderTable::of_starts(&self.context, known, starts, size)?;
            self.order = Some(table);
        }
        Ok(())
    }

    /// The order of the starts, if they are sorted.
    fn order(&self) -> Option<&OrderTable> {
        self.order.as_ref().filter(|_| self.are_sorted)
    }

    /// Binds the order of the starts, if they are sorted, for a program that reads it.
    fn bind_order(&self, program: &Program) {
        if let Some(order) = self.order() {
            order.bind(program);
        }
    }

    fn pairs(&self) -> Result<&PingPong, TraceError> {
        self.pairs.as_ref().ok_or(TraceError::NothingTraced)
    }

    /// Draws every wave at the source, if this is a separate pass.
    pub fn initialise(&self, frame: &PreparedFrame) -> Result<(), Error> {
        let FramePrograms::Passes { initialise, .. } = &frame.programs else {
            return Ok(());
        };
        frame.set_start_uniforms(initialise);
        self.start(initialise)
    }

    /// Draws the waves at their start with a program.
    pub fn start(&self, program: &Program) -> Result<(), Error> {
        let target = self.pairs()?.current();
        self.bind_order(program);
        self.draw(program, target, 1, 0..self.grid.height)
    }

    /// Uploads every wave at the source, with the given directions.
    pub fn upload_starts(&self, frame: &PreparedFrame, directions: &[Vec3]) -> Result<(), Error> {
        let texels = (self.grid.width * self.grid.height) as usize;
        let [origins, headings] = start_texels(frame.start(), directions.iter().copied(), texels);
        let current = self.pairs()?.current();
        current.first.upload(origins.as_flattened())?;
        current.second.upload(headings.as_flattened())?;
        Ok(())
    }

    /// Draws some rows of a march pass. When all rows of the pass are drawn, the pairs must be
    /// [flipped](Targets::flip).
    pub fn march_rows(
        &self,
        frame: &PreparedFrame,
        scene: &GpuScene,
        iterations: u32,
        rows: Range<u32>,
    ) -> Result<(), Error> {
        let program = frame.programs.march();
        scene.bind(program, 2);
        program.set_i32("uIterationsInPass", iterations as i32);
        let evaluations = frame.evaluations(&self.context, iterations);
        if frame.programs.are_one() {
            self.bind_order(program);
            let target = match (self.order(), &self.unordered) {
                (Some(_), Some((_, target))) => target,
                _ => &self.pan,
            };
            return self.draw(program, target, evaluations, rows);
        }
        let pairs = self.pairs()?;
        program.set_texture("uOrigins", 0, &pairs.current().first);
        program.set_texture("uDirections", 1, &pairs.current().second);
        self.draw(program, pairs.next(), evaluations, rows)
    }

    /// Swaps the pairs: the pair written last is read next.
    pub fn flip(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.flip();
        }
    }

    /// Draws the contribution of each wave to the left and the right, in the order of the waves. If the frame is drawn
    /// as one pass, only the rearrangement of the contributions may be left to do.
    pub fn pan(&self, frame: &PreparedFrame) -> Result<(), Error> {
        let program = match &frame.programs {
            FramePrograms::Passes { pan, .. } => pan,
            FramePrograms::WholeFrame { in_order, .. } => {
                return self.put_in_order(in_order.as_deref());
            }
        };
        self.bind_order(program);
        let current = self.pairs()?.current();
        program.set_texture("uOrigins", 0, &current.first);
        program.set_texture("uDirections", 1, &current.second);
        frame.set_pan_uniforms(program);
        self.draw(program, &self.pan, 1, 0..self.grid.height)
    }

    /// Rearranges the contributions of a frame drawn as one pass into the order of the waves, if its starts are sorted.
    fn put_in_order(&self, program: Option<&Program>) -> Result<(), Error> {
        let (Some(program), Some((texture, _))) = (program, &self.unordered) else {
            return Ok(());
        };
        self.bind_order(program);
        program.set_texture("uContributions", 0, texture);
        self.draw(program, &self.pan, 1, 0..self.grid.height)
    }

    /// Requests the result of a frame, after all of its passes are drawn.
    pub fn ask(&self, read_back: &mut ReadBack, on_gpu: bool) -> Result<(), Error> {
        if !on_gpu {
            return read_back.ask(&self.pan, self.grid);
        }
        let sum = self.sum.as_ref().ok_or(TraceError::NothingTraced)?;
        sum.draw(&self.context, &self.contributions, self.grid)?;
        read_back.ask_sum(sum)
    }

    /// Reads both textures of the current pair. The texels are in the order of the waves, without the texels beyond the
    /// last wave.
    pub fn read_pair(&self) -> Result<[Vec<f32>; 2], Error> {
        let length = 4 * self.grid.waves as usize;
        let target = &self.pairs()?.current().target;
        let mut origins = target.read(0)?;
        let mut directions = target.read(1)?;
        if let Some(order) = self.order().map(OrderTable::order) {
            return Ok([origins, directions].map(|texels| order.in_order_of_waves(&texels)));
        }
        origins.truncate(length);
        directions.truncate(length);
        Ok([origins, directions])
    }

    fn draw(
        &self,
        program: &Program,
        target: &impl Target,
        evaluations: u64,
        rows: Range<u32>,
    ) -> Result<(), Error> {
        draw(&self.context, program, self.grid, target, evaluations, rows)
    }
}

/// Draws some rows of one pass, in bands. `evaluations` is the maximum number of evaluations of a surface by one wave.
pub(super) fn draw(
    context: &Context,
    program: &Program,
    grid: Grid,
    target: &impl Target,
    evaluations: u64,
    rows: Range<u32>,
) -> Result<(), Error> {
    let waves = (EVALUATIONS_PER_DRAW / evaluations).min(WAVES_PER_DRAW);
    let in_band = (waves / u64::from(grid.width)).max(1) as u32;
    for start in rows.clone().step_by(in_band as usize) {
        let band = start..(start + in_band).min(rows.end);
        full_screen_pass_rows(context, program, target, grid.width, grid.height, band)?;
    }
    Ok(())
}

/// Rejects a number of waves that does not fit in a texture, before anything is allocated.
pub(super) fn check_waves(context: &Context, grid: Grid) -> Result<(), TraceError> {
    let limit = context.limits().max_texture_size;
    if grid.width <= limit {
        return Ok(());
    }
    Err(TraceError::TooManyWaves {
        waves: grid.waves,
        side: grid.width,
        limit,
        most: u64::from(limit) * u64::from(limit),
        renderer: context.renderer().to_owned(),
    })
}
