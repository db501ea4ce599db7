//! The current state of the scene during a walk.

use super::values::{ValueSlider, value_sliders};
use super::walk::{MoveInput, Walker, carried};
use echomarch::Error;
use echomarch::scene::{Pair, Scene, SceneError};
use glam::Vec3;

/// A scene during a walk.
#[derive(Clone, Debug)]
pub struct World {
    /// The name or the file that the scene was loaded from.
    pub name: String,
    /// The loaded scene with the changed values applied.
    pub base: Scene,
    /// Sliders for the named values, with the initial values of the scene file.
    pub sliders: Vec<ValueSlider>,
    /// The values that differ from the scene file, in the units of the file.
    pub values: Vec<(String, f32)>,
    /// The scene in its current state.
    pub now: Scene,
    /// Time along the paths of the scene, in seconds.
    pub seconds: f64,
    /// Whether the paths are paused.
    pub paused: bool,
    /// The position to which the listener walked; `None` before the first step.
    pub walker: Option<Walker>,
    /// The position to which the source was moved; `None` before it was picked up.
    pub source: Option<Vec3>,
    /// Whether the source is carried.
    pub carrying: bool,
}

/// The state of a walk, without the scene itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WalkState {
    /// The named values that differ from the scene's text, in the text's units.
    pub values: Vec<(String, f32)>,
    /// Time along the scene's paths, in seconds.
    pub seconds: f64,
    /// The position to which the listener walked; `None` before the first step.
    pub walker: Option<Walker>,
    /// The position to which the first source was moved, in world metres; `None` before it was picked up.
    pub source: Option<Vec3>,
}

impl WalkState {
    /// Returns the scene in this state. `base` is the scene as read from its text.
    ///
    /// # Errors
    /// The errors of [`Scene::set_value`].
    pub fn scene(&self, base: &Scene) -> Result<Scene, SceneError> {
        let mut base = base.clone();
        for (name, value) in &self.values {
            base.set_value(name, *value)?;
        }
        Ok(placed(&base, self.seconds, self.walker, self.source))
    }
}

/// Returns the scene at a time. The first listener and the first source are at the positions to which they were moved.
fn placed(base: &Scene, seconds: f64, walker: Option<Walker>, source: Option<Vec3>) -> Scene {
    let mut scene = match base.duration() > 0.0 {
        true => base.at(seconds),
        false => base.clone(),
    };
    if let (Some(walker), Some(first)) = (walker, scene.listeners.first_mut()) {
        walker.place(first);
    }
    if let (Some(position), Some(first)) = (source, scene.sources.first_mut()) {
        first.position = position;
    }
    scene
}

impl World {
    /// Loads a scene.
    ///
    /// # Errors
    /// The errors of [`Scene::load`].
    pub fn load(name: &str) -> Result<World, SceneError> {
        World::named(name, Scene::load(name)?)
    }

    /// Creates a world from a scene that was loaded from `name`.
    ///
    /// # Errors
    /// The errors of [`World::of`].
    pub fn named(name: &str, base: Scene) -> Result<World, SceneError> {
        Ok(World {
            name: name.to_owned(),
            ..World::of(base)?
        })
    }

    /// Creates a world from a scene without a file. The walker is its first listener, and can carry its first source.
    ///
    /// # Errors
    /// [`SceneError::NoSuchNumber`] for a scene without a source or without a listener.
    pub fn of(base: Scene) -> Result<World, SceneError> {
        base.pair(0, 0)?;
        Ok(World {
            name: base.name.clone(),
            sliders: value_sliders(&base),
            values: Vec::new(),
            now: base.clone(),
            base,
            seconds: 0.0,
            paused: false,
            walker: None,
            source: None,
            carrying: false,
        })
    }

