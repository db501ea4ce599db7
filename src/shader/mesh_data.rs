//! A triangle mesh in the scene's data. `glsl/shape/mesh.glsl` describes the vectors.

use crate::scene::mesh::{MeshCells, TriangleMesh};
use glam::Vec4;

/// Vectors before the cells.
const HEAD: usize = 3;

/// Words of cells in a vector.
const WORDS: usize = 4;

/// Vectors of a triangle.
const TRIANGLE: usize = 4;

/// The indices of the parts, relative to the first vector.
struct Parts {
    lists: usize,
    triangles: usize,
    length: usize,
}

impl Parts {
    fn of(mesh: &TriangleMesh) -> Parts {
        let cells = mesh.cells();
        let lists = HEAD + cells.words.len().div_ceil(WORDS);
        let triangles = lists + cells.lists.len();
        Parts {
            lists,
            triangles,
            length: triangles + TRIANGLE * mesh.triangle_count(),
        }
    }
}

/// Number of vectors of a mesh.
pub(super) fn mesh_length(mesh: &TriangleMesh) -> usize {
    Parts::of(mesh).length
}

/// The vectors of a mesh.
pub(super) fn mesh_vectors(mesh: &TriangleMesh) -> Vec<Vec4> {
    let Parts {
        lists,
        triangles,
        length,
    } = Parts::of(mesh);
    let MeshCells {
        origin,
        size,
        count,
        words,
        lists: vectors,
        ..
    } = mesh.cells();
    let outer_side = if mesh.report().is_hollow { -1.0 } else { 1.0 };
    let mut data = Vec::with_capacity(length);
    data.extend([
        origin.extend(*size),
        count.as_vec3().extend(outer_side),
        Vec4::new(HEAD as f32, lists as f32, triangles as f32, 0.0),
    ]);
    data.extend(words.chunks(WORDS).map(|four| {
        let word = |at: usize| four.get(at).copied().unwrap_or(1.0);
        Vec4::new(word(0), word(1), word(2), word(3))
    }));
    data.extend(vectors.iter().map(|list| Vec4::from_array(*list)));
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.corners;
        let sheet = if triangle.is_sheet { 0.5 } else { 0.0 };
        data.extend([
            triangle.normal.extend(f32::from(triangle.group) + sheet),
            a.extend((b - a).length()),
            b.extend((c - b).length()),
            c.extend((a - c).length()),
        ]);
    }
    data
}
