//! Materials of surfaces: absorption, scattering and transmission.

use super::Transmission;
use crate::bands::{BAND_COUNT, Bands, PerBand};
use std::ops::Range;

/// See [`Room::WALL_NAMES`](super::shape::Room::WALL_NAMES).
pub(super) const WALL_NAMES: [&str; 6] = ["left", "right", "floor", "ceiling", "front", "back"];

/// How a surface reflects and its solid transmits sound, in each octave band of [`BANDS_HZ`](crate::bands::BANDS_HZ).
///
/// ```
/// use echomarch::scene::Material;
/// let curtain = Material::absorbing(0.5).scattering_by(0.2);
/// assert_eq!(curtain.reflectance(), [0.5; 8]);
/// assert!(Material::MIRROR.is_mirror() && !curtain.is_mirror());
/// // 63 Hz to 8 kHz, as in data sheets.
/// let panel = Material::absorbing([0.18, 0.18, 0.12, 0.10, 0.09, 0.08, 0.07, 0.07]);
/// assert_eq!(panel.absorption[4], 0.09);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Share of the incident energy that a reflection absorbs, 0 to 1: the absorption coefficient for random incidence.
    pub absorption: Bands,
    /// Share of the reflected energy that leaves in other directions than the specular direction, 0 to 1: the
    /// scattering coefficient (ISO 17497-1).
    pub scattering: Bands,
    /// The sound that passes through the solid; `None` if no sound passes.
    pub transmission: Option<Transmission>,
}

impl Material {
    /// Materials that every scene can use by name. A scene's own material of the same name takes precedence. At 63 Hz
    /// each material has its published value for 125 Hz; at 8 kHz `wood-floor` has its value for 4 kHz. The scattering
    /// coefficients are 0. Sound passes through the solids of concrete, glass and marble, which have a density.
    pub const BUILTIN: &[BuiltinMaterial] = BUILTIN_MATERIALS;

    /// A perfect mirror, the material of surfaces without a material name.
    pub const MIRROR: Material = Material {
        absorption: [0.0; BAND_COUNT],
        scattering: [0.0; BAND_COUNT],
        transmission: None,
    };

    /// A specular reflector that absorbs a share (0 to 1) of the energy, given as one number for all bands or one
    /// number per band. [`Scene::validate`] rejects numbers outside 0 to 1.
    ///
    /// [`Scene::validate`]: super::Scene::validate
    pub fn absorbing(share: impl PerBand) -> Material {
        Material {
            absorption: share.per_band(),
            ..Material::MIRROR
        }
    }

    /// Returns the material with a scattering coefficient of `share` (0 to 1), given as one number for all bands or one
    /// number per band.
    #[must_use]
    pub fn scattering_by(self, share: impl PerBand) -> Material {
        Material {
            scattering: share.per_band(),
            ..self
        }
    }

    /// Returns the material with a solid through which sound passes.
    #[must_use]
    pub fn transmitting(self, transmission: Transmission) -> Material {
        Material {
            transmission: Some(transmission),
            ..self
        }
    }

    /// The share of the energy that a reflection keeps, 1 − absorption.
    pub fn reflectance(&self) -> Bands {
        self.absorption.map(|absorbed| 1.0 - absorbed)
    }

    /// Whether the material reflects all energy specularly in every band.
    pub fn is_mirror(&self) -> bool {
        let Material {
            absorption,
            scattering,
            ..
        } = Material::MIRROR;
        (self.absorption, self.scattering) == (absorption, scattering)
    }

    /// Whether the material scatters in any of these octave bands.
    pub(crate) fn scatters(&self, bands: Range<usize>) -> bool {
        self.scattering[bands].iter().any(|share| *share > 0.0)
    }

    /// Whether absorption and scattering are equal in all octave bands, so that a reflection preserves the timbre.
    pub fn is_grey(&self) -> bool {
        let is_even = |bands: &Bands| bands.iter().all(|value| *value == bands[0]);
        is_even(&self.absorption) && is_even(&self.scattering)
    }

    /// A built-in material by its name; see [`Material::BUILTIN`].
    pub fn builtin(name: &str) -> Option<&'static Material> {
        let known = Material::BUILTIN.iter().find(|known| known.name == name);
        known.map(|known| &known.material)
    }
}

impl Default for Material {
    fn default() -> Material {
        Material::MIRROR
    }
}

/// A material that scenes can use without defining it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BuiltinMaterial {
    /// Name in scenes.
    pub name: &'static str,
    /// Description of the measured object.
    pub of: &'static str,
    /// Publication of the absorption coefficients.
    pub source: &'static str,
    /// The values.
    pub material: Material,
}

/// The source of the absorption coefficients of [`Material::BUILTIN`].
const VORLAENDER: &str = "M. Vorländer, Auralization, Springer 2008, annex, tables of random-incidence absorption coefficients";

/// Extends seven published absorption coefficients (125 Hz to 8 kHz) to eight bands. The tables have no values at 63
/// Hz, so the value at 125 Hz is used. They have no scattering coefficients, so the scattering is 0.
const fn published(name: &'static str, of: &'static str, a: [f64; 7]) -> BuiltinMaterial {
    BuiltinMaterial {
        name,
        of,
        source: VORLAENDER,
        material: Material {
            absorption: [a[0], a[0], a[1], a[2], a[3], a[4], a[5], a[6]],
            ..Material::MIRROR
        },
    }
}

