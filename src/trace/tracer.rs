//! One frame after the other on one context.

mod heard;
mod job;
mod parts;
mod pending;

use super::budget::{self, Budget};
use super::directions::{random_turn, unit_directions};
use super::frame::{in_milliseconds, timed};
use super::limits::{check_surfaces, check_waves};
use super::programs::{Pass, Programs, shader_text};
use super::scene_data::SceneData;
use super::sum::Sum;
use super::user_fields::UserFields;
use super::waves::{STATUS_DEAD, waves};
use super::{
    Counts, Frame, Grid, Milliseconds, Panning, Profile, Settings, TraceError, Wave, panning,
};
use crate::error::Error;
use crate::gpu::{
    Clock, Context, GpuError, PingPong, Program, RenderTarget, Target, Texture,
    full_screen_pass_rows,
};
use crate::scene::Scene;
use crate::scene::glsl::Placement;
use glam::{Vec3, Vec4};
pub use heard::HeardPaths;
use job::{Job, set_grid};
use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;
use std::time::Instant;

/// Waves in one draw call at the most: a frame of more is drawn in bands of rows, so that
/// a graphics card's watchdog does not take a long pass for a hang.
const WAVES_PER_DRAW: u64 = 1 << 20;

/// Evaluations of one surface in one draw call at the most, were every march in it to take
/// all the steps it may: some 2^38 operations, about a second on the slowest card that has
/// OpenGL 3.3.
const EVALUATIONS_PER_DRAW: u64 = 1 << 33;

/// Traces frames. Programs and textures are kept from frame to frame: a frame that
/// only moves things compiles nothing and allocates nothing on the GPU. Of many scenes and
/// profiles in turns the programs used last are kept, a dozen of them.
///
/// Every call makes the tracer's context current, whatever the caller has made current in the
/// meantime, and a context of the caller's own (EGL) is current again when the call returns.
pub struct Tracer {
    context: Context,
    clock: Clock,
    kept: Rc<RefCell<Kept>>,
    targets: Option<Targets>,
    contributions: Vec<f32>,
    scene_data: SceneData,
    /// The frame begun and not yet collected, and what is kept from one to the next.
    pending: pending::Pending,
}

/// What tracers side by side share.
#[derive(Default)]
struct Kept {
    programs: Programs,
    user_fields: UserFields,
}

/// The textures for one count of waves.
struct Targets {
    grid: Grid,
    pairs: PingPong,
    contributions: Texture,
    pan: RenderTarget,
    /// Made for the first frame that is summed on the GPU.
    sum: Option<Sum>,
}

impl Tracer {
    /// A tracer on `context`. Programs are compiled when they are first needed.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer's clock cannot be had.
    pub fn new(context: &Context) -> Result<Tracer, Error> {
        Tracer::with(context, Rc::default())
    }

    /// Another tracer on the same context, with textures and a frame under way of its own,
    /// for another count of waves. The two share their programs: what the one has compiled,
    /// the other need not.
    ///
    /// # Errors
    /// As [`Tracer::new`].
    pub fn beside(&self) -> Result<Tracer, Error> {
        Tracer::with(&self.context, Rc::clone(&self.kept))
    }

    fn with(context: &Context, kept: Rc<RefCell<Kept>>) -> Result<Tracer, Error> {
        let _entered = context.enter()?;
        Ok(Tracer {
            context: context.clone(),
            clock: Clock::for_context(context)?,
            kept,
            targets: None,
            contributions: Vec::new(),
            scene_data: SceneData::new(context)?,
            pending: pending::Pending::new(context),
        })
    }

