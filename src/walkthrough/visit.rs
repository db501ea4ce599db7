//! One walk through a scene.

use super::plan::{Cut, PlanImage, way};
use super::{MoveInput, Paths, View, World};
use crate::error::Error;
use crate::gpu::Context;
use crate::picture::Bounds;
use crate::scene::Scene;
use crate::trace::{Fate, Frame, Settings, Tracer};
use glam::Vec3;

/// Iterations that the paths are followed for at the most.
const PATH_ITERATIONS: u32 = 16;

/// Length of a dead wave's stub, as a share of the plan's width.
const STUB: f32 = 0.12;

/// A walk through a scene on one context: time passes, waves are traced, the picture and the plan are drawn. Who
/// shows it calls [`pass`](Visit::pass), [`trace`](Visit::trace) and [`draw`](Visit::draw) once a picture.
///
/// ```
/// use echomarch::gpu::{Context, ContextOptions};
/// use echomarch::walkthrough::{MoveInput, Visit};
/// use echomarch::{Scene, Settings};
///
/// let context = Context::headless(&ContextOptions::default())?;
/// let mut visit = Visit::new(&context, Scene::builtin("corner")?)?;
/// let ahead = MoveInput { forward: 1.0, ..MoveInput::default() };
/// visit.pass(&ahead, 0.1);
/// assert!(visit.scene().listener.position.z < 8.0);
/// while visit.trace(8.0)?.is_none() {}
/// assert!(visit.frame().is_some_and(|frame| frame.counts.listener_hits > 0));
/// # Ok::<(), echomarch::Error>(())
/// ```
pub struct Visit {
    world: World,
    settings: Settings,
    tracer: Tracer,
    path_tracer: Tracer,
    view: View,
    paths: Paths,
    cut: Cut,
    /// What the frame under way is traced with, and whether that has gone since.
    under_way: Settings,
    is_stale: bool,
    heard: Option<Frame>,
}

/// The scene from above.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green and blue of each pixel, the row of the least world z first.
    pub rgb: &'a [u8],
    /// The part of the world that it shows.
    pub bounds: Bounds,
}

/// The way of one wave.
#[derive(Clone, Debug)]
pub struct Way {
    /// What became of it.
    pub fate: Fate,
    /// From the source on, where it was mirrored, and where it ended; world metres.
    pub points: Vec<Vec3>,
}

impl Visit {
    /// A walk that begins where the scene's listener stands.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails; as [`set_scene`](Visit::set_scene).
    pub fn new(context: &Context, scene: Scene) -> Result<Visit, Error> {
        let mut tracer = Tracer::new(context)?;
        let settings = Settings::default();
        tracer.check(&scene, &settings)?;
        Ok(Visit {
            world: World::of(scene),
            path_tracer: tracer.with_shared_programs()?,
            tracer,
            view: View::new(context)?,
            paths: Paths::default(),
            cut: Cut::default(),
            under_way: settings.clone(),
            settings,
            is_stale: false,
            heard: None,
        })
    }

