//! Triangle meshes: surfaces made of plane faces, mostly read from a file.
//!
//! A mesh is a list of triangles with corners in `f32`. The corners of a triangle run counterclockwise as seen from the
//! air. Each triangle belongs to a *group*, which has the name of a material in the file.
//!
//! # Solid and hollow
//! A closed mesh separates space into two parts. If the normals of the faces point out of the enclosed volume, the file
//! describes a solid object, and otherwise a hollow room. Some programs write rooms with normals that point out of the
//! air. [`MeshOptions::inside`] then states which part is air, and the faces are reversed where necessary.
//!
//! # Exactness
//! Lines meet the triangles themselves (`triangle.rs`): the end of a flight is exact to rounding, and no line passes
//! between two triangles with a common edge. The distance is that to the nearest triangle, with the sign of the angle
//! weighted pseudonormal (Bærentzen and Aanæs 2005, `tree.rs`). Sheets without thickness, drawn as two faces in one
//! place, reflect on both sides (`sheets.rs`). A GPU finds the triangles on a line by a grid of cells
//! (`cells.rs`).
//!
//! # Cost
//! A mesh of n triangles is checked and indexed in O(n log n).

mod air_boxes;
mod cells;
mod check;
mod edges;
mod error;
mod facets;
mod intersections;
mod measures;
mod nesting;
mod read;
#[cfg(feature = "meshes")]
mod read_gltf;
#[cfg(feature = "meshes")]
mod read_obj;
mod report;
mod sheets;
#[cfg(test)]
pub(crate) mod tests;
mod tree;
mod triangle;

pub(crate) use air_boxes::{AirCells, AirCorners, bodies};
pub(crate) use cells::MeshCells;
pub use error::MeshError;
pub(crate) use facets::Facet;
pub(crate) use report::LARGEST_USUAL_M;
pub use report::{Defect, MeshReport};
pub(crate) use triangle::Triangle;

use super::shape::Bounds3;
use facets::Facets;
use glam::{DVec3, Vec3};
use std::convert::identity;
use std::path::Path;
use std::sync::OnceLock;
use tree::Tree;

/// The part of space that a closed mesh encloses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub enum Inside {
    /// The mesh is a room: air inside, solid outside.
    Air,
    /// The mesh is an object: solid inside, air outside.
    Solid,
}

/// The faces of a mesh as lists, before any check.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFaces {
    /// Corners of the triangles, in the unit of the file.
    pub vertices: Vec<DVec3>,
    /// Indices of the corners of each triangle, counterclockwise as seen from the outer side.
    pub triangles: Vec<[u32; 3]>,
    /// The index in `groups` of each triangle's group.
    pub group_of: Vec<u32>,
    /// The names of the groups.
    pub groups: Vec<String>,
    /// Number of polygons with more than three corners that were divided into triangles.
    pub divided_polygons: usize,
    /// Number of polygons that could not be divided, because all their corners lie on a line.
    pub flat_polygons: usize,
}

/// Options for the use of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// The enclosed part; `None` to take it from the orientation of the faces.
    pub inside: Option<Inside>,
    /// Metres per unit of the file.
    pub scale: f32,
}

impl Default for MeshOptions {
    fn default() -> MeshOptions {
        MeshOptions {
            inside: None,
            scale: 1.0,
        }
    }
}

/// A checked triangle mesh, whose normals point into the air.
#[derive(Debug)]
pub struct TriangleMesh {
    name: String,
    options: MeshOptions,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    group_of: Vec<u8>,
    groups: Vec<String>,
    /// Unit normals of the triangles, into the air.
    normals: Vec<Vec3>,
    /// Whether air lies directly behind each triangle.
    is_sheet: Vec<bool>,
    report: MeshReport,
    bounds: Bounds3,
    tree: OnceLock<Tree>,
    facets: OnceLock<Facets>,
    cells: OnceLock<MeshCells>,
    has_far_side: OnceLock<bool>,
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &TriangleMesh) -> bool {
        self.has_faces_of(other) && self.name == other.name
    }
}

/// Maximum number of groups, so that the index of a group is a byte.
const MOST_GROUPS: usize = 255;

/// Number of the largest faces at which the solid around a room is tried for a far side.
const MOST_FACES_TRIED: usize = 4096;

/// Maximum number of triangles. A mesh of this size takes about 1 GB of memory while it is indexed.
pub(crate) const MOST_TRIANGLES: usize = 2_000_000;

impl TriangleMesh {
    /// Checks the faces, and makes a mesh of them. `name` is the name in reports.
    ///
    /// # Errors
    /// [`MeshError`] for faces that cannot be traced.
    pub fn new(
        name: &str,
        faces: MeshFaces,
        options: MeshOptions,
    ) -> Result<TriangleMesh, MeshError> {
        check::checked(name, faces, options)
    }

    /// Reads and checks a mesh file: OBJ, or glTF with its buffers in the file or in its folder.
    ///
    /// # Errors
    /// [`MeshError`] for a file that cannot be read, and for faces that cannot be traced.
    pub fn from_file(path: &Path, options: MeshOptions) -> Result<TriangleMesh, MeshError> {
        let faces = read::faces(path)?;
        TriangleMesh::new(&path.display().to_string(), faces, options)
    }

    /// Name in reports: the path of the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The options with which the mesh was made.
    pub fn options(&self) -> MeshOptions {
        self.options
    }

    /// The names of the groups.
    pub fn groups(&self) -> &[String] {
        &self.groups
    }

