//! Which surfaces are unrolled in the shader's text, and which are in cells.
//!
//! A few surfaces are unrolled: each has its own lines of text. Of many of a *kind* (a shape,
//! turned or not) only the kind is in the text, and its surfaces are data; cells list which of
//! them can be met where. What has no end cannot lie in a cell, but along an axis along which
//! most have none (a hall of endless pillars) the cells have no end, either.
//!
//! The choice is one of cost, kind by kind. Unrolled, each surface costs the same in every
//! evaluation. In cells a kind costs about as much as so many unrolled surfaces, however many
//! it has ([`Layout::of`], docs/benchmarks/surfaces-llvmpipe.md).

use super::cells::Lists;
use super::signature::SurfaceStructure;
use crate::scene::Surface;
use crate::scene::shape::MOST_NODES;

/// Surfaces of a kind from which on lines find them sooner in cells than unrolled.
const LINES_FROM: usize = 10;

/// Surfaces of a kind from which on distances are found sooner in cells.
const DISTANCES_FROM: usize = 24;

/// Vectors that describe the grid of a kind with its own cells to the shader.
pub const GRID_VECTORS: usize = 5;

/// Surfaces that could lie in cells and are unrolled at most: more take long to compile,
/// however few there are of each kind.
const UNROLLED_AT_MOST: usize = 23;

/// Surfaces that are unrolled, kinds, and nodes of their fields, at most: with the time that
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

/// The surfaces of a kind that could lie in cells, in their order.
struct Kind {
    structure: SurfaceStructure,
    surfaces: Vec<usize>,
}

impl Layout {
    /// The division of surfaces for the readers of these lists; it depends on what their text depends
    /// on, and on no position.
    pub fn of(surfaces: &[Surface], lists: Lists) -> Layout {
        let all = surfaces.len();
        let unrolled = Layout {
            unrolled: (0..all).collect(),
            instanced: Vec::new(),
            kind_of: vec![None; all],
            unbounded_axes: [false; 3],
        };
        let from = match lists {
            Lists::Lines | Lists::Overlapping => LINES_FROM,
            Lists::NearestCandidates => DISTANCES_FROM,
        };
        if all < from {
            return unrolled;
        }
        let endless: Vec<[bool; 3]> = surfaces.iter().map(endless_axes).collect();
        let unbounded_axes = mostly_endless(&endless);
        let fits = |axes: &[bool; 3]| {
            *axes != [true; 3] && (0..3).all(|axis| !axes[axis] || unbounded_axes[axis])
        };
        let fitting = (0..all).filter(|&index| fits(&endless[index]));
        let in_cells = in_cells(kinds(surfaces, fitting), from);
        let mut layout = Layout {
            instanced: in_cells.iter().map(|kind| kind.surfaces[0]).collect(),
            unbounded_axes,
            ..unrolled
        };
        for (number, kind) in in_cells.iter().enumerate() {
            for &index in &kind.surfaces {
                layout.kind_of[index] = Some(number as u32);
            }
        }
        let kind_of = &layout.kind_of;
        layout.unrolled.retain(|&index| kind_of[index].is_none());
        layout
    }

    /// Whether there are cells at all.
    pub fn has_cells(&self) -> bool {
        !self.instanced.is_empty()
    }

    /// The surfaces in cells whose kind is wanted, in their order.
    pub fn surfaces_of(&self, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let of = |index: &usize| self.kind_of[*index].is_some_and(|kind| wanted(kind as usize));
        (0..self.kind_of.len()).filter(of).collect()
    }
}

/// The axes along which most surfaces have no end, of those that have ends along any.
fn mostly_endless(endless: &[[bool; 3]]) -> [bool; 3] {
    let candidates = endless.iter().filter(|axes| **axes != [true; 3]);
    let count = candidates.clone().count();
    [0, 1, 2].map(|axis| 2 * candidates.clone().filter(|axes| axes[axis]).count() > count)
}

/// The kinds of these surfaces, in the order of their first ones.
fn kinds(surfaces: &[Surface], wanted: impl Iterator<Item = usize>) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for index in wanted {
        let structure = SurfaceStructure::as_data(&surfaces[index]);
        // More kinds than may be there are refused, and not told apart any more.
        let known = match kinds.len() {
            ..=MOST_UNROLLED => kinds.iter().position(|kind| kind.structure == structure),
            _ => None,
        };
        match known {
            Some(kind) => kinds[kind].surfaces.push(index),
            None => kinds.push(Kind {
                structure,
                surfaces: vec![index],
            }),
        }
    }
    kinds
}

/// The kinds of so many surfaces or more; and the largest of the others, until few are left.
fn in_cells(kinds: Vec<Kind>, from: usize) -> Vec<Kind> {
    let mut sizes: Vec<usize> = kinds.iter().map(|kind| kind.surfaces.len()).collect();
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    let mut left: usize = sizes.iter().sum();
    let mut least = from;
    for size in sizes {
        if size < from && left <= UNROLLED_AT_MOST {
            break;
        }
        least = least.min(size);
        left -= size;
    }
    let is_in = |kind: &Kind| kind.surfaces.len() >= least;
    kinds.into_iter().filter(is_in).collect()
}

/// The axes along which a surface has no end, on either side.
fn endless_axes(surface: &Surface) -> [bool; 3] {
    let bounds = surface.bounds();
    [0, 1, 2].map(|axis| !(bounds.min[axis].is_finite() && bounds.max[axis].is_finite()))
}
