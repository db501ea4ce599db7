//! A field as shader text: its value, its gradient, and where a line intersects it.
//!
//! Each tree becomes straight-line code, one statement a node, in functions that are named
//! after the surface's number: `field3(p)`, `gradient3(p)` (the gradient, and in its last
//! component the value), where there is a closed form `hit3(p, d, errorBound)`, of copies
//! `hit3(p, d, errorBound, limit)`, and for the march `free3(p, d, errorBound)`. Value and
//! gradient are the same text over two types: `float`, and `vec4` for a value with its gradient,
//! which the operators take along (forward differentiation).
//!
//! Numbers are literals. Those of a node that something moves are uniforms instead, all of
//! them at once, because several follow from one parameter (a rotation's nine).

mod along;
mod copies;
mod hit;
mod user;
mod value;

pub(in crate::kernel) use along::{free_text, is_bounded, leaps};
pub(in crate::kernel) use copies::{cells_crossed, has_step_limit};
pub(in crate::kernel) use hit::{has_closed_form, hit_text, takes_limit};
pub(in crate::kernel) use user::user_parts;
pub(crate) use user::{USER_FILE, shown_name, user_sources};
pub(super) use value::{gradient_text, has_differences, normal_text, value_text};

use crate::kernel::origin_rebasing::divides;
use crate::kernel::structure::Assets;
use crate::scene::Shape;

/// Writes a function of a field.
pub(in crate::kernel) type Write = fn(&Shape, &Place, &Assets) -> String;

/// The surface, or the kind of surfaces, that has a field.
pub(in crate::kernel) struct Place<'a> {
    /// The end of the names of its functions.
    pub tag: &'a str,
    /// The parameter of its functions beside the point, with a comma before it.
    pub parameter: &'a str,
    /// The argument for this parameter.
    pub argument: &'a str,
    /// Nodes whose numbers move, in the order of [`Shape::nodes`].
    pub moving: &'a [bool],
    /// The n-th vector of the numbers that move.
    pub value: &'a dyn Fn(usize) -> String,
}

/// Writes the text of one field.
pub(super) struct Writer<'a> {
    numbers: Numbers<'a>,
    place: &'a Place<'a>,
    /// The places of height images and users' fields of the scene.
    assets: &'a Assets,
    next_name: usize,
    /// Functions that the one being written calls.
    functions: String,
    body: String,
}

/// The numbers of a tree, node by node in the order of [`Shape::nodes`].
pub(super) struct Numbers<'a> {
    place: &'a Place<'a>,
    /// Moving numbers taken.
    taken: usize,
    node: usize,
}

impl<'a> Numbers<'a> {
    pub fn new(place: &'a Place<'a>) -> Numbers<'a> {
        Numbers {
            place,
            taken: 0,
            node: 0,
        }
    }

    /// The next node's numbers as expressions.
    pub fn next(&mut self, field: &Shape) -> Vec<String> {
        let moves = self.place.moving.get(self.node).copied().unwrap_or(false);
        self.node += 1;
        let numbers = field.shader_numbers();
        if !moves {
            return numbers.into_iter().map(literal).collect();
        }
        let taken = numbers.iter().map(|_| self.take());
        taken.collect()
    }

    /// Passes by the field that comes next.
    pub fn skip(&mut self, field: &Shape) {
        for node in field.nodes() {
            self.next(node);
        }
    }

    /// The place in the tree, for callers that write a part of it more than once.
    pub fn mark(&self) -> (usize, usize) {
        (self.taken, self.node)
    }

    /// Goes back to a [`Numbers::mark`].
    pub fn back_to(&mut self, (taken, node): (usize, usize)) {
        (self.taken, self.node) = (taken, node);
    }

    /// The factor of the whole value, or `None` where that is 1.
    pub fn lipschitz(&mut self, field: &Shape) -> Option<String> {
        let lipschitz = field.properties().lipschitz;
        if self.place.moving.contains(&true) && divides(field) {
            return Some(self.take());
        }
        (lipschitz > 1.0).then(|| literal(1.0 / lipschitz))
    }

    fn take(&mut self) -> String {
        let (vector, component) = (self.taken / 4, self.taken % 4);
        self.taken += 1;
        let vector = (self.place.value)(vector);
        format!("{vector}.{}", ["x", "y", "z", "w"][component])
    }
}

/// A number as GLSL reads it back to the same bits.
pub(super) fn literal(number: f64) -> String {
    let number = number as f32;
    // An endless size stands for itself within what GLSL can write.
    let held = number.clamp(-1e30, 1e30);
    format!("{held:?}")
}
