//! The interface of every shape and every operator.
//!
//! A part is one node of a tree without its children: its numbers and their ranges, its notation in scene files, the
//! relation of its value to the distance, and the value itself in `f64`. Each shape has its own file; the operators are
//! in `operator/`. The shaders are in `glsl/shape/` and `glsl/operator/`. [`parts`](super::list) lists all.

use super::asset::Asset;
use super::{Properties, Shape, SurfaceKind};
use crate::scene::notation::{Fields, Reader, Written};
use crate::scene::{Quantity, SceneError};
use glam::{DVec3, Vec2, Vec3};
use serde::de::DeserializeOwned;

/// The interface of a shape or an operator. `children` are the operands of an operator; a shape has no children.
pub(crate) trait Part: Parameters {
    /// Its form in a scene file, without its children and without the numbers that may move.
    fn words(&self) -> Fields {
        Fields::new()
    }

    /// The kind of its surface; for an operator, the kind if its children's surfaces are of that kind.
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::GENERAL
    }

    /// Whether it is an operator that copies its children's surface to other positions.
    fn copies(&self) -> bool {
        false
    }

    /// Whether its surface consists of its children's surfaces, moved and copied, without any of them touching.
    fn keeps_apart(&self, _children: &[Shape]) -> bool {
        self.surface_kind().moved
    }

    /// Rejects numbers that are within their ranges but do not fit together.
    ///
    /// # Errors
    /// A message that states what is required.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Rejects children to which it cannot be applied; their numbers have been checked.
    ///
    /// # Errors
    /// A message that states what is required.
    fn check_over(&self, _children: &[Shape]) -> Result<(), String> {
        Ok(())
    }

    /// Properties of its value.
    fn properties(&self, children: &[Shape]) -> Properties;

    /// Distance in metres by which the solid may exceed its bounds along any axis when its surface is moved to the
    /// level of 1 m. 1 m if the value is the distance; a bound of the distance can grow more slowly, so that its levels
    /// are farther apart.
    fn slowness(&self, children: &[Shape]) -> f64 {
        slowest(children)
    }

    /// The largest length among its own numbers, in metres; for a bounded shape, the greatest distance of its points
    /// from the origin.
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

    /// The numbers that the shader's text uses, in its order, derived from the parameters (halves, squares, sines); by
    /// default the parameters themselves.
    fn shader_numbers(&self, _children: &[Shape]) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.each_number(&mut |_, number| numbers.push(number.into()));
        numbers
    }

    /// Number of components of each argument of its shader functions.
    fn arguments(&self) -> &'static [usize] {
        &[1; 8]
    }

    /// The large object that its value depends on, if any.
    fn asset(&self) -> Option<Asset<'_>> {
        None
    }

    /// Whether waves in the air of its value are also in the air of the child with this index. Below a part where they
    /// are not, a user's field is checked on both sides of its surface.
    fn keeps_air(&self, _child: usize) -> bool {
        true
    }

    /// The stated Lipschitz constant of its value, in metres per metre; `None` if it is computed.
    fn stated_lipschitz(&self) -> Option<f32> {
        None
    }
}

/// States the kind of a part's surface, within its `impl Part`.
macro_rules! surface_kind {
    ($kind:ident) => {
        fn surface_kind(&self) -> $crate::scene::shape::SurfaceKind {
            $crate::scene::shape::SurfaceKind::$kind
        }
    };
}
pub(super) use surface_kind;

/// States the number of components of each argument of a part's shader functions, within its `impl Part`.
macro_rules! arguments {
    ($($components:literal),*) => {
        fn arguments(&self) -> &'static [usize] {
            &[$($components),*]
        }
    };
}
pub(super) use arguments;

/// Half of a full length in metres.
pub(super) fn half(length: f32) -> f64 {
    0.5 * f64::from(length)
}

/// The greatest slowness of these trees, at least 1.
pub(super) fn slowest(of: &[Shape]) -> f64 {
    of.iter().map(Shape::slowness).fold(1.0, f64::max)
}

/// A number of a part that may move.
pub struct Parameter<'a> {
    /// Name in a scene file: `radius`, `size.x`, `corners.2.y`.
    pub name: String,
    /// Its current value, in the unit of the code.
    pub number: &'a mut f32,
    /// Its quantity.
    pub quantity: Quantity,
}

/// The content of a part: the numbers that may move, and the number of its children.
pub(crate) trait Parameters {
    /// Minimum and maximum number of children.
    fn operands(&self) -> (usize, usize);

