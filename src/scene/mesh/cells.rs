//! A uniform grid of cells over a mesh, with which a GPU finds the triangles on a line.
//!
//! A cell through which a triangle passes has a list of such triangles. Every other cell has a *skip distance* k: all
//! cells up to k − 1 cells away along any axis or diagonal are free, so that a line can leave this block at once. It also
//! states whether the cell is air or solid.
//!
//! A triangle is listed in the cells that its projection along the largest component of its normal covers, between the
//! least and the greatest height of its plane over each of these cells. A margin covers the rounding of positions in
//! `f32`.

use super::TriangleMesh;
use super::triangle::Triangle;
use glam::{DVec2, DVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Least number of cells. A grid of this size takes a quarter of a MiB.
const LEAST_CELLS: usize = 1 << 16;

/// Cells for each triangle.
const CELLS_A_TRIANGLE: usize = 4;

/// Maximum number of cells. A grid of this size takes 16 MiB.
const MOST_CELLS: usize = 1 << 22;

/// Maximum number of cells along an axis. The rounding of a position is then far below the margin of the lists.
const MOST_ALONG_AXIS: u32 = 1024;

/// Margin of a triangle in its lists, as a share of a cell.
const MARGIN: f64 = 0.01;

/// Triangles in a vector of a list. The fourth component states whether another vector follows.
const TRIANGLES_A_VECTOR: usize = 3;

/// The grid of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct MeshCells {
    /// The corner with the least coordinates in metres, in the axes of the mesh.
    pub origin: Vec3,
    /// Width of a cell in metres.
    pub size: f32,
    /// Cells along each axis.
    pub count: UVec3,
    /// One number for each cell, x first: −1 − n for the list that begins at vector n; otherwise the skip distance, plus
    /// 0.5 in the solid.
    pub words: Vec<f32>,
    /// Vectors of lists: the indices of up to three triangles, −1 for none, and 1 if another vector follows.
    pub lists: Vec<[f32; 4]>,
    /// Vectors of the longest list.
    pub longest_list: usize,
}

/// The shape of the grid.
struct Grid {
    origin: DVec3,
    size: f64,
    count: UVec3,
}

impl MeshCells {
    pub fn of(mesh: &TriangleMesh) -> MeshCells {
        let grid = Grid::of(mesh);
        let mut pairs: Vec<(u32, u32)> = (0..mesh.triangle_count() as u32)
            .into_par_iter()
            .flat_map_iter(|index| {
                let cells = grid.cells_of(&mesh.triangle(index));
                cells.into_iter().map(move |cell| (cell, index))
            })
            .collect();
        pairs.par_sort_unstable();
        let total = grid.total();
        let mut words = vec![0.0_f32; total];
        let mut lists = Vec::new();
        let mut longest_list = 0;
        for list in pairs.chunk_by(|a, b| a.0 == b.0) {
            words[list[0].0 as usize] = -1.0 - lists.len() as f32;
            let vectors = list.chunks(TRIANGLES_A_VECTOR);
            longest_list = longest_list.max(vectors.len());
            let last = vectors.len() - 1;
            lists.extend(vectors.enumerate().map(|(place, part)| {
                let index = |at: usize| part.get(at).map_or(-1.0, |(_, index)| *index as f32);
                [index(0), index(1), index(2), f32::from(place < last)]
            }));
        }
        grid.add_skips(&mut words);
        grid.add_sides(mesh, &mut words);
        MeshCells {
            origin: grid.origin.as_vec3(),
            size: grid.size as f32,
            count: grid.count,
            words,
            lists,
            longest_list,
        }
    }

    /// Maximum turns of the loops over the cells on a line, their lists and the triangles of these (`hitMesh` in
    /// `glsl/shape/mesh.glsl`). A driver may count the turns of several lines together, each of which flies through
    /// other free cells.
    pub fn turns_on_line(&self) -> u64 {
        const LINES: u64 = 8;
        const TRIANGLES: u64 = 3;
        let cells = self.count.element_sum() as u64;
        cells * (1 + LINES + self.longest_list as u64 * (1 + TRIANGLES))
    }
}

impl Grid {
    fn of(mesh: &TriangleMesh) -> Grid {
        let bounds = mesh.bounds();
        let extent = bounds.max - bounds.min;
        // A flat mesh has a thin grid.
        let extent = extent.max(DVec3::splat(1e-3 * extent.max_element()));
        let wanted = (CELLS_A_TRIANGLE * mesh.triangle_count()).clamp(LEAST_CELLS, MOST_CELLS);
        let by_volume = (extent.element_product() / wanted as f64).cbrt();
        let size = by_volume.max(extent.max_element() / f64::from(MOST_ALONG_AXIS - 2));
        // Half a cell on each side, so that no face lies at the border of the grid. The size is a number in `f32`.
        let size = f64::from(size as f32);
        let count = (extent / size).ceil().as_uvec3() + 1;
        let spare = count.as_dvec3() * size - extent;
        Grid {
            origin: (bounds.min - 0.5 * spare).as_vec3().as_dvec3(),
            size,
            count,
        }
    }

    fn total(&self) -> usize {
        self.count.to_array().iter().map(|n| *n as usize).product()
    }

    fn index(&self, cell: UVec3) -> u32 {
        (cell.z * self.count.y + cell.y) * self.count.x + cell.x
    }

    /// The first and the last cell along an axis between two coordinates.
    fn range(&self, axis: usize, low: f64, high: f64) -> std::ops::RangeInclusive<u32> {
        let last = f64::from(self.count[axis] - 1);
        let cell = |at: f64| {
            ((at - self.origin[axis]) / self.size)
                .floor()
                .clamp(0.0, last) as u32
        };
        cell(low)..=cell(high)
    }