    /// The walker and the source that it can carry.
    ///
    /// # Errors
    /// [`SceneError::NoSuchNumber`] if the listener or the source was removed.
    pub fn pair(&self) -> Result<Pair<'_>, Error> {
        Ok(self.now.pair(0, 0)?)
    }

    /// Changes to another scene with the same name. The time, the walker, a moved source and changed values stay. A
    /// value that the new scene rejects is reset to the value in the file.
    ///
    /// # Errors
    /// The errors of [`World::of`]. An error changes nothing.
    pub fn change(&mut self, base: Scene) -> Result<(), SceneError> {
        base.pair(0, 0)?;
        self.sliders = value_sliders(&base);
        self.now = base.clone();
        self.base = base;
        for (name, value) in std::mem::take(&mut self.values) {
            // After an error, the slider shows the value in the file.
            let _ = self.set(&name, value);
        }
        Ok(())
    }

    /// Sets a named value, in the unit of its file.
    ///
    /// # Errors
    /// The errors of [`Scene::set_value`] and [`Scene::check`]. An error changes nothing.
    pub fn set(&mut self, name: &str, value: f32) -> Result<(), SceneError> {
        let mut scene = self.base.clone();
        scene.set_value(name, value)?;
        scene.check()?;
        self.base = scene;
        self.values.retain(|(known, _)| known != name);
        let known = self.sliders.iter().find(|slider| slider.name == name);
        if known.is_none_or(|slider| slider.start != value) {
            self.values.push((name.to_owned(), value));
        }
        Ok(())
    }

    /// Sets the material of a surface, given by its index from 0, and of all its walls.
    pub fn set_material(&mut self, surface: usize, name: Option<String>) {
        if let Some(surface) = self.base.surfaces.get_mut(surface) {
            surface.material = name;
            surface.walls = Default::default();
        }
    }

    /// The current value of a slider, in the unit of its file.
    pub fn value_of(&self, slider: &ValueSlider) -> f32 {
        let set = self.values.iter().find(|(name, _)| *name == slider.name);
        set.map_or(slider.start, |(_, value)| *value)
    }

    /// Returns this scene after setting its named values to those with the same names in `other`.
    #[must_use]
    pub fn like(mut self, other: &World) -> World {
        for slider in &other.sliders {
            let (name, value) = (&slider.name, other.value_of(slider));
            if self.sliders.iter().any(|known| known.name == *name) {
                // If this scene rejects the value, it keeps the value in its file.
                let _ = self.set(name, value);
            }
        }
        self
    }

    /// Advances time: objects move along their paths, and the walker walks. A carried source moves with the walker.
    pub fn pass(&mut self, input: &MoveInput, seconds: f64) {
        // A time that is not finite counts as 0.
        let seconds = if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        };
        if !self.paused {
            self.seconds += seconds;
        }
        self.now = placed(&self.base, self.looped(), self.walker, self.source);
        if !input.is_rest() {
            self.step(|walker, scene| walker.walk(scene, input, seconds as f32));
        }
        if self.carrying
            && let Some(walker) = self.now.listeners.first()
        {
            self.put_source(carried(&self.now, walker));
        }
    }

    /// Changes the walker's position or gaze.
    fn step(&mut self, change: impl FnOnce(&mut Walker, &Scene)) {
        if let Some(listener) = self.now.listeners.first() {
            let mut walker = Walker::of(listener);
            change(&mut walker, &self.now);
            self.stand(walker);
        }
    }

    /// Sets the position of the source that can be carried, in world metres.
    pub fn put_source(&mut self, position: Vec3) {
        if let Some(source) = self.now.sources.first_mut() {
            source.position = position;
        }
        self.source = Some(position);
    }

    /// Whether the scene has objects that move along paths.
    pub fn moves(&self) -> bool {
        self.base.duration() > 0.0
    }

    /// Time along the paths, in seconds. The paths restart one second after their end.
    pub fn looped(&self) -> f64 {
        self.seconds % (self.base.duration() + 1.0)
    }

    /// Rotates the gaze to the right and upwards, by angles in radians.
    pub fn look(&mut self, right: f32, up: f32) {
        self.step(|walker, _| walker.look(right, up));
    }

    /// Sets the listener's position and gaze to those of the walker.
    pub fn stand(&mut self, walker: Walker) {
        if let Some(listener) = self.now.listeners.first_mut() {
            walker.place(listener);
        }
        self.walker = Some(walker);
    }

    /// Picks the source up, or puts it down.
    pub fn pick_up_or_put_down(&mut self) {
        self.carrying = !self.carrying;
    }

    /// Resets the source, the listener and the time to their initial state.
    pub fn start_over(&mut self) {
        self.walker = None;
        self.source = None;
        self.carrying = false;
        self.seconds = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects moving scenes: the paths continue until paused, and a source that the user put down stays in place.
    #[test]
    fn a_moving_source_moves_until_it_is_picked_up() {
        let mut world = World::of(Scene::builtin("open-field").unwrap()).unwrap();
        world.pass(&MoveInput::default(), 2.0);
        assert!(world.now.sources[0].position.x.abs() < 1e-4);
        world.paused = true;
        world.pass(&MoveInput::default(), 1.0);
        assert!(world.now.sources[0].position.x.abs() < 1e-4);
        assert!(world.source.is_none() && world.walker.is_none());
        world.paused = false;
        world.pick_up_or_put_down();
        world.pass(&MoveInput::default(), 0.1);
        let held = world.now.sources[0].position;
        world.pick_up_or_put_down();
        world.pass(&MoveInput::default(), 1.0);
        assert_eq!(world.now.sources[0].position, held);
        assert!((held - world.now.listeners[0].position).z < -2.0);
        world.start_over();
        world.pass(&MoveInput::default(), 0.0);
        assert_eq!(world.now.sources[0].position.x, -8.0);
    }
}
