//! The surfaces, materials and air of a scene file.

use super::per_band::{Absorption, NamedBand, OfBands, Reduction, Scattering};
use crate::bands::Bands;
use crate::scene::air::{HUMIDITIES, PRESSURES, TEMPERATURES};
use crate::scene::notation::{Angle, Attached, Metres, Name, ReadNumbers, Reader, Vector, checked};
use crate::scene::shape::Room;
use crate::scene::shape::ShapeFile;
use crate::scene::transmission::{COINCIDENCES, DENSITIES, THICKNESSES_M};
use crate::scene::{
    Air, Material, MaterialDriver, MaterialNumber, SceneError, Surface, Transmission,
};
use crate::text::nearest_or_all;
use glam::{EulerRot, Quat, Vec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
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
    /// For a mesh: materials by the names of its groups of faces.
    #[serde(default)]
    faces: BTreeMap<String, Name>,
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
            faces: {
                let faces = self.faces.into_iter();
                faces.map(|(group, name)| (group, name.0)).collect()
            },
        })
    }
}

/// Materials by name; names are unique.
#[derive(Default)]
pub struct Materials(BTreeMap<String, ReadMaterial>);

#[derive(Clone)]
struct ReadMaterial {
    material: Material,
    /// The named values of its numbers.
    drivers: Vec<MaterialDriver>,
    /// Whether the file states the scattering of this material.
    states_scattering: bool,
}

impl Materials {
    /// The names of the materials.
    pub fn names(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    /// The named values of the materials' numbers.
    pub fn drivers(&self) -> Vec<MaterialDriver> {
        let drivers = self.0.values().flat_map(|read| &read.drivers);
        drivers.cloned().collect()
    }

    /// The materials. Those that state no scattering have the scattering of the scene.
    pub fn scattering_by(
        &self,
        of_scene: Bands,
    ) -> impl Iterator<Item = (String, Material)> + use<'_> {
        self.0.iter().map(move |(name, read)| {
            let material = match read.states_scattering {
                true => read.material,
                false => read.material.scattering_by(of_scene),
            };
            (name.clone(), material)
        })
    }
}

#[derive(Deserialize)]
#[serde(rename = "Material", deny_unknown_fields)]
pub(super) struct MaterialFile {
    absorption: Option<OfBands<Absorption>>,
    scattering: Option<OfBands<Scattering>>,
    reduction: Option<OfBands<Reduction>>,
    thickness: Option<Thickness>,
    density: Option<Density>,
    coincidence: Option<Coincidence>,
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
    /// The named values of the numbers of this material.
    fn drivers(&self, material: &str) -> Vec<MaterialDriver> {
        let absorption = self.absorption.iter().flat_map(|said| &said.named);
        let scattering = self.scattering.iter().flat_map(|said| &said.named);
        let absorption = absorption.map(|named| (MaterialNumber::Absorption, named));
        let scattering = scattering.map(|named| (MaterialNumber::Scattering, named));
        let driver = |(number, named): (MaterialNumber, &NamedBand)| MaterialDriver {
            material: material.to_owned(),
            number,
            band: named.band,
            value: named.value.clone(),
        };
        absorption.chain(scattering).map(driver).collect()
    }

