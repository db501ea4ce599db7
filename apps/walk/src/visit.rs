//! One walk through a scene.

use super::paths::{PATH_ITERATIONS, Paths};
use super::plan::{Cut, PlanImage, STUB, way};
use super::{MoveInput, ValueSlider, Walker, World};
use echomarch::Error;
use echomarch::gl::Context;
use echomarch::picture::{Bounds, View};
use echomarch::scene::Scene;
use echomarch::tracer::{Fate, Frame, Settings, Tracer};
use glam::Vec3;

/// A walk through a scene on one context. A visit advances time, traces waves, and draws the picture and the plan. The
/// caller calls [`pass`](Visit::pass), [`trace`](Visit::trace) and [`draw`](Visit::draw) once per picture.
///
/// ```
/// use echomarch::gl::{Context, ContextOptions};
/// use echomarch_walk::{MoveInput, Visit};
/// use echomarch::{Scene, Settings};
///
/// let context = Context::headless(&ContextOptions::default())?;
/// let mut visit = Visit::new(&context, Scene::builtin("corner")?)?;
/// let ahead = MoveInput { forward: 1.0, ..MoveInput::default() };
/// visit.pass(&ahead, 0.1);
/// assert!(visit.scene().listeners[0].position.z < 8.0);
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
    /// Scene and settings of the current or last frame; `None` forces a new frame.
    traced: Option<(Scene, Settings)>,
    heard: Option<Frame>,
}

/// The scene from above.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green and blue of each pixel. The row with the smallest world z comes first.
    pub rgb: &'a [u8],
    /// The part of the world that the plan shows.
    pub bounds: Bounds,
}

/// The path of one wave.
#[derive(Clone, Debug)]
pub struct Way {
    /// The final state of the wave.
    pub fate: Fate,
    /// World positions in metres: the source, the reflections, and the end of the path.
    pub points: Vec<Vec3>,
}

impl Visit {
    /// Begins a walk at the scene's first listener.
    ///
    /// # Errors
    /// [`Error::Gpu`] if OpenGL fails, [`Error::Scene`] for a scene without a source or a listener, and the errors of
    /// [`set_scene`](Visit::set_scene).
    pub fn new(context: &Context, scene: Scene) -> Result<Visit, Error> {
        let mut tracer = Tracer::new(context)?;
        let settings = Settings::default();
        let mut view = View::new(context)?;
        tracer.check(&scene, &settings)?;
        view.check(&scene)?;
        Ok(Visit {
            world: World::of(scene)?,
            path_tracer: tracer.with_shared_programs()?,
            tracer,
            view,
            paths: Paths::default(),
            cut: Cut::default(),
            settings,
            traced: None,
            heard: None,
        })
    }

    /// Changes to another scene, or to another text of the current scene. If the name is the same, the walker, a moved
    /// source, the time and changed values stay.
    ///
    /// # Errors
    /// The errors of [`Tracer::check`], and shader errors of the picture. An error changes nothing.
    pub fn set_scene(&mut self, scene: Scene) -> Result<(), Error> {
        if scene.name != self.world.name {
            return self.open_scene(scene);
        }
        self.check_scene(&scene)?;
        self.world.change(scene)?;
        self.forget();
        Ok(())
    }

    /// Opens a scene in its initial state, even if the current scene has the same name.
    ///
    /// # Errors
    /// The errors of [`set_scene`](Visit::set_scene). An error changes nothing.
    pub fn open_scene(&mut self, scene: Scene) -> Result<(), Error> {
        self.check_scene(&scene)?;
        self.world = World::of(scene)?;
        self.forget();
        Ok(())
    }

    /// Checks that waves can be traced in a scene, and that its picture can be drawn.
    fn check_scene(&mut self, scene: &Scene) -> Result<(), Error> {
        scene.pair(0, 0)?;
        self.tracer.check(scene, &self.settings)?;
        self.view.check(scene)
    }

    /// Clears the state of the previous scene.
    fn forget(&mut self) {
        self.view.forget();
        self.paths.forget();
        self.cut = Cut::default();
        self.traced = None;
        self.heard = None;
    }

