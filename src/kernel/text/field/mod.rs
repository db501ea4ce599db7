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
mod numbers;
mod user;
mod value;

pub(in crate::kernel) use along::{free_text, is_bounded, leaps};
pub(in crate::kernel) use copies::{cells_crossed, has_step_limit};
pub(in crate::kernel) use hit::{has_closed_form, hit_text, takes_limit};
pub(crate) use user::shown_name;
pub(in crate::kernel) use user::{user_parts, user_text};
pub(super) use value::{gradient_text, has_differences, normal_text, value_text};

use crate::kernel::assets::Assets;
use crate::scene::Shape;
use numbers::Numbers;

/// Writes a function of a field.
pub(in crate::kernel) type Write = fn(&Shape, &Place, &Assets) -> String;

/// What the text of a field is about: a surface, or a kind of surfaces.
pub(in crate::kernel) struct Place<'a> {
    /// What its functions are called after.
    pub tag: &'a str,
    /// What its functions take beside the point, with a comma before it.
    pub parameter: &'a str,
    /// What they are given for that.
    pub argument: &'a str,
    /// Nodes whose numbers move, in the order of [`Shape::nodes`].
    pub moving: &'a [bool],
    /// The n-th vector of the numbers that move.
    pub value: &'a dyn Fn(usize) -> String,
}

/// What the text of one field is written with.
pub(super) struct Writer<'a> {
    numbers: Numbers<'a>,
    place: &'a Place<'a>,
    /// Where each height image and user's field of the scene lies.
    assets: &'a Assets,
    next_name: usize,
    /// Functions that the one being written calls.
    functions: String,
    body: String,
}
