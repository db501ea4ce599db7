//! Which surfaces stand in the shader's text one by one, and which lie in cells.
//!
//! A few surfaces are unrolled: each has its own lines of text. Of many, only *kinds* are
//! in the text (a shape, turned or not), and the surfaces of a kind are data; cells say
//! which of them can be met where. What has no end cannot lie in a cell, but along an axis
//! along which most have none (a hall of endless pillars) the cells have no end, either.

use super::signature::SurfaceStructure;
use crate::scene::shape::MOST_NODES;
use crate::scene::{Scene, Surface};

/// Surfaces that could lie in cells from which on they do. Below, unrolled text compiles in
/// well under a second, and what is in it needs no look-up.
pub const CELLS_FROM: usize = 24;

/// Surfaces that are unrolled, kinds, and nodes of their fields, at the most: with the time that
/// it takes to compile their text, which grows faster than they do. 500 planes took llvmpipe 8 s
/// and 0.5 GB, 1,000 took more than 30 s and 1.7 GB, and a field of 4,000 nodes more than 7 GB.
pub const MOST_UNROLLED: usize = MOST_NODES;

/// The parting of a scene's surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Indices of the surfaces that are unrolled.
    pub unrolled: Vec<usize>,
    /// For each kind the index of its first surface.
    pub instanced: Vec<usize>,
    /// For each surface the kind that it is of, if it lies in cells.
    pub kind_of: Vec<Option<u32>>,
    /// Axes along which cells have no end.
    pub unbounded_axes: [bool; 3],
}

impl Layout {
    /// The parting of a scene; it depends on what its text depends on, and on no position.
    pub fn of(scene: &Scene) -> Layout {
        let all = scene.surfaces.len();
        let unrolled = Layout {
            unrolled: (0..all).collect(),
            instanced: Vec::new(),
            kind_of: vec![None; all],
            unbounded_axes: [false; 3],
        };
        if all < CELLS_FROM {
            return unrolled;
        }
        let endless: Vec<[bool; 3]> = scene.surfaces.iter().map(endless_axes).collect();
        let candidates = endless.iter().filter(|axes| **axes != [true; 3]).count();
        let unbounded_axes = [0, 1, 2].map(|axis| {
            let along = endless
                .iter()
                .filter(|e| **e != [true; 3] && e[axis])
                .count();
            2 * along > candidates
        });
        let fits = |axes: &[bool; 3]| {
            *axes != [true; 3] && (0..3).all(|axis| !axes[axis] || unbounded_axes[axis])
        };
        if endless.iter().filter(|axes| fits(axes)).count() < CELLS_FROM {
            return unrolled;
        }
        let mut layout = Layout {
            unrolled: Vec::new(),
            unbounded_axes,
            ..unrolled
        };
        let mut structures: Vec<SurfaceStructure> = Vec::new();
        for (index, surface) in scene.surfaces.iter().enumerate() {
            if !fits(&endless[index]) {
                layout.unrolled.push(index);
                continue;
            }
            let structure = SurfaceStructure::as_data(surface);
            // More kinds than may be there are refused, and not told apart any more.
            let known = match structures.len() {
                ..=MOST_UNROLLED => structures.iter().position(|s| *s == structure),
                _ => None,
            };
            let kind = known.unwrap_or_else(|| {
                structures.push(structure);
                layout.instanced.push(index);
                structures.len() - 1
            });
            layout.kind_of[index] = Some(kind as u32);
        }
        layout
    }

    /// Whether there are cells at all.
    pub fn has_cells(&self) -> bool {
        !self.instanced.is_empty()
    }
}

/// The axes along which a surface has no end, on either side.
fn endless_axes(surface: &Surface) -> [bool; 3] {
    let bounds = surface.bounds();
    [0, 1, 2].map(|axis| !(bounds.min[axis].is_finite() && bounds.max[axis].is_finite()))
}