    /// Sets the settings for tracing.
    ///
    /// # Errors
    /// The errors of [`Tracer::check`] for the current scene. An error changes nothing.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), Error> {
        self.tracer.check(&self.world.now, &settings)?;
        self.settings = settings;
        Ok(())
    }

    /// The settings for tracing.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The scene in its current state.
    pub fn scene(&self) -> &Scene {
        &self.world.now
    }

    /// The last frame of waves; `None` before the first frame of a scene.
    pub fn frame(&self) -> Option<&Frame> {
        self.heard.as_ref()
    }

    /// Advances time by `seconds`: objects move along their paths, and the walker walks.
    pub fn pass(&mut self, input: &MoveInput, seconds: f64) {
        self.world.pass(input, seconds);
    }

    /// Rotates the gaze to the right and upwards, by angles in radians.
    pub fn look(&mut self, right: f32, up: f32) {
        self.world.look(right, up);
    }

    /// Sets the listener's position and gaze.
    pub fn stand(&mut self, walker: Walker) {
        self.world.stand(walker);
    }

    /// The position to which the listener walked; `None` before the first step.
    pub fn walker(&self) -> Option<Walker> {
        self.world.walker
    }

    /// Sets the source's position, in world metres.
    pub fn put_source(&mut self, position: Vec3) {
        self.world.put_source(position);
    }

    /// The position to which the user moved the source, in world metres; `None` while the source follows its path.
    pub fn placed_source(&self) -> Option<Vec3> {
        self.world.source
    }

    /// Picks the source up, or puts it down.
    pub fn pick_up_or_put_down(&mut self) {
        self.world.pick_up_or_put_down();
    }

    /// Pauses or resumes the moving objects.
    pub fn pause_or_go_on(&mut self) {
        self.world.paused = !self.world.paused;
    }

    /// Time along the scene's paths, in seconds.
    pub fn seconds(&self) -> f64 {
        self.world.looped()
    }

    /// Resets the source, the listener and the time to their initial state.
    pub fn start_over(&mut self) {
        self.world.start_over();
    }

    /// The sliders of the scene's named values, and their current values.
    pub fn values(&self) -> impl Iterator<Item = (&ValueSlider, f32)> {
        let sliders = self.world.sliders.iter();
        sliders.map(|slider| (slider, self.world.value_of(slider)))
    }

    /// Sets a named value, in the unit of its file.
    ///
    /// # Errors
    /// The errors of [`Scene::set_value`] and [`Scene::check`]. An error changes nothing.
    pub fn set_value(&mut self, name: &str, value: f32) -> Result<(), Error> {
        Ok(self.world.set(name, value)?)
    }

    /// Traces waves for about `milliseconds`. The call continues the current frame, or begins a new one if the scene or
    /// the settings have changed since the last frame. Returns the frame once it is finished. Returns `None` while
    /// nothing changes, because a new frame would equal the last one.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`]. After an error the next call begins a new frame.
    pub fn trace(&mut self, milliseconds: f64) -> Result<Option<Frame>, Error> {
        let traced = self.trace_on(milliseconds);
        if traced.is_err() {
            self.traced = None;
        }
        traced
    }

    fn trace_on(&mut self, milliseconds: f64) -> Result<Option<Frame>, Error> {
        // A frame begun for a previous scene is discarded.
        let came = self.tracer.frame_poll()?.filter(|_| self.traced.is_some());
        if let Some(frame) = &came {
            self.heard = Some(frame.clone());
        }
        if self.is_frame_due() {
            self.tracer
                .frame_begin(self.world.pair()?, &self.settings)?;
            self.traced = Some((self.world.now.clone(), self.settings.clone()));
        }
        if self.tracer.is_frame_pending() {
            self.tracer.frame_advance(milliseconds)?;
        }
        Ok(came)
    }

    /// Whether a new frame must begin. A frame in progress is finished first, unless its settings have changed.
    fn is_frame_due(&self) -> bool {
        let Some((scene, settings)) = &self.traced else {
            return true;
        };
        let is_under_way = self.tracer.is_frame_pending();
        *settings != self.settings || !is_under_way && *scene != self.world.now
    }

    /// Draws the listener's view on the context's window or canvas of `size` pixels. `scale` (0 to 1) is the ratio of
    /// the picture's resolution to that of the window. Returns whether the picture is new. While nothing moves, the
    /// last picture is shown again and gradually refined.
    ///
    /// # Errors
    /// [`Error::Trace`] for a scene that is too large for the shader, [`Error::Gpu`] if OpenGL fails.
    pub fn draw(&mut self, size: [u32; 2], scale: f32) -> Result<bool, Error> {
        let drawn = self.view.draw(self.world.pair()?, size, (scale, true))?;
        Ok(drawn.anew)
    }

    /// The plan, and whether the plan has changed since the last call.
    pub fn plan(&mut self) -> (Plan<'_>, bool) {
        let is_new = self.cut.refresh(&self.world.name, &self.world.now);
        let bounds = self.cut.bounds();
        let PlanImage { width, height, rgb } = self.cut.image();
        let size = [*width, *height];
        (Plan { size, rgb, bounds }, is_new)
    }

    /// Returns the paths of heard waves and of some others, for the plan. While nothing moves, each call continues the
    /// search for heard waves.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn ways(&mut self) -> Result<Vec<Way>, Error> {
        let iterations = self.settings.iterations.min(PATH_ITERATIONS);
        let settings = self.settings.clone().with_iterations(iterations);
        let pair = self.world.pair()?;
        self.paths.follow(&mut self.path_tracer, pair, &settings)?;
        let bounds = self.cut.bounds();
        let stub = STUB * (bounds.max.x - bounds.min.x);
        let states = self.paths.states();
        let waves = states.first().map_or(0, Vec::len);
        let follow = |wave| way(states, wave, pair.source().position, stub);
        let ways = (0..waves).map(follow);
        Ok(ways.map(|(fate, points)| Way { fate, points }).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use echomarch::gl::ContextOptions;
    use std::thread;
    use std::time::Duration;

    fn visit(scene: &str) -> Visit {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut visit = Visit::new(&context, Scene::builtin(scene).unwrap()).unwrap();
        let settings = Settings::default().with_waves(1024);
        visit.set_settings(settings).unwrap();
        visit
    }

    /// Returns the next frame; `None` if 1000 calls finish no frame.
    fn next_frame(visit: &mut Visit) -> Option<Frame> {
        const CALLS: usize = 1000;
        let mut came = |_| {
            let frame = visit.trace(f64::INFINITY).unwrap();
            if frame.is_none() {
                thread::sleep(Duration::from_millis(1));
            }
            frame
        };
        (0..CALLS).find_map(&mut came)
    }

    /// Protects the processor from unnecessary work: a frame is traced only if it would differ from the last one.
    #[test]
    fn only_what_has_changed_is_traced() {
        let mut visit = visit("corner");
        let first = next_frame(&mut visit).unwrap();
        visit.pass(&MoveInput::default(), 1.0);
        assert!(next_frame(&mut visit).is_none());
        visit.look(0.5, 0.0);
        let turned = next_frame(&mut visit).unwrap();
        assert_eq!(turned.counts, first.counts);
        assert_ne!(turned.panning, first.panning);
        let settings = visit.settings().clone().with_waves(2048);
        visit.set_settings(settings).unwrap();
        assert!(next_frame(&mut visit).is_some());
    }

    /// Protects a walk from settings and scenes that cannot be traced: they are rejected, and the walk continues.
    #[test]
    fn what_cannot_be_traced_is_refused_and_the_walk_goes_on() {
        let mut visit = visit("corner");
        let before = visit.settings().clone();
        let too_many = before.clone().with_waves(u32::MAX);
        assert!(visit.set_settings(too_many).is_err());
        assert_eq!(*visit.settings(), before);
        let mut empty = Scene::builtin("cave").unwrap();
        empty.listeners[0].radius = f32::NAN;
        assert!(visit.set_scene(empty).is_err());
        assert_eq!(visit.scene().name, "corner");
        assert!(next_frame(&mut visit).is_some());
    }

    /// Protects a new scene from showing the counts and the extent of the previous scene. Also protects a link that the
    /// user follows: earlier actions have no effect on its state.
    #[test]
    fn a_scene_that_is_opened_begins_anew() {
        let mut visit = visit("corner");
        assert!(next_frame(&mut visit).is_some());
        visit.put_source(Vec3::ONE);
        visit.look(0.5, 0.0);
        assert_eq!(visit.placed_source(), Some(Vec3::ONE));
        visit.world.now.listeners[0].position.x += 500.0;
        let width = |visit: &mut Visit| {
            let (plan, _) = visit.plan();
            plan.bounds.max.x - plan.bounds.min.x
        };
        let wide = width(&mut visit);
        visit.set_scene(Scene::builtin("corner").unwrap()).unwrap();
        assert!(width(&mut visit) < wide - 400.0);
        assert!(visit.frame().is_none());
        assert!(visit.walker().is_some() && visit.placed_source().is_some());
        visit.open_scene(Scene::builtin("corner").unwrap()).unwrap();
        assert!(visit.walker().is_none() && visit.placed_source().is_none());
        visit.pass(&MoveInput::default(), 0.0);
        assert_eq!(
            visit.scene().listeners[0],
            Scene::builtin("corner").unwrap().listeners[0]
        );
    }
}
