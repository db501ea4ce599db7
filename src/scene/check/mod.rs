//! Checks of a scene: errors if it cannot be traced, warnings if it is unusual.

mod placement;
#[cfg(test)]
mod tests;
mod units;
mod warnings;

use super::air::{HUMIDITIES, PRESSURES, TEMPERATURES};
use super::directivity::OMNI_SHARES;
use super::shape::{LARGEST, Rooms};
use super::{
    Directivity, Listener, Material, MaterialDriver, Motion, Path, Scene, SceneError, Source,
    Surface, Transmission,
};
use crate::bands::BAND_COUNT;
use crate::text::nearest_or_all;
use glam::Vec3;
use std::collections::HashSet;
use std::fmt;
use std::ops::RangeInclusive;

/// Maximum product of the number of a surface's key-frame times and the number of nodes of its field. Checking each
/// node at each time then takes a few seconds.
const MOST_WORK: usize = 3_000_000;

/// Maximum product of the number of nodes in all moving surfaces and the number of checked times between key frames.
/// Checking each node at each of these times takes less than a second.
const MOST_WORK_BETWEEN: usize = 300_000;

/// Maximum number of checked frames between the first and the last key: 90 s at 30 frames per second.
const MOST_BETWEEN: usize = 2700;

/// Range of a source's level relative to other sources, in decibels. It is wider than the range from the threshold of
/// hearing to the threshold of pain.
pub(super) const LEVELS: RangeInclusive<f32> = -120.0..=120.0;

/// Maximum number of a scene's sources, and maximum number of its listeners. Each pair of a source and a listener is
/// checked and traced as a separate sound.
pub(super) const MOST_PLACED: usize = 256;

impl Scene {
    /// Checks the scene like [`Scene::validate_moving`], and every field like `Shape::check`, which takes a few
    /// milliseconds for each field that states its Lipschitz constant. This check runs when a scene file is read, and
    /// when a tracer gets a new structure. The tracer compiles the text of users' fields later.
    ///
    /// # Errors
    /// The errors of [`Scene::validate_moving`].
    pub fn check(&self) -> Result<(), SceneError> {
        self.validate_moving()?;
        for (index, surface) in self.surfaces.iter().enumerate() {
            let checked = surface.shape.check();
            checked.map_err(|why| self.bad_field(&surface.label(index), why))?;
        }
        // If there are many times, fewer points are evaluated at each time.
        self.at_checked_times(|scene, label, posed, times| {
            let checked = posed.shape.check_growth_at_one_of(times);
            checked.map_err(|why| scene.bad_field(label, why))
        })
    }

    /// Checks every number. This check is fast enough to run in every frame of a scene that moves or was written in
    /// Rust. [`Scene::check`] contains the checks that need to run only once.
    ///
    /// # Errors
    /// [`SceneError::Empty`] without surfaces; [`SceneError::BadNumber`] for numbers that are not finite, and for sizes
    /// and radii that are not positive.
    pub fn validate(&self) -> Result<(), SceneError> {
        if self.surfaces.is_empty() {
            return Err(SceneError::Empty {
                scene: self.name.clone(),
            });
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            let label = surface.label(index);
            self.validate_pose(&label, surface)?;
            self.validate_drivers(&label, surface)?;
        }
        self.validate_sound()
    }

    /// Checks the scene like [`Scene::validate`], and each surface at all its key frames and every thirtieth of a
    /// second between them.
    ///
    /// # Errors
    /// The errors of [`Scene::validate`]; [`SceneError::At`] for a value that is invalid at a later time only.
    pub fn validate_moving(&self) -> Result<(), SceneError> {
        self.validate()?;
        for (index, surface) in self.surfaces.iter().enumerate() {
            self.validate_work(&surface.label(index), surface)?;
        }
        self.at_checked_times(|scene, label, posed, _| scene.validate_pose(label, posed))
    }

    /// Checks that evaluating every node at every key frame takes at most a few seconds.
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

    /// Calls `check` for each moving surface, in its state at each checked time. `check` also receives the number of
    /// checked times.
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

    /// Checks the position, the rotation and the shape in their current state.
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

    /// Checks that every driver sets an existing number, and that its keys are in order.
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
                        known
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
        // The label of a user's field already contains its kind.
        let why = match why.strip_prefix("Field: ") {
            Some(rest) if label.ends_with("(Field)") => rest.to_owned(),
            _ => why,
        };
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

