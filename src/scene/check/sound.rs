//! Checks of a scene's sound data: sources and listeners, materials, air.

use crate::scene::air::{HUMIDITIES, PRESSURES, TEMPERATURES};
use crate::scene::{
    BUILTIN_MATERIALS, Listener, Material, Path, Scene, SceneError, Source, Surface,
};
use crate::text::nearest_or_all;
use glam::Vec3;
use std::collections::HashSet;
use std::ops::RangeInclusive;

/// Level of a source relative to others in decibels: a wider range than from the softest audible
/// sound to pain.
pub(crate) const LEVELS: RangeInclusive<f32> = -120.0..=120.0;

/// Maximum number of a scene's sources, and of its listeners: each pair of them is checked, and
/// traced as a sound of its own.
pub(crate) const MOST_PLACED: usize = 256;

impl Scene {
    /// Checks everything except the surfaces' shapes and positions.
    pub(super) fn validate_sound(&self) -> Result<(), SceneError> {
        self.few_enough("sources", 1 + self.further_sources.len())?;
        self.few_enough("listeners", 1 + self.further_listeners.len())?;
        for (index, source) in self.sources().enumerate() {
            self.validate_source(&self.source_label(index), source)?;
        }
        for (index, listener) in self.listeners().enumerate() {
            self.validate_listener(&self.listener_label(index), listener)?;
        }
        self.validate_names("sources", self.sources().map(|source| &source.name))?;
        let listeners = self.listeners().map(|listener| &listener.name);
        self.validate_names("listeners", listeners)?;
        self.validate_air()?;
        for (name, material) in &self.materials {
            self.validate_material(name, material)?;
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            self.validate_material_names(index, surface)?;
        }
        Ok(())
    }

    fn few_enough(&self, what: &str, count: usize) -> Result<(), SceneError> {
        if count <= MOST_PLACED {
            return Ok(());
        }
        Err(self.bad_number(&format!("the number of its {what}"), "at most 256", count))
    }

    fn validate_source(&self, label: &str, source: &Source) -> Result<(), SceneError> {
        self.finite(&format!("{label}'s position"), source.position)?;
        self.validate_path(&source.path)?;
        if LEVELS.contains(&source.level_db) {
            return Ok(());
        }
        let what = format!("{label}'s level in decibels");
        Err(self.bad_number(&what, "-120 to 120", source.level_db))
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

    /// Checks that each name is used once.
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
        if !TEMPERATURES.contains(&air.temperature) {
            let what = "the air's temperature in degrees Celsius";
            return Err(self.bad_number(what, "-20 to 50", air.temperature));
        }
        if !HUMIDITIES.contains(&air.humidity) {
            let what = "the air's humidity in per cent";
            return Err(self.bad_number(what, "0 to 100", air.humidity));
        }
        if !PRESSURES.contains(&air.pressure) {
            let what = "the air's pressure in kilopascals";
            return Err(self.bad_number(what, "50 to 200", air.pressure));
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
        Ok(())
    }

    /// Checks that every material named by the surface exists, and that only a room has materials
    /// of walls.
    fn validate_material_names(&self, index: usize, surface: &Surface) -> Result<(), SceneError> {
        for name in surface.material_names() {
            self.find_material(name)
                .map_err(|why| self.bad_field(&surface.label(index), why))?;
        }
        if surface.has_walls() || surface.walls.iter().all(Option::is_none) {
            return Ok(());
        }
        Err(self.bad_field(&surface.label(index), NOT_A_ROOM.to_owned()))
    }

    /// The material of this name, or the message that there is none.
    pub(in crate::scene) fn find_material(&self, name: &str) -> Result<&Material, String> {
        self.material_named(name).ok_or_else(|| {
            let mut all: Vec<&str> = self.materials.keys().map(String::as_str).collect();
            let built_in = BUILTIN_MATERIALS.iter().map(|known| known.name);
            all.extend(built_in.filter(|name| !self.materials.contains_key(*name)));
            nearest_or_all(&format!("there is no material {name:?}"), name, &all)
        })
    }

    /// The name of the source with this index (from 0) in messages.
    pub(super) fn source_label(&self, index: usize) -> String {
        let count = 1 + self.further_sources.len();
        let name = self.sources().nth(index).and_then(|s| s.name.as_deref());
        label("source", index, count, name)
    }

    /// The name of the listener with this index (from 0) in messages.
    pub(super) fn listener_label(&self, index: usize) -> String {
        let count = 1 + self.further_listeners.len();
        let name = self.listeners().nth(index).and_then(|l| l.name.as_deref());
        label("listener", index, count, name)
    }
}

/// Message where another shape than a room has materials of walls.
pub(in crate::scene) const NOT_A_ROOM: &str =
    "only the walls of a Room have materials of their own";

/// The first name that occurs twice.
pub(in crate::scene) fn twice<'a>(
    names: impl Iterator<Item = Option<&'a String>>,
) -> Option<&'a String> {
    let mut known = HashSet::new();
    names.flatten().find(|name| !known.insert(*name))
}

/// A name that is the number of an unnamed one, which is called by its number.
fn number_of_another<'a>(names: &[Option<&'a String>]) -> Option<&'a String> {
    let is_of_another = |(index, name): &(usize, &'a String)| {
        let other = name.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        other.is_some_and(|other| other != *index && names.get(other) == Some(&None))
    };
    let named = names.iter().enumerate();
    let mut named = named.filter_map(|(index, name)| Some((index, (*name)?)));
    named.find(is_of_another).map(|(_, name)| name)
}

