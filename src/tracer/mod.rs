//! Traces frames of a scene: sphere tracing on the GPU.
//!
//! One frame runs as in figure 6 of the thesis:
//!
//! 1. *initialise*: each texel becomes one wave at the source, with its own direction;
//! 2. *march*, once per iteration: traces every wave to the next object, and swaps the two texture pairs;
//! 3. *pan*: computes the contribution to the left and the right of each wave that reached the listener;
//! 4. the texture of contributions is read back once, and summed on the CPU to a [`Panning`].
//!
//! The states of the waves stay on the GPU between these steps. Differences from the thesis are documented in the
//! shader files under `glsl/` and in `docs/thesis.md`.

mod arrival_passes;
mod arrival_run;
mod arrivals;
mod block_waves;
mod error;
mod field_trial;
pub(crate) mod fields_cost;
mod frame;
mod frame_steps;
mod gpu_scene;
mod heard_paths;
mod order_table;
mod passage_passes;
mod prepared;
mod programs;
mod read_back;
mod reload;
mod settings;
mod start_order;
mod targets;
#[cfg(test)]
mod tests;
mod throughput;
mod user_fields;
mod waves;

use crate::error::Error;
use crate::gl::{Context, GpuTimer};
use crate::platform::Instant;
use crate::scene::{IntoPair, Pair, Scene};
#[doc(hidden)]
pub use crate::shader::Budget;
pub use crate::shader::Directions;
use crate::shader::{Materials, StartOrderText, Structure};
use arrivals::ArrivalTargets;
pub use arrivals::{ArrivalCounts, ArrivalSettings};
pub(crate) use arrivals::{
    Detector, FarEnd, Followed, Limits, MOST_LIMITS, NO_LIMITS, SolidHit, Start, Transmitting,
    WavesToFollow, early_band_groups, resampled_band_groups,
};
pub use error::TraceError;
pub use field_trial::{FieldTrial, TrialCommand};
use frame::timed;
pub use frame::{Counts, Frame, Milliseconds, Panning};
pub use frame_steps::FrameTexture;
use frame_steps::FrameUnderWay;
use glam::Vec3;
pub(crate) use gpu_scene::GpuScene;
use gpu_scene::{OWN_UNIFORM_VECTORS, check_uniforms};
#[doc(hidden)]
pub use heard_paths::{HeardPaths, HeardSearch, MostKept};
use prepared::{FramePrograms, PreparedFrame, set_direction_uniforms};
#[doc(hidden)]
#[cfg(feature = "simulator")]
pub(crate) use programs::arrivals_key;
pub use programs::{Pass, shader_text};
use programs::{
    Programs, ScenePass, WavePass, loops_asked, march_options, march_text, start_order, structure,
};
use read_back::{GpuSum, ReadBack};
#[doc(hidden)]
pub use reload::Opening;
pub use reload::Reloading;
#[doc(hidden)]
pub use settings::MARCHES_PER_PASS;
pub use settings::{Algorithm, Profile, Settings, ThesisOptions};
use start_order::Starts;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;
use targets::{Targets, check_waves};
use throughput::Throughput;
use user_fields::UserFields;
pub(crate) use waves::Grid;
pub use waves::{Fate, Wave};
#[cfg(test)]
pub(crate) use waves::{STATUS_DEAD, STATUS_LISTENER, STATUS_STARTED};
use waves::{unit_directions, waves};