    /// The cells in whose lists a triangle is.
    fn cells_of(&self, triangle: &Triangle) -> Vec<u32> {
        let margin = MARGIN * self.size;
        let corners = triangle.corners.map(|corner| corner.as_dvec3());
        let normal = triangle.exact_normal();
        let up = normal.abs().max_position();
        let (u, v) = ((up + 1) % 3, (up + 2) % 3);
        let low = corners[0].min(corners[1]).min(corners[2]) - margin;
        let high = corners[0].max(corners[1]).max(corners[2]) + margin;
        let flat = corners.map(|corner| DVec2::new(corner[u], corner[v]));
        let half = 0.5 * self.size + margin;
        let (slope_u, slope_v) = (-normal[u] / normal[up], -normal[v] / normal[up]);
        let mut found = Vec::new();
        for cell_v in self.range(v, low[v], high[v]) {
            for cell_u in self.range(u, low[u], high[u]) {
                let middle = DVec2::new(
                    self.origin[u] + (f64::from(cell_u) + 0.5) * self.size,
                    self.origin[v] + (f64::from(cell_v) + 0.5) * self.size,
                );
                if !covers(&flat, middle, half) {
                    continue;
                }
                let height = corners[0][up]
                    + slope_u * (middle.x - flat[0].x)
                    + slope_v * (middle.y - flat[0].y);
                let reach = (slope_u.abs() + slope_v.abs()) * half + margin;
                let (bottom, top) = (
                    (height - reach).max(low[up]),
                    (height + reach).min(high[up]),
                );
                if bottom > top {
                    continue;
                }
                for cell_up in self.range(up, bottom, top) {
                    let mut cell = UVec3::ZERO;
                    (cell[u], cell[v], cell[up]) = (cell_u, cell_v, cell_up);
                    found.push(self.index(cell));
                }
            }
        }
        found
    }

    /// Writes the skip distances: the chessboard distance to the nearest cell with a list, by two passes over all
    /// neighbours (Rosenfeld and Pfaltz 1968).
    fn add_skips(&self, words: &mut [f32]) {
        let [nx, ny, nz] = self.count.to_array().map(|n| n as i64);
        let before: Vec<[i64; 3]> = (-1..=1)
            .flat_map(|z| (-1..=1).flat_map(move |y| (-1..=1).map(move |x| [x, y, z])))
            .take(13)
            .collect();
        let far = nx.max(ny).max(nz);
        let mut steps: Vec<u16> = words
            .iter()
            .map(|w| if *w < 0.0 { 0 } else { far as u16 })
            .collect();
        for side in [1, -1] {
            for place in 0..nx * ny * nz {
                let at = if side > 0 {
                    place
                } else {
                    nx * ny * nz - 1 - place
                };
                if steps[at as usize] == 0 {
                    continue;
                }
                let [x, y, z] = [at % nx, at / nx % ny, at / (nx * ny)];
                for [dx, dy, dz] in &before {
                    let (x, y, z) = (x + side * dx, y + side * dy, z + side * dz);
                    let is_within =
                        (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
                    if is_within {
                        let other = steps[((z * ny + y) * nx + x) as usize] + 1;
                        let own = &mut steps[at as usize];
                        *own = (*own).min(other);
                    }
                }
            }
        }
        for (word, steps) in words
            .iter_mut()
            .zip(steps)
            .filter(|(word, _)| **word >= 0.0)
        {
            *word = f32::from(steps);
        }
    }

    /// Marks the free cells in the solid. Neighbouring free cells are on the same side.
    fn add_sides(&self, mesh: &TriangleMesh, words: &mut [f32]) {
        let [nx, ny, nz] = self.count.to_array();
        let mut is_known: Vec<bool> = words.iter().map(|word| *word < 0.0).collect();
        let mut part = Vec::new();
        for first in 0..words.len() as u32 {
            if is_known[first as usize] {
                continue;
            }
            let cell = UVec3::new(first % nx, first / nx % ny, first / (nx * ny));
            let middle = self.origin + (cell.as_dvec3() + 0.5) * self.size;
            let is_solid = mesh.distance(middle) < 0.0;
            is_known[first as usize] = true;
            part.push(first);
            while let Some(at) = part.pop() {
                if is_solid {
                    words[at as usize] += 0.5;
                }
                let cell = UVec3::new(at % nx, at / nx % ny, at / (nx * ny));
                for (axis, stride) in [1, nx, nx * ny].into_iter().enumerate() {
                    let below = (cell[axis] > 0).then(|| at - stride);
                    let above = (cell[axis] + 1 < [nx, ny, nz][axis]).then(|| at + stride);
                    for other in below.into_iter().chain(above) {
                        if !is_known[other as usize] {
                            is_known[other as usize] = true;
                            part.push(other);
                        }
                    }
                }
            }
        }
    }
}

/// Whether a triangle in a plane can cover part of a square, by the separating axis theorem.
fn covers(triangle: &[DVec2; 3], middle: DVec2, half: f64) -> bool {
    let [a, b, c] = triangle.map(|corner| corner - middle);
    [(a, b, c), (b, c, a), (c, a, b)]
        .into_iter()
        .all(|(from, to, other)| {
            let across = (to - from).perp();
            let (edge, far) = (across.dot(from), across.dot(other));
            let reach = half * (across.x.abs() + across.y.abs());
            let (low, high) = (edge.min(far), edge.max(far));
            low <= reach && high >= -reach
        })
}
