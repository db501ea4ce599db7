//! The numbers of shapes and operators that may move: their names, quantities and ranges.

use crate::scene::Quantity;
use glam::{Vec2, Vec3};

/// A number of a part that may move.
pub struct Parameter<'a> {
    /// Name in a scene file: `radius`, `size.x`, `corners.2.y`.
    pub name: String,
    /// Its current value, in the unit of the code.
    pub number: &'a mut f32,
    /// Its quantity.
    pub quantity: Quantity,
}

/// The content of a part: its numbers that may move, and the number of its children.
pub(crate) trait Parameters {
    /// Least and greatest number of children.
    fn operands(&self) -> (usize, usize) {
        (0, 0)
    }

    /// All numbers with their names and quantities, in order.
    fn parameters_mut(&mut self) -> Vec<Parameter<'_>>;

    /// Visits all numbers without their names, which allocates no memory: for every frame.
    fn each_number(&self, visit: &mut dyn FnMut(Quantity, f32));
}

/// The largest coordinate, size or time in a scene, in metres or seconds: results computed from it
/// in `f32`, squares included, stay finite.
pub(crate) const LARGEST: f32 = 1e9;

/// Whether a number is in the range of its quantity, and a statement of the range.
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

/// Numbers that belong together: a single one, or those of a vector.
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

/// The numbers of an array are named by their position: `corners.0.x`.
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
