//! Finds the measured directions that surround a direction, and their weights.
//!
//! The directions are triangulated once, by the Delaunay triangulation on the sphere. Its facets are the facets of the
//! directions' convex hull. Stereographic projection from one of the directions reduces this to a triangulation in the
//! plane (K. Q. Brown, Information Processing Letters 9, 1979): the triangles of the plane's Delaunay triangulation are
//! the facets that do not touch that direction. The remaining facets connect that direction with the edges of the
//! plane's hull.
//!
//! # Weights
//! For a direction d that passes through a facet with corners a, b and c, the weights solve w₁ a + w₂ b + w₃ c = d.
//! They are non-negative and scaled so that they add up to 1 (the vector base of V. Pulkki, JAES 45, 1997). They are
//! continuous over the whole sphere, and 1 at a measured direction.
//!
//! # Directions without a facet
//! If the measured directions do not surround the head (a ring, a half-space), some directions lie in no facet. For
//! these directions the three nearest measured directions are used, weighted by the inverse of the angle. This
//! interpolation has small discontinuities.

use glam::{DMat3, DVec3, I64Vec3};
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// Directions with a smaller angle (radians) between them count as one: 0.0006°, far below the
/// resolution of any measurement, and far above the rounding of degrees in `f32`.
const LEAST_ANGLE: f64 = 1e-5;

/// Least distance of a facet's plane from the listener, relative to the distance of the directions. The corners of a
/// closer facet lie almost on a great circle, so they do not determine the directions through it.
const LEAST_OFFSET: f64 = 1e-3;

/// Twice the area below which a facet counts as a line: the area of a triangle with one side of [`LEAST_ANGLE`] and
/// another side of a tenth of a degree.
const LEAST_AREA: f64 = LEAST_ANGLE * 1.7e-3;

/// Rounding of the weights of a direction on the edge between two facets.
const EDGE: f64 = 1e-9;

/// A measured direction and its weight.
pub(crate) type Weight = (usize, f64);

#[derive(Clone, Debug, PartialEq)]
struct Facet {
    corners: [usize; 3],
    /// Matrix from a direction to the weights of the three corners.
    inverse: DMat3,
}

/// A cap and three half-spaces that contain all directions of a facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    /// The middle of the cap: a unit vector.
    middle: DVec3,
    /// Distance from the middle to the edge of the cap, as between points on the unit sphere.
    radius: f64,
    /// Unit normals of the planes through the edges and the centre of the sphere, into the facet.
    inward: [DVec3; 3],
}

impl Extent {
    /// Whether the facet may contain directions at most `reach` from `middle`, as distances between points on the unit
    /// sphere.
    pub(crate) fn may_meet(&self, middle: DVec3, reach: f64) -> bool {
        self.middle.distance(middle) <= self.radius + reach
            && self
                .inward
                .iter()
                .all(|normal| normal.dot(middle) >= -reach)
    }
}

/// The facets between measured directions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Facets {
    directions: Vec<DVec3>,
    facets: Vec<Facet>,
}

impl Facets {
    /// Triangulates `directions`, which must be distinct ([`distinct`]) unit vectors.
    pub(crate) fn new(directions: Vec<DVec3>) -> Facets {
        let middle = directions.iter().sum::<DVec3>() / directions.len().max(1) as f64;
        let corners = triangulate(&directions);
        let facet = |corners: [usize; 3]| facet(&directions, middle, corners);
        let facets = corners.into_iter().filter_map(facet).collect();
        Facets { directions, facets }
    }

    /// The measured directions.
    pub(crate) fn directions(&self) -> &[DVec3] {
        &self.directions
    }

    /// The measured directions around a direction (a unit vector), with weights that add up to 1.
    pub(crate) fn around(&self, from: DVec3) -> [Weight; 3] {
        self.within(self.facets.iter(), from)
            .unwrap_or_else(|| self.nearest(from))
    }

    /// Like [`around`](Self::around), if only the facets with these indices can contain the direction.
    pub(crate) fn around_among(&self, facets: &[u32], from: DVec3) -> [Weight; 3] {
        let facets = facets.iter().map(|index| &self.facets[*index as usize]);
        self.within(facets, from)
            .unwrap_or_else(|| self.nearest(from))
    }