/// Traces frames. Programs and textures are kept from frame to frame, so a frame in which objects only move compiles no
/// program and allocates nothing on the GPU. If scenes and profiles alternate, the twelve programs used last are kept.
///
/// Every call makes the tracer's context current, regardless of the context that the caller has made current in the
/// meantime. If that was another EGL context, it is current again when the call returns. A tracer on a context from
/// [`Context::from_glow`] traces on the caller's context.
///
/// ```
/// use echomarch::gl::{Context, ContextOptions};
/// use echomarch::{Scene, Settings, Tracer};
///
/// let context = Context::headless(&ContextOptions::default())?;
/// let mut tracer = Tracer::new(&context)?;
/// let mut scene = Scene::builtin("corner")?;
/// let settings = Settings::default().with_waves(1024);
/// let ahead = tracer.frame(&scene, &settings)?;
/// let compiled = tracer.programs_compiled();
///
/// scene.listeners[0].yaw = 1.5; // to the right, in radians
/// let turned = tracer.frame(&scene, &settings)?;
/// assert_ne!(ahead.panning, turned.panning);
/// assert_eq!(tracer.programs_compiled(), compiled);
/// # Ok::<(), echomarch::Error>(())
/// ```
///
/// A frame has three steps: begin, advance, and poll or wait. [`frame_begin`](Tracer::frame_begin) has an example.
/// [`frame`](Tracer::frame) runs all three.
pub struct Tracer {
    context: Context,
    shared: Rc<RefCell<SharedPrograms>>,
    targets: Option<Targets>,
    arrival_targets: Option<ArrivalTargets>,
    scene: GpuScene,
    throughput: Throughput,
    under_way: Option<FrameUnderWay>,
    /// The timer and read-back of the last frame, for the next one.
    spare: Option<ReadBack>,
}

/// Whether the waves of a frame are requested, in addition to the panning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Waves {
    Kept,
    Dropped,
    /// The waves are requested, and the caller gives their directions. They start in the order of these directions.
    Given,
}

/// The part of a tracer that several tracers may share.
#[derive(Default)]
struct SharedPrograms {
    programs: Programs,
    /// The users' fields that were checked.
    user_fields: UserFields,
}

