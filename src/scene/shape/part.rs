//! The interface of every shape and every operator.
//!
//! A part is one node of a tree without its children. Each has a file of its own, with its
//! numbers, their ranges, the relation of its value to the distance, and the value itself in `f64`.
//! Its shader is in `glsl/shape/` or `glsl/operator/`. [`parts`](super::list) lists all.

use super::parameter::Parameters;
use super::{HeightImage, Properties, Shape, SurfaceKind, UserField};
use crate::scene::notation::{Fields, Written};
use glam::DVec3;
use std::sync::Arc;

/// A large object that a shape's value depends on, besides its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Asset<'a> {
    /// The heights of an image.
    Image(&'a Arc<HeightImage>),
    /// A user's field.
    User(&'a Arc<UserField>),
}

/// The interface of a shape or an operator. `children` are the operands of an operator; a shape has
/// none.
pub(crate) trait Part: Parameters {
    /// Its form in a scene file without its children and the numbers that may move.
    fn words(&self) -> Fields {
        Fields::new()
    }

    /// Its children as a scene file writes them.
    fn written_children(&self, mut children: Vec<Written>) -> Fields {
        match self.operands() {
            (_, 0) => Fields::new(),
            (_, 1) => children
                .pop()
                .map(|child| ("of", child))
                .into_iter()
                .collect(),
            _ => vec![("of", Written::List(children))],
        }
    }

    /// Whether it is one of the thesis' five shapes: [`Shape::is_basic`].
    fn is_basic(&self) -> bool {
        false
    }

    /// The kind of its surface; for an operator, if its children's surfaces are of that kind.
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::GENERAL
    }

    /// Whether it is an operator that copies its children's surface to other places.
    fn copies(&self) -> bool {
        false
    }

    /// Whether its surface consists of those of its children, moved and copied, without any of them
    /// touching.
    fn keeps_apart(&self, _children: &[Shape]) -> bool {
        self.surface_kind().moved
    }

    /// Rejects numbers that are within their ranges but do not fit together.
    ///
    /// # Errors
    /// A message that states the requirement.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Rejects children that it cannot be applied to; their numbers are valid.
    ///
    /// # Errors
    /// A message that states the requirement.
    fn check_over(&self, _children: &[Shape]) -> Result<(), String> {
        Ok(())
    }

    /// Properties of its value.
    fn properties(&self, children: &[Shape]) -> Properties;

    /// Distance in metres by which the solid may exceed its bounds along any axis when its surface
    /// is moved to a value of 1 m. 1 m if the value is the distance; a bound of the distance can
    /// grow more slowly, so that its levels are further apart.
    fn slowness(&self, children: &[Shape]) -> f64 {
        slowest(children)
    }

    /// The largest length among its own numbers, in metres; for a bounded shape, its greatest
    /// distance from the origin.
    fn own_length(&self) -> f64 {
        let (_, most) = self.operands();
        let bounds = match most {
            0 => self.properties(&[]).bounds,
            _ => return 0.0,
        };
        let far = bounds.min.abs().max(bounds.max.abs()).max_element();
        if far.is_finite() { far } else { 0.0 }
    }

    /// The value at a point of its own axes (metres): positive in the air.
    fn value(&self, children: &[Shape], p: DVec3) -> f64;

    /// The numbers that the shader's text uses, in its order, derived from the parameters (halves,
    /// squares, sines).
    fn shader_numbers(&self, _children: &[Shape]) -> Vec<f64> {
        Vec::new()
    }

    /// Number of components of each argument of its shader functions.
    fn arguments(&self) -> &'static [usize] {
        &[1; 8]
    }

    /// The large object that its value depends on, if any.
    fn asset(&self) -> Option<Asset<'_>> {
        None
    }

    /// The stated Lipschitz constant of its value, in metres per metre; `None` if it is computed.
    fn stated_lipschitz(&self) -> Option<f32> {
        None
    }
}

/// The greatest slowness of some trees, at least 1.
pub(super) fn slowest(of: &[Shape]) -> f64 {
    of.iter().map(Shape::slowness).fold(1.0, f64::max)
}

