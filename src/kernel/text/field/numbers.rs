//! Where the numbers of a field are stored: in the text, in `uSurfaces`, or in the scene's data.

use super::Place;
use crate::kernel::surface_values::divides;
use crate::scene::Shape;

/// The numbers of a tree, node by node in the order of [`Shape::nodes`].
pub(super) struct Numbers<'a> {
    place: &'a Place<'a>,
    /// Moving numbers so far.
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

    /// What the whole value is divided by, or nothing where that is 1.
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
