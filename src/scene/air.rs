//! The air: speed of sound and attenuation.

use crate::bands::{BAND_COUNT, Bands};
use std::ops::RangeInclusive;

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