impl Tracer {
    /// A tracer on `context`. Programs are compiled when they are first needed.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn new(context: &Context) -> Result<Tracer, Error> {
        Tracer::with(context, Rc::default())
    }

    /// Another tracer on the same context, for another number of waves. It has separate textures and a separate current
    /// frame. The two tracers share their programs, so each program is compiled only once.
    ///
    /// # Errors
    /// The errors of [`Tracer::new`].
    pub fn with_shared_programs(&self) -> Result<Tracer, Error> {
        Tracer::with(&self.context, Rc::clone(&self.shared))
    }

    fn with(context: &Context, shared: Rc<RefCell<SharedPrograms>>) -> Result<Tracer, Error> {
        let _entered = context.enter()?;
        Ok(Tracer {
            context: context.clone(),
            shared,
            targets: None,
            arrival_targets: None,
            scene: GpuScene::new(context)?,
            throughput: Throughput::new(GpuTimer::new(context)),
            under_way: None,
            spare: None,
        })
    }

    /// The context on which frames are traced.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// The name of the clock that measures the passes.
    pub fn clock_name(&self) -> &'static str {
        self.throughput.timer_name()
    }

    /// Number of programs that this tracer, and all tracers that [share its programs](Tracer::with_shared_programs),
    /// have compiled.
    pub fn programs_compiled(&self) -> usize {
        self.shared.borrow().programs.compiled()
    }

    /// Checks everything that a frame needs, including users' fields, and compiles its programs, but traces no wave. A
    /// scene that passes the check can be traced with these settings.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn check(&mut self, scene: &Scene, settings: &Settings) -> Result<(), Error> {
        let _entered = self.context.enter()?;
        let structure = self.check_input(scene, settings)?;
        let budget = || Budget::of_structure(scene, structure.clone(), settings);
        let as_one = fits_one_pass(scene, settings, budget);
        self.programs(scene, &structure, settings, as_one)?;
        Ok(())
    }

    /// Traces one frame of a source and a listener in their current state. A scene with one source and one listener can
    /// be passed instead.
    ///
    /// The first frame of a scene's structure compiles its programs, and the first frame with a number of waves creates
    /// its textures. Neither is included in the frame's times.
    ///
    /// # Errors
    /// [`Error::Scene`] and [`Error::Trace`] for input that cannot be traced, such as a scene with several sources that
    /// is passed without a [choice](Scene::pair); [`Error::Gpu`] when the renderer fails.
    pub fn frame<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
    ) -> Result<Frame, Error> {
        let pair = pair.chosen()?;
        let _entered = self.context.enter()?;
        self.aside(|tracer| tracer.frame_at_once(pair, settings))
    }

    /// Traces one frame, and reads back every wave, in order. The frame's times do not include the read-back of the
    /// waves.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn frame_with_waves<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
    ) -> Result<(Frame, Vec<Wave>), Error> {
        self.frame_with_waves_of(pair.chosen()?, settings)
    }

    fn frame_with_waves_of(
        &mut self,
        pair: Pair,
        settings: &Settings,
    ) -> Result<(Frame, Vec<Wave>), Error> {
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            tracer.begin(pair, settings, Waves::Kept)?;
            let origin = tracer.scene.compiled.origin();
            let (starts, reading) = timed(|| tracer.targets()?.read_pair())?;
            let mut frame = tracer.frame_to_its_end()?;
            frame.milliseconds.total -= reading;
            let ends = tracer.targets()?.read_pair()?;
            Ok((frame, waves(&starts, &ends, origin)))
        })
    }

    /// Traces every wave, and returns its state at the start and after each iteration.
    ///
    /// The outer list has `settings.iterations + 1` entries, and each inner list has one entry per wave. This function
    /// is intended for pictures and comparisons.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn paths<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
    ) -> Result<Vec<Vec<Wave>>, Error> {
        let pair = pair.chosen()?;
        let _entered = self.context.enter()?;
        let frame = self.prepare(pair, settings, Waves::Kept)?;
        self.targets()?.initialise(&frame)?;
        self.follow(&frame)
    }

    /// Traces one wave for each of `directions`, which is its start direction. In all other respects the function works
    /// as [`Tracer::paths`]. `settings.waves`, `seed` and `directions` are ignored.
    ///
    /// The directions are in world axes. Their lengths may be any except 0, because they are normalised.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`]; [`BadSetting`](TraceError::BadSetting) for a direction that is 0 or not finite,
    /// and for an empty list.
    pub fn trace_directions<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
        directions: &[impl Copy + Into<[f32; 3]>],
    ) -> Result<Vec<Vec<Wave>>, Error> {
        let directions = directions.iter().map(|way| Vec3::from((*way).into()));
        let units = unit_directions(&directions.collect::<Vec<_>>())?;
        self.trace_units(pair.chosen()?, settings, &units)
    }

    fn trace_units(
        &mut self,
        pair: Pair,
        settings: &Settings,
        units: &[Vec3],
    ) -> Result<Vec<Vec<Wave>>, Error> {
        let _entered = self.context.enter()?;
        let waves = u32::try_from(units.len()).unwrap_or(u32::MAX);
        let settings = settings.clone().with_waves(waves);
        let frame = self.prepare(pair, &settings, Waves::Given)?;
        self.targets()?.upload_starts(&frame, units)?;
        self.follow(&frame)
    }

    /// Finds the paths of `wanted` waves that reach the listener. Traces the waves of `settings`, and then those of the
    /// next seeds, until `wanted` waves are found or `most` waves were traced.
    ///
    /// In the profile `thesis`, which continues to march dead waves, a wave that died before it reached the listener
    /// does not count.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    #[doc(hidden)]
    pub fn heard_paths<'a>(
        &mut self,
        pair: impl IntoPair<'a>,
        settings: &Settings,
        wanted: usize,
        most: u64,
    ) -> Result<HeardPaths, Error> {
        HeardPaths::search(self, pair.chosen()?, settings, wanted, most)
    }

    /// The start directions of the waves, in order: unit vectors in world axes. From `settings`, only the waves, the
    /// seed and the directions are used.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub(crate) fn start_directions(&mut self, settings: &Settings) -> Result<Vec<Vec3>, Error> {
        settings.validate()?;
        let _entered = self.context.enter()?;
        self.aside(|tracer| {
            let grid = Grid::new(settings.waves);
            check_waves(&tracer.context, grid)?;
            let initialise = {
                let programs = &mut tracer.shared.borrow_mut().programs;
                let pass = WavePass::Initialise(settings.directions, StartOrderText::ByNumber);
                programs.of_waves(&tracer.context, pass)?
            };
            tracer.give_up_marching();
            tracer.make_room(settings, true)?.sort_starts(None)?;
            set_direction_uniforms(&initialise, settings, grid);
            let targets = tracer.targets()?;
            targets.start(&initialise)?;
            let [_, directions] = targets.read_pair()?;
            let texels = directions.as_chunks::<4>().0.iter();
            Ok(texels.map(|[x, y, z, _]| Vec3::new(*x, *y, *z)).collect())
        })
    }

    /// Checks the input, compiles the scene, and provides the programs and the textures.
    fn prepare(
        &mut self,
        pair: Pair,
        settings: &Settings,
        keep: Waves,
    ) -> Result<PreparedFrame, Error> {
        let scene = pair.scene;
        let structure = self.check_input(scene, settings)?;
        // Drops a frame in progress, because its textures are reused.
        self.give_up_marching();
        let asked = loops_asked(settings);
        let (budget, setup) = timed(|| {
            let none = Materials::default();
            let rebasing = asked.algorithm.rebasing(pair.listener);
            self.scene.set(scene, rebasing, structure, &none)?;
            Ok(self.scene.compiled.budget(&asked))
        })?;
        let as_one = keep == Waves::Dropped && fits_one_pass(scene, settings, || budget);
        let structure = &self.scene.compiled.structure;
        let programs = self.programs(scene, structure, settings, as_one)?;
        let starts = match keep == Waves::Given {
            true => None,
            false => starts(scene, settings),
        };
        let targets = self.make_room(settings, !programs.are_one())?;
        targets.provide_unordered(starts.is_some() && programs.are_one())?;
        // Sorting is counted as part of the first frame with these starts.
        let ((), sorting) = timed(|| Ok(targets.sort_starts(starts)?))?;
        // The compilation of programs and the creation of textures, which happen only in a first frame, are not part of
        // the frame's time.
        let setup = Duration::from_secs_f64((setup + sorting) * 1e-3);
        let now = Instant::now();
        let began = now.checked_sub(setup).unwrap_or(now);
        let compiled = &self.scene.compiled;
        Ok(PreparedFrame::new(
            pair, settings, compiled, budget, programs, began,
        ))
    }

    /// The programs of a frame, compiled if necessary. `as_one` states whether all passes are drawn as one.
    fn programs(
        &self,
        scene: &Scene,
        structure: &Structure,
        settings: &Settings,
        as_one: bool,
    ) -> Result<FramePrograms, Error> {
        let (programs, context) = (&mut self.shared.borrow_mut().programs, &self.context);
        let (march, of) = (march_options(settings), (scene, structure));
        let (directions, order) = (settings.directions, start_order(scene, settings));
        if as_one {
            let pass = ScenePass::WholeFrame(march, (directions, order));
            let in_order = match order {
                StartOrderText::ByNumber => None,
                StartOrderText::Sorted => Some(programs.of_waves(context, WavePass::InOrder)?),
            };
            return Ok(FramePrograms::WholeFrame {
                frame: programs.of_scene(context, of, pass)?,
                in_order,
            });
        }
        Ok(FramePrograms::Passes {
            march: programs.of_scene(context, of, ScenePass::March(march))?,
            initialise: programs.of_waves(context, WavePass::Initialise(directions, order))?,
            pan: programs.of_waves(context, WavePass::Pan(order))?,
        })
    }

    /// Creates textures for the waves, unless textures of the right size exist.
    fn make_room(&mut self, settings: &Settings, with_pairs: bool) -> Result<&mut Targets, Error> {
        let grid = Grid::new(settings.waves);
        let targets = match self.targets.take().filter(|targets| targets.grid == grid) {
            Some(targets) => targets,
            // The old textures are dropped before the new ones are created.
            None => Targets::new(&self.context, grid)?,
        };
        let targets = self.targets.insert(targets);
        if with_pairs {
            targets.provide_pairs()?;
        }
        if settings.sum_on_gpu && targets.sum.is_none() {
            let programs = &mut self.shared.borrow_mut().programs;
            targets.sum = Some(GpuSum::new(&self.context, programs, grid)?);
        }
        Ok(targets)
    }

    /// Checks the input of a frame, and users' fields before the first frame. Returns the structure of the scene.
    fn check_input(&self, scene: &Scene, settings: &Settings) -> Result<Structure, Error> {
        scene.validate()?;
        settings.validate()?;
        check_profile(scene, settings)?;
        check_waves(&self.context, Grid::new(settings.waves))?;
        let structure = structure(scene, settings);
        check_uniforms(&self.context, scene, &structure, OWN_UNIFORM_VECTORS)?;
        let fields = &mut self.shared.borrow_mut().user_fields;
        let text = || march_text(scene, &structure, settings);
        fields.check(&self.context, scene, &structure, text)?;
        Ok(structure)
    }

    fn targets(&self) -> Result<&Targets, TraceError> {
        self.targets.as_ref().ok_or(TraceError::NothingTraced)
    }

    /// Sets the uniforms of the march that are the same for all iterations.
    fn set_march_uniforms(&self, frame: &PreparedFrame) {
        frame.set_march_uniforms();
        self.scene.set_uniforms(frame.programs.march());
    }

    /// Swaps the texture pairs: the pair written last is read next.
    fn flip(&mut self) {
        if let Some(targets) = &mut self.targets {
            targets.flip();
        }
    }

    /// The states of the waves now, and after each iteration.
    fn follow(&mut self, frame: &PreparedFrame) -> Result<Vec<Vec<Wave>>, Error> {
        self.set_march_uniforms(frame);
        let starts = self.targets()?.read_pair()?;
        let mut states = vec![waves(&starts, &starts, frame.origin)];
        for _ in 0..frame.settings.iterations {
            let targets = self.targets()?;
            targets.march_rows(frame, &self.scene, 1, 0..frame.grid.height)?;
            self.flip();
            let ends = self.targets()?.read_pair()?;
            states.push(waves(&starts, &ends, frame.origin));
        }
        Ok(states)
    }
}

