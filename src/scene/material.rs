//! Materials of surfaces (absorption and scattering), and the air (speed of sound and attenuation).

use crate::bands::{BAND_COUNT, Bands, PerBand};
use std::ops::{Range, RangeInclusive};

/// See [`Room::WALL_NAMES`](super::shape::Room::WALL_NAMES).
pub(super) const WALL_NAMES: [&str; 6] = ["left", "right", "floor", "ceiling", "front", "back"];

/// How a surface reflects, in each octave band of [`BANDS_HZ`](crate::bands::BANDS_HZ).
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
}

impl Material {
    /// Materials that every scene can use by name. A scene's own material of the same name takes precedence. At 63 Hz
    /// each material has its published value for 125 Hz; at 8 kHz `wood-floor` has its value for 4 kHz. The scattering
    /// coefficients are 0.
    pub const BUILTIN: &[BuiltinMaterial] = BUILTIN_MATERIALS;

    /// A perfect mirror, the material of surfaces without a material name.
    pub const MIRROR: Material = Material {
        absorption: [0.0; BAND_COUNT],
        scattering: [0.0; BAND_COUNT],
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

    /// The share of the energy that a reflection keeps, 1 − absorption.
    pub fn reflectance(&self) -> Bands {
        self.absorption.map(|absorbed| 1.0 - absorbed)
    }

    /// Whether the material reflects all energy specularly in every band.
    pub fn is_mirror(&self) -> bool {
        *self == Material::MIRROR
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
    /// Publication of the values.
    pub source: &'static str,
    /// The values.
    pub material: Material,
}

/// The source of all values of [`Material::BUILTIN`].
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
    ),
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
    ),
    published(
        "marble",
        "marble floor",
        [0.01, 0.01, 0.01, 0.02, 0.02, 0.02, 0.02],
    ),
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
    ),
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

/// Valid temperatures in degrees Celsius: the range of the tables in ISO 9613-1, in which its formulas are accurate to
/// 10 %.
pub(crate) const TEMPERATURES: RangeInclusive<f64> = -20.0..=50.0;

/// Valid relative humidities in per cent.
pub(crate) const HUMIDITIES: RangeInclusive<f64> = 0.0..=100.0;

/// Valid pressures in kilopascals: from the pressure at 5.5 km above sea level to the upper limit of ISO 9613-1.
pub(crate) const PRESSURES: RangeInclusive<f64> = 50.0..=200.0;

/// Reference temperature of ISO 9613-1 in kelvin: 20 °C.
const REFERENCE_K: f64 = 293.15;

/// Reference pressure of ISO 9613-1 in kilopascals: one atmosphere.
const REFERENCE_KPA: f64 = 101.325;

/// Triple point of water in kelvin (ISO 9613-1, annex B: 0.01 °C).
const TRIPLE_POINT_K: f64 = 273.16;

/// Zero degrees Celsius in kelvin.
const ZERO_C_IN_K: f64 = 273.15;

/// Speed of sound in dry air at the reference temperature, in metres per second (ISO 9613-1, annex A).
const REFERENCE_SPEED: f64 = 343.2;

/// Homogeneous air between the surfaces.
///
/// ```
/// use echomarch::scene::Air;
/// let air = Air { temperature: 10.0, humidity: 70.0, ..Air::default() };
/// // 3.66 dB per kilometre at 1 kHz (ISO 9613-2, table 2, gives 3.7).
/// let db_a_km = 10.0 * air.attenuation()[4] * 1000.0 / 10f64.ln();
/// assert!((db_a_km - 3.66).abs() < 0.005);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Temperature in degrees Celsius, −20 to 50.
    pub temperature: f64,
    /// Relative humidity in per cent, 0 to 100.
    pub humidity: f64,
    /// Pressure in kilopascals, 50 to 200.
    pub pressure: f64,
}

impl Default for Air {
    /// 20 °C, 50 % relative humidity, one atmosphere (101.325 kPa).
    fn default() -> Air {
        Air {
            temperature: 20.0,
            humidity: 50.0,
            pressure: REFERENCE_KPA,
        }
    }
}

impl Air {
    /// Speed of sound in a scene without air, in metres per second: the rounded speed at 20 °C.
    pub const USUAL_SPEED_OF_SOUND: f64 = 343.0;

    /// Speed of sound in metres per second: 343.2 √(T / 293.15 K), as in ISO 9613-1, annex A.
    ///
    /// Humidity is ignored. It raises the speed by 0.2 % at 20 °C and 50 %, and by about 1 % at 40 °C and 100 %.
    pub fn speed_of_sound(&self) -> f64 {
        REFERENCE_SPEED * (self.kelvin() / REFERENCE_K).sqrt()
    }

    /// Attenuation coefficient m of sound energy by octave band, in 1/m: after s metres, the share exp(−m s) of the
    /// energy remains. Computed by equations (3) to (5) of ISO 9613-1:1993 for pure tones. As in the tables of the
    /// standard, the frequencies are the exact midband frequencies of equation (6), 10^(3k/10) kHz (for example 7943 Hz
    /// instead of 8 kHz).
    pub fn attenuation(&self) -> Bands {
        // The index of the 1 kHz band.
        const BAND_OF_1_KHZ: i32 = 4;
        let db_in_m = std::f64::consts::LN_10 / 10.0;
        let mut bands = [0.0; BAND_COUNT];
        for (band, m) in (0..).zip(&mut bands) {
            let hertz = 1000.0 * 10f64.powf(0.3 * f64::from(band - BAND_OF_1_KHZ));
            *m = db_in_m * self.decibels_a_metre(hertz);
        }
        bands
    }

