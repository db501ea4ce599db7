//! The air of a scene file.

use crate::scene::Air;
use crate::scene::air::{HUMIDITIES, PRESSURES, TEMPERATURES};
use serde::Deserialize;
use std::ops::RangeInclusive;

/// The air of a file; values may be left out.
#[derive(Deserialize)]
#[serde(rename = "Air", deny_unknown_fields)]
pub(super) struct AirFile {
    #[serde(default)]
    temperature: Option<Temperature>,
    #[serde(default)]
    humidity: Option<Humidity>,
    #[serde(default)]
    pressure: Option<Pressure>,
}

impl AirFile {
    /// The previous air, or else the default, with the given values changed.
    pub fn change(&self, before: Option<Air>) -> Air {
        let before = before.unwrap_or_default();
        let Air {
            temperature,
            humidity,
            pressure,
        } = before;
        Air {
            temperature: self.temperature.map_or(temperature, |said| said.0),
            humidity: self.humidity.map_or(humidity, |said| said.0),
            pressure: self.pressure.map_or(pressure, |said| said.0),
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

macro_rules! ranged {
    ($($(#[$doc:meta])* $name:ident: $what:literal, $range:ident $unit:literal;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Deserialize)]
        #[serde(try_from = "f64")]
        struct $name(f64);

        impl TryFrom<f64> for $name {
            type Error = String;
            fn try_from(value: f64) -> Result<$name, String> {
                within($what, &$range, $unit, value).map($name)
            }
        }
    )*};
}

ranged! {
    /// Degrees Celsius.
    Temperature: "the air's temperature", TEMPERATURES "°C";
    /// Relative, in per cent.
    Humidity: "the air's humidity", HUMIDITIES "%";
    /// Kilopascals.
    Pressure: "the air's pressure", PRESSURES "kPa";
}