fn label(what: &str, index: usize, count: usize, name: Option<&str>) -> String {
    match (name, count) {
        (None, 1) => format!("the {what}"),
        (None, _) => format!("{what} {}", index + 1),
        (Some(name), 1) => format!("the {what} ({name})"),
        (Some(name), _) => format!("{what} {} ({name})", index + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Air;
    use crate::scene::shape::{Room, Sphere};

    fn hall() -> Scene {
        let room = Surface::new(Room {
            size: Vec3::splat(9.0),
        });
        let (source, listener) = (Source::at(Vec3::X), Listener::at(Vec3::Y, 0.3));
        let mut scene = Scene::new("hall", vec![room.with_material("own")], source, listener);
        let own = Material::absorbing(0.5);
        scene.materials.insert("own".into(), own);
        scene.further_sources.push(Source::at(Vec3::Z));
        scene.further_listeners.push(Listener::at(-Vec3::Z, 0.3));
        scene.air = Some(Air::default());
        scene
    }

    /// Names in messages: a single one has no number, one of several has.
    #[test]
    fn one_of_several_is_called_by_its_number() {
        let mut scene = hall();
        scene.further_listeners[0].name = Some("seat".to_owned());
        let labels = |scene: &Scene| [scene.source_label(0), scene.listener_label(0)];
        assert_eq!(labels(&scene), ["source 1", "listener 1"]);
        assert_eq!(scene.listener_label(1), "listener 2 (seat)");
        scene.further_sources.clear();
        scene.further_listeners.clear();
        assert_eq!(labels(&scene), ["the source", "the listener"]);
    }

    /// Numbers are unambiguous: no name is the number of an unnamed one.
    #[test]
    fn no_name_is_the_number_of_another() {
        let named = |first: Option<&str>, second: Option<&str>| {
            let mut scene = hall();
            scene.source.name = first.map(str::to_owned);
            scene.further_sources[0].name = second.map(str::to_owned);
            scene.validate().map_err(|refused| refused.to_string())
        };
        for (first, second) in [(Some("2"), None), (None, Some("1"))] {
            let told = named(first, second).unwrap_err();
            assert!(told.contains("one of the sources is called"), "{told}");
        }
        for (first, second) in [
            (Some("1"), None),
            (Some("2"), Some("1")),
            (Some("3"), None),
            (None, Some("flute")),
        ] {
            assert_eq!(named(first, second), Ok(()), "{first:?}, {second:?}");
        }
    }

    /// Invalid shares, air and sources are reported by name.
    #[test]
    fn bad_sound_is_refused_by_its_name() {
        hall().validate().unwrap();
        type Spoil = fn(&mut Scene);
        let cases: [(Spoil, &str); 13] = [
            (
                |s| s.further_sources = vec![Source::at(Vec3::Z); 256],
                "the number of its sources must be at most 256, not 257",
            ),
            (
                |s| s.further_sources[0].position.x = f32::NAN,
                "source 2's position must be finite",
            ),
            (
                |s| s.source.level_db = 121.0,
                "source 1's level in decibels must be -120 to 120, not 121",
            ),
            (
                |s| s.further_listeners[0].radius = 0.0,
                "listener 2's radius in metres must be greater than 0",
            ),
            (
                |s| {
                    s.air = Some(Air {
                        temperature: 60.0,
                        ..Air::default()
                    })
                },
                "the air's temperature in degrees Celsius must be -20 to 50, not 60",
            ),
            (
                |s| {
                    s.air = Some(Air {
                        humidity: f64::NAN,
                        ..Air::default()
                    })
                },
                "the air's humidity in per cent must be 0 to 100, not NaN",
            ),
            (
                |s| {
                    s.air = Some(Air {
                        pressure: 0.0,
                        ..Air::default()
                    })
                },
                "the air's pressure in kilopascals must be 50 to 200, not 0",
            ),
            (
                |s| {
                    s.materials.insert("own".into(), Material::absorbing(1.5));
                },
                "the absorption of the material \"own\" must be 0 to 1, not 1.5",
            ),
            (
                |s| {
                    let scatters = Material::MIRROR.scattering_by(f64::NAN);
                    s.materials.insert("own".into(), scatters);
                },
                "the scattering of the material \"own\" must be 0 to 1, not NaN",
            ),
            (
                |s| s.surfaces[0].material = Some("carpt".into()),
                "surface 1 (Room): there is no material \"carpt\"; did you mean carpet?",
            ),
            (
                |s| s.surfaces[0].walls[5] = Some("owm".into()),
                "there is no material \"owm\"; did you mean own?",
            ),
            (
                |s| {
                    s.surfaces[0].shape = Sphere { radius: 20.0 }.into();
                    s.surfaces[0].walls[2] = Some("own".into());
                },
                "surface 1 (Sphere): only the walls of a Room have materials of their own",
            ),
            (
                |s| {
                    s.source.name = Some("flute".into());
                    s.further_sources[0].name = Some("flute".into());
                },
                "scene \"hall\": two of the sources are called \"flute\"",
            ),
        ];
        for (spoil, says) in cases {
            let mut scene = hall();
            spoil(&mut scene);
            let told = scene.validate().unwrap_err().to_string();
            assert!(told.contains(says), "{told}");
        }
    }
}