    /// Attenuation in dB/m at a frequency, equation (5) of ISO 9613-1:1993.
    fn decibels_a_metre(&self, hertz: f64) -> f64 {
        let kelvin = self.kelvin();
        let warmth = kelvin / REFERENCE_K;
        let pressure = self.pressure / REFERENCE_KPA;
        let square = hertz * hertz;
        let classical = 1.84e-11 / pressure * warmth.sqrt();
        let oxygen_hz = self.oxygen_hz();
        let oxygen = 0.012_75 * (-2239.1 / kelvin).exp() / (oxygen_hz + square / oxygen_hz);
        let nitrogen_hz = self.nitrogen_hz();
        let nitrogen = 0.1068 * (-3352.0 / kelvin).exp() / (nitrogen_hz + square / nitrogen_hz);
        8.686 * square * (classical + warmth.powf(-2.5) * (oxygen + nitrogen))
    }

    /// Relaxation frequency of oxygen in hertz, equation (3) of ISO 9613-1:1993.
    fn oxygen_hz(&self) -> f64 {
        let water = self.molar_concentration();
        let pressure = self.pressure / REFERENCE_KPA;
        pressure * (24.0 + 4.04e4 * water * (0.02 + water) / (0.391 + water))
    }

    /// Relaxation frequency of nitrogen in hertz, equation (4) of ISO 9613-1:1993.
    fn nitrogen_hz(&self) -> f64 {
        let water = self.molar_concentration();
        let pressure = self.pressure / REFERENCE_KPA;
        let warmth = self.kelvin() / REFERENCE_K;
        let cold = (-4.17 * (warmth.cbrt().recip() - 1.0)).exp();
        pressure / warmth.sqrt() * (9.0 + 280.0 * water * cold)
    }

    /// Molar concentration of water vapour in per cent, ISO 9613-1:1993, annex B.
    fn molar_concentration(&self) -> f64 {
        let exponent = -6.8346 * (TRIPLE_POINT_K / self.kelvin()).powf(1.261) + 4.6151;
        self.humidity * 10f64.powf(exponent) * REFERENCE_KPA / self.pressure
    }

    fn kelvin(&self) -> f64 {
        self.temperature + ZERO_C_IN_K
    }
}

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
            } = known.material;
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

    /// Table 2 of ISO 9613-2:1996, which contains rounded values of ISO 9613-1: temperature in °C, humidity in %, and
    /// dB/km by octave band.
    const TABLE: [(f64, f64, [f64; 8]); 6] = [
        (10.0, 70.0, [0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117.0]),
        (20.0, 70.0, [0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6]),
        (30.0, 70.0, [0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3]),
        (15.0, 20.0, [0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202.0]),
        (15.0, 50.0, [0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129.0]),
        (15.0, 80.0, [0.1, 0.3, 1.1, 2.4, 4.1, 8.3, 23.7, 82.8]),
    ];

    fn db_a_km(air: &Air) -> Bands {
        air.attenuation().map(|m| 1e4 * m / 10f64.ln())
    }

    /// Protects the formulas and the midband frequencies: all values of the published table are reproduced to the last
    /// printed digit.
    #[test]
    fn attenuation_is_that_of_the_published_table() {
        for (temperature, humidity, expected) in TABLE {
            let air = Air {
                temperature,
                humidity,
                ..Air::default()
            };
            for (band, (found, expected)) in db_a_km(&air).into_iter().zip(expected).enumerate() {
                // Half of the last printed digit, plus a tenth of that half: two of the 48 values (4.151 and 12.75) lie
                // halfway between two printed values.
                let digit = if expected > 100.0 { 1.0 } else { 0.1 };
                assert!(
                    (found - expected).abs() <= 0.6 * digit,
                    "{temperature} °C, {humidity} %, band {band}: {found} for {expected}"
                );
            }
        }
    }

    /// Protects the speed: it equals the value in the standard at 20 °C, and 331.3 m/s at 0 °C (331.29 by 343.2
    /// √(273.15 / 293.15)).
    #[test]
    fn sound_is_faster_in_warm_air() {
        let at = |temperature| Air {
            temperature,
            ..Air::default()
        };
        assert_eq!(at(20.0).speed_of_sound(), 343.2);
        assert!((at(0.0).speed_of_sound() - 331.29).abs() < 0.005);
    }

    /// Protects from NaN: for all combinations of the range limits, the attenuation is positive and increases with
    /// frequency.
    #[test]
    fn every_air_in_range_takes_more_of_higher_bands() {
        let ends = |range: &RangeInclusive<f64>| [*range.start(), *range.end()];
        for temperature in ends(&TEMPERATURES) {
            for humidity in ends(&HUMIDITIES) {
                for pressure in ends(&PRESSURES) {
                    let air = Air {
                        temperature,
                        humidity,
                        pressure,
                    };
                    let bands = air.attenuation();
                    assert!(bands.iter().all(|m| m.is_finite() && *m > 0.0), "{air:?}");
                    assert!(bands.is_sorted_by(|a, b| a < b), "{air:?}: {bands:?}");
                }
            }
        }
    }
}