    /// The context that the frames run on.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// How the times of passes are taken.
    pub fn clock_name(&self) -> &'static str {
        self.clock.name()
    }

    /// Programs compiled since the tracer was made, by it and by those [beside](Tracer::beside)
    /// it.
    pub fn programs_compiled(&self) -> usize {
        self.kept.borrow().programs.compiled()
    }

    /// Checks all that a frame needs, users' fields included, and compiles its programs, but
    /// traces nothing. What passes can be traced with these settings.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn check(&mut self, scene: &Scene, settings: &Settings) -> Result<(), Error> {
        let _entered = self.context.enter()?;
        self.check_input(scene, settings)?;
        let programs = &mut self.kept.borrow_mut().programs;
        programs.march(&self.context, scene, settings)?;
        programs.initialise(&self.context, settings.directions)?;
        programs.pan(&self.context)?;
        Ok(())
    }

    /// Traces one frame of the scene as it stands.
    ///
    /// The first frame of a scene's structure compiles its programs, and the first of a count
    /// of waves makes its textures; neither is in the frame's times.
    ///
    /// # Errors
    /// [`Error::Scene`] and [`Error::Trace`] for input that cannot be traced,
    /// [`Error::Gpu`] when the renderer fails.
    pub fn frame(&mut self, scene: &Scene, settings: &Settings) -> Result<Frame, Error> {
        let _entered = self.context.enter()?;
        let job = self.prepare(scene, settings)?;
        let initialise = self.initialise(&job)?;
        let march = self.march_all(&job)?;
        self.finish(&job, initialise, march)
    }

    /// Traces one frame and reads back every wave, in order. The frame's times are without
    /// this reading.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn frame_with_waves(
        &mut self,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(Frame, Vec<Wave>), Error> {
        let _entered = self.context.enter()?;
        let job = self.prepare(scene, settings)?;
        let initialise = self.initialise(&job)?;
        let (starts, first_read) = timed(|| self.read_pair())?;
        let march = self.march_all(&job)?;
        let (ends, second_read) = timed(|| self.read_pair())?;
        let mut frame = self.finish(&job, initialise, march)?;
        frame.milliseconds.total -= first_read + second_read;
        Ok((frame, waves(&starts, &ends, job.placement.anchor)))
    }

    /// Follows every wave: its state after the start and after each iteration.
    ///
    /// The outer list has `settings.iterations + 1` entries, the inner ones a wave
    /// each. Meant for pictures and comparisons.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn paths(&mut self, scene: &Scene, settings: &Settings) -> Result<Vec<Vec<Wave>>, Error> {
        let _entered = self.context.enter()?;
        let job = self.prepare(scene, settings)?;
        self.initialise(&job)?;
        self.follow(&job)
    }

    /// Follows one wave for each of `directions`, which leave the scene's source along
    /// them: as [`Tracer::paths`], but for the start. `settings.waves`, `seed` and
    /// `directions` do not matter.
    ///
    /// World axes. A direction of any length but 0 will do: it is made a unit vector.
    ///
    /// # Errors
    /// As [`Tracer::frame`]; [`TraceError::BadSetting`] for a direction that is 0 or not
    /// finite, and for none at all.
    pub fn trace_directions(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        directions: &[Vec3],
    ) -> Result<Vec<Vec<Wave>>, Error> {
        let _entered = self.context.enter()?;
        let units = unit_directions(directions)?;
        let waves = u32::try_from(units.len()).unwrap_or(u32::MAX);
        let settings = settings.clone().with_waves(waves);
        let job = self.prepare(scene, &settings)?;
        self.upload_starts(&job, &units)?;
        self.follow(&job)
    }
}

/// The parts of a frame, in order.
impl Tracer {
    /// Checks the input, gets the program and the textures, and sets every uniform
    /// of the march that is the same for all iterations.
    fn prepare<'a>(&mut self, scene: &'a Scene, settings: &'a Settings) -> Result<Job<'a>, Error> {
        self.check_input(scene, settings)?;
        // The textures are this frame's now.
        self.pending.parts = None;
        let grid = Grid::new(settings.waves);
        let placement = match settings.profile {
            Profile::Thesis => Placement::world(),
            Profile::March | Profile::Hybrid => Placement::anchored(scene),
        };
        if self.targets.as_ref().is_none_or(|t| t.grid != grid) {
            // The old textures go before the new ones come.
            self.targets = None;
            self.targets = Some(Targets::new(&self.context, grid)?);
        }
        let programs = &mut self.kept.borrow_mut().programs;
        let march = programs.march(&self.context, scene, settings)?;
        let initialise = programs.initialise(&self.context, settings.directions)?;
        let pan = programs.pan(&self.context)?;
        if settings.sum_on_gpu
            && let Some(targets) = &mut self.targets
            && targets.sum.is_none()
        {
            targets.sum = Some(Sum::new(&self.context, programs, grid)?);
        }
        // What only a first frame pays is over.
        let began = Instant::now();
        let placed = placement.apply(scene);
        let lists = budget::lists(settings);
        self.scene_data.set(scene, &placement, &placed, lists)?;
        let budget = Budget::with_cells(scene, settings, self.scene_data.cells());
        let job = Job {
            scene,
            settings,
            budget,
            placed,
            placement,
            march,
            initialise,
            pan,
            began,
        };
        job.set_uniforms(grid);
        self.scene_data.set_uniforms(&job.march);
        Ok(job)
    }

