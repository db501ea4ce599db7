//! Named values that set numbers of materials: `absorption: Value("alpha", 0.1)`.

use super::{Material, NamedValue, Quantity, Scene};
use crate::bands::Bands;
use std::collections::BTreeMap;

/// Sets a number of one of a scene's materials by a named value.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDriver {
    /// Name of the material in [`Scene::materials`].
    pub material: String,
    /// The number.
    pub number: MaterialNumber,
    /// Index of the octave band; `None` for all bands.
    pub band: Option<usize>,
    /// Name of the value; see [`Scene::set_value`].
    pub value: String,
}

/// A number of a material that a named value can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MaterialNumber {
    /// [`Material::absorption`].
    Absorption,
    /// [`Material::scattering`].
    Scattering,
}

impl MaterialNumber {
    pub(super) fn of(self, material: &Material) -> &Bands {
        match self {
            MaterialNumber::Absorption => &material.absorption,
            MaterialNumber::Scattering => &material.scattering,
        }
    }

    fn of_mut(self, material: &mut Material) -> &mut Bands {
        match self {
            MaterialNumber::Absorption => &mut material.absorption,
            MaterialNumber::Scattering => &mut material.scattering,
        }
    }
}

impl Scene {
    /// Sets the numbers of materials that these values drive.
    pub(super) fn drive_materials(&mut self, values: &BTreeMap<String, f32>) {
        for driver in &self.material_drivers {
            let material = self.materials.get_mut(&driver.material);
            let (Some(material), Some(value)) = (material, values.get(&driver.value)) else {
                continue;
            };
            let bands = driver.number.of_mut(material);
            let driven = match driver.band {
                None => &mut bands[..],
                Some(band) => bands.get_mut(band..=band).unwrap_or_default(),
            };
            driven.fill(as_written(*value));
        }
    }

    /// The values that set numbers of materials, one for each driver.
    pub(super) fn values_of_materials(&self) -> impl Iterator<Item = NamedValue> {
        self.material_drivers.iter().filter_map(|driver| {
            let material = self.materials.get(&driver.material)?;
            let share = driver.number.of(material).get(driver.band.unwrap_or(0))?;
            Some(NamedValue {
                name: driver.value.clone(),
                value: *share as f32,
                quantity: Quantity::Share,
            })
        })
    }

    /// Replaces the drivers of these materials.
    pub(super) fn set_material_drivers(&mut self, names: &[String], drivers: Vec<MaterialDriver>) {
        self.material_drivers
            .retain(|driver| !names.contains(&driver.material));
        self.material_drivers.extend(drivers);
        // The order of a file. The drivers of a material keep theirs.
        let drivers = &mut self.material_drivers;
        drivers.sort_by(|a, b| a.material.cmp(&b.material));
    }
}

/// The number with the shortest decimal notation of a value: 0.1 for the value nearest to 0.1, so that a value that is
/// set equals the same number in a file.
fn as_written(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;

    const SCENE: &str = r#"Scene(
        surfaces: [Surface(shape: Room(size: (8, 3, 5)), material: "walls", walls: (floor: "floor"))],
        materials: {
            "walls": Material(absorption: Value("alpha", 0.3), scattering: 0.1),
            "floor": Material(
                absorption: [0.1, 0.1, Value("alpha", 0.3), 0.1, 0.1, 0.1, 0.1, Value("treble", 0.5)],
                scattering: Value("s", 0.2),
            ),
        },
        source: Source(position: (0, 0, -1)), listener: Listener(position: (0, 0, 1), radius: 0.3))"#;

    /// Protects named values of materials: set to a number, they give the scene with this number in its text.
    #[test]
    fn values_set_numbers_of_materials() {
        let mut scene = Scene::from_ron(SCENE, "scene").unwrap();
        assert_eq!(scene.value_names(), ["alpha", "s", "treble"]);
        let told = scene.named_values();
        let told: Vec<_> = told
            .iter()
            .map(|value| (value.value, value.quantity))
            .collect();
        assert_eq!(told, [0.3, 0.2, 0.5].map(|value| (value, Quantity::Share)));
        scene.set_value("alpha", 0.1).unwrap();
        let expected = SCENE.replace("\"alpha\", 0.3", "\"alpha\", 0.1");
        assert_eq!(scene, Scene::from_ron(&expected, "scene").unwrap());
        assert_eq!(scene.materials["walls"].absorption, [0.1; BAND_COUNT]);
        scene.set_value("s", 1.5).unwrap();
        let refused = scene.validate().unwrap_err().to_string();
        assert!(refused.contains("scattering of the material \"floor\" must be 0 to 1, not 1.5"));
    }

    /// Protects written scenes: the values are read again, and set the same numbers.
    #[test]
    fn values_of_materials_round_trip() {
        let scene = Scene::from_ron(SCENE, "scene").unwrap();
        let text = ron::to_string(&scene).unwrap();
        let mut read = Scene::from_ron(&text, "written").unwrap();
        assert_eq!(read, scene);
        let json = serde_json::to_string(&scene).unwrap();
        assert_eq!(serde_json::from_str::<Scene>(&json).unwrap(), scene);
        read.set_value("treble", 0.9).unwrap();
        assert_eq!(read.materials["floor"].absorption[7], 0.9);
    }

    /// Protects readers of messages: a value needs a name and a number, other quantities take none, and a material that
    /// replaces one of the base has its own values.
    #[test]
    fn wrong_values_of_materials_are_refused() {
        for (said, why) in [
            (
                "absorption: Value(\"a\")",
                "a named value is written Value(\"name\", number)",
            ),
            ("absorption: Value(\"\", 0.1)", "a named value needs a name"),
            (
                "absorption: Value(\"a\", 2)",
                "an absorption must be 0 to 1, not 2",
            ),
            (
                "reduction: Value(\"a\", 30), thickness: 0.1",
                "a reduction: its numbers cannot be named values",
            ),
        ] {
            let text = SCENE.replace("absorption: Value(\"alpha\", 0.3)", said);
            let refused = Scene::from_ron(&text, "scene").unwrap_err().to_string();
            assert!(refused.contains(why), "{said}: {refused}");
        }
        let whole = SCENE.replace("materials:", "scattering: Value(\"a\", 0.1), materials:");
        let refused = Scene::from_ron(&whole, "scene").unwrap_err().to_string();
        assert!(
            refused.contains("give the value to its materials"),
            "{refused}"
        );
    }
}