    /// Its children as a scene file writes them.
    fn written_children(&self, children: Vec<Written>) -> Fields;

    /// All numbers with their names and quantities, in order.
    fn parameters_mut(&mut self) -> Vec<Parameter<'_>>;

    /// Visits all numbers without their names. This allocates no memory, as it happens in every frame.
    fn each_number(&self, visit: &mut dyn FnMut(Quantity, f32));
}

/// The largest coordinate, size or time in a scene, in metres or seconds: results computed from it in `f32`, squares
/// included, are finite.
pub(crate) const LARGEST: f32 = 1e9;

/// Whether a number is in the range of its quantity, and a description of the range.
fn range(quantity: Quantity, value: f32) -> (bool, &'static str) {
    match quantity {
        Quantity::Length | Quantity::Factor => (
            value > 0.0 && value <= LARGEST,
            "greater than 0 and at most 1e9",
        ),
        Quantity::Share => ((0.0..=1.0).contains(&value), "0 to 1"),
        _ => (
            value.is_finite() && value.abs() <= LARGEST,
            "finite and at most 1e9 in size",
        ),
    }
}

/// Whether every number of a part is in the range of its quantity.
pub(super) fn in_range(part: &(impl Parameters + ?Sized)) -> bool {
    let mut all = true;
    part.each_number(&mut |quantity, value| all &= range(quantity, value).0);
    all
}

impl Parameter<'_> {
    /// Rejects a number outside the range of its quantity.
    ///
    /// # Errors
    /// A message that states the valid range.
    pub(super) fn check(&self) -> Result<(), String> {
        let value = *self.number;
        let (is_right, must) = range(self.quantity, value);
        if is_right {
            return Ok(());
        }
        let (name, unit) = (self.name.replace('_', " "), self.quantity.unit());
        Err(format!("its {name} must be {must}{unit}, not {value}"))
    }
}

/// Numbers that belong together: a single number, or those of a vector.
pub(crate) trait Numbers {
    /// Adds each number with its name.
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>);

    /// Visits each number.
    fn each(&self, visit: &mut dyn FnMut(f32));
}

impl Numbers for f32 {
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>) {
        all.push(Parameter {
            name: name.to_owned(),
            number: self,
            quantity,
        });
    }

    fn each(&self, visit: &mut dyn FnMut(f32)) {
        visit(*self);
    }
}

impl Numbers for Vec2 {
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>) {
        let Vec2 { x, y } = self;
        x.add_to(&format!("{name}.x"), quantity, all);
        y.add_to(&format!("{name}.y"), quantity, all);
    }

    fn each(&self, visit: &mut dyn FnMut(f32)) {
        self.to_array().into_iter().for_each(visit);
    }
}

impl Numbers for Vec3 {
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>) {
        let Vec3 { x, y, z } = self;
        x.add_to(&format!("{name}.x"), quantity, all);
        y.add_to(&format!("{name}.y"), quantity, all);
        z.add_to(&format!("{name}.z"), quantity, all);
    }

    fn each(&self, visit: &mut dyn FnMut(f32)) {
        self.to_array().into_iter().for_each(visit);
    }
}

/// The numbers of an array are named by their index: `corners.0.x`.
impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>) {
        for (index, number) in self.iter_mut().enumerate() {
            number.add_to(&format!("{name}.{index}"), quantity, all);
        }
    }

    fn each(&self, visit: &mut dyn FnMut(f32)) {
        for number in self {
            number.each(visit);
        }
    }
}

/// The notation of a part in scene files.
pub(crate) trait Notation {
    /// The content after its name.
    type File: DeserializeOwned;

    /// Reads the tree that has this part as its root.
    ///
    /// # Errors
    /// The errors of the files that it names.
    fn read(file: Self::File, reader: &mut Reader) -> Result<Shape, SceneError>;
}