/// Defines a part whose numbers all may move: the struct, its form in a scene file, and the list of
/// its parameters. Each number is `name: type as Unit`, with `= default` if a file may leave it
/// out.
///
/// ```text
/// numbers! {
///     /// A ring about y.
///     Torus {
///         /// Radius of the ring's centre line, in metres.
///         ring: f32 as Radius,
///         /// Radius of the tube, in metres.
///         tube: f32 as Radius,
///     }
/// }
/// ```
///
/// An operator states its operands before its numbers: `Shell over (of: Box<ShapeFile>) {…}`.
macro_rules! numbers {
    (
        $(#[$doc:meta])*
        $part:ident $(over ($children:ident: $operands:ty))? {
            $(
                $(#[$field_doc:meta])*
                $field:ident: $kind:ty as $unit:ident $(= $default:ident)?,
            )*
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part {
            $($(#[$field_doc])* pub $field: $kind,)*
        }

        /// Its form in a scene file.
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct File {
            $($children: $operands,)?
            $(
                $(#[serde($default)])?
                $field: <$kind as $crate::scene::notation::ReadNumbers>::Said<$crate::scene::notation::$unit>,
            )*
        }

        impl $crate::scene::shape::FromFile for File {
            fn read(
                self,
                reader: &mut $crate::scene::notation::Reader,
            ) -> Result<$crate::scene::Shape, $crate::scene::SceneError> {
                let part = $part {
                    $($field: <$kind as $crate::scene::notation::ReadNumbers>::read(
                        self.$field,
                        stringify!($field),
                        reader,
                    ),)*
                };
                #[allow(unused_mut, unused_assignments)]
                let mut children = Vec::new();
                $(children = $crate::scene::shape::Operands::read(self.$children, reader)?;)?
                Ok($crate::scene::Shape { node: part.into(), children })
            }
        }

        $crate::scene::shape::part::parameters!($part $(over (<$operands as $crate::scene::shape::Operands>::COUNT))? {
            $($field: <$crate::scene::notation::$unit as $crate::scene::notation::Unit>::QUANTITY,)*
        });
    };
}
pub(super) use numbers;

/// Lists the numbers of a part that may move and their quantities; for an operator, also the number of its
/// children.
macro_rules! parameters {
    ($part:ident $(over $operands:tt)? { $($field:ident: $quantity:expr),* $(,)? }) => {
        impl $crate::scene::shape::parameter::Parameters for $part {
            $(fn operands(&self) -> (usize, usize) {
                $operands
            })?

            fn parameters_mut(&mut self) -> Vec<$crate::scene::shape::Parameter<'_>> {
                #[allow(unused_mut)]
                let mut all = Vec::new();
                $($crate::scene::shape::parameter::Numbers::add_to(
                    &mut self.$field,
                    stringify!($field),
                    $quantity,
                    &mut all,
                );)*
                all
            }

            #[allow(unused_variables)]
            fn each_number(&self, visit: &mut dyn FnMut($crate::scene::Quantity, f32)) {
                $($crate::scene::shape::parameter::Numbers::each(
                    &self.$field,
                    &mut |number| visit($quantity, number),
                );)*
            }
        }
    };
}
pub(super) use parameters;

/// Defines a part without numbers: a unit struct. Its form in a scene file is its name alone.
macro_rules! no_numbers {
    ($(#[$doc:meta])* $part:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part;

        /// Its form in a scene file: its name alone.
        #[derive(serde::Deserialize)]
        pub(crate) struct File;

        impl $crate::scene::shape::FromFile for File {
            fn read(
                self,
                _: &mut $crate::scene::notation::Reader,
            ) -> Result<$crate::scene::Shape, $crate::scene::SceneError> {
                Ok($crate::scene::Shape::from($part))
            }
        }

        $crate::scene::shape::part::parameters!($part {});
    };
    ($(#[$doc:meta])* $part:ident over $operands:ty) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part;

        /// Its form in a scene file: its operands.
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct File {
            of: $operands,
        }

        impl $crate::scene::shape::FromFile for File {
            fn read(
                self,
                reader: &mut $crate::scene::notation::Reader,
            ) -> Result<$crate::scene::Shape, $crate::scene::SceneError> {
                let children = $crate::scene::shape::Operands::read(self.of, reader)?;
                Ok($crate::scene::Shape::over($part, children))
            }
        }

        $crate::scene::shape::part::parameters!(
            $part over (<$operands as $crate::scene::shape::Operands>::COUNT) {}
        );
    };
}
pub(super) use no_numbers;