    /// What is checked before every frame, and of users' fields before the first.
    fn check_input(&mut self, scene: &Scene, settings: &Settings) -> Result<(), Error> {
        scene.validate()?;
        settings.validate()?;
        check_waves(&self.context, Grid::new(settings.waves))?;
        check_surfaces(&self.context, scene)?;
        let fields = &mut self.kept.borrow_mut().user_fields;
        fields.check(&self.context, scene, || {
            shader_text(scene, settings, Pass::March)
        })
    }

    fn initialise(&self, job: &Job) -> Result<f64, Error> {
        let program = &job.initialise;
        let targets = self.targets()?;
        set_grid(program, targets.grid);
        program.set_vec3("uSource", job.placement.place(job.scene.source.position));
        program.set_f32("uStartStatus", job.start_status());
        program.set_u32("uSeed", job.settings.seed);
        program.set_vec4("uTurn", Vec4::from(random_turn(job.settings.seed)));
        self.pass(program, targets.grid, targets.pairs.current(), 1)
    }

    /// What the initialise pass does, for directions that are given.
    fn upload_starts(&self, job: &Job, directions: &[Vec3]) -> Result<(), Error> {
        let targets = self.targets()?;
        let texels = (targets.grid.width * targets.grid.height) as usize;
        let start = job.placement.place(job.scene.source.position);
        let origin = start.extend(job.start_status()).to_array();
        let mut origins = vec![origin; directions.len()];
        origins.resize(texels, [0.0, 0.0, 0.0, STATUS_DEAD]);
        let mut headings: Vec<[f32; 4]> = directions
            .iter()
            .map(|direction| direction.extend(0.0).to_array())
            .collect();
        headings.resize(texels, [0.0; 4]);
        let current = targets.pairs.current();
        current.first.upload(origins.as_flattened())?;
        current.second.upload(headings.as_flattened())?;
        Ok(())
    }

    /// The waves as they stand, and after each iteration.
    fn follow(&mut self, job: &Job) -> Result<Vec<Vec<Wave>>, Error> {
        let anchor = job.placement.anchor;
        let starts = self.read_pair()?;
        let mut states = vec![waves(&starts, &starts, anchor)];
        for _ in 0..job.settings.iterations {
            self.march(job, 1)?;
            states.push(waves(&starts, &self.read_pair()?, anchor));
        }
        Ok(states)
    }

    fn march_all(&mut self, job: &Job) -> Result<f64, Error> {
        let mut time = 0.0;
        let mut left = job.settings.iterations;
        while left > 0 {
            let iterations = left.min(job.budget.iterations_per_pass);
            time += self.march(job, iterations)?;
            left -= iterations;
        }
        Ok(time)
    }

    fn march(&mut self, job: &Job, iterations: u32) -> Result<f64, Error> {
        let height = self.targets()?.grid.height;
        let time = self.march_rows(job, iterations, 0..height)?;
        self.flip();
        Ok(time)
    }

    /// Some rows of a pass of so many iterations; when all are drawn the pairs are to be
    /// flipped.
    fn march_rows(&self, job: &Job, iterations: u32, rows: Range<u32>) -> Result<f64, Error> {
        let targets = self.targets()?;
        let current = targets.pairs.current();
        job.march.set_texture("uOrigins", 0, &current.first);
        job.march.set_texture("uDirections", 1, &current.second);
        self.scene_data.bind(&job.march, 2);
        job.march.set_i32("uIterationsInPass", iterations as i32);
        let mut evaluations = job.evaluations(iterations);
        // No watchdog looks after what the processor draws.
        if !self.context.is_software() {
            evaluations = evaluations.saturating_mul(job.weight());
        }
        let next = targets.pairs.next();
        self.pass_rows(&job.march, targets.grid, next, evaluations, rows)
    }

