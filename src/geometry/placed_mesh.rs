//! Intersections of a line with a triangle mesh, in the mesh's own axes and in `f64`.

use super::in_front::OpenPlane;
use super::intersection::Intersection;
use crate::scene::Bounds3;
use crate::scene::mesh::TriangleMesh;
use glam::DVec3;
use std::sync::Arc;

/// Least distance of a hit from the edges of its triangle, as a share of the largest coordinate: some tens of units in
/// the last place. A reflected wave then starts in front of the next wall, also in a corner.
const INSET: f64 = 1e-14;

/// A mesh with the data that its lines need.
#[derive(Clone, Debug)]
pub(super) struct PlacedMesh {
    mesh: Arc<TriangleMesh>,
    /// Bounding box of the solid.
    bounds: Bounds3,
}

impl PlacedMesh {
    pub fn new(mesh: &Arc<TriangleMesh>) -> PlacedMesh {
        let is_hollow = mesh.report().is_hollow;
        let bounds = match is_hollow {
            true => Bounds3::EVERYWHERE,
            false => mesh.bounds(),
        };
        PlacedMesh {
            mesh: Arc::clone(mesh),
            bounds,
        }
    }

    pub fn extent(&self) -> f64 {
        self.mesh.extent()
    }

    /// Bounding box of the solid, which is unbounded around a room.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    pub fn distance(&self, p: DVec3) -> f64 {
        self.mesh.distance(p)
    }

    /// See [`TriangleMesh::distance_in_front`].
    pub fn distance_in_front(&self, p: DVec3, plane: OpenPlane) -> f64 {
        let OpenPlane {
            point,
            normal,
            touch,
        } = plane;
        self.mesh.distance_in_front(p, (point, normal), touch)
    }

    /// The first face met within `until` metres.
    pub fn intersect(
        &self,
        o: DVec3,
        d: DVec3,
        error_bound: f64,
        until: f64,
    ) -> Option<Intersection> {
        let (t, triangle) = self.mesh.first_hit(o, d, error_bound, until)?;
        Some(Intersection {
            t,
            face: None,
            triangle: Some(triangle),
        })
    }

    /// Distance in metres to the first face at which a line enters the solid, or leaves it if it starts inside; infinite
    /// if there is none.
    pub fn next_face(&self, o: DVec3, d: DVec3, is_inside: bool, error_bound: f64) -> f64 {
        let met = match is_inside {
            true => self.mesh.first_exit(o, d, error_bound, f64::INFINITY),
            false => self.mesh.first_hit(o, d, error_bound, f64::INFINITY),
        };
        met.map_or(f64::INFINITY, |(t, _)| t)
    }

    /// The groups of the faces within `reach` metres of a point, each once.
    pub fn groups_near(&self, p: DVec3, reach: f64) -> Vec<usize> {
        let facets = self.mesh.facets_near(p, reach).into_iter();
        let mut groups: Vec<usize> = facets.map(|(_, facet)| usize::from(facet.group)).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// The group of the first face met within `until` metres.
    pub fn group_met(&self, o: DVec3, d: DVec3, error_bound: f64, until: f64) -> Option<usize> {
        let (_, triangle) = self.mesh.first_hit(o, d, error_bound, until)?;
        Some(usize::from(self.mesh.triangle(triangle).group))
    }

    /// The point of a hit on its triangle, and the unit normal there.
    pub fn project(&self, triangle: u32, o: DVec3, d: DVec3) -> (DVec3, DVec3) {
        let inset = INSET * self.mesh.extent();
        let triangle = self.mesh.triangle(triangle);
        (triangle.place(o, d, inset), triangle.exact_normal())
    }
}
