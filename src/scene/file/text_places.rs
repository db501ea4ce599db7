//! Places in the text of a scene file that can be parsed, but is rejected because of its content.

use super::material::Walls;
use super::raw_fields::RawFields;
use super::{malformed, options};
use crate::scene::SceneError;
use crate::scene::notation::Attached;
use ron::value::RawValue;
use serde::Deserialize;
use serde::de::IgnoredAny;

/// The reason why a parsed file is rejected.
pub(super) enum Refused {
    /// The text at a place, and why it is invalid.
    At(Place, String),
    /// An error without a place, or one that reports its own.
    Scene(SceneError),
}

/// The place of a value in a scene file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// The value of a field of the scene.
    Field(&'static str),
    /// The material of a surface (from 0), or of one of its walls.
    Material { surface: usize, wall: Option<usize> },
    /// The end of the scene, if something is missing.
    End,
}

impl From<SceneError> for Refused {
    fn from(error: SceneError) -> Refused {
        Refused::Scene(error)
    }
}

impl Refused {
    /// The error with its line and column in the file's text.
    pub fn in_text(self, text: &str, files: &Attached) -> SceneError {
        match self {
            Refused::Scene(error) => error,
            Refused::At(place, why) => {
                let (line, column) = place.find(text).unwrap_or((1, 1));
                malformed(files, line, column, &why)
            }
        }
    }

    /// The error in a format without places.
    pub fn without_place(self) -> String {
        match self {
            Refused::Scene(error) => error.to_string(),
            Refused::At(_, why) => why,
        }
    }
}

/// Line and column, each from 1, of a value that is a part of the text.
pub(super) fn place_of(text: &str, value: &RawValue) -> (usize, usize) {
    let value = value.trim().get_ron();
    let before = value.as_ptr() as usize - text.as_ptr() as usize;
    let lines = text[..before].split('\n');
    let (count, last) = lines.fold((0, ""), |(count, _), line| (count + 1, line));
    (count, last.chars().count() + 1)
}

/// The values of a surface that may be rejected after the whole file was read.
#[derive(Deserialize)]
#[serde(rename = "Surface")]
struct SurfaceValues<'a> {
    #[serde(borrow, default)]
    material: Option<&'a RawValue>,
    #[serde(borrow, default)]
    walls: Option<Walls<&'a RawValue>>,
}

/// A file's scene that is rejected at its end.
#[derive(Deserialize)]
#[serde(try_from = "IgnoredAny")]
struct Ended;

impl TryFrom<IgnoredAny> for Ended {
    type Error = &'static str;
    fn try_from(_: IgnoredAny) -> Result<Ended, &'static str> {
        Err("the end")
    }
}

impl Place {
    /// Line and column, each from 1.
    fn find(self, text: &str) -> Option<(usize, usize)> {
        if let Place::End = self {
            let end = options().from_str::<Ended>(text).err()?.span.start;
            return Some((end.line, end.col));
        }
        Some(place_of(text, self.among(&RawFields::of(text)?)?))
    }

    fn among<'a>(self, fields: &RawFields<'a>) -> Option<&'a RawValue> {
        match self {
            Place::Field(name) => fields.get(name),
            Place::End => None,
            Place::Material { surface, wall } => {
                let surfaces: Vec<SurfaceValues> = fields.read("surfaces")?;
                let surface = surfaces.into_iter().nth(surface)?;
                match wall {
                    None => surface.material,
                    Some(wall) => surface.walls?.into_array()[wall],
                }
            }
        }
    }
}
