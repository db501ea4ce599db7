//! How the surfaces of a kind lie in its cells, for lines.
//!
//! A cell is one *record*: so many vectors that the surface in it is tested at once. One number
//! of its first vector is the *tag*:
//!
//! | tag | what the record is |
//! | --- | --- |
//! | the number of a surface | that surface, the last of its list: next is the next cell |
//! | the number times −1 | that surface; the next of the list lies behind it |
//! | 0, and the first component is not 0 | where the cell's list begins, of several surfaces |
//! | 0 | an empty cell, or none |
//!
//! The values of a surface are in its record as elsewhere, after a vector for the tag
//! (with the first component for the place of a list), unless they leave a component of their
//! first vector free: a box does, and an endless pillar, whose height means nothing.

use super::surface_values::value_count;
use crate::scene::{Node, Surface};
use glam::Vec4;

/// Where the tag and the values of a record lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Whether a vector of its own holds the tag.
    pub has_head: bool,
    /// The component of the first vector that is the tag.
    pub tag: usize,
    /// Vectors of a record.
    pub vectors: usize,
}

impl Record {
    /// That of a surface's kind.
    pub fn of(surface: &Surface) -> Record {
        let free = match surface.shape.node {
            Node::Cuboid(_) => Some(3),
            Node::Cylinder(_) if !surface.has_rotation() => Some(1),
            _ => None,
        };
        let values = value_count(surface, true);
        Record {
            has_head: free.is_none(),
            tag: free.unwrap_or(1),
            vectors: values + usize::from(free.is_none()),
        }
    }

    /// The tag's name in GLSL.
    pub fn component(&self) -> &'static str {
        ["x", "y", "z", "w"][self.tag]
    }

    /// The record of a surface with these values.
    pub fn push(&self, tag: f32, values: &[Vec4], records: &mut Vec<Vec4>) {
        let first = records.len();
        if self.has_head {
            records.push(Vec4::ZERO);
        }
        records.extend_from_slice(values);
        records[first][self.tag] = tag;
    }
}