    /// The extent of each facet on the sphere.
    pub(crate) fn extents(&self) -> impl Iterator<Item = Extent> + '_ {
        self.facets.iter().map(|facet| {
            let corners = facet.corners.map(|corner| self.directions[corner]);
            let middle = corners.iter().sum::<DVec3>().normalize();
            let distances = corners.map(|corner| corner.distance(middle));
            Extent {
                middle,
                radius: distances.into_iter().fold(0.0, f64::max),
                inward: [0, 1, 2].map(|corner| facet.inverse.row(corner).normalize()),
            }
        })
    }

    /// The weights in the facet that contains the direction, out of `facets`. If several facets contain the direction,
    /// the facet with the largest minimum weight is used.
    fn within<'a>(
        &self,
        facets: impl Iterator<Item = &'a Facet>,
        from: DVec3,
    ) -> Option<[Weight; 3]> {
        let mut best = (-EDGE, None);
        for facet in facets {
            let weights = facet.inverse * from;
            let sum = weights.element_sum();
            let inside = weights.min_element() / sum;
            if sum > 0.0 && inside > best.0 {
                best = (inside, Some((facet, weights.max(DVec3::ZERO))));
            }
        }
        let (facet, weights) = best.1?;
        let share = weights / weights.element_sum();
        Some(std::array::from_fn(|at| (facet.corners[at], share[at])))
    }

    /// The three nearest measured directions, weighted by the inverse of their angle; only one if it equals `from`.
    fn nearest(&self, from: DVec3) -> [Weight; 3] {
        let mut found = [(0, f64::INFINITY); 3];
        for (index, direction) in self.directions.iter().enumerate() {
            let angle = direction.distance(from);
            let place = found.iter().position(|(_, other)| angle < *other);
            if let Some(place) = place {
                found[place..].rotate_right(1);
                found[place] = (index, angle);
            }
        }
        if found[0].1 < LEAST_ANGLE {
            return [(found[0].0, 1.0), (found[0].0, 0.0), (found[0].0, 0.0)];
        }
        // With fewer than three directions, the remaining entries have an infinite angle and thus no weight.
        let sum: f64 = found.iter().map(|(_, angle)| 1.0 / angle).sum();
        found.map(|(index, angle)| (index, 1.0 / (angle * sum)))
    }
}

/// The indices of distinct directions; for equal directions, the first index.
pub(super) fn distinct(directions: &[DVec3]) -> Vec<usize> {
    let mut seen = std::collections::HashSet::with_capacity(directions.len());
    (0..directions.len())
        .filter(|index| seen.insert(place(directions[*index])))
        .collect()
}

/// A direction (a unit vector), rounded to multiples of [`LEAST_ANGLE`]. Directions with the same result count as one.
pub(crate) fn place(direction: DVec3) -> I64Vec3 {
    (direction / LEAST_ANGLE).round().as_i64vec3()
}

/// The corners of all facets of the convex hull.
fn triangulate(directions: &[DVec3]) -> Vec<[usize; 3]> {
    let Some((pole, others)) = directions.split_first() else {
        return Vec::new();
    };
    let (across, along) = pole.any_orthonormal_pair();
    let project = |direction: &DVec3| {
        let distance = 1.0 - direction.dot(*pole);
        Point2::new(
            direction.dot(across) / distance,
            direction.dot(along) / distance,
        )
    };
    let points: Vec<Point2<f64>> = others.iter().map(project).collect();
    // Points are identified by their position: spade keeps one vertex for equal points.
    let Ok(plane) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points) else {
        return Vec::new();
    };
    let index = |vertex: usize| vertex + 1;
    let inner = plane
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| index(vertex.index())));
    let outer = plane.convex_hull().map(|edge| {
        let [from, to] = edge.vertices().map(|vertex| index(vertex.index()));
        [0, from, to]
    });
    inner.chain(outer).collect()
}

