//! The interface that all shapes and operators implement.
//!
//! A part is one node of a tree without its children. It has numbers with ranges, a notation in scene files, properties
//! that relate its value to the distance, and the value itself in `f64`. Each shape has its own file, and the operators
//! are in `operator/`. The shaders are in `glsl/shape/` and `glsl/operator/`. [`list`](super::list) contains all parts.

use super::asset::Asset;
use super::{Properties, Shape, SurfaceKind};
use crate::scene::notation::{Fields, Reader, Written};
use crate::scene::{Quantity, SceneError};
use glam::{DVec3, Vec2, Vec3};
use serde::de::DeserializeOwned;

/// The interface of a shape or an operator. `children` contains the operands of an operator, and is empty for a shape.
pub(crate) trait Part: Parameters {
    /// The part's fields in a scene file, without its children and without the numbers that can move.
    fn words(&self) -> Fields {
        Fields::new()
    }

    /// The kind of the part's surface. For an operator, this kind requires that the surfaces of all children have the
    /// same kind.
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::GENERAL
    }

    /// Whether the part is an operator that copies the surfaces of its children to other positions.
    fn copies(&self) -> bool {
        false
    }

    /// Whether the surface consists of moved and copied surfaces of the children, and none of these surfaces touch each
    /// other.
    fn keeps_apart(&self, _children: &[Shape]) -> bool {
        self.surface_kind().moved
    }

    /// Rejects numbers that are within their ranges but contradict each other.
    ///
    /// # Errors
    /// A message that states the requirement.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Rejects children that the operator cannot be applied to. The numbers of the children have already been checked.
    ///
    /// # Errors
    /// A message that states the requirement.
    fn check_over(&self, _children: &[Shape]) -> Result<(), String> {
        Ok(())
    }

    /// Properties of the part's value.
    fn properties(&self, children: &[Shape]) -> Properties;

    /// Maximum distance in metres, along any axis, from the bounds of the solid to the level set at 1 m. It is 1 m if
    /// the value is the distance. A bound of the distance can grow more slowly, so that its level sets are farther
    /// apart.
    fn slowness(&self, children: &[Shape]) -> f64 {
        slowest(children)
    }

    /// The largest length among the part's own numbers, in metres. For a bounded shape, this is the largest coordinate
    /// of its bounds.
    fn own_length(&self) -> f64 {
        let (_, most) = self.operands();
        let bounds = match most {
            0 => self.properties(&[]).bounds,
            _ => return 0.0,
        };
        let far = bounds.min.abs().max(bounds.max.abs()).max_element();
        if far.is_finite() { far } else { 0.0 }
    }

    /// The value at a point of the part's own axes (metres): positive in the air.
    fn value(&self, children: &[Shape], p: DVec3) -> f64;

    /// The numbers that the shader text uses, in the order of their use. They are derived from the parameters (halves,
    /// squares, sines). The default is the parameters themselves.
    fn shader_numbers(&self, _children: &[Shape]) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.each_number(&mut |_, number| numbers.push(number.into()));
        numbers
    }

    /// Number of components of each argument of the part's shader functions.
    fn arguments(&self) -> &'static [usize] {
        &[1; 8]
    }

    /// The large object that the value depends on, if any.
    fn asset(&self) -> Option<Asset<'_>> {
        None
    }

    /// Whether all air of the part is also air of the child with this index. If it is not, the users' fields below this
    /// child are checked on both sides of their surfaces.
    fn keeps_air(&self, _child: usize) -> bool {
        true
    }

    /// The stated Lipschitz constant of the value, in metres per metre; `None` if the constant is computed.
    fn stated_lipschitz(&self) -> Option<f32> {
        None
    }
}

/// Defines the kind of a part's surface, within its `impl Part`.
macro_rules! surface_kind {
    ($kind:ident) => {
        fn surface_kind(&self) -> $crate::scene::shape::SurfaceKind {
            $crate::scene::shape::SurfaceKind::$kind
        }
    };
}
pub(super) use surface_kind;

/// Defines the number of components of each argument of a part's shader functions, within its `impl Part`.
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

/// The greatest slowness of these trees, but at least 1.
pub(super) fn slowest(of: &[Shape]) -> f64 {
    of.iter().map(Shape::slowness).fold(1.0, f64::max)
}

/// A number of a part that can move.
pub struct Parameter<'a> {
    /// Name in a scene file: `radius`, `size.x`, `corners.2.y`.
    pub name: String,
    /// Current value, in the unit of the code.
    pub number: &'a mut f32,
    /// Its quantity.
    pub quantity: Quantity,
}

/// The numbers of a part that can move, and its children.
pub(crate) trait Parameters {
    /// Minimum and maximum number of children.
    fn operands(&self) -> (usize, usize);

    /// The children in the notation of a scene file.
    fn written_children(&self, children: Vec<Written>) -> Fields;

    /// All numbers with their names and quantities, in order.
    fn parameters_mut(&mut self) -> Vec<Parameter<'_>>;

    /// Visits all numbers without their names. This function allocates no memory, because it runs in every frame.
    fn each_number(&self, visit: &mut dyn FnMut(Quantity, f32));
}

/// The largest coordinate, size or time in a scene, in metres or seconds. Results computed from such numbers in `f32`,
/// including squares, are finite.
pub(crate) const LARGEST: f32 = 1e9;

/// Whether a number is in the range of its quantity, and the description of this range.
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

/// A single number, or the numbers of a vector.
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

/// The names of the numbers of an array contain the index: `corners.0.x`.
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
    /// The content after the part's name.
    type File: DeserializeOwned;

    /// Reads the tree whose root is this part.
    ///
    /// # Errors
    /// The errors of the files that the tree names.
    fn read(file: Self::File, reader: &mut Reader) -> Result<Shape, SceneError>;
}

/// Defines a part: the struct, its notation in a scene file, and the list of its numbers that can move. Each number has
/// the form `name: type as Unit`, followed by `= default` if it is optional in a file. After `and` follow the values
/// that cannot move, with their serde attributes.
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
/// An operator declares its operands before its numbers: `Shell over (of: Box<ShapeFile>) {…}`. A part without numbers
/// is a unit struct. The notation of a shape without numbers is its name alone.
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

            /// The notation in a scene file.
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

/// Lists the numbers of a part that can move, with their quantities. For an operator, lists its children too.
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