    /// The material, or the reason why its fields contradict each other.
    fn material(self) -> Result<Material, &'static str> {
        let transmission = self.transmission()?;
        let Base(base) = self.base;
        Ok(Material {
            absorption: self.absorption.map_or(base.absorption, |said| said.bands),
            scattering: self.scattering.map_or(base.scattering, |said| said.bands),
            transmission,
        })
    }

    fn transmission(&self) -> Result<Option<Transmission>, &'static str> {
        let base = self.base.0.transmission;
        let coincidence = self.coincidence.map(|said| said.0);
        let density = match (&self.density, base) {
            (Some(said), _) => Some(said.0),
            (None, Some(Transmission::Mass { density, .. })) => Some(density),
            _ => None,
        };
        match (&self.reduction, self.thickness) {
            (Some(_), _) if self.density.is_some() || coincidence.is_some() => {
                Err("has either a reduction or a density, not both")
            }
            (Some(_), None) => Err("has a reduction, but no thickness to which it belongs"),
            (None, Some(_)) => Err("has a thickness, but no reduction that belongs to it"),
            (Some(index_db), Some(thickness)) => {
                Ok(Some(Transmission::reduced_by(index_db.bands, thickness.0)))
            }
            (None, None) if self.density.is_none() && coincidence.is_none() => Ok(base),
            (None, None) => {
                let density = density.ok_or("has a coincidence, but no density")?;
                Ok(Some(Transmission::Mass {
                    density,
                    coincidence,
                }))
            }
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
            let states_scattering = said.scattering.is_some();
            let drivers = said.drivers(&name);
            let material = said.material().map_err(|why| {
                let why = format!("the material {name:?} {why}");
                A::Error::custom(why)
            })?;
            let read = ReadMaterial {
                material,
                drivers,
                states_scattering,
            };
            materials.insert(name, read);
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
    /// Metres.
    #[derive(Clone, Copy)]
    Thickness(f64) from f64: |value| within("a thickness", &THICKNESSES_M, "m", value);
    /// Kilograms per cubic metre.
    #[derive(Clone, Copy)]
    Density(f64) from f64: |value| within("a density", &DENSITIES, "kg/m³", value);
    /// Metres times hertz.
    #[derive(Clone, Copy)]
    Coincidence(f64) from f64: |value| within("a coincidence", &COINCIDENCES, "m·Hz", value);
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

    /// Protects the fields for transmission: each has its own meaning, the base supplies the density, and a coincidence
    /// of the material itself takes the place of that of the base.
    #[test]
    fn transmission_is_a_reduction_or_a_density() {
        let transmission = |said: &str| {
            let material = material(&format!("Material({said})"));
            material.map(|material| material.transmission)
        };
        let measured = Transmission::reduced_by(35.0, 0.1);
        assert_eq!(
            transmission("reduction: 35, thickness: 0.1"),
            Ok(Some(measured))
        );
        let heavy = |density, coincidence| Transmission::Mass {
            density,
            coincidence,
        };
        for (said, expected) in [
            ("density: 1800", heavy(1800.0, None)),
            ("density: 1800, coincidence: 20", heavy(1800.0, Some(20.0))),
            ("base: \"glass\"", heavy(2500.0, Some(12.7))),
            (
                "base: \"glass\", coincidence: 15",
                heavy(2500.0, Some(15.0)),
            ),
            ("base: \"glass\", density: 2400", heavy(2400.0, None)),
            ("base: \"glass\", reduction: 35, thickness: 0.1", measured),
        ] {
            assert_eq!(transmission(said), Ok(Some(expected)), "{said}");
        }
        assert_eq!(transmission("absorption: 0.1"), Ok(None));
        for (said, why) in [
            ("reduction: 35", "no thickness to which it belongs"),
            ("thickness: 0.1", "no reduction that belongs to it"),
            ("coincidence: 20", "has a coincidence, but no density"),
            ("reduction: 35, thickness: 0.1, density: 1", "not both"),
            ("reduction: 35, thickness: 0.1, coincidence: 20", "not both"),
            (
                "reduction: -1, thickness: 0.1",
                "must be 0 to 200 dB, not -1",
            ),
            ("reduction: [35], thickness: 0.1", "is one number or eight"),
            (
                "reduction: 35, thickness: 0",
                "must be 0.00001 to 100 m, not 0",
            ),
            ("density: NaN", "must be 1 to 25000 kg/m³, not NaN"),
            (
                "density: 1800, coincidence: 0",
                "must be 1 to 1000 m·Hz, not 0",
            ),
        ] {
            let refused = transmission(said).unwrap_err();
            assert!(refused.contains(why), "{said}: {refused}");
        }
    }
}