    /// What was written last is read next.
    fn flip(&mut self) {
        if let Some(targets) = &mut self.targets {
            targets.pairs.flip();
        }
    }

    fn finish(&mut self, job: &Job, initialise: f64, march: f64) -> Result<Frame, Error> {
        let pan = self.pan(job)?;
        let reading = Instant::now();
        let (panning, counts) = self.read_back(job.settings)?;
        Ok(Frame {
            panning,
            counts,
            milliseconds: Milliseconds {
                initialise,
                march,
                pan,
                read_back: in_milliseconds(reading.elapsed()),
                total: in_milliseconds(job.began.elapsed()),
            },
        })
    }

    fn pan(&self, job: &Job) -> Result<f64, Error> {
        let program = &job.pan;
        let targets = self.targets()?;
        let current = targets.pairs.current();
        program.set_texture("uOrigins", 0, &current.first);
        program.set_texture("uDirections", 1, &current.second);
        program.set_vec4("uListener", job.listener());
        program.set_vec3("uListenerRight", job.scene.listener.right());
        self.pass(program, targets.grid, &targets.pan, 1)
    }

    /// The sum of the contributions: on the CPU, or on the GPU if the settings say so.
    fn read_back(&mut self, settings: &Settings) -> Result<(Panning, Counts), Error> {
        let Some(targets) = &self.targets else {
            return Err(TraceError::NothingTraced.into());
        };
        let grid = targets.grid;
        let are_evaluations = settings.count_evaluations;
        if settings.sum_on_gpu
            && let Some(sum) = &targets.sum
        {
            sum.draw(&self.context, &targets.contributions, grid)?;
            return sum.read(grid, are_evaluations);
        }
        let texels = &mut self.contributions;
        targets.pan.read_into(0, grid.width, grid.height, texels)?;
        let of_waves = &texels[..4 * grid.waves as usize];
        Ok(panning::sum(of_waves, are_evaluations))
    }

    /// Both textures of the current pair, the texels beyond the last wave left out.
    fn read_pair(&self) -> Result<[Vec<f32>; 2], Error> {
        let targets = self.targets()?;
        let length = 4 * targets.grid.waves as usize;
        let target = &targets.pairs.current().target;
        let mut origins = target.read(0)?;
        let mut directions = target.read(1)?;
        origins.truncate(length);
        directions.truncate(length);
        Ok([origins, directions])
    }

    /// Draws one pass in bands of rows, of so many evaluations a wave at the most, and
    /// takes its time in milliseconds.
    fn pass(
        &self,
        program: &Program,
        grid: Grid,
        target: &impl Target,
        evaluations: u64,
    ) -> Result<f64, Error> {
        self.pass_rows(program, grid, target, evaluations, 0..grid.height)
    }

    /// The same for some rows alone.
    fn pass_rows(
        &self,
        program: &Program,
        grid: Grid,
        target: &impl Target,
        evaluations: u64,
        part: Range<u32>,
    ) -> Result<f64, Error> {
        let waves = (EVALUATIONS_PER_DRAW / evaluations).min(WAVES_PER_DRAW);
        let rows = (waves / u64::from(grid.width)).max(1) as u32;
        let draw = || {
            for start in part.clone().step_by(rows as usize) {
                let band = start..(start + rows).min(part.end);
                let (width, height) = (grid.width, grid.height);
                full_screen_pass_rows(&self.context, program, target, width, height, band)?;
            }
            Ok::<(), Error>(())
        };
        if self.pending.is_beginning() {
            // Its parts are told apart by marks, which nothing waits for.
            return draw().map(|()| 0.0);
        }
        let (drawn, time) = self.clock.measure(draw)?;
        drawn?;
        Ok(in_milliseconds(time))
    }

    fn targets(&self) -> Result<&Targets, TraceError> {
        self.targets.as_ref().ok_or(TraceError::NothingTraced)
    }
}

impl Targets {
    fn new(context: &Context, grid: Grid) -> Result<Targets, GpuError> {
        let contributions = Texture::new(context, grid.width, grid.height)?;
        Ok(Targets {
            grid,
            pairs: PingPong::new(context, grid.width, grid.height)?,
            pan: RenderTarget::new(context, &[&contributions])?,
            contributions,
            sum: None,
        })
    }
}
