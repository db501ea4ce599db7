//! Facets with an index by direction, for many evaluations: only the facets near a direction are tested.

use super::facets::{Extent, Facets, Weight};
use crate::sphere_cells::Cells;
use glam::DVec3;
use rayon::prelude::*;

/// Number of cells of the index. A cell has a width of about 3°, less than the usual 5° between measured directions.
const CELLS: f64 = 6144.0;

/// Distance on the unit sphere by which the search for facets exceeds a cell. It exceeds the rounding error of a
/// direction on the edge of a cell.
const ROUNDING: f64 = 1e-6;

/// Measured directions, and the facets that may contain the directions of each cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct IndexedFacets {
    facets: Facets,
    /// For each cell, the indices of facets in ascending order.
    near: Vec<Vec<u32>>,
}

impl IndexedFacets {
    /// Triangulates `directions`, which must be distinct unit vectors.
    pub(crate) fn new(directions: Vec<DVec3>) -> IndexedFacets {
        let facets = Facets::new(directions);
        let extents: Vec<Extent> = facets.extents().collect();
        let near = |cell: usize| {
            let (middle, reach) = cap(cell);
            let all = extents.iter().enumerate();
            let found = all.filter(|(_, extent)| extent.may_meet(middle, reach + ROUNDING));
            found.map(|(index, _)| index as u32).collect()
        };
        let near = (0..cells().count()).into_par_iter().map(near).collect();
        IndexedFacets { facets, near }
    }

    /// The measured directions.
    pub(crate) fn directions(&self) -> &[DVec3] {
        self.facets.directions()
    }

    /// The measured directions around a direction (a unit vector), with weights that add up to 1.
    pub(crate) fn around(&self, from: DVec3) -> [Weight; 3] {
        self.facets.around_among(&self.near[cells().of(from)], from)
    }
}

fn cells() -> Cells {
    Cells::about(CELLS)
}

/// The middle of a cell, and the distance from it within which all directions of the cell lie. The edges of a cell are
/// arcs of great circles, so a corner is farthest from the middle.
fn cap(cell: usize) -> (DVec3, f64) {
    let at = |place: [f64; 2]| cells().direction(cell, place).0;
    let middle = at([0.5; 2]);
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
    let distances = corners.map(|corner| at(corner).distance(middle));
    (middle, distances.into_iter().fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::super::tests::grid;
    use super::*;
    use crate::sampling::lattice;
    use std::f64::consts::{FRAC_PI_3, TAU};

    /// A pole and a ring of directions at 60° on the other side of the equator: facets of 150° by less than 1°.
    fn narrow_facets(count: usize) -> Vec<DVec3> {
        let (down, flat) = FRAC_PI_3.sin_cos();
        let on_ring = |number: usize| {
            let (sin, cos) = (TAU * number as f64 / count as f64).sin_cos();
            DVec3::new(flat * cos, flat * sin, -down)
        };
        (0..count).map(on_ring).chain([DVec3::Z]).collect()
    }

    /// Protects the time of evaluations in files with narrow facets: only the facets that cross a cell are tested.
    #[test]
    fn few_narrow_facets_are_near_a_cell() {
        const COUNT: usize = 5000;
        let indexed = IndexedFacets::new(narrow_facets(COUNT));
        let near: usize = indexed.near.iter().map(Vec::len).sum();
        // A facet of 150° crosses about 50 cells of 3°. Its cap would meet half of all cells.
        assert!(near < 300 * COUNT, "{}", near / COUNT);
    }

    /// Protects the weights from the index: they are those of a search among all facets, for directions all around, on
    /// a half-space, on long narrow facets, and between two directions.
    #[test]
    fn the_index_leaves_out_no_facet() {
        let half: Vec<DVec3> = grid(15).into_iter().filter(|d| d.z > -0.01).collect();
        let few = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_ONE.normalize()];
        let two = vec![DVec3::X, DVec3::Y];
        let narrow = narrow_facets(500);
        for directions in [grid(5), lattice(300).collect(), half, narrow, few, two] {
            let (all, indexed) = (
                Facets::new(directions.clone()),
                IndexedFacets::new(directions),
            );
            let measured = all.directions().to_vec();
            for from in lattice(5000).chain(measured) {
                assert_eq!(indexed.around(from), all.around(from), "{from}");
            }
        }
    }
}