    pub(super) fn bad_number(
        &self,
        what: &str,
        must: &'static str,
        value: impl fmt::Display,
    ) -> SceneError {
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
}

impl Scene {
    /// Checks everything except the surfaces' shapes and positions.
    fn validate_sound(&self) -> Result<(), SceneError> {
        self.few_enough("sources", self.sources.len())?;
        self.few_enough("listeners", self.listeners.len())?;
        for (index, source) in self.sources.iter().enumerate() {
            self.validate_source(&self.source_label(index), source)?;
        }
        for (index, listener) in self.listeners.iter().enumerate() {
            self.validate_listener(&self.listener_label(index), listener)?;
        }
        self.validate_names("sources", self.sources.iter().map(|source| &source.name))?;
        let listeners = self.listeners.iter().map(|listener| &listener.name);
        self.validate_names("listeners", listeners)?;
        self.validate_air()?;
        self.validate_value_ranges()?;
        if let Some(share) = self
            .scattering
            .iter()
            .find(|share| !(0.0..=1.0).contains(*share))
        {
            return Err(self.bad_number("the scattering of the scene", "0 to 1", share));
        }
        for (name, material) in &self.materials {
            self.validate_material(name, material)?;
        }
        for driver in &self.material_drivers {
            self.validate_material_driver(driver)?;
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            self.validate_material_names(index, surface)?;
        }
        Ok(())
    }

    /// Checks that a driver sets an existing number.
    fn validate_material_driver(&self, driver: &MaterialDriver) -> Result<(), SceneError> {
        let what = |of: &str| format!("{of} that the value {:?} sets", driver.value);
        if !self.materials.contains_key(&driver.material) {
            let must = "a material of the scene";
            return Err(self.bad_number(&what("the material"), must, &driver.material));
        }
        if driver.value.is_empty() {
            let what = "the name of a value of a material";
            return Err(self.bad_number(what, "not empty", "\"\""));
        }
        match driver.band {
            Some(band) if band >= BAND_COUNT => {
                Err(self.bad_number(&what("the index of the octave band"), "0 to 7", band))
            }
            _ => Ok(()),
        }
    }

    fn few_enough(&self, what: &str, count: usize) -> Result<(), SceneError> {
        if count <= MOST_PLACED {
            return Ok(());
        }
        Err(self.bad_number(&format!("the number of its {what}"), "at most 256", count))
    }

    fn validate_source(&self, label: &str, source: &Source) -> Result<(), SceneError> {
        self.finite(&format!("{label}'s position"), source.position)?;
        let axis = Vec3::new(source.yaw, source.pitch, 0.0);
        self.finite(&format!("{label}'s yaw and pitch"), axis)?;
        self.validate_path(&source.path)?;
        self.validate_directivity(label, &source.directivity)?;
        if LEVELS.contains(&source.level_db) {
            return Ok(());
        }
        let what = format!("{label}'s level in decibels");
        Err(self.bad_number(&what, "-120 to 120", source.level_db))
    }

    fn validate_directivity(
        &self,
        label: &str,
        directivity: &Directivity,
    ) -> Result<(), SceneError> {
        let Directivity::FirstOrder(shares) = directivity else {
            return Ok(());
        };
        match shares.iter().find(|share| !OMNI_SHARES.contains(*share)) {
            None => Ok(()),
            Some(share) => {
                let what = format!("the omnidirectional share of {label}'s directivity");
                Err(self.bad_number(&what, "0 to 1", share))
            }
        }
    }

    fn validate_listener(&self, label: &str, listener: &Listener) -> Result<(), SceneError> {
        self.finite(&format!("{label}'s position"), listener.position)?;
        let gaze = Vec3::new(listener.yaw, listener.pitch, 0.0);
        self.finite(&format!("{label}'s yaw and pitch"), gaze)?;
        self.positive(&format!("{label}'s radius in metres"), listener.radius)?;
        self.validate_path(&listener.path)
    }

    fn validate_path(&self, path: &Path) -> Result<(), SceneError> {
        for key in path.keys() {
            self.finite("a path's position", key.position)?;
            let turn_and_time = Vec3::new(key.yaw, key.pitch, key.time as f32);
            self.finite("a path's yaw, pitch and time", turn_and_time)?;
        }
        Ok(())
    }

    /// Checks that all names are unique.
    fn validate_names<'a>(
        &self,
        what: &'static str,
        names: impl Iterator<Item = &'a Option<String>>,
    ) -> Result<(), SceneError> {
        let names: Vec<Option<&String>> = names.map(Option::as_ref).collect();
        let scene = self.name.clone();
        if let Some(name) = number_of_another(&names) {
            let name = name.clone();
            return Err(SceneError::NameIsNumber { scene, what, name });
        }
        match twice(names.into_iter()) {
            None => Ok(()),
            Some(name) => Err(SceneError::SameName {
                scene,
                what,
                name: name.clone(),
            }),
        }
    }

