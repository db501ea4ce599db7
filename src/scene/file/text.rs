//! The text of a scene file: its fields, the positions of rejected values, and the older notation of three operators,
//! `Union([…])` for `Union(of: […])`.
//!
//! RON accepts either fields or a single value after a name. A text in the older notation is therefore converted to the
//! current notation before it is read. Errors state positions in the original text.

use super::surfaces::Walls;
use super::{malformed, options};
use crate::scene::SceneError;
use crate::scene::notation::Attached;
use ron::value::RawValue;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The reason why a parsed file is rejected.
pub(super) enum Refused {
    /// The position in the text, and the reason why the text there is invalid.
    At(Place, String),
    /// An error without a position, or with its own position.
    Scene(SceneError),
    /// The position of the part that names a file, and the error of this file.
    File(Place, SceneError),
}

/// The position of a value in a scene file.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// The value of a field of the scene.
    Field(&'static str),
    /// The material of a surface (from 0), or of one of its walls.
    Material { surface: usize, wall: Option<usize> },
    /// The material of a group of faces of a surface (from 0), as the index of the group in the order of names.
    Face { surface: usize, face: usize },
    /// The shape of a surface (from 0).
    Shape(usize),
    /// The end of the scene, where something is missing.
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
            Refused::File(place, mut error) => {
                if let SceneError::Attached { place: at, .. } = &mut error {
                    *at = place.find(text);
                }
                error
            }
            Refused::At(place, why) => {
                let (line, column) = place.find(text).unwrap_or((1, 1));
                malformed(files, line, column, &why)
            }
        }
    }

    /// The message of the error without its position, for formats without positions.
    pub fn without_place(self) -> String {
        match self {
            Refused::Scene(error) | Refused::File(_, error) => error.to_string(),
            Refused::At(_, why) => why,
        }
    }
}

/// Line and column, each counted from 1, of a value that is a slice of `text`.
pub(super) fn place_of(text: &str, value: &RawValue) -> (usize, usize) {
    let value = value.trim().get_ron();
    let before = value.as_ptr() as usize - text.as_ptr() as usize;
    let lines = text[..before].split('\n');
    let (count, last) = lines.fold((0, ""), |(count, _), line| (count + 1, line));
    (count, last.chars().count() + 1)
}

/// The values of a surface that are checked after the whole file has been read.
#[derive(Deserialize)]
#[serde(rename = "Surface")]
struct SurfaceValues<'a> {
    #[serde(borrow)]
    shape: Option<&'a RawValue>,
    #[serde(borrow)]
    material: Option<&'a RawValue>,
    #[serde(borrow)]
    walls: Option<Walls<&'a RawValue>>,
    #[serde(borrow, default)]
    faces: BTreeMap<String, &'a RawValue>,
}

/// A type whose deserialisation fails at the end of the text, to find the position of the end.
#[derive(Deserialize)]
#[serde(try_from = "IgnoredAny")]
struct Ended;

impl TryFrom<IgnoredAny> for Ended {
    type Error = &'static str;
    fn try_from(_: IgnoredAny) -> Result<Ended, &'static str> {
        Err("the end")
    }
}

/// The values of the surface with this index.
fn surface_values<'a>(fields: &RawFields<'a>, index: usize) -> Option<SurfaceValues<'a>> {
    let surfaces: Vec<SurfaceValues> = fields.read("surfaces")?;
    surfaces.into_iter().nth(index)
}

impl Place {
    /// Line and column of the place in the text, each counted from 1.
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
            Place::Shape(surface) => surface_values(fields, surface)?.shape,
            Place::Face { surface, face } => {
                let faces = surface_values(fields, surface)?.faces;
                faces.into_values().nth(face)
            }
            Place::Material { surface, wall } => {
                let surface = surface_values(fields, surface)?;
                match wall {
                    None => surface.material,
                    Some(wall) => surface.walls?.into_array()[wall],
                }
            }
        }
    }
}

