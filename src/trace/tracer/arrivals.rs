//! Arrivals: the passes that take waves past a transparent listener.

use super::super::arrivals::{
    Arrival, ArrivalCounts, ArrivalSettings, ArrivalTargets, Block, Chunk, LISTED_AT_MOST, Listed,
    Replay, SPEED_OF_SOUND, WAVES_IN_BLOCK, listed_rows, open_volume,
};
use super::super::programs::march_options;
use super::super::{Algorithm, Grid, Profile, Settings, TraceError};
use super::Tracer;
use super::prepared::{FramePrograms, PreparedFrame};
use crate::error::Error;
use crate::gpu::{Program, RenderTarget};
use crate::kernel::ArrivalsText;
use crate::scene::Scene;
use std::ops::Range;
use std::rc::Rc;
use std::time::Instant;

/// By how much farther than asked for waves are followed, as a share: the GPU adds up in `f32`,
/// which rounds by 6e-8 in each chunk, and there are 4,095 at the most; what is too much is left
/// out on the CPU.
const FARTHER: f64 = 3e-4;

/// What one call of [`Tracer::arrivals`] goes by.
struct Run {
    frame: PreparedFrame,
    program: Rc<Program>,
    replay: Replay,
    /// Iterations of a wave at the most.
    iterations: u32,
}

/// A chunk to be drawn.
#[derive(Clone)]
struct Part {
    first_wave: u32,
    iterations: u32,
    is_start: bool,
    rows: Range<u32>,
}