    fn validate_air(&self) -> Result<(), SceneError> {
        let Some(air) = self.air else {
            return Ok(());
        };
        for (what, value, range, must) in [
            (
                "temperature in degrees Celsius",
                air.temperature,
                TEMPERATURES,
                "-20 to 50",
            ),
            ("humidity in per cent", air.humidity, HUMIDITIES, "0 to 100"),
            (
                "pressure in kilopascals",
                air.pressure,
                PRESSURES,
                "50 to 200",
            ),
        ] {
            if !range.contains(&value) {
                return Err(self.bad_number(&format!("the air's {what}"), must, value));
            }
        }
        Ok(())
    }

    fn validate_material(&self, name: &str, material: &Material) -> Result<(), SceneError> {
        let parts = [
            ("absorption", &material.absorption),
            ("scattering", &material.scattering),
        ];
        for (part, bands) in parts {
            if let Some(share) = bands.iter().find(|share| !(0.0..=1.0).contains(*share)) {
                let what = format!("the {part} of the material {name:?}");
                return Err(self.bad_number(&what, "0 to 1", share));
            }
        }
        let transmission = material.transmission.as_ref();
        match transmission.and_then(Transmission::bad_number) {
            None => Ok(()),
            Some((part, must, value)) => {
                let what = format!("the {part} of the material {name:?}");
                Err(self.bad_number(&what, must, value))
            }
        }
    }

    /// Checks that every material named by the surface exists, and that only rooms have wall materials.
    fn validate_material_names(&self, index: usize, surface: &Surface) -> Result<(), SceneError> {
        for name in surface.material_names() {
            self.find_material(name)
                .map_err(|why| self.bad_field(&surface.label(index), why))?;
        }
        if !surface.takes_walls() && surface.walls.iter().any(Option::is_some) {
            return Err(self.bad_field(&surface.label(index), NOT_A_ROOM.to_owned()));
        }
        match no_such_group(surface) {
            Some((_, why)) => Err(self.bad_field(&surface.label(index), why)),
            None => Ok(()),
        }
    }
}

/// The name of faces that the surface lacks but that have a material, and the error message, if there are any.
pub(super) fn no_such_group(surface: &Surface) -> Option<(&str, String)> {
    if let Some(rooms) = surface.rooms() {
        return no_such_wall(surface, rooms);
    }
    let groups = surface.shape.mesh().map_or(&[][..], |mesh| mesh.groups());
    let unknown = surface.faces.keys().find(|name| !groups.contains(name))?;
    if groups.is_empty() {
        return Some((unknown, NOT_A_MESH.to_owned()));
    }
    let all: Vec<&str> = groups.iter().map(String::as_str).collect();
    let refused = format!("the mesh has no faces of the material {unknown:?}");
    Some((unknown, nearest_or_all(&refused, unknown, &all)))
}

/// The name of a box or wall that rooms lack but that has a material, and the error message, if there are any.
fn no_such_wall<'a>(surface: &'a Surface, rooms: &Rooms) -> Option<(&'a str, String)> {
    let has = |group: &usize| rooms.has_faces(*group);
    let walls = (0..surface.part_count()).filter(has);
    let walls = walls.filter_map(|group| surface.group_name(group).map(str::to_owned));
    let all: Vec<String> = rooms.names().chain(walls).collect();
    let unknown = surface.faces.keys().find(|name| !all.contains(name))?;
    if (0..surface.part_count()).any(|group| surface.group_name(group) == Some(unknown)) {
        let why = format!(
            "the wall {unknown:?} of the rooms is open to other boxes as a whole, and takes no material"
        );
        return Some((unknown, why));
    }
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    let refused = format!("the rooms have no box and no wall {unknown:?}");
    Some((unknown, nearest_or_all(&refused, unknown, &all)))
}

/// The error message for materials of faces of a shape that is not a mesh.
const NOT_A_MESH: &str = "only the faces of a Mesh and the walls of Rooms have materials by names";

/// The error message for wall materials of a shape that is not a room.
pub(super) const NOT_A_ROOM: &str =
    "only the walls of a Room or of Rooms have materials of their own";

/// The first name that occurs twice.
pub(super) fn twice<'a>(names: impl Iterator<Item = Option<&'a String>>) -> Option<&'a String> {
    let mut known = HashSet::new();
    names.flatten().find(|name| !known.insert(*name))
}

/// Finds a name that equals the number of an unnamed source or listener. Reports use this number as a name.
fn number_of_another<'a>(names: &[Option<&'a String>]) -> Option<&'a String> {
    let is_of_another = |(index, name): &(usize, &'a String)| {
        let other = name.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        other.is_some_and(|other| other != *index && names.get(other) == Some(&None))
    };
    let named = names.iter().enumerate();
    let mut named = named.filter_map(|(index, name)| Some((index, (*name)?)));
    named.find(is_of_another).map(|(_, name)| name)
}
