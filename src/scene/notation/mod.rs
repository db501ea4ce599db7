//! Parts of the notation of scene files: numbers with their units, the forms of shapes for reading and writing, and the
//! files that a scene names.

mod numbers;

pub(super) use numbers::checked;
pub(crate) use numbers::{
    Angle, Degrees, Factor, Finite, FixedRadius, Length, Lipschitz, Metres, MostBend, Name, Number,
    Plain, Point, Radius, Rate, ReadNumbers, Reader, Share, Side, Size, Unit, Vector,
};

use super::mesh::{Inside, MeshOptions, TriangleMesh};
use super::{Balloon, FIELDS, HeightImage, SampledField, SceneError, UserField};
use crate::file_input::{InputError, read_text};
use crate::text::in_a_line;
use glam::Vec3;
use serde::de::{self, Deserialize, DeserializeSeed, Deserializer, Error, VariantAccess, Visitor};
use serde::forward_to_deserialize_any;
use serde::ser::{
    Serialize, SerializeStruct, SerializeStructVariant, SerializeTuple, SerializeTupleVariant,
    Serializer,
};
use std::cell::{Cell, RefCell};
use std::fmt;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The notation after the name of a shape or an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Numbers and children by name: `Torus(ring: …, tube: …)`.
    Fields(&'static [&'static str]),
    /// One value: `Quadric((…))`.
    Value,
    /// Nothing: `Plane`.
    NameAlone,
}

impl Form {
    /// The form that the type `F` requests when it is deserialised; `None` if it requests no particular form.
    pub fn of<'de, F: Deserialize<'de>>() -> Option<Form> {
        F::deserialize(Asked).err().and_then(|answer| answer.0)
    }

    /// Formats a shape or another part of this name in this form.
    pub fn written(self, name: &str) -> String {
        match self {
            Form::Fields(fields) => format!("{name}({}: …)", fields.join(": …, ")),
            Form::Value => format!("{name}(…)"),
            Form::NameAlone => format!("{name}, without parentheses"),
        }
    }
}

/// A deserializer without content that records the form requested by a type.
struct Asked;

/// The requested form. It is returned as an error, which ends the deserialisation.
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

/// The content of an enum variant, after its name.
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

/// A deserialisation seed that passes the content of a newtype to the newtype's visitor.
struct Newtype<'de, V>(V, PhantomData<&'de ()>);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Newtype<'de, V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<V::Value, D::Error> {
        self.0.visit_newtype_struct(deserializer)
    }
}

/// A value in the notation of scene files, to be written.
#[derive(Clone, Debug)]
pub(crate) enum Written {
    Number(f32),
    /// A 64-bit number.
    Real(f64),
    Count(u32),
    Flag(bool),
    Text(String),
    /// The part that a mesh encloses.
    Inside(Inside),
    /// In parentheses.
    Tuple(Vec<Written>),
    /// In brackets.
    List(Vec<Written>),
    /// A key-framed number: pairs (seconds, value).
    Keys(Vec<(f64, f32)>),
    /// A number driven by a named value: the name and the current number.
    Named(String, Box<Written>),
    /// Values by name: `{"name": …}`.
    Map(Vec<(String, Written)>),
    /// A struct of the notation, with its name and fields.
    Struct(&'static str, Fields),
    /// The name of a shape or an operator.
    Plain(ShapeName),
    /// The name of a shape or operator with one value: `Quadric((…))`.
    Holding(ShapeName, Box<Written>),
    /// The name of a shape or operator with fields: `Torus(ring: …, tube: …)`.
    With(ShapeName, Fields),
}

/// The name of a shape or an operator, and its index for formats that write indices instead of names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeName {
    pub name: &'static str,
    pub index: u32,
}