fn facet(directions: &[DVec3], middle: DVec3, corners: [usize; 3]) -> Option<Facet> {
    let [a, b, c] = corners.map(|corner| directions[corner]);
    let across = (b - a).cross(c - a);
    if across.length() < LEAST_AREA {
        return None;
    }
    let outward = across.normalize() * (a - middle).dot(across).signum();
    if outward.dot(a) < LEAST_OFFSET {
        return None;
    }
    Some(Facet {
        corners,
        inverse: DMat3::from_cols(a, b, c).inverse(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::grid;
    use super::*;
    use crate::sampling::lattice;

    /// Protects the triangulation: a sphere of n directions has 2 n − 4 facets, even if many directions lie on one
    /// circle, and each pole is one direction.
    #[test]
    fn facets_close_the_sphere() {
        let round: Vec<DVec3> = lattice(500).collect();
        assert_eq!(Facets::new(round).facets.len(), 996);
        // As in files: the poles are repeated at each azimuth.
        let mut rings = grid(15);
        rings.extend([DVec3::new(1e-9, 0.0, 1.0), DVec3::new(0.0, 1e-9, 1.0)]);
        let kept = distinct(&rings);
        let grid: Vec<DVec3> = kept.into_iter().map(|index| rings[index]).collect();
        assert_eq!(grid.len(), 24 * 11 + 2);
        let count = 2 * grid.len() - 4;
        assert_eq!(Facets::new(grid).facets.len(), count);
    }

    /// Protects weights: they are not negative, their sum is 1, their weighted mean is the requested direction, and
    /// only nearby corners have weight.
    #[test]
    fn weights_point_where_they_should() {
        let facets = Facets::new(grid(15));
        for from in lattice(5000) {
            let weights = facets.around(from);
            let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
            let mean: DVec3 = weights
                .iter()
                .map(|(corner, weight)| facets.directions()[*corner] * *weight)
                .sum();
            assert!((sum - 1.0).abs() < 1e-12 && weights.iter().all(|(_, w)| *w >= 0.0));
            assert!(mean.normalize().distance(from) < 1e-7, "{from}");
            assert!(mean.length() > 0.98, "{from}: {}", mean.length());
        }
    }

    /// Protects measured directions from being mixed with other directions, and protects continuity: small steps change
    /// the weights only slightly.
    #[test]
    fn weights_are_continuous() {
        let facets = Facets::new(lattice(200).collect());
        let table = |from: DVec3| {
            let mut all = vec![0.0; 200];
            for (corner, weight) in facets.around(from) {
                all[corner] += weight;
            }
            all
        };
        for (index, direction) in facets.directions().iter().enumerate() {
            assert!(table(*direction)[index] > 1.0 - 1e-9);
        }
        let step = 1e-4;
        let at = |turn: f64| {
            DVec3::new(turn.cos() * 0.8, turn.sin() * 0.8, 0.6 * (3.0 * turn).sin()).normalize()
        };
        for turn in (0..60_000).map(|count| f64::from(count) * step) {
            let (here, there) = (table(at(turn)), table(at(turn + step)));
            let change: f64 = here.iter().zip(&there).map(|(a, b)| (a - b).abs()).sum();
            // Corners are about 0.25 apart: a step of 3e-4 changes each weight by about 1e-3.
            assert!(change < 0.01, "{turn}: {change}");
        }
    }

    /// Protects sets that do not surround the head: a ring, a half-space, one or two directions.
    #[test]
    fn few_directions_are_used_as_they_are() {
        let ring: Vec<DVec3> = (0..72)
            .map(|turn| DVec3::from((glam::DVec2::from_angle(f64::from(turn) * 0.0872665), 0.0)))
            .collect();
        let half: Vec<DVec3> = grid(15).into_iter().filter(|d| d.z > -0.01).collect();
        let one = vec![DVec3::X];
        let two = vec![DVec3::X, DVec3::Y];
        for directions in [ring, half, one, two] {
            let facets = Facets::new(directions);
            for from in lattice(300) {
                let weights = facets.around(from);
                let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
                assert!((sum - 1.0).abs() < 1e-9, "{weights:?}");
                assert!(weights.iter().all(|(_, weight)| *weight >= 0.0));
            }
            let first = facets.directions()[0];
            let weight: f64 = facets
                .around(first)
                .iter()
                .filter(|(corner, _)| *corner == 0)
                .map(|(_, weight)| weight)
                .sum();
            assert!(weight > 1.0 - 1e-6);
        }
    }
}