/// The waves of a frame, or `None` if their starts are not sorted.
fn starts(scene: &Scene, settings: &Settings) -> Option<Starts> {
    let Settings {
        waves,
        seed,
        directions,
        ..
    } = *settings;
    match start_order(scene, settings) {
        StartOrderText::ByNumber => None,
        StartOrderText::Sorted => Some(Starts::new(directions, seed, waves, 0..waves)),
    }
}

/// Rejects a mesh in the profile `thesis`, whose minimum distance would round all edges.
fn check_profile(scene: &Scene, settings: &Settings) -> Result<(), TraceError> {
    let mut shapes = scene.surfaces.iter().map(|surface| &surface.shape);
    match settings.profile() == Profile::Thesis && shapes.any(|shape| shape.mesh().is_some()) {
        true => Err(TraceError::NoMeshes),
        false => Ok(()),
    }
}

/// Whether all passes of a frame are drawn as one. In `thesis` they are not. A scene with users' fields, whose programs
/// are tried before use, has only the program of the march. The budget is computed only for other scenes, because it
/// may need the scene's cells.
fn fits_one_pass(scene: &Scene, settings: &Settings, budget: impl FnOnce() -> Budget) -> bool {
    settings.profile() != Profile::Thesis
        && scene.user_fields().next().is_none()
        && settings.iterations <= budget().iterations_per_pass
}
