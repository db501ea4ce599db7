//! The surfaces, materials and air of a scene file.

use crate::bands::{BAND_COUNT, Bands};
use crate::scene::air::{HUMIDITIES, PRESSURES, TEMPERATURES};
use crate::scene::notation::{Angle, Attached, Metres, Name, ReadNumbers, Reader, Vector, checked};
use crate::scene::shape::Room;
use crate::scene::shape::ShapeFile;
use crate::scene::{Air, Material, SceneError, Surface};
use crate::text::nearest_or_all;
use glam::{EulerRot, Quat, Vec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;

#[derive(Deserialize)]
#[serde(rename = "Surface", deny_unknown_fields)]
pub(super) struct SurfaceFile {
    name: Option<Name>,
    shape: ShapeFile,
    #[serde(default)]
    position: Vector<Metres>,
    /// Right-handed rotations about the world's x, then y, then z axis.
    #[serde(default)]
    rotation: Vector<Angle>,
    #[serde(default)]
    turns: bool,
    material: Option<Name>,
    walls: Option<Walls<Name>>,
}

impl SurfaceFile {
    /// Converts the content of the file to a surface.
    ///
    /// # Errors
    /// The errors of the files that the surface names.
    pub fn read(self, files: &Attached) -> Result<Surface, SceneError> {
        let mut reader = Reader::new(files);
        let position = Vec3::read(self.position, "position", &mut reader);
        let angles = Vec3::read(self.rotation, "rotation", &mut reader);
        let turning = reader.moves("rotation.");
        let shape = self.shape.read(&mut reader)?;
        Ok(Surface {
            name: self.name.map(|name| name.0),
            shape,
            position,
            rotation: Quat::from_euler(EulerRot::XYZEx, angles.x, angles.y, angles.z),
            dynamic_rotation: self.turns || turning,
            angles: if turning { angles } else { Vec3::ZERO },
            drivers: reader.into_drivers(),
            material: self.material.map(|name| name.0),
            walls: self.walls.map(Walls::names).unwrap_or_default(),
        })
    }
}

/// Materials by name; names are unique.
#[derive(Default)]
pub struct Materials(pub BTreeMap<String, Material>);

#[derive(Deserialize)]
#[serde(rename = "Material", deny_unknown_fields)]
pub(super) struct MaterialFile {
    absorption: Option<Shares<false>>,
    scattering: Option<Shares<true>>,
    /// The material that supplies the values that are not given.
    #[serde(default)]
    base: Base,
}

/// A built-in material, given by name; a perfect mirror if no name is given.
#[derive(Default)]
struct Base(Material);

impl<'de> Deserialize<'de> for Base {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Base, D::Error> {
        let Name(name) = Name::deserialize(from)?;
        let material = Material::builtin(&name).ok_or_else(|| {
            let names = Material::BUILTIN.iter().map(|known| known.name);
            let all: Vec<&str> = names.collect();
            let refused = format!("there is no built-in material {name:?}");
            D::Error::custom(nearest_or_all(&refused, &name, &all))
        })?;
        Ok(Base(*material))
    }
}

impl MaterialFile {
    fn material(self) -> Material {
        let Base(base) = self.base;
        Material {
            absorption: self.absorption.map_or(base.absorption, |said| said.0),
            scattering: self.scattering.map_or(base.scattering, |said| said.0),
        }
    }
}

/// Values for individual walls of a room.
#[derive(Deserialize)]
#[serde(rename = "Walls", deny_unknown_fields, bound = "T: Deserialize<'de>")]
pub(super) struct Walls<T> {
    left: Option<T>,
    right: Option<T>,
    floor: Option<T>,
    ceiling: Option<T>,
    front: Option<T>,
    back: Option<T>,
}

impl<T> Walls<T> {
    /// In the order of [`Room::WALL_NAMES`](crate::scene::shape::Room::WALL_NAMES).
    pub fn into_array(self) -> [Option<T>; Room::WALL_COUNT] {
        [
            self.left,
            self.right,
            self.floor,
            self.ceiling,
            self.front,
            self.back,
        ]
    }
}

impl Walls<Name> {
    /// The names of the walls' materials.
    pub fn names(self) -> [Option<String>; Room::WALL_COUNT] {
        self.into_array().map(|name| name.map(|name| name.0))
    }
}

/// Shares of energy by octave band, given as one number or eight numbers. They are shares of the scattered energy if
/// `SCATTERED`, otherwise of the absorbed energy.
struct Shares<const SCATTERED: bool>(Bands);

/// A share, checked while it is read.
struct Share<const SCATTERED: bool>(f64);

const fn what(scattered: bool) -> &'static str {
    match scattered {
        true => "a scattering",
        false => "an absorption",
    }
}

impl<const SCATTERED: bool> Share<SCATTERED> {
    fn new<E: Error>(share: f64) -> Result<Self, E> {
        if (0.0..=1.0).contains(&share) {
            return Ok(Share(share));
        }
        let what = what(SCATTERED);
        Err(E::custom(format!("{what} must be 0 to 1, not {share}")))
    }
}

impl<'de, const SCATTERED: bool> Deserialize<'de> for Share<SCATTERED> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Share::new(f64::deserialize(from)?)
    }
}

impl<'de, const SCATTERED: bool> Deserialize<'de> for Shares<SCATTERED> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OneOrEight::<SCATTERED>)
    }
}