/// Defines a part: the struct, its form in a scene file, and the list of its numbers that may move. Each of these is
/// `name: type as Unit`, with `= default` if a file may leave it out. Values that never move follow after `and`, each
/// with its serde attributes.
///
/// ```text
/// part! {
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
/// An operator states its operands before its numbers: `Shell over (of: Box<ShapeFile>) {…}`. A part without numbers is
/// a unit struct; a shape without numbers is its name alone in a scene file.
macro_rules! part {
    ($(#[$doc:meta])* $part:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part;

        $crate::scene::shape::part::part!(@notation $part over {} {} {} struct File;);
    };
    ($(#[$doc:meta])* $part:ident over ($($operand:ident: $operands:ty),*)) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part;

        $crate::scene::shape::part::part!(@notation $part over { $($operand: $operands,)* } {} {} struct File {
            $($operand: $operands,)*
        });
    };
    (
        $(#[$doc:meta])*
        $part:ident $(over ($($operand:ident: $operands:ty),*))? {
            $(
                $(#[$field_doc:meta])*
                $field:ident: $kind:ty as $unit:ident $(= $default:ident)?,
            )*
        }
        $(and {
            $(
                $(#[doc = $fixed_doc:literal])*
                #[serde($($how:tt)*)]
                $fixed:ident: $fixed_kind:ty,
            )*
        })?
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part {
            $($(#[$field_doc])* pub $field: $kind,)*
            $($($(#[doc = $fixed_doc])* pub $fixed: $fixed_kind,)*)?
        }

        $crate::scene::shape::part::part!(@notation $part over { $($($operand: $operands,)*)? } {
            $($field: $kind as $unit,)*
        } {
            $($($fixed,)*)?
        } struct File {
            $($($operand: $operands,)*)?
            $($(#[serde($default)])? $field: <$kind as ReadNumbers>::Said<notation::$unit>,)*
            $($(#[serde($($how)*)] $fixed: $fixed_kind,)*)?
        });
    };
    (
        @notation $part:ident over { $($operand:ident: $operands:ty,)* }
        { $($field:ident: $kind:ty as $unit:ident,)* } { $($fixed:ident,)* } $($file:tt)*
    ) => {
        #[allow(unused_imports)]
        const _: () = {
            use $crate::scene::notation::{self, ReadNumbers, Reader};
            use $crate::scene::shape::list::{Operands, read_children};
            use $crate::scene::shape::part::{Notation, parameters};
            use $crate::scene::{SceneError, Shape};

            /// Its form in a scene file.
            #[derive(serde::Deserialize)]
            #[serde(deny_unknown_fields)]
            pub(crate) $($file)*

            impl Notation for $part {
                type File = File;

                #[allow(unused_variables, unused_mut)]
                fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
                    let part = $part {
                        $($field: <$kind>::read(file.$field, stringify!($field), reader),)*
                        $($fixed: file.$fixed,)*
                    };
                    let mut children = Vec::new();
                    $(file.$operand.add_to(&mut children);)*
                    let children = read_children(children, reader)?;
                    Ok(Shape { node: part.into(), children })
                }
            }

            parameters!($part over { $($operand: $operands,)* } {
                $($field: <notation::$unit as notation::Unit>::QUANTITY,)*
            });
        };
    };
}
pub(super) use part;

/// Lists the numbers of a part that may move and their quantities; for an operator, also its children.
macro_rules! parameters {
    ($part:ident { $($field:ident: $quantity:expr),* $(,)? }) => {
        $crate::scene::shape::part::parameters!($part over {} { $($field: $quantity,)* });
    };
    ($part:ident over { $($operand:ident: $operands:ty,)* } { $($field:ident: $quantity:expr,)* }) => {
        #[allow(unused_imports, unused_mut, unused_variables)]
        const _: () = {
            use $crate::scene::notation::{Fields, Written};
            use $crate::scene::shape::list::Operands;
            use $crate::scene::shape::part::{self, Numbers, Parameter};
            use $crate::scene::Quantity;

            impl part::Parameters for $part {
                fn operands(&self) -> (usize, usize) {
                    let (mut least, mut most) = (0, 0_usize);
                    $({
                        let of = <$operands as Operands>::COUNT;
                        (least, most) = (least + of.0, most.saturating_add(of.1));
                    })*
                    (least, most)
                }

                fn written_children(&self, children: Vec<Written>) -> Fields {
                    let mut left = children.into_iter();
                    let mut fields = Fields::new();
                    $(
                        let field = <$operands as Operands>::written(&mut left);
                        fields.extend(field.map(|field| (stringify!($operand), field)));
                    )*
                    fields
                }

                fn parameters_mut(&mut self) -> Vec<Parameter<'_>> {
                    let mut all = Vec::new();
                    $(self.$field.add_to(stringify!($field), $quantity, &mut all);)*
                    all
                }

                fn each_number(&self, visit: &mut dyn FnMut(Quantity, f32)) {
                    $(self.$field.each(&mut |number| visit($quantity, number));)*
                }
            }
        };
    };
}
pub(super) use parameters;