    /// Another scene, or another text of the present one: of the same name, the walker, the source that was moved,
    /// the time and values that were set stay.
    ///
    /// # Errors
    /// As [`Tracer::check`]; then all stays as it was.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), Error> {
        self.tracer.check(&scene, &self.settings)?;
        if scene.name == self.world.name {
            self.world.change(scene);
        } else {
            self.world = World::of(scene);
        }
        self.view.forget();
        self.paths.forget();
        self.is_stale = true;
        Ok(())
    }

    /// How waves are traced from now on.
    ///
    /// # Errors
    /// As [`Settings::validate`]; then all stays as it was.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        settings.validate()?;
        self.settings = settings;
        Ok(())
    }

    /// How waves are traced.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The scene as it stands.
    pub fn scene(&self) -> &Scene {
        &self.world.now
    }

    /// What was heard last; none before the first frame of a scene.
    pub fn frame(&self) -> Option<&Frame> {
        self.heard.as_ref()
    }

    /// Lets so many seconds pass: paths go on, the walker walks.
    pub fn pass(&mut self, input: &MoveInput, seconds: f64) {
        self.world.pass(input, seconds);
    }

    /// Turns the gaze by radians to the right and upwards.
    pub fn look(&mut self, right: f32, up: f32) {
        self.world.look(right, up);
    }

    /// Puts the listener there, its gaze in radians.
    pub fn stand(&mut self, walker: super::Walker) {
        self.world.stand(walker);
    }

    /// Puts the source there, in world metres.
    pub fn put_source(&mut self, position: Vec3) {
        self.world.source = Some(position);
        self.world.now.source.position = position;
    }

    /// Picks the source up, or puts it down.
    pub fn pick_up_or_put_down(&mut self) {
        self.world.pick_up_or_put_down();
    }

    /// Holds the moving things, or lets them go on.
    pub fn pause_or_go_on(&mut self) {
        self.world.paused = !self.world.paused;
    }

    /// Seconds on the scene's paths.
    pub fn seconds(&self) -> f64 {
        self.world.looped()
    }

    /// Puts source, listener and time back to the beginning.
    pub fn start_over(&mut self) {
        self.world.start_over();
    }

    /// The named values of the scene: name, value, least and greatest value, unit.
    pub fn values(&self) -> impl Iterator<Item = (&str, f32, [f32; 2], &'static str)> {
        self.world.sliders.iter().map(|slider| {
            let ends = [*slider.range.start(), *slider.range.end()];
            let value = self.world.value_of(slider);
            (slider.name.as_str(), value, ends, slider.unit)
        })
    }

    /// Sets a named value, in the unit of its file.
    ///
    /// # Errors
    /// As [`Scene::set_value`] and [`Scene::check`]; then it stays as it was.
    pub fn set_value(&mut self, name: &str, value: f32) -> Result<(), Error> {
        Ok(self.world.set(name, value)?)
    }

    /// Traces waves for about so many milliseconds: begins a frame where none is under way, or goes on with it.
    /// The frame, if it is there.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn trace(&mut self, milliseconds: f64) -> Result<Option<Frame>, Error> {
        let came = self.tracer.frame_poll()?.filter(|_| !self.is_stale);
        if let Some(frame) = &came {
            self.heard = Some(frame.clone());
        }
        let has_changed = self.is_stale || self.under_way != self.settings;
        if has_changed || !self.tracer.is_frame_pending() {
            self.tracer.frame_begin(&self.world.now, &self.settings)?;
            self.under_way = self.settings.clone();
            self.is_stale = false;
        }
        self.tracer.frame_advance(milliseconds)?;
        Ok(came)
    }

    /// Draws what the listener sees over the window or canvas of the context, of that size in pixels, at a share of
    /// its size (0 to 1). Whether it was drawn anew: where nothing has moved the last picture is shown again, and
    /// by and by refined.
    ///
    /// # Errors
    /// [`Error::Trace`] for a scene that does not fit, [`Error::Gpu`] when the renderer fails.
    pub fn draw(&mut self, size: [u32; 2], scale: f32) -> Result<bool, Error> {
        let drawn = self.view.draw(&self.world.now, size, (scale, true))?;
        Ok(drawn.anew)
    }

    /// The plan, and whether it has changed since it was last asked for.
    pub fn plan(&mut self) -> (Plan<'_>, bool) {
        let is_new = self.cut.refresh(&self.world.name, &self.world.now);
        let bounds = self.cut.bounds();
        let PlanImage { width, height, rgb } = self.cut.image();
        let size = [*width, *height];
        (Plan { size, rgb, bounds }, is_new)
    }

    /// Follows waves that are heard, and some others, for the plan; goes on with the search for them where nothing
    /// has moved.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn ways(&mut self) -> Result<Vec<Way>, Error> {
        let iterations = self.settings.iterations.min(PATH_ITERATIONS);
        let settings = self.settings.clone().with_iterations(iterations);
        let scene = &self.world.now;
        self.paths.follow(&mut self.path_tracer, scene, &settings)?;
        let bounds = self.cut.bounds();
        let stub = STUB * (bounds.max.x - bounds.min.x);
        let states = self.paths.states();
        let waves = states.first().map_or(0, Vec::len);
        let follow = |wave| way(states, wave, scene.source.position, stub);
        let ways = (0..waves).map(follow);
        Ok(ways.map(|(fate, points)| Way { fate, points }).collect())
    }
}
