//! What every shape and every operator says of itself.
//!
//! A part is one node of a tree without its children. Each has a file of its own, with its
//! numbers, their ranges, what its value says of the distance, and the value itself in `f64`.
//! Its shader stands in `glsl/shape/` or `glsl/operator/`. [`parts`](super::list) lists all.

use super::{Properties, Shape};
use crate::scene::Quantity;
use crate::scene::notation::{Fields, Written};
use glam::{DVec3, Vec2, Vec3};

/// A number of a part that may move.
pub struct Parameter<'a> {
    /// What a scene file calls it: `radius`, `size.x`, `corners.2.y`.
    pub name: String,
    /// Where it stands, in the unit of the code.
    pub number: &'a mut f32,
    /// What it measures.
    pub quantity: Quantity,
}

/// What a shape or an operator says of itself. `children` are the fields that an operator
/// works on; of a shape there are none.
pub(crate) trait Part: Parameters {
    /// The name that scene files, shaders and reports use.
    fn name(&self) -> &'static str;

    /// The name that scene files have for it, where it is another.
    fn name_in_files(&self) -> &'static str {
        self.name()
    }

    /// What a scene file says of it beside its children and the numbers that may move.
    fn words(&self) -> Fields {
        Fields::new()
    }

    /// Its children as a scene file says them.
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

    /// How many children it takes: least and most.
    fn operands(&self) -> (usize, usize) {
        (0, 0)
    }

    /// Refuses what the ranges of the parameters alone do not.
    ///
    /// # Errors
    /// A sentence on what must be.
    fn check(&self) -> Result<(), String> {
        Ok(())
    }

    /// Refuses children that it cannot work on; their numbers are sound.
    ///
    /// # Errors
    /// A sentence on what must be.
    fn check_over(&self, _children: &[Shape]) -> Result<(), String> {
        Ok(())
    }

    /// What its value promises.
    fn properties(&self, children: &[Shape]) -> Properties;

    /// How far the solid may reach out of its bounds when its surface is moved to a value of
    /// 1 m, along any axis. 1 m where the value is the distance; a bound of the distance can
    /// be slower, and its levels further apart.
    fn slowness(&self, children: &[Shape]) -> f64 {
        slowest(children)
    }

    /// The largest length among its own numbers, in metres; of a shape how far it reaches, if
    /// it ends.
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

    /// The numbers that the shader's text uses, in its order: what follows from the parameters
    /// (halves, squares, sines).
    fn shader_numbers(&self, _children: &[Shape]) -> Vec<f64> {
        Vec::new()
    }

    /// How these are grouped into the arguments of its functions: components of each.
    fn arguments(&self) -> &'static [usize] {
        &[1; 8]
    }

    /// How fast its value may grow, in metres a metre, where its scene says that instead of
    /// having it computed.
    fn stated_lipschitz(&self) -> Option<f32> {
        None
    }
}

/// The numbers of a part that may move.
pub(crate) trait Parameters {
    /// Each with its name and what it measures, in order.
    fn parameters_mut(&mut self) -> Vec<Parameter<'_>>;

    /// Each without its name, which takes no memory: for every frame.
    fn each_number(&self, visit: &mut dyn FnMut(Quantity, f32));
}

/// The greatest slowness of some trees, at least 1.
pub(super) fn slowest(of: &[Shape]) -> f64 {
    of.iter().map(Shape::slowness).fold(1.0, f64::max)
}

/// The largest coordinate, size or time that a scene may hold, in metres or seconds: what is
/// computed of it in `f32`, squares included, stays finite.
pub(crate) const LARGEST: f32 = 1e9;

/// Whether a number is in the range of its quantity, and what it must be.
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
pub(super) fn in_range(part: &dyn Part) -> bool {
    let mut all = true;
    part.each_number(&mut |quantity, value| all &= range(quantity, value).0);
    all
}

impl Parameter<'_> {
    /// Refuses a number out of the range of its quantity.
    ///
    /// # Errors
    /// A sentence on what it must be.
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

/// Numbers that stand together: one, or a vector's.
pub(crate) trait Numbers {
    /// Adds each with its name.
    fn add_to<'a>(&'a mut self, name: &str, quantity: Quantity, all: &mut Vec<Parameter<'a>>);

    /// Visits each.
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

/// Numbers in a row are called after their place: `corners.0.x`.
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

/// A part whose numbers all may move: the struct, what a scene file says of it, and the list of
/// its parameters. Each number is `name: type as Unit`, or `= default` where a file may leave
/// it out.
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
/// An operator says before its numbers what it works on: `Shell over (of: Box<ShapeFile>) {…}`.
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

        /// What a scene file says of it.
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

        $crate::scene::shape::part::parameters!($part {
            $($field: <$crate::scene::notation::$unit as $crate::scene::notation::Unit>::QUANTITY,)*
        });
    };
}
pub(super) use numbers;

/// Says which numbers of a part may move, and what each measures.
macro_rules! parameters {
    ($part:ident { $($field:ident: $quantity:expr),* $(,)? }) => {
        impl $crate::scene::shape::part::Parameters for $part {
            fn parameters_mut(&mut self) -> Vec<$crate::scene::shape::Parameter<'_>> {
                #[allow(unused_mut)]
                let mut all = Vec::new();
                $($crate::scene::shape::part::Numbers::add_to(
                    &mut self.$field,
                    stringify!($field),
                    $quantity,
                    &mut all,
                );)*
                all
            }

            #[allow(unused_variables)]
            fn each_number(&self, visit: &mut dyn FnMut($crate::scene::Quantity, f32)) {
                $($crate::scene::shape::part::Numbers::each(
                    &self.$field,
                    &mut |number| visit($quantity, number),
                );)*
            }
        }
    };
}
pub(super) use parameters;

/// A part without numbers: a unit struct. What a scene file says of a shape is its name alone.
macro_rules! no_numbers {
    ($(#[$doc:meta])* $part:ident) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part;

        /// What a scene file says of it: nothing but its name.
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

        /// What a scene file says of it: what it works on.
        #[derive(serde::Deserialize)]
        pub(crate) struct File($operands);

        impl $crate::scene::shape::FromFile for File {
            fn read(
                self,
                reader: &mut $crate::scene::notation::Reader,
            ) -> Result<$crate::scene::Shape, $crate::scene::SceneError> {
                let children = $crate::scene::shape::Operands::read(self.0, reader)?;
                Ok($crate::scene::Shape::over($part, children))
            }
        }

        $crate::scene::shape::part::parameters!($part {});
    };
}
pub(super) use no_numbers;
