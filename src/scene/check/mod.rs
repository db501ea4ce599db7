//! Checks of a scene: errors where it cannot be traced, warnings where it is odd.

mod sound;
mod warnings;

pub(super) use sound::{LEVELS, MOST_PLACED, NOT_A_ROOM, twice};
pub use warnings::Warning;

use crate::scene::shape::LARGEST;
use crate::scene::{Motion, Scene, SceneError, Surface};
use glam::Vec3;
use std::fmt;

/// Maximum product of a surface's key-frame times and the nodes of its field: a few seconds of
/// checking each node at each time.
const MOST_WORK: usize = 3_000_000;

/// As [`MOST_WORK`], for the times between keys alone and all surfaces together: less than a
/// second.
const MOST_WORK_BETWEEN: usize = 300_000;

/// Maximum number of frames between keys that are checked: a minute and a half.
const MOST_BETWEEN: usize = 2700;

impl Scene {
    /// Checks as [`Scene::validate_moving`] does, and every field as
    /// [`Shape::check`](super::Shape::check) does: a few milliseconds for each field that states its
    /// Lipschitz constant. Scene files are checked like this when they are read, and a tracer does so
    /// with every new structure. The text of users' fields is compiled later, by the tracer.
    ///
    /// # Errors
    /// As [`Scene::validate_moving`].
    pub fn check(&self) -> Result<(), SceneError> {
        self.validate_moving()?;
        for (index, surface) in self.surfaces.iter().enumerate() {
            let checked = surface.shape.check();
            checked.map_err(|why| self.bad_field(&surface.label(index), why))?;
        }
        self.at_checked_times(Scene::check_growth)
    }

    /// Checks the stated Lipschitz constants at one of `times` times; with many times, fewer points
    /// are tried at each.
    fn check_growth(&self, label: &str, surface: &Surface, times: usize) -> Result<(), SceneError> {
        let checked = surface.shape.check_growth_at_one_of(times);
        checked.map_err(|why| self.bad_field(label, why))
    }

    /// Checks every number: cheap, for every frame of a scene that moves or was written in
    /// Rust. See [`Scene::check`] for what is checked once.
    ///
    /// # Errors
    /// [`SceneError::Empty`] without surfaces; [`SceneError::BadNumber`] for
    /// numbers that are not finite and for sizes and radii that are not positive.
    pub fn validate(&self) -> Result<(), SceneError> {
        if self.surfaces.is_empty() {
            return Err(SceneError::Empty {
                scene: self.name.clone(),
            });
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            self.validate_surface(&surface.label(index), surface)?;
        }
        self.validate_sound()
    }

    /// Checks as [`Scene::validate`] does, and each surface at every time of its key frames and at
    /// the thirtieths of a second between them.
    ///
    /// # Errors
    /// Errors of [`Scene::validate`]; [`SceneError::At`] for a value that is wrong only at a later
    /// time.
    pub fn validate_moving(&self) -> Result<(), SceneError> {
        self.validate()?;
        for (index, surface) in self.surfaces.iter().enumerate() {
            self.validate_work(&surface.label(index), surface)?;
        }
        self.at_checked_times(|scene, label, posed, _| scene.validate_pose(label, posed))
    }

    /// Checks that evaluating every node at every key takes seconds at most.
    fn validate_work(&self, label: &str, surface: &Surface) -> Result<(), SceneError> {
        let nodes = surface.nodes();
        let keys = surface.checked_times(0).len();
        if nodes * keys <= MOST_WORK {
            return Ok(());
        }
        let what = format!("{label}: times of its key frames (at a field of {nodes} nodes)");
        let must = "few enough that times × nodes are at most 3000000";
        Err(self.bad_number(&what, must, keys))
    }

    /// Checks each surface in its state at every sampled time; `check` receives the number of
    /// these times.
    fn at_checked_times(
        &self,
        check: impl Fn(&Scene, &str, &Surface, usize) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        let moves = |(_, surface): &(usize, &Surface)| !surface.drivers.is_empty();
        let moving = || self.surfaces.iter().enumerate().filter(moves);
        let nodes: usize = moving().map(|(_, surface)| surface.nodes()).sum();
        let most_between = (MOST_WORK_BETWEEN / nodes.max(1)).min(MOST_BETWEEN);
        for (index, surface) in moving() {
            let mut posed = surface.clone();
            let label = surface.label(index);
            let times = surface.checked_times(most_between);
            for &seconds in &times {
                posed.drive_to(seconds);
                check(self, &label, &posed, times.len()).map_err(|refused| refused.at(seconds))?;
            }
        }
        Ok(())
    }

    fn validate_surface(&self, label: &str, surface: &Surface) -> Result<(), SceneError> {
        self.validate_pose(label, surface)?;
        self.validate_drivers(label, surface)
    }