/// Defines a type with the fields of a scene file as unparsed text.
macro_rules! raw_fields {
    ($($field:ident)*) => {
        /// The content of a scene file, field by field.
        #[derive(Deserialize)]
        #[serde(rename = "Scene")]
        pub(super) struct RawFields<'a> {
            $(#[serde(borrow)] $field: Option<&'a RawValue>,)*
        }

        impl<'a> RawFields<'a> {
            /// The text of a field; `None` if the file lacks it.
            pub fn get(&self, name: &str) -> Option<&'a RawValue> {
                match name {
                    $(stringify!($field) => self.$field,)*
                    _ => None,
                }
            }
        }
    };
}

raw_fields! { base name surfaces materials air source sources listener listeners values }

impl<'a> RawFields<'a> {
    /// The fields of a text; `None` if the text is not a scene.
    pub fn of(text: &'a str) -> Option<RawFields<'a>> {
        options().from_str(text).ok()
    }

    /// The parsed value of a field.
    pub fn read<T: Deserialize<'a>>(&self, name: &str) -> Option<T> {
        options().from_str(self.get(name)?.get_ron()).ok()
    }
}

/// Operators whose operands had no field name in the older notation.
const OPERATORS: [&str; 3] = ["Union", "Intersection", "Complement"];

/// The text that is inserted before the operands.
const NAME: &str = "of: ";

/// A text in the current notation, and the positions of the inserted names.
pub(super) struct Modern<'a> {
    pub text: Cow<'a, str>,
    /// Line and column in the original text, each counted from 1, of every inserted name, in order.
    inserted: Vec<(usize, usize)>,
}