impl Tracer {
    /// Follows waves past the listener, which stops none of them, and gives every crossing of its
    /// sphere to `take`: in the order of the waves, for 262,144 waves and so many iterations
    /// at a time. The same input gives the same arrivals, bit for bit on one renderer.
    ///
    /// Of `settings` the algorithm, the waves, the seed, the directions and the maximum distance
    /// count; how far waves are followed is in `how`. `take` must use no GL.
    ///
    /// ```
    /// use echomarch::gpu::Context;
    /// use echomarch::trace::ArrivalSettings;
    /// use echomarch::{Scene, Settings, Tracer};
    ///
    /// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
    /// let scene = Scene::builtin("shoebox")?;
    /// let settings = Settings::default().with_waves(4096);
    /// let mut energy = 0.0;
    /// let counts = tracer.arrivals(&scene, &settings, &ArrivalSettings::new(0.2), &mut |arrival| {
    ///     energy += arrival.energy[4]; // at 1 kHz
    /// })?;
    /// assert!(counts.arrivals > 0 && energy > 0.0);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Tracer::frame`]; [`TraceError::NoArrivals`] in the profile `thesis`,
    /// [`TraceError::BadSetting`] for numbers of `how` out of their range.
    pub fn arrivals(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        how: &ArrivalSettings,
        take: &mut dyn FnMut(Arrival),
    ) -> Result<ArrivalCounts, Error> {
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            let run = tracer.prepare_arrivals(scene, settings, how)?;
            let mut counts = ArrivalCounts {
                open_volume_m3: open_volume(scene),
                ..ArrivalCounts::default()
            };
            for first in (0..settings.waves).step_by(WAVES_IN_BLOCK as usize) {
                tracer.arrivals_of_block(&run, first, &mut counts, take)?;
            }
            Ok(counts)
        })
    }

    fn prepare_arrivals(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        how: &ArrivalSettings,
    ) -> Result<Run, Error> {
        let profile = settings.profile();
        if profile == Profile::Thesis {
            let profile = profile.to_string();
            return Err(TraceError::NoArrivals { profile }.into());
        }
        how.validate()?;
        let mut settings = settings
            .clone()
            .with_iterations_per_pass(how.iterations_in_chunk)
            .with_count_evaluations(false);
        settings.algorithm = Algorithm::of(profile);
        self.check_input(scene, &settings)?;
        // The scene's data are of this scene now.
        if self.frame_marching_for().is_some() {
            self.give_up();
        }
        let (rebasing, rebased, budget) = self.set_scene_data(scene, &settings)?;
        let records = self.context.limits().most_outputs() - ArrivalsText::outputs(0);
        let text = ArrivalsText {
            algorithm: march_options(&settings).algorithm,
            directions: settings.directions,
            records: records.min(how.records),
        };
        let programs = &mut self.shared.borrow_mut().programs;
        let program = programs.arrivals(&self.context, scene, text)?;
        let grid = Grid::new(settings.waves.min(WAVES_IN_BLOCK));
        let known = self.arrival_targets.take();
        let known = known.filter(|known| known.grid == grid && known.records == text.records);
        self.arrival_targets = Some(match known {
            Some(known) => known,
            None => ArrivalTargets::new(&self.context, grid, text.records)?,
        });
        let place = (&rebasing, &rebased);
        let programs = FramePrograms::WholeFrame(Rc::clone(&program));
        let frame = PreparedFrame::new(scene, &settings, place, budget, programs, Instant::now());
        Ok(Run {
            frame,
            program,
            replay: replay(scene, &settings, how),
            iterations: how.iterations,
        })
    }

    /// Follows the waves of a block through all their chunks. While a chunk is drawn the one before
    /// is added up.
    fn arrivals_of_block(
        &mut self,
        run: &Run,
        first_wave: u32,
        counts: &mut ArrivalCounts,
        take: &mut dyn FnMut(Arrival),
    ) -> Result<(), Error> {
        let Some(mut targets) = self.arrival_targets.take() else {
            return Err(TraceError::NothingTraced.into());
        };
        let grid = Grid {
            waves: targets
                .grid
                .waves
                .min(run.frame.settings.waves - first_wave),
            ..targets.grid
        };
        let mut block = Block::new(first_wave, grid);
        let per_chunk = run.frame.budget.iterations_per_pass;
        let mut part = Part {
            first_wave,
            iterations: per_chunk.min(run.iterations),
            is_start: true,
            rows: 0..grid.waves.div_ceil(grid.width),
        };
        self.set_arrival_uniforms(run, grid);
        self.draw_chunk(run, &targets, &part)?;
        loop {
            targets.read(part.rows.end)?;
            block.rows = part.rows.clone();
            let list = block.list(&targets.texels);
            let listed = self.draw_lists(run, &targets, &part, &list)?;
            let drawn = part.clone();
            let done = block.iterations + part.iterations;
            part.rows = block.rows_travelling(&targets.texels);
            part.iterations = per_chunk.min(run.iterations - done);
            part.is_start = false;
            let goes_on = !part.rows.is_empty() && part.iterations > 0;
            targets.flip();
            if goes_on {
                self.draw_chunk(run, &targets, &part)?;
            }
            let chunk = Chunk {
                texels: &targets.texels,
                list: &list,
                listed: &listed,
                iterations: drawn.iterations,
            };
            counts.arrivals += block.replay(&run.replay, &chunk, take);
            if !goes_on {
                break;
            }
        }
        block.count(counts);
        self.arrival_targets = Some(targets);
        Ok(())
    }

    fn set_arrival_uniforms(&self, run: &Run, grid: Grid) {
        run.frame.set_march_uniforms();
        self.scene_data.set_uniforms(&run.program);
        let limit = run.replay.length_limit * (1.0 + FARTHER);
        run.program.set_u32("uGridWidth", grid.width);
        run.program.set_f32("uLengthLimit", limit as f32);
        run.program
            .set_f32("uChordScale", (1.0 / run.replay.chord_unit) as f32);
    }

    fn draw_chunk(&self, run: &Run, targets: &ArrivalTargets, part: &Part) -> Result<(), Error> {
        let program = &run.program;
        program.set_i32("uIsListed", 0);
        program.set_texture("uList", 3, &targets.current()[0]);
        self.draw_part(
            run,
            targets,
            part,
            targets.next(),
            targets.grid,
            part.rows.clone(),
        )
    }

    /// Draws the waves that were listed, and reads their records back.
    fn draw_lists(
        &self,
        run: &Run,
        targets: &ArrivalTargets,
        part: &Part,
        list: &[Listed],
    ) -> Result<Vec<Vec<f32>>, Error> {
        let mut records = vec![Vec::new(); targets.records as usize];
        let (width, height) = targets.list.size();
        let grid = Grid {
            waves: width * height,
            width,
            height,
        };
        for piece in list.chunks(LISTED_AT_MOST) {
            targets.list.upload(piece)?;
            let program = &run.program;
            program.set_i32("uIsListed", 1);
            program.set_texture("uList", 3, &targets.list.waves);
            let rows = 0..listed_rows(piece.len());
            self.draw_part(run, targets, part, &targets.list.target, grid, rows)?;
            targets.list.read(piece.len(), &mut records)?;
        }
        Ok(records)
    }

    fn draw_part(
        &self,
        run: &Run,
        targets: &ArrivalTargets,
        part: &Part,
        target: &RenderTarget,
        grid: Grid,
        rows: Range<u32>,
    ) -> Result<(), Error> {
        let program = &run.program;
        let [origins, directions] = targets.current();
        program.set_texture("uOrigins", 0, origins);
        program.set_texture("uDirections", 1, directions);
        self.scene_data.bind(program, 2);
        program.set_i32("uIsStart", i32::from(part.is_start));
        program.set_u32("uFirstWave", part.first_wave);
        program.set_i32("uIterationsInChunk", part.iterations as i32);
        let mut evaluations = run.frame.evaluations(part.iterations);
        if !self.context.is_software() {
            evaluations = evaluations.saturating_mul(run.frame.weight());
        }
        self.draw(program, grid, target, evaluations, rows)
    }
}

fn replay(scene: &Scene, settings: &Settings, how: &ArrivalSettings) -> Replay {
    let volume = open_volume(scene);
    let density = match volume > 0.0 {
        true => 1.0 / (volume * f64::from(settings.waves)),
        false => 0.0,
    };
    Replay {
        early_order: how.early_order,
        length_limit: how.seconds * SPEED_OF_SOUND,
        chord_unit: 4.0 * f64::from(scene.listener.radius),
        density,
    }
}