    /// Measures and defects of the mesh.
    pub fn report(&self) -> &MeshReport {
        &self.report
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Bounding box of the faces in metres.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// The largest coordinate in metres.
    pub(crate) fn extent(&self) -> f64 {
        let Bounds3 { min, max } = self.bounds;
        min.abs().max(max.abs()).max_element()
    }

    /// Whether both meshes have the same faces, regardless of their files.
    pub(crate) fn has_faces_of(&self, other: &TriangleMesh) -> bool {
        self.options == other.options
            && self.vertices == other.vertices
            && self.triangles == other.triangles
            && self.group_of == other.group_of
            && self.groups == other.groups
    }

    /// The triangle with this index.
    #[inline]
    pub(crate) fn triangle(&self, index: u32) -> Triangle {
        let index = index as usize;
        let corners = self.triangles[index].map(|corner| self.vertices[corner as usize]);
        Triangle {
            corners,
            normal: self.normals[index],
            group: self.group_of[index],
            is_sheet: self.is_sheet[index],
        }
    }

    /// Whether a triangle belongs to this group.
    pub(crate) fn has_group(&self, group: usize) -> bool {
        self.group_of.iter().any(|of| usize::from(*of) == group)
    }

    /// All triangles in order.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = Triangle> {
        (0..self.triangles.len() as u32).map(|index| self.triangle(index))
    }

    /// Signed distance in metres from a point to the nearest face: positive in the air.
    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        self.tree().signed_distance(self, p, |_| true)
    }

    /// Signed distance in metres from a point in front of a plane through `on_plane` to the nearest face that rises more
    /// than `touch` metres in front of it, also partly.
    pub(crate) fn distance_in_front(
        &self,
        p: DVec3,
        (on_plane, normal): (DVec3, DVec3),
        touch: f64,
    ) -> f64 {
        let height = |corner: Vec3| (corner.as_dvec3() - on_plane).dot(normal);
        let is_in_front = |triangle: &Triangle| {
            triangle
                .corners
                .iter()
                .any(|corner| height(*corner) > touch)
        };
        self.tree().signed_distance(self, p, is_in_front)
    }

    /// The first face met by the line from `origin` along the unit vector `direction` within `until` metres, from its
    /// air side: the distance in metres, and the index of the triangle. The start may lie up to `error_bound` metres
    /// behind the face.
    pub(crate) fn first_hit(
        &self,
        origin: DVec3,
        direction: DVec3,
        error_bound: f64,
        until: f64,
    ) -> Option<(f64, u32)> {
        let line = (origin, direction);
        self.tree()
            .first_hit(self, identity, line, error_bound, until)
    }

    /// The first face met from its solid side, as [`TriangleMesh::first_hit`] from the air side.
    pub(crate) fn first_exit(
        &self,
        origin: DVec3,
        direction: DVec3,
        error_bound: f64,
        until: f64,
    ) -> Option<(f64, u32)> {
        let reversed = |triangle: Triangle| triangle.reversed();
        let line = (origin, direction);
        self.tree()
            .first_hit(self, reversed, line, error_bound, until)
    }

    /// The faces in one plane and of one group that have a triangle within `reach` metres of a point, each once. All
    /// of them if `reach` is infinite.
    pub(crate) fn facets_near(&self, p: DVec3, reach: f64) -> Vec<(u32, Facet)> {
        let facets = self.facets.get_or_init(|| Facets::of(self));
        let mut found: Vec<u32> = match reach.is_finite() {
            true => {
                let near = self.tree().triangles_near(self, p, reach);
                near.into_iter()
                    .map(|index| facets.of_triangle(index))
                    .collect()
            }
            false => (0..facets.all().len() as u32).collect(),
        };
        found.sort_unstable();
        found.dedup();
        let facet = |index: u32| (index, facets.all()[index as usize]);
        found.into_iter().map(facet).collect()
    }

    /// Greatest distance in metres of a corner from the plane of its facet.
    pub(crate) fn flatness(&self) -> f64 {
        self.facets.get_or_init(|| Facets::of(self)).flatness()
    }

    /// Whether a line can pass the solid: always if the mesh is an object. The solid around a room has a far side if the
    /// normal at the centre of one of its largest faces meets another face of it, as in a wall between two rooms.
    pub(crate) fn has_far_side(&self) -> bool {
        *self
            .has_far_side
            .get_or_init(|| !self.report.is_hollow || self.has_wall_between_rooms())
    }

    fn has_wall_between_rooms(&self) -> bool {
        let mut largest: Vec<Triangle> = self.triangles().collect();
        largest.sort_by(|a, b| b.area().total_cmp(&a.area()));
        largest.truncate(MOST_FACES_TRIED);
        largest.iter().any(|face| {
            let [a, b, c] = face.exact_corners();
            let (centre, inward) = ((a + b + c) / 3.0, -face.exact_normal());
            let mut is_passed = false;
            self.tree().each_on_line(centre, inward, |index| {
                let far = self.triangle(index).reversed();
                is_passed |= far.hit(centre, inward, 0.0).is_some();
            });
            is_passed
        })
    }

    /// The grid of cells for the GPU.
    pub(crate) fn cells(&self) -> &MeshCells {
        self.cells.get_or_init(|| MeshCells::of(self))
    }

    fn tree(&self) -> &Tree {
        self.tree.get_or_init(|| Tree::of(self))
    }

    /// Corners, triangles and groups as little-endian bytes, for comparisons of scenes.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let places = self.vertices.iter().flat_map(|v| v.to_array());
        let corners = self.triangles.iter().flatten();
        places
            .flat_map(f32::to_le_bytes)
            .chain(corners.flat_map(|corner| corner.to_le_bytes()))
            .chain(self.group_of.iter().copied())
            .collect()
    }
}
