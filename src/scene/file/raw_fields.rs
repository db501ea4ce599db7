//! The fields of a scene file as unparsed text.

use super::options;
use ron::value::RawValue;
use serde::Deserialize;

/// The content of a scene file, field by field.
#[derive(Deserialize)]
#[serde(rename = "Scene")]
pub(super) struct RawFields<'a> {
    #[serde(borrow, default)]
    base: Option<&'a RawValue>,
    #[serde(borrow, default)]
    name: Option<&'a RawValue>,
    #[serde(borrow, default)]
    surfaces: Option<&'a RawValue>,
    #[serde(borrow, default)]
    materials: Option<&'a RawValue>,
    #[serde(borrow, default)]
    air: Option<&'a RawValue>,
    #[serde(borrow, default)]
    source: Option<&'a RawValue>,
    #[serde(borrow, default)]
    sources: Option<&'a RawValue>,
    #[serde(borrow, default)]
    listener: Option<&'a RawValue>,
    #[serde(borrow, default)]
    listeners: Option<&'a RawValue>,
    #[serde(borrow, default)]
    values: Option<&'a RawValue>,
}

impl<'a> RawFields<'a> {
    /// The fields of a text; `None` if it is not a scene.
    pub fn of(text: &'a str) -> Option<RawFields<'a>> {
        options().from_str(text).ok()
    }

    /// The text of a field; `None` if the file does not have it.
    pub fn get(&self, name: &str) -> Option<&'a RawValue> {
        match name {
            "base" => self.base,
            "name" => self.name,
            "surfaces" => self.surfaces,
            "materials" => self.materials,
            "air" => self.air,
            "source" => self.source,
            "sources" => self.sources,
            "listener" => self.listener,
            "listeners" => self.listeners,
            "values" => self.values,
            _ => None,
        }
    }

    /// The parsed value of a field.
    pub fn read<T: Deserialize<'a>>(&self, name: &str) -> Option<T> {
        options().from_str(self.get(name)?.get_ron()).ok()
    }
}
