//! A repetition as a line traversals of its copies.

use super::literal;
use crate::scene::shape::Repeat;
use crate::scene::{Copies, Node, Shape};

/// Cells of a repetition that a line is always taken past; of more, or without end, as far as
/// the step limit.
const MOST_CELLS: u64 = 1024;

/// Whether each copy keeps to its own cell, so that a line intersects them in the order of the cells.
pub(super) fn keep_to_cells(field: &Shape) -> bool {
    let within = |copies: &Copies| !matches!(copies, Copies::Around(_));
    field.copies().is_ok_and(|c| c.iter().all(within))
}

/// Cells that a line crosses at most on its way past all copies; `None` where there are too many, so that a
/// traversal has a step limit.
pub(in crate::kernel) fn cells_crossed(field: &Shape) -> Option<u64> {
    let Node::Repeat(Repeat { period, count }) = &field.node else {
        return Some(0);
    };
    let along = |axis: usize| match (period[axis] > 0.0, count[axis]) {
        (false, _) => Some(1),
        (true, 0) => None,
        (true, count) => Some(u64::from(count)),
    };
    let cells: Option<u64> = (0..3).map(along).sum();
    cells.filter(|cells| *cells <= MOST_CELLS)
}

/// Whether a traversal of copies of it has a step limit.
pub(in crate::kernel) fn has_step_limit(field: &Shape) -> bool {
    let unlimited = |node: &&Shape| cells_crossed(node).is_none();
    field.nodes().iter().any(unlimited)
}

/// A repetition as the traversal takes it: vectors of expressions.
pub(super) struct CopyAxes {
    /// From the origin to the middle of copy 0.
    pub shift: String,
    /// From one copy to the next; 1 along an axis without repetition.
    pub period: String,
    /// The box about a copy's middle.
    least: String,
    most: String,
    /// Numbers of the copies.
    first: String,
    last: String,
}

impl CopyAxes {
    /// The axes of a `Repeat` with these numbers as expressions.
    pub fn new(field: &Shape, numbers: &[String]) -> Option<CopyAxes> {
        let Node::Repeat(Repeat { period, count }) = &field.node else {
            return None;
        };
        let axes = [0, 1, 2].map(|axis| {
            let count = (period[axis] > 0.0).then_some(count[axis]);
            Along::new(count, &numbers[axis])
        });
        let vector = |[x, y, z]: [&str; 3]| format!("vec3({x}, {y}, {z})");
        let each = |of: fn(&Along) -> &str| vector([0, 1, 2].map(|axis| of(&axes[axis])));
        let three = |from: usize| vector([0, 1, 2].map(|axis| numbers[from + axis].as_str()));
        Some(CopyAxes {
            shift: each(|along| &along.shift),
            period: each(|along| &along.period),
            least: three(3),
            most: three(6),
            first: each(|along| &along.first),
            last: each(|along| &along.last),
        })
    }

    /// The traversal of a line whose start is relative to copy 0.
    pub fn traversal(&self, q: &str, d: &str, error_bound: &str) -> String {
        let CopyAxes {
            period,
            least,
            most,
            first,
            last,
            ..
        } = self;
        format!(
            "traverseCopies({q}, {d}, {error_bound}, {period}, {least}, {most}, {first}, {last})"
        )
    }
}

/// One axis of it.
struct Along {
    shift: String,
    period: String,
    first: String,
    last: String,
}

impl Along {
    /// With `count` copies (0: without end), or without repetition.
    fn new(count: Option<u32>, period: &str) -> Along {
        /// Beyond every copy that a float can number.
        const NO_LAST: f64 = 1e30;
        let (first, last) = match count {
            None => (0.0, 0.0),
            Some(0) => (-NO_LAST, NO_LAST),
            Some(count) => {
                let first = -f64::from(count / 2);
                (first, first + f64::from(count - 1))
            }
        };
        // Copies of an even number lie about the origin, none at it.
        let even = count.is_some_and(|count| count > 0 && count.is_multiple_of(2));
        Along {
            shift: if even {
                format!("0.5 * {period}")
            } else {
                literal(0.0)
            },
            period: if count.is_some() {
                period.to_owned()
            } else {
                literal(1.0)
            },
            first: literal(first),
            last: literal(last),
        }
    }
}
