//! The passes of a frame, and the textures that they draw to.

use super::super::directions::start_texels;
use super::super::gpu_sum::GpuSum;
use super::super::renderer_limits::check_waves;
use super::super::{Grid, Settings, TraceError};
use super::Tracer;
use super::prepared::{EVALUATIONS_PER_DRAW, FramePrograms, PreparedFrame, set_direction_uniforms};
use crate::error::Error;
use crate::gpu::{
    Context, GpuError, PingPong, Program, RenderTarget, Target, Texture, full_screen_pass_rows,
};
use glam::Vec3;
use std::ops::Range;

/// Waves in one draw call at most: a frame of more is drawn in bands of rows, so that
/// a graphics card's watchdog does not take a long pass for a hang.
const WAVES_PER_DRAW: u64 = 1 << 20;

/// The textures for one count of waves.
pub(super) struct Targets {
    pub grid: Grid,
    /// Made for the first frame in several passes.
    pairs: Option<PingPong>,
    pub contributions: Texture,
    pub pan: RenderTarget,
    /// Made for the first frame that is summed on the GPU.
    pub sum: Option<GpuSum>,
}

impl Targets {
    pub fn new(context: &Context, grid: Grid) -> Result<Targets, GpuError> {
        let contributions = Texture::new(context, grid.width, grid.height)?;
        Ok(Targets {
            grid,
            pairs: None,
            pan: RenderTarget::new(context, &[&contributions])?,
            contributions,
            sum: None,
        })
    }

    /// Makes the texture pairs where there are none yet.
    pub fn provide_pairs(&mut self, context: &Context) -> Result<(), GpuError> {
        if self.pairs.is_none() {
            self.pairs = Some(PingPong::new(context, self.grid.width, self.grid.height)?);
        }
        Ok(())
    }
}

/// The passes. None is waited for, and the callers take their times.
impl Tracer {
    pub(super) fn targets(&self) -> Result<&Targets, TraceError> {
        self.targets.as_ref().ok_or(TraceError::NothingTraced)
    }

    fn pairs(&self) -> Result<&PingPong, TraceError> {
        let pairs = self.targets()?.pairs.as_ref();
        pairs.ok_or(TraceError::NothingTraced)
    }

    /// Puts every wave at the source, where that is a pass of its own.
    pub(super) fn initialise(&self, frame: &PreparedFrame) -> Result<(), Error> {
        let FramePrograms::Passes { initialise, .. } = &frame.programs else {
            return Ok(());
        };
        frame.set_start_uniforms(initialise);
        let target = self.pairs()?.current();
        self.draw(initialise, frame.grid, target, 1, 0..frame.grid.height)
    }

    /// The start directions of the waves, in order: unit vectors, world axes. Of `settings` the
    /// waves, the seed and the directions count.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub(crate) fn start_directions(&mut self, settings: &Settings) -> Result<Vec<Vec3>, Error> {
        settings.validate()?;
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            let grid = Grid::new(settings.waves);
            check_waves(&tracer.context, grid)?;
            let initialise = {
                let programs = &mut tracer.shared.borrow_mut().programs;
                programs.initialise(&tracer.context, settings.directions)?
            };
            // The textures are no frame's now.
            if tracer.frame_marching_for().is_some() {
                tracer.give_up();
            }
            tracer.make_room(settings, true)?;
            set_direction_uniforms(&initialise, settings, grid);
            let target = tracer.pairs()?.current();
            tracer.draw(&initialise, grid, target, 1, 0..grid.height)?;
            let [_, directions] = tracer.read_pair()?;
            let texels = directions.as_chunks::<4>().0.iter();
            Ok(texels.map(|[x, y, z, _]| Vec3::new(*x, *y, *z)).collect())
        })
    }

    /// What the initialise pass does, for directions that are given.
    pub(super) fn upload_starts(
        &self,
        frame: &PreparedFrame,
        directions: &[Vec3],
    ) -> Result<(), Error> {
        let texels = (frame.grid.width * frame.grid.height) as usize;
        let [origins, headings] = start_texels(frame.start(), directions.iter().copied(), texels);
        let current = self.pairs()?.current();
        current.first.upload(origins.as_flattened())?;
        current.second.upload(headings.as_flattened())?;
        Ok(())
    }

    /// Sets every uniform of the march that is the same for all iterations.
    pub(super) fn set_march_uniforms(&self, frame: &PreparedFrame) {
        frame.set_march_uniforms();
        self.scene_data.set_uniforms(frame.programs.march());
    }

    /// Some rows of a march pass of so many iterations; when all are drawn the pairs are to be
    /// [flipped](Tracer::flip).
    pub(super) fn march_rows(
        &self,
        frame: &PreparedFrame,
        iterations: u32,
        rows: Range<u32>,
    ) -> Result<(), Error> {
        let program = frame.programs.march();
        self.scene_data.bind(program, 2);
        program.set_i32("uIterationsInPass", iterations as i32);
        let mut evaluations = frame.evaluations(iterations);
        // No watchdog looks after what the processor draws.
        if !self.context.is_software() {
            evaluations = evaluations.saturating_mul(frame.weight());
        }
        if frame.programs.are_one() {
            let target = &self.targets()?.pan;
            return self.draw(program, frame.grid, target, evaluations, rows);
        }
        let pairs = self.pairs()?;
        program.set_texture("uOrigins", 0, &pairs.current().first);
        program.set_texture("uDirections", 1, &pairs.current().second);
        self.draw(program, frame.grid, pairs.next(), evaluations, rows)
    }

    /// What was written last is read next.
    pub(super) fn flip(&mut self) {
        let pairs = self.targets.as_mut().and_then(|t| t.pairs.as_mut());
        if let Some(pairs) = pairs {
            pairs.flip();
        }
    }

    /// What each wave gives to either side, where that is a pass of its own.
    pub(super) fn pan(&self, frame: &PreparedFrame) -> Result<(), Error> {
        let FramePrograms::Passes { pan: program, .. } = &frame.programs else {
            return Ok(());
        };
        let targets = self.targets()?;
        let current = self.pairs()?.current();
        program.set_texture("uOrigins", 0, &current.first);
        program.set_texture("uDirections", 1, &current.second);
        frame.set_pan_uniforms(program);
        self.draw(program, frame.grid, &targets.pan, 1, 0..frame.grid.height)
    }

    /// Both textures of the current pair, the texels beyond the last wave left out.
    pub(super) fn read_pair(&self) -> Result<[Vec<f32>; 2], Error> {
        let targets = self.targets()?;
        let length = 4 * targets.grid.waves as usize;
        let target = &self.pairs()?.current().target;
        let mut origins = target.read(0)?;
        let mut directions = target.read(1)?;
        origins.truncate(length);
        directions.truncate(length);
        Ok([origins, directions])
    }

    /// Draws some rows of one pass in bands, of so many evaluations a wave at most.
    pub(super) fn draw(
        &self,
        program: &Program,
        grid: Grid,
        target: &impl Target,
        evaluations: u64,
        part: Range<u32>,
    ) -> Result<(), Error> {
        let waves = (EVALUATIONS_PER_DRAW / evaluations).min(WAVES_PER_DRAW);
        let rows = (waves / u64::from(grid.width)).max(1) as u32;
        for start in part.clone().step_by(rows as usize) {
            let band = start..(start + rows).min(part.end);
            full_screen_pass_rows(
                &self.context,
                program,
                target,
                grid.width,
                grid.height,
                band,
            )?;
        }
        Ok(())
    }
}
