//! How a shape or an operator is written in a scene file, as defined by the type that reads it.

use serde::de::{self, Deserialize, Deserializer, Visitor};
use serde::forward_to_deserialize_any;
use std::fmt;

/// The notation after the name of a shape or an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Numbers and children by their names: `Torus(ring: …, tube: …)`.
    Fields(&'static [&'static str]),
    /// One value: `Quadric((…))`.
    Value,
    /// Nothing: `Plane`.
    NameAlone,
}

impl Form {
    /// The form that `F` requests when it is read; `None` if it accepts any.
    pub fn of<'de, F: Deserialize<'de>>() -> Option<Form> {
        F::deserialize(Asked).err().and_then(|answer| answer.0)
    }

    /// A part of this name as it is written in this form.
    pub fn written(self, name: &str) -> String {
        match self {
            Form::Fields(fields) => format!("{name}({}: …)", fields.join(": …, ")),
            Form::Value => format!("{name}(…)"),
            Form::NameAlone => format!("{name}, with nothing behind it"),
        }
    }
}

/// A deserializer that reads nothing and records the requested form.
struct Asked;

/// The requested form, as the error that ends the reading.
#[derive(Debug)]
struct Answer(Option<Form>);

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("nothing is read")
    }
}

impl std::error::Error for Answer {}

impl de::Error for Answer {
    fn custom<T: fmt::Display>(_: T) -> Answer {
        Answer(None)
    }
}

impl<'de> Deserializer<'de> for Asked {
    type Error = Answer;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(None))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Answer> {
        Err(Answer(Some(Form::Fields(fields))))
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: V,
    ) -> Result<V::Value, Answer> {
        Err(Answer(Some(Form::Value)))
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: V,
    ) -> Result<V::Value, Answer> {
        Err(Answer(Some(Form::NameAlone)))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        option unit seq tuple tuple_struct map enum identifier ignored_any
    }
}
