//! Facets with an index by direction, for many evaluations: only the facets near a direction are tested.

use super::facets::{Facets, Weight};
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
        let caps: Vec<(DVec3, f64)> = facets.caps().collect();
        let near = |cell: usize| {
            let (middle, reach) = cap(cell);
            let is_near = |(_, (centre, radius)): &(usize, &(DVec3, f64))| {
                centre.distance(middle) <= radius + reach + ROUNDING
            };
            let found = caps.iter().enumerate().filter(is_near);
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

    /// Protects the weights from the index: they are those of a search among all facets, for directions all around, on
    /// a half-space, and between two directions.
    #[test]
    fn the_index_leaves_out_no_facet() {
        let half: Vec<DVec3> = grid(15).into_iter().filter(|d| d.z > -0.01).collect();
        let few = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_ONE.normalize()];
        let two = vec![DVec3::X, DVec3::Y];
        for directions in [grid(5), lattice(300).collect(), half, few, two] {
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
