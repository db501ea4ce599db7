//! The kinds of functions that are written for a tree: value, gradient, normal, and the value on a line.

use super::has_slope;
use crate::scene::{Node, Shape};

/// The result of a function.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Value,
    Gradient,
    /// A gradient whose direction is as exact as possible.
    Normal,
    /// Value, slope and limits of the second derivative on a line (`glsl/common/on_line.glsl`).
    Line,
}

impl Kind {
    pub fn of_type(self) -> &'static str {
        match self {
            Kind::Value => "float",
            Kind::Gradient | Kind::Normal => "vec4",
            Kind::Line => "OnLine",
        }
    }

    pub fn function(self) -> &'static str {
        match self {
            Kind::Value => "field",
            Kind::Gradient => "gradient",
            Kind::Normal => "normal",
            Kind::Line => "onLine",
        }
    }

    /// The parameters of the function.
    pub fn parameters(self) -> &'static str {
        match self {
            Kind::Line => "vec3 p, vec3 d",
            _ => "vec3 p",
        }
    }

    /// The start of the names of the operators' functions.
    pub fn operator(self) -> &'static str {
        match self {
            Kind::Line => "onLine",
            _ => "op",
        }
    }

    pub fn prefix(self, node: &Node) -> &'static str {
        match self {
            Kind::Value => "sd",
            Kind::Normal if takes_differences(node) => "gn",
            Kind::Gradient | Kind::Normal | Kind::Line => "gd",
        }
    }
}

/// Whether some part of the field's gradient is computed by differences.
pub(in crate::shader) fn has_differences(field: &Shape) -> bool {
    let mut nodes = field.nodes().into_iter();
    nodes.any(|node| takes_differences(&node.node))
}

/// Whether a node is a user's field whose text neither states a gradient nor is differentiated.
fn takes_differences(node: &Node) -> bool {
    node.user().is_some_and(|user| !has_slope(user))
}