impl BuiltinMaterial {
    /// Returns the material with a solid of `density` kg/m³ (the design value of EN ISO 10456:2007, table 3). Its
    /// product of thickness and critical frequency is `coincidence` m·Hz (M. Long, *Architectural Acoustics*, 2006,
    /// table 9.1).
    const fn of_mass(mut self, density: f64, coincidence: Option<f64>) -> BuiltinMaterial {
        self.material.transmission = Some(Transmission::Mass {
            density,
            coincidence,
        });
        self
    }
}

/// See [`Material::BUILTIN`].
const BUILTIN_MATERIALS: &[BuiltinMaterial] = &[
    published(
        "audience",
        "audience, orchestra or choir, with narrow aisles",
        [0.60, 0.74, 0.88, 0.96, 0.93, 0.85, 0.85],
    ),
    published(
        "brick",
        "rendered brickwork",
        [0.01, 0.02, 0.02, 0.03, 0.03, 0.04, 0.04],
    ),
    published(
        "carpet",
        "6 mm pile carpet on closed-cell foam",
        [0.03, 0.09, 0.25, 0.31, 0.33, 0.44, 0.44],
    ),
    published(
        "concrete",
        "smooth unpainted concrete",
        [0.01, 0.01, 0.02, 0.02, 0.02, 0.05, 0.05],
    )
    .of_mass(2300.0, None),
    published(
        "curtain",
        "cotton curtain of 0.5 kg/m², draped to 3/4 of its area, some 130 mm before a wall",
        [0.30, 0.45, 0.65, 0.56, 0.59, 0.71, 0.71],
    ),
    published(
        "door",
        "solid wooden door",
        [0.14, 0.10, 0.06, 0.08, 0.10, 0.10, 0.10],
    ),
    published(
        "glass",
        "glass window of 0.68 kg/m²",
        [0.10, 0.05, 0.04, 0.03, 0.03, 0.03, 0.03],
    )
    .of_mass(2500.0, Some(12.7)),
    published(
        "marble",
        "marble floor",
        [0.01, 0.01, 0.01, 0.02, 0.02, 0.02, 0.02],
    )
    .of_mass(2800.0, None),
    published(
        "mineral-wool",
        "50 mm of mineral wool of 40 kg/m³, glued to a wall",
        [0.15, 0.70, 0.60, 0.60, 0.85, 0.90, 0.90],
    ),
    published(
        "plaster",
        "hard walls and floors on average: brick, plaster and the like",
        [0.02, 0.02, 0.03, 0.03, 0.04, 0.05, 0.05],
    ),
    published(
        "plasterboard",
        "two boards of 13 mm on a steel frame, 50 mm of mineral wool behind them, painted",
        [0.15, 0.10, 0.06, 0.04, 0.04, 0.05, 0.05],
    ),
    published(
        "rough-concrete",
        "rough concrete",
        [0.02, 0.03, 0.03, 0.03, 0.04, 0.07, 0.07],
    )
    .of_mass(2300.0, None),
    published(
        "seats",
        "empty chairs, upholstered, with a cover of cloth",
        [0.44, 0.60, 0.77, 0.89, 0.82, 0.70, 0.70],
    ),
    published(
        "wood-floor",
        "stage floor of two layers, 27 mm over an air space",
        [0.10, 0.07, 0.06, 0.06, 0.06, 0.06, 0.06],
    ),
    published(
        "wood-panel",
        "16 mm of wood on studs of 40 mm",
        [0.18, 0.12, 0.10, 0.09, 0.08, 0.07, 0.07],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the built-in list: the coefficients are valid, the names are in order and unique, and each material has
    /// a source.
    #[test]
    fn built_in_materials_are_shares_with_names_and_sources() {
        let names: Vec<&str> = Material::BUILTIN.iter().map(|known| known.name).collect();
        assert!(names.is_sorted_by(|a, b| a < b), "{names:?}");
        for known in Material::BUILTIN {
            let Material {
                absorption,
                scattering,
                transmission,
            } = known.material;
            assert_eq!(transmission.and_then(|solid| solid.bad_number()), None);
            let mut all = absorption.iter().chain(&scattering);
            assert!(all.all(|share| (0.0..=1.0).contains(share)), "{known:?}");
            assert!(!known.material.is_mirror() && !known.source.is_empty());
            assert_eq!(Material::builtin(known.name), Some(&known.material));
        }
        assert_eq!(Material::builtin("bricks"), None);
    }

    /// Protects the conversion of one number or eight numbers, as `f32` or `f64`, to the values of the bands.
    #[test]
    fn materials_take_one_number_or_one_for_each_band() {
        let each: Bands = std::array::from_fn(|band| band as f64 / 8.0);
        assert_eq!(Material::absorbing(each).absorption, each);
        assert_eq!(
            Material::absorbing(each.map(|share| share as f32)).absorption,
            each
        );
        assert_eq!(Material::absorbing(0.25_f32), Material::absorbing(0.25));
        let rough = Material::absorbing(0.25).scattering_by(each);
        assert_eq!(
            (rough.absorption, rough.scattering),
            ([0.25; BAND_COUNT], each)
        );
    }

    /// Protects the order of the bands, from low to high, and the use of the value for 125 Hz at 63 Hz.
    #[test]
    fn published_values_stand_at_their_bands() {
        let carpet = Material::builtin("carpet").unwrap();
        assert_eq!(
            carpet.absorption,
            [0.03, 0.03, 0.09, 0.25, 0.31, 0.33, 0.44, 0.44]
        );
    }
}