impl<'a> Modern<'a> {
    pub fn of(text: &'a str) -> Modern<'a> {
        let places = places(text);
        let Some(last) = places.last() else {
            return Modern {
                text: Cow::Borrowed(text),
                inserted: Vec::new(),
            };
        };
        let mut modern = String::with_capacity(text.len() + NAME.len() * places.len());
        let mut inserted = Vec::with_capacity(places.len());
        let (mut from, mut line, mut column) = (0, 1, 1);
        for place in &places {
            let before = &text[from..*place];
            line += before.matches('\n').count();
            column = match before.rsplit_once('\n') {
                Some((_, last)) => 1 + last.chars().count(),
                None => column + before.chars().count(),
            };
            inserted.push((line, column));
            modern += before;
            modern += NAME;
            from = *place;
        }
        modern += &text[*last..];
        Modern {
            text: Cow::Owned(modern),
            inserted,
        }
    }

    /// Converts the position of an error in the converted text to the position in the original text, if the error is in
    /// the text named `origin`.
    pub fn in_text_as_it_was(&self, mut error: SceneError, origin: &str) -> SceneError {
        match &mut error {
            SceneError::Malformed(malformed) if malformed.origin == origin => {
                malformed.column = self.column_as_it_was(malformed.line, malformed.column);
            }
            SceneError::Attached {
                origin: of,
                place: Some((line, column)),
                ..
            } if of == origin => *column = self.column_as_it_was(*line, *column),
            _ => {}
        }
        error
    }

    fn column_as_it_was(&self, line: usize, column: usize) -> usize {
        let in_line = self.inserted.iter().filter(|(at, _)| *at == line);
        in_line.fold(column, |column, (_, begin)| {
            // A position inside an inserted name becomes the position of the insertion.
            match column > *begin {
                true => column.saturating_sub(NAME.len()).max(*begin),
                false => column,
            }
        })
    }
}

/// Byte positions of operands without a field name.
fn places(text: &str) -> Vec<usize> {
    let mut places = Vec::new();
    let mut at = 0;
    while at < text.len() {
        if let Some(length) = beside_code(&text[at..]) {
            at += length;
            continue;
        }
        let word = word_length(&text[at..]);
        if word == 0 {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
            continue;
        }
        let name = &text[at..at + word];
        at += word;
        if OPERATORS.contains(&name)
            && let Some(inside) = inside(text, at)
        {
            at = inside;
            if is_unnamed(text, inside) {
                places.push(inside);
            }
        }
    }
    places
}

/// Byte position of the content of the parenthesis that opens at `at`, ignoring blanks and comments; `None` if there is
/// no parenthesis.
fn inside(text: &str, at: usize) -> Option<usize> {
    let open = after_blanks(text, at);
    text[open..]
        .starts_with('(')
        .then(|| after_blanks(text, open + 1))
}

/// Whether a value without a field name begins at `at`.
fn is_unnamed(text: &str, at: usize) -> bool {
    let word = word_length(&text[at..]);
    let is_name = word > 0 && text[after_blanks(text, at + word)..].starts_with(':');
    let is_empty = text[at..].is_empty() || text[at..].starts_with(')');
    !is_name && !is_empty
}

fn after_blanks(text: &str, mut at: usize) -> usize {
    loop {
        let rest = &text[at..];
        let blanks = rest.len() - rest.trim_start().len();
        match comment_length(rest) {
            _ if blanks > 0 => at += blanks,
            Some(length) => at += length,
            None => return at,
        }
    }
}

fn word_length(text: &str) -> usize {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
    end.unwrap_or(text.len())
}

/// Length in bytes of the comment, string or character literal at the beginning of the text; `None` if there is none.
fn beside_code(text: &str) -> Option<usize> {
    if let Some(length) = comment_length(text) {
        return Some(length);
    }
    if text.starts_with('"') {
        return Some(text_length(text));
    }
    let raw = text.strip_prefix('r')?;
    let hashes = raw.len() - raw.trim_start_matches('#').len();
    let inside = raw[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let length = inside
        .find(&end)
        .map_or(inside.len(), |found| found + end.len());
    Some(text.len() - inside.len() + length)
}

/// Length in bytes of the comment at the beginning of the text; block comments may be nested.
fn comment_length(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    if !text.starts_with("/*") {
        return None;
    }
    let (mut depth, mut at) = (0usize, 0);
    while let Some(found) = text[at..].find(['/', '*']) {
        at += found;
        match text.get(at..at + 2) {
            Some("/*") => depth += 1,
            Some("*/") => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    Some(text.len())
}

/// Length in bytes of the string literal at the beginning of the text.
fn text_length(text: &str) -> usize {
    let mut at = 1;
    while let Some(found) = text[at..].find(['"', '\\']) {
        at += found + 1;
        if text[..at].ends_with('"') {
            return at;
        }
        at += text[at..].chars().next().map_or(0, char::len_utf8);
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// Protects files in either notation: names are inserted exactly where they are missing.
    #[test]
    fn names_are_put_in_where_they_lack() {
        for (text, expected) in [
            ("Union([Plane])", "Union(of: [Plane])"),
            (
                "Complement ( Intersection( [A, Union([B])]))",
                "Complement ( of: Intersection( of: [A, Union(of: [B])]))",
            ),
            (
                "Union /* (a */ ( // b\n [C])",
                "Union /* (a */ ( // b\n of: [C])",
            ),
            (
                "Complement(Sphere(radius: 1))",
                "Complement(of: Sphere(radius: 1))",
            ),
        ] {
            assert_eq!(Modern::of(text).text, expected);
        }
        for same in [
            "Union(of: [Plane])",
            "Union( of /* a */ : [Plane])",
            "Union(off: [Plane])",
            "Union()",
            "Union",
            "Union(",
            "SmoothUnion(of: [Plane], radius: 1)",
            "\"Union([\", 'a', \"\\\"Union([\"",
            "r#\"Union([\"Union([\"#",
            "// Union([\n",
            "/* Union([ /* */ Union([ */",
            "/* Union([",
            "\"Union([",
            "\"\\",
        ] {
            assert!(matches!(Modern::of(same).text, Cow::Borrowed(text) if text == same));
        }
    }

    /// Protects the positions of errors in files with the older notation.
    #[test]
    fn errors_stand_where_they_stood() {
        let told = |shape: &str| {
            let text = format!("Scene(surfaces: [\n Surface(shape: {shape})])");
            Scene::from_ron(&text, "f").unwrap_err().to_string()
        };
        for (shape, place) in [
            ("Union([Complement(Sphere(radius: one))])", "f:2:53: "),
            ("Union([Plane,\n Teapot])", "f:3:2: "),
            ("Union([Complement(Teapot)])", "f:2:35: "),
        ] {
            let said = told(shape);
            assert!(said.starts_with(place), "{shape}: {said}");
            // The message is the same as for the current notation, except for the position.
            let modern = told(&Modern::of(shape).text);
            assert_eq!(
                said.split_once(": ").unwrap().1,
                modern.split_once(": ").unwrap().1
            );
        }
    }
}
