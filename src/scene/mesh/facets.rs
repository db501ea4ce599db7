//! Facets: coplanar triangles of one group, which mirror sound as one plane.
//!
//! A wall of a room is divided into triangles. An image source needs one plane for the whole wall. Starting from the
//! largest triangle that belongs to no facet yet, a facet grows across edges, as long as the corners lie in its plane.

use super::TriangleMesh;
use super::edges::Edges;
use glam::DVec3;

/// Maximum distance of a corner from the plane of its facet, as a share of the largest coordinate: eight units in the
/// last place of that coordinate in `f32`, in which corners are stored.
const FLATNESS: f64 = 8.0 * f32::EPSILON as f64;

/// Least cosine between the normals of a facet and of its triangles. A fold of a few degrees exceeds rounding.
const LEAST_COSINE: f64 = 0.9999;

/// Maximum number of facets that are compared with each other to join coplanar facets that do not touch.
const MOST_COMPARED: usize = 2_000;

/// A plane of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facet {
    /// Unit normal into the air.
    pub normal: DVec3,
    /// normal · p for points p of the plane, in metres.
    pub offset: f64,
    /// Index of the group.
    pub group: u8,
}

#[derive(Debug)]
pub(super) struct Facets {
    all: Vec<Facet>,
    of_triangles: Vec<u32>,
    flatness: f64,
}

impl Facets {
    pub fn of(mesh: &TriangleMesh) -> Facets {
        let count = mesh.triangles.len();
        let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
        for sides in Edges::of(&mesh.triangles).all() {
            for own in sides {
                let others = sides.iter().filter(|side| side.triangle != own.triangle);
                neighbours[own.triangle as usize].extend(others.map(|side| side.triangle));
            }
        }
        let area = |index: u32| {
            let [a, b, c] = mesh.triangle(index).corners.map(|corner| corner.as_dvec3());
            (b - a).cross(c - a).length()
        };
        let mut order: Vec<(f64, u32)> = (0..count as u32).map(|i| (area(i), i)).collect();
        order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let most = FLATNESS * mesh.extent();
        let mut facets = Facets {
            all: Vec::new(),
            of_triangles: vec![u32::MAX; count],
            flatness: 0.0,
        };
        for (_, seed) in order {
            if facets.of_triangles[seed as usize] != u32::MAX {
                continue;
            }
            let facet = facet_of(mesh, seed);
            let number = facets.number_of(facet, mesh, seed, most);
            let facet = facets.all[number as usize];
            let mut waiting = vec![seed];
            facets.take(mesh, seed, number);
            while let Some(at) = waiting.pop() {
                for &other in &neighbours[at as usize] {
                    let is_free = facets.of_triangles[other as usize] == u32::MAX;
                    if is_free && facet.has(mesh, other, most) {
                        facets.take(mesh, other, number);
                        waiting.push(other);
                    }
                }
            }
        }
        facets
    }

    /// The number of a known facet that contains the triangle, otherwise of a new one.
    fn number_of(&mut self, facet: Facet, mesh: &TriangleMesh, seed: u32, most: f64) -> u32 {
        let known = match self.all.len() <= MOST_COMPARED {
            true => self
                .all
                .iter()
                .position(|known| known.has(mesh, seed, most)),
            false => None,
        };
        known.unwrap_or_else(|| {
            self.all.push(facet);
            self.all.len() - 1
        }) as u32
    }

    fn take(&mut self, mesh: &TriangleMesh, index: u32, number: u32) {
        self.of_triangles[index as usize] = number;
        let off = self.all[number as usize].off(mesh, index);
        self.flatness = self.flatness.max(off);
    }

    pub fn all(&self) -> &[Facet] {
        &self.all
    }

    /// The number of a triangle's facet.
    pub fn of_triangle(&self, index: u32) -> u32 {
        self.of_triangles[index as usize]
    }

    /// Greatest distance in metres of a corner from the plane of its facet.
    pub fn flatness(&self) -> f64 {
        self.flatness
    }
}

fn facet_of(mesh: &TriangleMesh, index: u32) -> Facet {
    let triangle = mesh.triangle(index);
    let normal = triangle.exact_normal();
    Facet {
        normal,
        offset: normal.dot(triangle.corners[0].as_dvec3()),
        group: triangle.group,
    }
}

impl Facet {
    /// Greatest distance in metres of a triangle's corners from the plane.
    fn off(&self, mesh: &TriangleMesh, index: u32) -> f64 {
        let corners = mesh.triangle(index).corners;
        let heights = corners.map(|corner| self.normal.dot(corner.as_dvec3()) - self.offset);
        heights.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    fn has(&self, mesh: &TriangleMesh, index: u32, most: f64) -> bool {
        let triangle = mesh.triangle(index);
        triangle.group == self.group
            && self.normal.dot(triangle.exact_normal()) >= LEAST_COSINE
            && self.off(mesh, index) <= most
    }
}