/// Pairs of name and value, in order.
pub(crate) type Fields = Vec<(&'static str, Written)>;

impl Serialize for Written {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Written::Number(value) => to.serialize_f32(*value),
            Written::Real(value) => to.serialize_f64(*value),
            Written::Count(value) => to.serialize_u32(*value),
            Written::Flag(value) => to.serialize_bool(*value),
            Written::Inside(value) => value.serialize(to),
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

/// Maximum size of the text of a user's field in bytes. A larger file is assumed to be a mistake.
const LARGEST_FIELD: u64 = 1 << 20;

/// Maximum number of cells of all `Rooms` of a scene: seven times those of the largest.
const MOST_ROOM_CELLS: usize = 1 << 22;

/// The location of the files that a scene names. Each file is read only once.
pub(crate) struct Attached {
    /// The name of the scene's text in errors.
    origin: String,
    place: Place,
    images: RefCell<Vec<(String, Arc<HeightImage>)>>,
    samples: RefCell<Vec<(String, Arc<SampledField>)>>,
    meshes: RefCell<Vec<(String, Arc<TriangleMesh>)>>,
    fields: RefCell<Vec<Arc<UserField>>>,
    balloons: RefCell<Vec<(String, Arc<Balloon>)>>,
    /// Cells of all `Rooms` that were read.
    room_cells: Cell<usize>,
}

enum Place {
    /// Files in the folder of the scene file.
    Folder(PathBuf),
    /// Files embedded in the program, as names and texts.
    Embedded(&'static [(&'static str, &'static str)]),
}

impl Attached {
    /// Files in `folder`, which is empty for the current folder.
    pub fn in_folder(origin: &str, folder: &Path) -> Attached {
        Attached::new(origin, Place::Folder(folder.to_owned()))
    }

    /// Texts embedded in the program.
    pub fn embedded(origin: &str, texts: &'static [(&'static str, &'static str)]) -> Attached {
        Attached::new(origin, Place::Embedded(texts))
    }

    fn new(origin: &str, place: Place) -> Attached {
        Attached {
            origin: origin.to_owned(),
            place,
            images: RefCell::default(),
            samples: RefCell::default(),
            meshes: RefCell::default(),
            fields: RefCell::default(),
            balloons: RefCell::default(),
            room_cells: Cell::default(),
        }
    }

    /// The name of the scene's text in errors.
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// The folder of the files; `None` for embedded texts.
    pub fn folder(&self) -> Option<&Path> {
        match &self.place {
            Place::Folder(folder) => Some(folder),
            Place::Embedded(_) => None,
        }
    }

    /// Reads the height image with this file name.
    pub fn heights(&self, name: &str) -> Result<Arc<HeightImage>, SceneError> {
        let known = self.images.borrow();
        if let Some((_, image)) = known.iter().find(|(known, _)| known == name) {
            return Ok(image.clone());
        }
        drop(known);
        let image = HeightImage::from_file(&self.path(name))
            .map_err(|error| self.refused(error.to_string()))?;
        let image = Arc::new(image);
        let read = (name.to_owned(), image.clone());
        self.images.borrow_mut().push(read);
        Ok(image)
    }

    /// Reads the sampled field with this file name. `cell` is the distance between its samples in metres.
    pub fn samples(&self, name: &str, cell: f32) -> Result<Arc<SampledField>, SceneError> {
        let is_same =
            |(known, field): &&(String, Arc<SampledField>)| known == name && field.cell() == cell;
        if let Some((_, field)) = self.samples.borrow().iter().find(is_same) {
            return Ok(field.clone());
        }
        let field = SampledField::from_file(&self.path(name), cell)
            .map_err(|error| self.refused(error.to_string()))?;
        let field = Arc::new(field);
        let read = (name.to_owned(), field.clone());
        self.samples.borrow_mut().push(read);
        Ok(field)
    }

    /// Reads the mesh with this file name.
    pub fn mesh(&self, name: &str, options: MeshOptions) -> Result<Arc<TriangleMesh>, SceneError> {
        let is_same = |(known, mesh): &&(String, Arc<TriangleMesh>)| {
            known == name && mesh.options() == options
        };
        if let Some((_, mesh)) = self.meshes.borrow().iter().find(is_same) {
            return Ok(mesh.clone());
        }
        let path = self.path(name);
        let mesh = TriangleMesh::from_file(&path, options)
            .map_err(|error| self.refused(format!("the mesh {}: {error}", path.display())))?;
        let mesh = Arc::new(mesh);
        self.meshes
            .borrow_mut()
            .push((name.to_owned(), mesh.clone()));
        Ok(mesh)
    }

    /// Counts the cells of `Rooms` that are read. The triangles of all `Rooms` of a scene take at most a gigabyte of
    /// memory.
    pub fn take_room_cells(&self, count: usize) -> Result<(), SceneError> {
        let cells = self.room_cells.get() + count;
        if cells > MOST_ROOM_CELLS {
            return Err(self.refused("all Rooms of the scene together have too many boxes".into()));
        }
        self.room_cells.set(cells);
        Ok(())
    }

    /// Reads the GLSL field with this file name.
    pub fn field(
        &self,
        name: &str,
        size: Vec3,
        lipschitz: f32,
        bend: Option<f32>,
    ) -> Result<Arc<UserField>, SceneError> {
        let path = self.path(name);
        let same = |field: &&Arc<UserField>| {
            field.file == path
                && field.size == size
                && field.lipschitz == lipschitz
                && field.bend == bend
        };
        if let Some(field) = self.fields.borrow().iter().find(same) {
            return Ok(field.clone());
        }
        let text = self.text(name).map_err(|why| {
            self.refused(format!("cannot read the field {}: {why}", path.display()))
        })?;
        let mut field = UserField::new(path, text, size, lipschitz);
        field.bend = bend;
        let field = Arc::new(field);
        self.fields.borrow_mut().push(field.clone());
        Ok(field)
    }

    /// Reads the measured directivity with this file name.
    pub fn balloon(&self, name: &str) -> Result<Arc<Balloon>, SceneError> {
        let known = self.balloons.borrow();
        if let Some((_, balloon)) = known.iter().find(|(known, _)| known == name) {
            return Ok(balloon.clone());
        }
        drop(known);
        let balloon = Arc::new(read_balloon(&self.path(name)).map_err(|why| self.refused(why))?);
        let read = (name.to_owned(), balloon.clone());
        self.balloons.borrow_mut().push(read);
        Ok(balloon)
    }

    fn path(&self, name: &str) -> PathBuf {
        match &self.place {
            Place::Folder(folder) => folder.join(name),
            Place::Embedded(_) => PathBuf::from(name),
        }
    }

    fn text(&self, name: &str) -> Result<String, String> {
        match &self.place {
            Place::Folder(folder) => {
                let path = folder.join(name);
                // A built-in scene that was copied to another folder still finds its field.
                match (path.exists(), embedded(FIELDS, name)) {
                    (false, Some(text)) => Ok(text),
                    _ => read_text(&path, LARGEST_FIELD).map_err(with_own_fields),
                }
            }
            Place::Embedded(texts) => {
                embedded(texts, name).ok_or_else(|| "it is not embedded in the program".to_owned())
            }
        }
    }

    /// An error of something that the scene names.
    pub fn refused(&self, why: String) -> SceneError {
        SceneError::Attached {
            origin: self.origin.clone(),
            place: None,
            why: in_a_line(&why).into_owned(),
        }
    }
}

/// The message for a field that cannot be read. In a browser it names the fields that can be read.
fn with_own_fields(error: InputError) -> String {
    let InputError::NoFiles = error else {
        return error.to_string();
    };
    let own: Vec<&str> = FIELDS.iter().map(|(name, _)| *name).collect();
    let own = own.join(", ");
    format!(
        "{error}; a text on the page can name only {own}, and GLSL of your own needs the program"
    )
}

#[cfg(feature = "sofa")]
fn read_balloon(path: &Path) -> Result<Balloon, String> {
    Balloon::read_sofa(path).map_err(|error| error.to_string())
}

#[cfg(not(feature = "sofa"))]
fn read_balloon(path: &Path) -> Result<Balloon, String> {
    let path = path.display();
    Err(format!(
        "cannot read the directivity {path}: this program is built without SOFA files"
    ))
}

fn embedded(texts: &[(&str, &str)], name: &str) -> Option<String> {
    let known = texts.iter().find(|(known, _)| *known == name);
    known.map(|(_, text)| (*text).to_owned())
}