/// Reads a number, or eight numbers in brackets.
struct OneOrEight<const SCATTERED: bool>;

impl<const SCATTERED: bool> OneOrEight<SCATTERED> {
    fn all<E: Error>(share: f64) -> Result<Shares<SCATTERED>, E> {
        let Share(share) = Share::<SCATTERED>::new(share)?;
        Ok(Shares([share; BAND_COUNT]))
    }
}

impl<'de, const SCATTERED: bool> Visitor<'de> for OneOrEight<SCATTERED> {
    type Value = Shares<SCATTERED>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = what(SCATTERED);
        write!(
            f,
            "{what} as a number from 0 to 1 or eight of them in brackets (octave bands 63 Hz to 8 kHz)"
        )
    }

    fn visit_f64<E: Error>(self, share: f64) -> Result<Self::Value, E> {
        OneOrEight::all(share)
    }

    fn visit_u64<E: Error>(self, share: u64) -> Result<Self::Value, E> {
        OneOrEight::all(share as f64)
    }

    fn visit_i64<E: Error>(self, share: i64) -> Result<Self::Value, E> {
        OneOrEight::all(share as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut shares: A) -> Result<Self::Value, A::Error> {
        let mut bands = [0.0; BAND_COUNT];
        let mut count = 0;
        while let Some(Share(share)) = shares.next_element::<Share<SCATTERED>>()? {
            if let Some(band) = bands.get_mut(count) {
                *band = share;
            }
            count += 1;
        }
        if count == BAND_COUNT {
            return Ok(Shares(bands));
        }
        let what = what(SCATTERED);
        Err(A::Error::custom(format!(
            "{what} is one number or eight (octave bands 63 Hz to 8 kHz), not {count}"
        )))
    }
}

impl<'de> Deserialize<'de> for Materials {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Materials, D::Error> {
        from.deserialize_map(ByName)
    }
}

/// Reads a map from names to materials.
struct ByName;

impl<'de> Visitor<'de> for ByName {
    type Value = Materials;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("materials by their names, {\"name\": Material(…), …}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut said: A) -> Result<Materials, A::Error> {
        let mut materials = BTreeMap::new();
        while let Some(Name(name)) = said.next_key()? {
            if name.is_empty() {
                return Err(A::Error::custom("a material needs a name"));
            }
            if materials.contains_key(&name) {
                let why = format!("the material {name:?} is defined twice");
                return Err(A::Error::custom(why));
            }
            let said: MaterialFile = said.next_value()?;
            materials.insert(name, said.material());
        }
        Ok(Materials(materials))
    }
}

/// The air in a scene file; each value is optional.
#[derive(Deserialize)]
#[serde(rename = "Air", deny_unknown_fields)]
pub(super) struct AirFile {
    temperature: Option<Temperature>,
    humidity: Option<Humidity>,
    pressure: Option<Pressure>,
}

impl AirFile {
    /// Returns the previous or the default air, with the given values replaced.
    pub fn change(&self, before: Option<Air>) -> Air {
        let before = before.unwrap_or_default();
        Air {
            temperature: self.temperature.map_or(before.temperature, |said| said.0),
            humidity: self.humidity.map_or(before.humidity, |said| said.0),
            pressure: self.pressure.map_or(before.pressure, |said| said.0),
        }
    }
}

fn within(what: &str, range: &RangeInclusive<f64>, unit: &str, value: f64) -> Result<f64, String> {
    if range.contains(&value) {
        return Ok(value);
    }
    let (least, most) = (range.start(), range.end());
    Err(format!(
        "{what} must be {least} to {most} {unit}, not {value}"
    ))
}

checked! {
    /// Degrees Celsius.
    #[derive(Clone, Copy)]
    Temperature(f64) from f64: |value| within("the air's temperature", &TEMPERATURES, "°C", value);
    /// Relative humidity in per cent.
    #[derive(Clone, Copy)]
    Humidity(f64) from f64: |value| within("the air's humidity", &HUMIDITIES, "%", value);
    /// Kilopascals.
    #[derive(Clone, Copy)]
    Pressure(f64) from f64: |value| within("the air's pressure", &PRESSURES, "kPa", value);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn material(said: &str) -> Result<Material, String> {
        let text = format!(
            "Scene(surfaces: [Surface(shape: Plane, material: \"own\")], materials: {{\"own\": {said}}}, \
             source: Source(position: (0, 1, 0)), listener: Listener(position: (5, 2, 0), radius: 1))"
        );
        let scene = Scene::from_ron(&text, "scene").map_err(|refused| refused.to_string())?;
        Ok(scene.materials["own"])
    }

    /// Protects the `base` of a material: given values are used, and the base supplies all others.
    #[test]
    fn a_base_says_what_is_left_out() {
        let brick = Material::builtin("brick").expect("a built-in material");
        let rough = material("Material(base: \"brick\", scattering: 0.3)");
        assert_eq!(rough, Ok(brick.scattering_by(0.3)));
        let hard = material("Material(base: \"brick\", absorption: 0)");
        assert_eq!(hard, Ok(Material::MIRROR));
        assert_eq!(material("Material()"), Ok(Material::MIRROR));
        let refused = material("Material(base: \"brik\")").unwrap_err();
        assert!(
            refused.contains("there is no built-in material \"brik\"; did you mean brick?"),
            "{refused}"
        );
    }
}
