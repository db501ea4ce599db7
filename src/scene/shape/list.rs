//! The list of all shapes and operators: to add one, write its two files, a line here, and its
//! `mod` and `pub use` lines in `mod.rs`.

#[cfg(test)]
use super::octahedron;
use super::operator::{
    bend, complement, difference, elongate, intersection, mirror, morph, offset, repeat, rotate,
    scale, shell, smooth_union, translate, twist, union,
};
use super::part::Part;
use super::{
    capped_cylinder, capsule, cone, cuboid, cylinder, ellipsoid, half_space, height_field,
    hyperboloid, paraboloid, plane, prism, quadric, room, rounded_box, sphere, torus, user,
};
use crate::scene::notation::{Form, Reader, ShapeName, Variant};
use crate::scene::shape::{FromFile, Operands};
use crate::scene::{SceneError, Shape};
use serde::de::{Deserialize, Deserializer, EnumAccess, Visitor};
use std::fmt;

macro_rules! parts {
    (
        said: { $($(#[$attr:meta])* $name:literal $module:ident::$part:ident,)* }
        made: { $($made_name:literal $made_module:ident::$made:ident,)* }
    ) => {
        /// A node of a tree: a shape or an operator, without its children.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Node {
            $($(#[$attr])* #[doc = concat!("`", $name, "` in scene files.")] $part($module::$part),)*
            $(#[doc = "Written differently in scene files."] $made($made_module::$made),)*
        }

        impl Node {
            /// The name in shaders and reports; in scene files a `CappedCylinder` is a `Cylinder`.
            pub fn name(&self) -> &'static str {
                match self {
                    $($(#[$attr])* Node::$part(_) => $name,)*
                    $(Node::$made(_) => stringify!($made),)*
                }
            }

            /// The name in scene files.
            pub(crate) fn name_in_files(&self) -> &'static str {
                match self {
                    $(Node::$made(_) => $made_name,)*
                    _ => self.name(),
                }
            }

            pub(crate) fn part(&self) -> &dyn Part {
                match self {
                    $($(#[$attr])* Node::$part(part) => part,)*
                    $(Node::$made(part) => part,)*
                }
            }

            pub(crate) fn part_mut(&mut self) -> &mut dyn Part {
                match self {
                    $($(#[$attr])* Node::$part(part) => part,)*
                    $(Node::$made(part) => part,)*
                }
            }
        }

        $($(#[$attr])* impl From<$module::$part> for Node {
            fn from(part: $module::$part) -> Node {
                Node::$part(part)
            }
        }

        $(#[$attr])*
        impl From<$module::$part> for Shape {
            fn from(part: $module::$part) -> Shape {
                Shape::from(Node::$part(part))
            }
        })*
        $(impl From<$made_module::$made> for Node {
            fn from(part: $made_module::$made) -> Node {
                Node::$made(part)
            }
        }

        impl From<$made_module::$made> for Shape {
            fn from(part: $made_module::$made) -> Shape {
                Shape::from(Node::$made(part))
            }
        })*

        /// The form of a shape or an operator in a scene file.
        pub(crate) enum ShapeFile {
            $($(#[$attr])* $part($module::File),)*
        }

        impl ShapeFile {
            /// Reads its tree.
            ///
            /// # Errors
            /// Errors of the files that it names.
            pub fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
                match self {
                    $($(#[$attr])* ShapeFile::$part(file) => file.read(reader),)*
                }
            }
        }

        /// The notation of the shape or operator of this name in a scene file.
        pub(crate) fn form_of(name: &str) -> Option<Form> {
            match name {
                $($(#[$attr])* $name => Form::of::<$module::File>(),)*
                _ => None,
            }
        }

        const NAMES: &[&str] = &[$($(#[$attr])* $name),*];

        #[derive(serde::Deserialize)]
        #[serde(variant_identifier)]
        enum Name {
            $($(#[$attr])* #[serde(rename = $name)] $part,)*
        }

        impl<'de> Visitor<'de> for Tree {
            type Value = ShapeFile;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a shape or an operator")
            }

            fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<ShapeFile, A::Error> {
                let (name, variant) = data.variant()?;
                Ok(match name {
                    $($(#[$attr])* Name::$part => {
                        ShapeFile::$part(Deserialize::deserialize(Variant(variant))?)
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
            said: { $($shapes)* $($operators)* $($written_out)* }
            made: { $($made)* }
        }
    };
}

/// Passes the list to a macro: the name in scene files, the module here (for most also the name of
/// the file under `glsl/`), the type.
macro_rules! every_part {
    ($callback:ident) => {
        $callback! {
            // Each with its functions in `glsl/shape/`.
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
                // The worked example in `docs/architecture.md`.
                #[cfg(test)]
                "Octahedron" octahedron::Octahedron,
            }
            // Each with its functions in `glsl/operator/`.
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
            // Inlined in the shader's text, without functions.
            written_out: {
                "Field" user::User,
                "Complement" complement::Complement,
                "Translate" translate::Translate,
                "Rotate" rotate::Rotate,
                "Scale" scale::Scale,
            }
            // Shapes with a different notation in scene files: a cylinder with a height.
            made: {
                "Cylinder" capped_cylinder::CappedCylinder,
            }
        }
    };
}
pub(crate) use every_part;

every_part!(all_parts);

/// The names of all shapes and operators in scene files.
pub(crate) fn shape_names() -> &'static [&'static str] {
    NAMES
}

/// This name and its number.
pub(crate) fn numbered(name: &'static str) -> ShapeName {
    let index = NAMES.iter().position(|known| *known == name);
    let index = index.unwrap_or_default() as u32;
    ShapeName { name, index }
}

/// Reads the name of a shape or operator, and its content.
struct Tree;

impl<'de> Deserialize<'de> for ShapeFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ShapeFile, D::Error> {
        deserializer.deserialize_enum("Shape", NAMES, Tree)
    }
}

impl Operands for Box<ShapeFile> {
    const COUNT: (usize, usize) = (1, 1);

    fn read(self, reader: &mut Reader) -> Result<Vec<Shape>, SceneError> {
        Ok(vec![
            reader.within(0, |reader| ShapeFile::read(*self, reader))?,
        ])
    }
}

impl Operands for Vec<ShapeFile> {
    const COUNT: (usize, usize) = (1, usize::MAX);

    fn read(self, reader: &mut Reader) -> Result<Vec<Shape>, SceneError> {
        let numbered = self.into_iter().enumerate();
        let read = |(index, file): (usize, ShapeFile)| {
            reader.within(index, |reader| ShapeFile::read(file, reader))
        };
        numbered.map(read).collect()
    }
}
