//! Numbers of a scene file by octave band: one number for all bands, or eight numbers.

use crate::bands::{BAND_COUNT, Bands};
use crate::scene::transmission::REDUCTIONS_DB;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A quantity with a value in each octave band.
pub(super) trait BandQuantity {
    /// Name with its article.
    const WHAT: &'static str;
    /// Maximum; the minimum is 0.
    const MOST: f64;
    /// Space and unit; empty for a share.
    const UNIT: &'static str;
}

/// Share of the energy that is absorbed.
pub(super) struct Absorption;

/// Share of the reflected energy that is scattered.
pub(super) struct Scattering;

/// Sound reduction index.
pub(super) struct Reduction;

/// Omnidirectional share of the pressure of a source.
pub(super) struct OmniShare;

impl BandQuantity for OmniShare {
    const WHAT: &'static str = "an omnidirectional share";
    const MOST: f64 = 1.0;
    const UNIT: &'static str = "";
}

impl BandQuantity for Absorption {
    const WHAT: &'static str = "an absorption";
    const MOST: f64 = 1.0;
    const UNIT: &'static str = "";
}

impl BandQuantity for Scattering {
    const WHAT: &'static str = "a scattering";
    const MOST: f64 = 1.0;
    const UNIT: &'static str = "";
}

impl BandQuantity for Reduction {
    const WHAT: &'static str = "a reduction";
    const MOST: f64 = *REDUCTIONS_DB.end();
    const UNIT: &'static str = " dB";
}

/// The values of a quantity by octave band, given as one number or eight numbers.
pub(super) struct OfBands<Q>(pub Bands, PhantomData<Q>);

/// A value of a quantity, checked while it is read.
struct Value<Q>(f64, PhantomData<Q>);

impl<Q: BandQuantity> Value<Q> {
    fn new<E: Error>(value: f64) -> Result<Self, E> {
        if (0.0..=Q::MOST).contains(&value) {
            return Ok(Value(value, PhantomData));
        }
        let (what, most, unit) = (Q::WHAT, Q::MOST, Q::UNIT);
        Err(E::custom(format!(
            "{what} must be 0 to {most}{unit}, not {value}"
        )))
    }
}

impl<'de, Q: BandQuantity> Deserialize<'de> for Value<Q> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Value::new(f64::deserialize(from)?)
    }
}

impl<'de, Q: BandQuantity> Deserialize<'de> for OfBands<Q> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OneOrEight(PhantomData))
    }
}

/// Reads a number, or eight numbers in brackets.
struct OneOrEight<Q>(PhantomData<Q>);

impl<Q: BandQuantity> OneOrEight<Q> {
    fn all<E: Error>(value: f64) -> Result<OfBands<Q>, E> {
        let Value(value, _) = Value::<Q>::new(value)?;
        Ok(OfBands([value; BAND_COUNT], PhantomData))
    }
}

impl<'de, Q: BandQuantity> Visitor<'de> for OneOrEight<Q> {
    type Value = OfBands<Q>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, most, unit) = (Q::WHAT, Q::MOST, Q::UNIT);
        write!(
            f,
            "{what} as a number from 0 to {most}{unit} or eight of them in brackets (octave bands 63 Hz to 8 kHz)"
        )
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        OneOrEight::all(value)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
        OneOrEight::all(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        OneOrEight::all(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Self::Value, A::Error> {
        let mut bands = [0.0; BAND_COUNT];
        let mut count = 0;
        while let Some(Value(value, _)) = values.next_element::<Value<Q>>()? {
            if let Some(band) = bands.get_mut(count) {
                *band = value;
            }
            count += 1;
        }
        if count == BAND_COUNT {
            return Ok(OfBands(bands, PhantomData));
        }
        let what = Q::WHAT;
        Err(A::Error::custom(format!(
            "{what} is one number or eight (octave bands 63 Hz to 8 kHz), not {count}"
        )))
    }
}
