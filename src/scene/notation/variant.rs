//! A variant of an enum, read as the type of its content.
//!
//! `Torus(ring: 1, tube: 2)` is a variant with fields, `Quadric((…))` one with a value, `Plane` one
//! without content. Through this deserializer, each is read as an ordinary struct, newtype or unit
//! type, defined in the file of its shape.

use serde::de::{DeserializeSeed, Deserializer, Error, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;
use std::marker::PhantomData;

/// The rest of a variant after its name.
pub(crate) struct Variant<A>(pub A);

impl<'de, A: VariantAccess<'de>> Deserializer<'de> for Variant<A> {
    type Error = A::Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, A::Error> {
        Err(A::Error::custom(
            "a variant holds a struct, a value or nothing",
        ))
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.struct_variant(fields, visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.newtype_variant_seed(Newtype(visitor, PhantomData))
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        self.0.unit_variant()?;
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        option unit seq tuple tuple_struct map enum identifier ignored_any
    }
}

/// The content of a newtype, for a visitor of the newtype.
struct Newtype<'de, V>(V, PhantomData<&'de ()>);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Newtype<'de, V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(deserializer)
    }
}
