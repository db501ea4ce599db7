//! The grid: uniform cells around the surfaces.

use super::ENDLESS;
use crate::scene::Bounds3;
use glam::{DVec3, UVec3};

/// Approximate number of cells per surface. With this number most cells hold at most one surface. Between 2 and 5 cells
/// per surface, the rates of `hybrid` differ by less than a tenth: with fewer cells their lists are longer, and with
/// more cells a line crosses more of them.
pub const CELLS_A_SURFACE: f64 = 2.0;

/// Approximate number of cells per surface if cells list the boxes of marched surfaces. A march costs as much as
/// several cells, and with smaller cells fewer surfaces are marched before the first hit. A frame is a tenth to a third
/// faster than with 2 cells per surface.
pub const CELLS_A_BOX: f64 = 4.0;

/// Maximum cells along an axis. With this number rounding moves a face of the last cell by a quarter of [`PAD`].
const MOST_CELLS: f64 = 1024.0;

/// Extension of every cell when lists are built, as a share of its size. A point that rounding moves into the next cell
/// must find the same surfaces there.
const PAD: f64 = 1e-3;

/// The empty border of the grid, as a share of its size. Surfaces that move within this border require no new grid.
const BORDER: f64 = 0.05;

/// The position and size of a grid's cells, in world metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The corner with the lowest coordinates.
    pub origin: DVec3,
    /// Width, height and depth of a cell.
    pub cell: DVec3,
    /// Cells along each axis.
    pub count: UVec3,
    /// Bounds of all surfaces in the grid: smaller than the grid.
    pub inner: Bounds3,
}

impl Grid {
    /// A grid of about `wanted` cells within `inner`.
    pub fn around(inner: Bounds3, wanted: f64, unbounded_axes: [bool; 3]) -> Grid {
        let size = inner.max - inner.min;
        let longest = (0..3)
            .filter(|&axis| !unbounded_axes[axis])
            .map(|axis| size[axis])
            .fold(0.0, f64::max);
        let border = DVec3::from_array([0, 1, 2].map(|axis| match unbounded_axes[axis] {
            true => 0.0,
            false => BORDER * longest.max(1e-3),
        }));
        let outer = inner.grown(border);
        let size = outer.max - outer.min;
        let along: Vec<f64> = (0..3)
            .filter(|&a| !unbounded_axes[a])
            .map(|a| size[a])
            .collect();
        let edge = (along.iter().product::<f64>() / wanted).powf(1.0 / along.len().max(1) as f64);
        let count = [0, 1, 2].map(|axis| match unbounded_axes[axis] {
            true => 1,
            false => (size[axis] / edge).round().clamp(1.0, MOST_CELLS) as u32,
        });
        let count = UVec3::from_array(count);
        Grid {
            origin: outer.min,
            cell: size / count.as_dvec3(),
            count,
            inner,
        }
    }

    /// Whether the border around the surfaces still has at least half its original width.
    pub fn has_room(&self) -> bool {
        let end = self.origin + self.cell * self.count.as_dvec3();
        let unbounded_axes = self.cell.cmpge(DVec3::splat(2.0 * ENDLESS));
        let border = 0.5 * BORDER / (1.0 + 2.0 * BORDER);
        let longest = DVec3::select(unbounded_axes, DVec3::ZERO, end - self.origin).max_element();
        let free = (self.inner.min - self.origin).min(end - self.inner.max);
        (0..3).all(|axis| unbounded_axes.test(axis) || free[axis] >= border * longest)
    }

    pub fn cells(&self) -> usize {
        self.count.element_product() as usize
    }

    pub fn index(&self, at: UVec3) -> usize {
        ((at.z * self.count.y + at.y) * self.count.x + at.x) as usize
    }

    pub fn at(&self, index: usize) -> UVec3 {
        let index = index as u32;
        let (x, rest) = (index % self.count.x, index / self.count.x);
        UVec3::new(x, rest % self.count.y, rest / self.count.y)
    }

    pub fn padded(&self, at: UVec3) -> Bounds3 {
        let min = self.origin + self.cell * at.as_dvec3();
        let max = min + self.cell;
        Bounds3 { min, max }.grown(PAD * self.cell)
    }

    /// The first and the last cell that a box overlaps.
    pub fn range(&self, bounds: Bounds3) -> (UVec3, UVec3) {
        let padded = bounds.grown(PAD * self.cell);
        let last = (self.count - 1).as_dvec3();
        let cell = |place: DVec3| ((place - self.origin) / self.cell).floor();
        let held = |place: DVec3| cell(place).clamp(DVec3::ZERO, last).as_uvec3();
        (held(padded.min), held(padded.max))
    }

    /// Blocks of neighbouring cells. Most surfaces are excluded for a whole block at once.
    pub fn blocks(&self) -> Vec<Vec<usize>> {
        const SIDE: u32 = 4;
        let blocks = (self.count + (SIDE - 1)) / SIDE;
        let mut all = vec![Vec::new(); blocks.element_product() as usize];
        for index in 0..self.cells() {
            let block = self.at(index) / SIDE;
            let place = (block.z * blocks.y + block.y) * blocks.x + block.x;
            all[place as usize].push(index);
        }
        all
    }
}