    /// Checks the current numbers.
    fn validate_pose(&self, label: &str, surface: &Surface) -> Result<(), SceneError> {
        self.finite(&format!("{label}: position"), surface.position)?;
        let rotation = surface.rotation;
        if !rotation.is_normalized() {
            let what = format!("{label}: rotation");
            return Err(self.bad_number(&what, "a unit quaternion", rotation));
        }
        let checked = surface.shape.validate();
        checked.map_err(|why| self.bad_field(label, why))
    }

    /// Checks that every driver drives an existing number and that its keys are in order.
    fn validate_drivers(&self, label: &str, surface: &Surface) -> Result<(), SceneError> {
        if surface.drivers.is_empty() {
            return Ok(());
        }
        let known = surface.parameter_names();
        for driver in &surface.drivers {
            if !known.contains(&driver.parameter) {
                return Err(SceneError::UnknownParameter {
                    scene: self.name.clone(),
                    surface: label.to_owned(),
                    parameter: driver.parameter.clone(),
                    known: {
                        let mut known: Vec<String> = known.into_iter().collect();
                        known.sort_unstable();
                        known.join(", ")
                    },
                });
            }
            let Motion::Keys(keys) = &driver.motion else {
                continue;
            };
            let increasing = keys.windows(2).all(|pair| pair[0].0 < pair[1].0);
            let finite = keys.iter().all(|(t, v)| t.is_finite() && v.is_finite());
            if keys.is_empty() || !increasing || !finite {
                let what = format!("{label}: the keys of {}", driver.parameter);
                let must = "finite, at least one, with times that increase";
                let value = format!("these {}", keys.len());
                return Err(self.bad_number(&what, must, value));
            }
        }
        Ok(())
    }

    fn bad_field(&self, label: &str, why: String) -> SceneError {
        let why = without_kind(label, why);
        SceneError::BadField {
            scene: self.name.clone(),
            surface: label.to_owned(),
            why,
        }
    }

    fn finite(&self, what: &str, value: Vec3) -> Result<(), SceneError> {
        if value.is_finite() && value.abs().max_element() <= LARGEST {
            return Ok(());
        }
        Err(self.bad_number(what, "finite and at most 1e9 in size", value))
    }

    fn positive(&self, what: &str, value: f32) -> Result<(), SceneError> {
        if value > 0.0 && value <= LARGEST {
            return Ok(());
        }
        Err(self.bad_number(what, "greater than 0 and at most 1e9", value))
    }

    fn bad_number(&self, what: &str, must: &'static str, value: impl fmt::Display) -> SceneError {
        SceneError::BadNumber {
            scene: self.name.clone(),
            what: what.to_owned(),
            must,
            value: value.to_string(),
        }
    }
}

impl Surface {
    /// Number of nodes in its tree.
    fn nodes(&self) -> usize {
        self.shape.nodes().len()
    }

    /// The name of the surface with this index (from 0) in messages.
    pub fn label(&self, index: usize) -> String {
        let number = index + 1;
        match &self.name {
            Some(name) => format!("surface {number} ({name})"),
            None => format!("surface {number} ({})", self.shape.name()),
        }
    }
}

/// The message about a user's field without the kind of the surface, which `label` already
/// contains: it begins with the field's file.
fn without_kind(label: &str, why: String) -> String {
    match why
        .strip_prefix("Field: ")
        .filter(|_| label.ends_with("(Field)"))
    {
        Some(rest) => rest.to_owned(),
        None => why,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cuboid, Room, Sphere};
    use crate::scene::{Listener, Node, Source};

    pub(super) fn room() -> Scene {
        Scene::new(
            "test",
            vec![Surface::new(Node::Room(Room {
                size: Vec3::splat(10.0),
            }))],
            Source::at(Vec3::X * 3.0),
            Listener::at(Vec3::ZERO, 1.0),
        )
    }

    /// Protects from numbers that would break a shader: they are refused.
    #[test]
    fn bad_numbers_are_refused() {
        assert!(room().validate().is_ok());
        let spoil: [fn(&mut Scene); 7] = [
            |s| s.surfaces.clear(),
            |s| {
                let size = Vec3::new(1.0, 0.0, 1.0);
                s.surfaces[0].shape = Node::Cuboid(Cuboid { size }).into();
            },
            |s| s.surfaces[0].shape = Node::Sphere(Sphere { radius: f32::NAN }).into(),
            |s| s.surfaces[0].position.x = f32::INFINITY,
            |s| s.source.position.y = f32::NAN,
            |s| s.listener.radius = 0.0,
            |s| s.listener.yaw = f32::INFINITY,
        ];
        for (index, spoil) in spoil.iter().enumerate() {
            let mut scene = room();
            spoil(&mut scene);
            assert!(scene.validate().is_err(), "case {index}");
        }
    }
}
