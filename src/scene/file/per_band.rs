//! Numbers of a scene file by octave band: one number for all bands, or eight numbers. Numbers of materials may be named
//! values, `Value("name", number)`.

use crate::bands::{BAND_COUNT, Bands};
use crate::scene::notation::Name;
use crate::scene::transmission::REDUCTIONS_DB;
use serde::Deserialize;
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
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
    /// The reason why no named value sets the quantity; `None` if named values may set it.
    const REFUSES_NAMES: Option<&'static str> = Some("its numbers cannot be named values");
}

/// Share of the energy that is absorbed.
pub(super) struct Absorption;

/// Share of the reflected energy that is scattered.
pub(super) struct Scattering;

/// Scattering of a scene, which its materials without a scattering of their own are read with.
pub(super) struct SceneScattering;

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
    const REFUSES_NAMES: Option<&'static str> = None;
}

impl BandQuantity for Scattering {
    const WHAT: &'static str = "a scattering";
    const MOST: f64 = 1.0;
    const UNIT: &'static str = "";
    const REFUSES_NAMES: Option<&'static str> = None;
}

impl BandQuantity for SceneScattering {
    const WHAT: &'static str = Scattering::WHAT;
    const MOST: f64 = Scattering::MOST;
    const UNIT: &'static str = Scattering::UNIT;
    const REFUSES_NAMES: Option<&'static str> =
        Some("that of a scene cannot be a named value: give the value to its materials");
}

impl BandQuantity for Reduction {
    const WHAT: &'static str = "a reduction";
    const MOST: f64 = *REDUCTIONS_DB.end();
    const UNIT: &'static str = " dB";
}

/// The values of a quantity by octave band, given as one number or eight numbers.
pub(super) struct OfBands<Q> {
    pub bands: Bands,
    /// The named values that set the numbers.
    pub named: Vec<NamedBand>,
    quantity: PhantomData<Q>,
}

/// A named value that sets the number of one band, or of all bands.
#[derive(Clone, Debug)]
pub(super) struct NamedBand {
    /// Index of the band; `None` for all bands.
    pub band: Option<usize>,
    pub value: String,
}

/// A number of a quantity, checked while it is read, and the named value that sets it.
struct Number<Q> {
    value: f64,
    named: Option<String>,
    quantity: PhantomData<Q>,
}

impl<Q: BandQuantity> Number<Q> {
    fn new<E: Error>(value: f64) -> Result<Self, E> {
        let (what, most, unit) = (Q::WHAT, Q::MOST, Q::UNIT);
        match (0.0..=Q::MOST).contains(&value) {
            true => Ok(Number {
                value,
                named: None,
                quantity: PhantomData,
            }),
            false => Err(E::custom(format!(
                "{what} must be 0 to {most}{unit}, not {value}"
            ))),
        }
    }

    fn named<E: Error>(name: String, value: f64) -> Result<Self, E> {
        if let Some(why) = Q::REFUSES_NAMES {
            return Err(E::custom(format!("{}: {why}", Q::WHAT)));
        }
        if name.is_empty() {
            return Err(E::custom("a named value needs a name"));
        }
        Ok(Number {
            named: Some(name),
            ..Number::new(value)?
        })
    }
}

impl<Q> From<Number<Q>> for OfBands<Q> {
    fn from(number: Number<Q>) -> OfBands<Q> {
        let named = number.named.map(|value| NamedBand { band: None, value });
        OfBands {
            bands: [number.value; BAND_COUNT],
            named: named.into_iter().collect(),
            quantity: PhantomData,
        }
    }
}

/// An element of a list: a number, or the name of a named value, which is followed by its number.
enum Element<Q> {
    Number(Number<Q>),
    Name(String),
}

impl<'de, Q: BandQuantity> Deserialize<'de> for Element<Q> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OneElement(PhantomData))
    }
}

impl<'de, Q: BandQuantity> Deserialize<'de> for OfBands<Q> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OneOrEight(PhantomData))
    }
}

/// Reads an element of a list. RON passes on `Value("name", 0.5)` as a sequence, JSON as a map with the key `Value`.
struct OneElement<Q>(PhantomData<Q>);

impl<'de, Q: BandQuantity> Visitor<'de> for OneElement<Q> {
    type Value = Element<Q>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        expecting::<Q>(f)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(Element::Number(Number::new(value)?))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
        let Name(name) = Name::deserialize(name.into_deserializer())?;
        Ok(Element::Name(name))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Self::Value, A::Error> {
        let both = (parts.next_element::<Name>()?, parts.next_element::<f64>()?);
        match both {
            (Some(Name(name)), Some(value)) => Ok(Element::Number(Number::named(name, value)?)),
            _ => Err(A::Error::custom(HOW_NAMED)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, parts: A) -> Result<Self::Value, A::Error> {
        Ok(Element::Number(of_map(parts)?))
    }
}

/// The notation of a named value.
const HOW_NAMED: &str = "a named value is written Value(\"name\", number)";

/// The named value of a map with the key `Value`.
fn of_map<'de, Q: BandQuantity, A: MapAccess<'de>>(mut parts: A) -> Result<Number<Q>, A::Error> {
    match parts.next_entry::<String, (Name, f64)>()? {
        Some((key, (Name(name), value))) if key == "Value" => Number::named(name, value),
        _ => Err(A::Error::custom(HOW_NAMED)),
    }
}

fn expecting<Q: BandQuantity>(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (what, most, unit) = (Q::WHAT, Q::MOST, Q::UNIT);
    write!(
        f,
        "{what} as a number from 0 to {most}{unit} or eight of them in brackets (octave bands 63 Hz to 8 kHz)"
    )
}

/// Reads a number, or eight numbers in brackets.
struct OneOrEight<Q>(PhantomData<Q>);

impl<'de, Q: BandQuantity> Visitor<'de> for OneOrEight<Q> {
    type Value = OfBands<Q>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        expecting::<Q>(f)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(Number::new(value)?.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, parts: A) -> Result<Self::Value, A::Error> {
        Ok(of_map::<Q, A>(parts)?.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Self::Value, A::Error> {
        let (mut bands, mut named) = ([0.0; BAND_COUNT], Vec::new());
        let mut count = 0;
        while let Some(element) = elements.next_element::<Element<Q>>()? {
            let number = match element {
                Element::Number(number) => number,
                Element::Name(name) if count == 0 => {
                    let value = elements.next_element::<f64>()?;
                    let value = value.ok_or_else(|| A::Error::custom(HOW_NAMED))?;
                    return Ok(Number::named(name, value)?.into());
                }
                Element::Name(_) => return Err(A::Error::custom(HOW_NAMED)),
            };
            if let Some(band) = bands.get_mut(count) {
                *band = number.value;
            }
            let band = Some(count);
            named.extend(number.named.map(|value| NamedBand { band, value }));
            count += 1;
        }
        if count == BAND_COUNT {
            return Ok(OfBands {
                bands,
                named,
                quantity: PhantomData,
            });
        }
        let what = Q::WHAT;
        Err(A::Error::custom(format!(
            "{what} is one number or eight (octave bands 63 Hz to 8 kHz), not {count}"
        )))
    }
}
