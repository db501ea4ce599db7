//! Serialises values of a scene file: the reverse of reading the notation.

use serde::ser::{
    Serialize, SerializeStruct, SerializeStructVariant, SerializeTuple, SerializeTupleVariant,
    Serializer,
};

/// A value of a scene file.
#[derive(Clone, Debug)]
pub(crate) enum Written {
    Number(f32),
    /// A 64-bit number.
    Real(f64),
    Count(u32),
    Flag(bool),
    Text(String),
    /// In parentheses.
    Tuple(Vec<Written>),
    /// In brackets.
    List(Vec<Written>),
    /// A key-framed number: seconds and value.
    Keys(Vec<(f64, f32)>),
    /// A number that follows a named value, and its current value.
    Named(String, f32),
    /// Names and their values: `{"name": …}`.
    Map(Vec<(String, Written)>),
    /// A name of the notation, and its fields.
    Struct(&'static str, Fields),
    /// The name of a shape or an operator.
    Plain(ShapeName),
    /// The same with one value: `Quadric((…))`.
    Holding(ShapeName, Box<Written>),
    /// The same with fields: `Torus(ring: …, tube: …)`.
    With(ShapeName, Fields),
}

/// The name of a shape or an operator, and its number, which formats without names write.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeName {
    pub name: &'static str,
    pub index: u32,
}

/// Names and values, in order.
pub(crate) type Fields = Vec<(&'static str, Written)>;

impl Serialize for Written {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Written::Number(value) => to.serialize_f32(*value),
            Written::Real(value) => to.serialize_f64(*value),
            Written::Count(value) => to.serialize_u32(*value),
            Written::Flag(value) => to.serialize_bool(*value),
            Written::Text(value) => to.serialize_str(value),
            Written::Tuple(items) => {
                let mut tuple = to.serialize_tuple(items.len())?;
                for item in items {
                    tuple.serialize_element(item)?;
                }
                tuple.end()
            }
            Written::List(items) => items.serialize(to),
            Written::Keys(keys) => to.serialize_newtype_variant("Number", 0, "Keys", keys),
            Written::Named(name, value) => {
                let mut variant = to.serialize_tuple_variant("Number", 1, "Value", 2)?;
                variant.serialize_field(name)?;
                variant.serialize_field(value)?;
                variant.end()
            }
            Written::Map(entries) => {
                let entries = entries.iter();
                to.collect_map(entries.map(|(key, value)| (key, value)))
            }
            Written::Struct(name, fields) => {
                let mut all = to.serialize_struct(name, fields.len())?;
                for (field, value) in fields {
                    all.serialize_field(field, value)?;
                }
                all.end()
            }
            Written::Plain(ShapeName { name, index }) => {
                to.serialize_unit_variant("Shape", *index, name)
            }
            Written::Holding(ShapeName { name, index }, value) => {
                to.serialize_newtype_variant("Shape", *index, name, value)
            }
            Written::With(ShapeName { name, index }, fields) => {
                let mut variant =
                    to.serialize_struct_variant("Shape", *index, name, fields.len())?;
                for (field, value) in fields {
                    variant.serialize_field(field, value)?;
                }
                variant.end()
            }
        }
    }
}
