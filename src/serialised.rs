//! Serialisation of numbers in settings and results. Numbers that a format such as JSON cannot represent are refused,
//! or have a defined representation. No number is read back as a different number.

use serde::de::{Deserialize, Deserializer};
use serde::ser::{Error, Serialize, Serializer};

/// Reads an optional field. `null` is accepted only if the field's own type accepts it.
pub(crate) fn given<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    T::deserialize(deserializer).map(Some)
}

/// Writes an optional number, and refuses a number that is not finite, because JSON would store it as `null`, which
/// means a missing number.
pub(crate) fn finite<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) if !value.is_finite() => Err(Error::custom(format!(
            "{value} cannot be written: it is not a finite number"
        ))),
        value => value.serialize(to),
    }
}

/// A number that may be ∞. ∞ is written as `null`.
pub(crate) mod infinite {
    use super::*;

    pub(crate) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        super::finite(&Some(*value).filter(|value| *value != f64::INFINITY), to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Option::deserialize(from).map(|value| value.unwrap_or(f64::INFINITY))
    }
}
