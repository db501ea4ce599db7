//! The list of all shapes and operators. To add one, write its two files, a line in this list, and its `mod` and `pub
//! use` lines in `mod.rs`.

use super::part::{Notation, Part};
use crate::scene::notation::{Form, Reader, ShapeName, Variant, Written};
use crate::scene::{SceneError, Shape};
use serde::de::{Deserialize, Deserializer, EnumAccess, Visitor};
use std::fmt;

macro_rules! parts {
    (
        all: { $($(#[$attr:meta])* $name:literal $_module:ident::$part:ident,)* }
        said: { $($(#[$said_attr:meta])* $said_name:literal $_said_module:ident::$said:ident,)* }
    ) => {
        /// A node of a tree: a shape, or an operator without its children.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Node {
            $($(#[$attr])* #[doc = concat!("`", $name, "` in scene files.")] $part(super::$part),)*
        }

        impl Node {
            /// The name in scene files.
            pub(crate) fn name_in_files(&self) -> &'static str {
                match self {
                    $($(#[$attr])* Node::$part(_) => $name,)*
                }
            }

            pub(crate) fn part(&self) -> &dyn Part {
                match self {
                    $($(#[$attr])* Node::$part(part) => part,)*
                }
            }

            pub(crate) fn part_mut(&mut self) -> &mut dyn Part {
                match self {
                    $($(#[$attr])* Node::$part(part) => part,)*
                }
            }
        }

        $($(#[$attr])* #[doc(hidden)] impl From<super::$part> for Node {
            fn from(part: super::$part) -> Node {
                Node::$part(part)
            }
        }

        $(#[$attr])* impl From<super::$part> for Shape {
            fn from(part: super::$part) -> Shape {
                Shape::over(part, [])
            }
        })*

        #[doc(hidden)]
        impl From<Node> for Shape {
            fn from(node: Node) -> Shape {
                Shape::over(node, [])
            }
        }

        /// The notation of a shape or an operator in a scene file.
        pub(crate) enum ShapeFile {
            $($(#[$said_attr])* $said(<super::$said as Notation>::File),)*
        }

        impl ShapeFile {
            /// Reads the tree of shapes.
            ///
            /// # Errors
            /// The errors of the files that the tree names.
            pub fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
                match self {
                    $($(#[$said_attr])* ShapeFile::$said(file) => super::$said::read(file, reader),)*
                }
            }
        }

        /// The notation of the shape or operator with this name in scene files.
        pub(crate) fn form_of(name: &str) -> Option<Form> {
            match name {
                $($(#[$said_attr])* $said_name => Form::of::<<super::$said as Notation>::File>(),)*
                _ => None,
            }
        }

        const NAMES: &[&str] = &[$($(#[$said_attr])* $said_name),*];

        #[derive(serde::Deserialize)]
        #[serde(variant_identifier)]
        enum Name {
            $($(#[$said_attr])* #[serde(rename = $said_name)] $said,)*
        }

        impl<'de> Visitor<'de> for Tree {
            type Value = ShapeFile;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a shape or an operator")
            }

            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<ShapeFile, A::Error> {
                let (name, variant) = data.variant()?;
                Ok(match name {
                    $($(#[$said_attr])* Name::$said => {
                        ShapeFile::$said(Deserialize::deserialize(Variant(variant))?)
                    })*
                })
            }
        }
    };
}

macro_rules! all_parts {
    (
        shapes: { $($shapes:tt)* }
        operators: { $($operators:tt)* }
        written_out: { $($written_out:tt)* }
        made: { $($made:tt)* }
    ) => {
        parts! {
            all: { $($shapes)* $($operators)* $($written_out)* $($made)* }
            said: { $($shapes)* $($operators)* $($written_out)* }
        }
    };
}

/// Passes the list to a macro. Each line has the name in scene files, the name of the file under `glsl/` (except for
/// operators that are inlined in the shader text), and the type.
macro_rules! every_part {
    ($callback:ident) => {
        $callback! {
            // Shapes, which have functions in `glsl/shape/`.
            shapes: {
                "Plane" plane::Plane,
                "HalfSpace" half_space::HalfSpace,
                "Box" cuboid::Cuboid,
                "Room" room::Room,
                "RoundedBox" rounded_box::RoundedBox,
                "Sphere" sphere::Sphere,
                "Cylinder" cylinder::Cylinder,
                "Capsule" capsule::Capsule,
                "Torus" torus::Torus,
                "Cone" cone::Cone,
                "Prism" prism::Prism,
                "Ellipsoid" ellipsoid::Ellipsoid,
                "Paraboloid" paraboloid::Paraboloid,
                "Hyperboloid" hyperboloid::Hyperboloid,
                "Quadric" quadric::GeneralQuadric,
                "HeightField" height_field::HeightField,
                "Grid" grid::Grid,
                "Mesh" mesh::Mesh,
                // The example in `docs/architecture.md`.
                #[cfg(test)]
                "Octahedron" octahedron::Octahedron,
            }
            // Operators that have functions in `glsl/operator/`.
            operators: {
                "Union" union::Union,
                "Intersection" intersection::Intersection,
                "Difference" difference::Difference,
                "Shell" shell::Shell,
                "SmoothUnion" smooth_union::SmoothUnion,
                "Offset" offset::Offset,
                "Mirror" mirror::Mirror,
                "Repeat" repeat::Repeat,
                "Elongate" elongate::Elongate,
                "Twist" twist::Twist,
                "Bend" bend::Bend,
                "Morph" morph::Morph,
            }
            // Operators that are inlined in the shader text, and shapes without functions of their own.
            written_out: {
                "Field" user::User,
                "Rooms" rooms::Rooms,
                "Complement" complement::Complement,
                "Translate" translate::Translate,
                "Rotate" rotate::Rotate,
                "Scale" scale::Scale,
            }
            // Shapes whose notation in scene files is that of another shape: a `Cylinder` with a height.
            made: {
                "Cylinder" capped_cylinder::CappedCylinder,
            }
        }
    };
}
pub(crate) use every_part;

every_part!(all_parts);

impl Node {
    /// The name in reports. In scene files a `CappedCylinder` is written as `Cylinder`.
    pub fn name(&self) -> &'static str {
        match self {
            Node::CappedCylinder(_) => "CappedCylinder",
            _ => self.name_in_files(),
        }
    }

    /// The name of the node's functions in shaders: `Rooms` are triangles, like a `Mesh`.
    pub(crate) fn name_in_shaders(&self) -> &'static str {
        match self {
            Node::Rooms(_) => "Mesh",
            _ => self.name(),
        }
    }
}

/// The names of all shapes and operators in scene files.
pub(crate) fn shape_names() -> &'static [&'static str] {
    NAMES
}

/// A name with its index in the list.
pub(crate) fn numbered(name: &'static str) -> ShapeName {
    let index = NAMES.iter().position(|known| *known == name);
    let index = index.unwrap_or_default() as u32;
    ShapeName { name, index }
}

/// Visitor that reads the name of a shape or operator, and its content.
struct Tree;

impl<'de> Deserialize<'de> for ShapeFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ShapeFile, D::Error> {
        deserializer.deserialize_enum("Shape", NAMES, Tree)
    }
}

/// One field of an operator in a scene file, which contains children.
pub(crate) trait Operands {
    /// Minimum and maximum number of children.
    const COUNT: (usize, usize);

    /// Adds the children in order.
    fn add_to(self, all: &mut Vec<ShapeFile>);

    /// The value of the field, taken from the children that have not been written yet.
    fn written(left: &mut impl Iterator<Item = Written>) -> Option<Written>;
}

impl Operands for Box<ShapeFile> {
    const COUNT: (usize, usize) = (1, 1);

    fn add_to(self, all: &mut Vec<ShapeFile>) {
        all.push(*self);
    }

    fn written(left: &mut impl Iterator<Item = Written>) -> Option<Written> {
        left.next()
    }
}

impl Operands for Vec<ShapeFile> {
    const COUNT: (usize, usize) = (1, usize::MAX);

    fn add_to(self, all: &mut Vec<ShapeFile>) {
        all.extend(self);
    }

    fn written(left: &mut impl Iterator<Item = Written>) -> Option<Written> {
        Some(Written::List(left.collect()))
    }
}

/// Reads the children of an operator, numbered in order.
pub(super) fn read_children(
    files: Vec<ShapeFile>,
    reader: &mut Reader,
) -> Result<Vec<Shape>, SceneError> {
    let numbered = files.into_iter().enumerate();
    let read = |(index, file): (usize, ShapeFile)| reader.within(index, |reader| file.read(reader));
    numbered.map(read).collect()
}
