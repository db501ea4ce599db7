//! Corners, areas and volumes of the triangles of a mesh.

use glam::{DVec3, Vec3};

/// Twice the area of a triangle, along its normal.
pub(super) fn cross(vertices: &[Vec3], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = corners(vertices, triangle);
    (b - a).cross(c - a)
}

/// The corners of a triangle in metres.
pub(super) fn corners(vertices: &[Vec3], triangle: &[u32; 3]) -> [DVec3; 3] {
    triangle.map(|at| vertices[at as usize].as_dvec3())
}

/// The area of a triangle in m².
pub(super) fn area(vertices: &[Vec3], triangle: &[u32; 3]) -> f64 {
    0.5 * cross(vertices, triangle).length()
}

/// The volume behind the faces in m³, by the divergence theorem, relative to the first corner.
pub(super) fn signed_volume<'a>(
    vertices: &[Vec3],
    triangles: impl IntoIterator<Item = &'a [u32; 3]>,
) -> f64 {
    let mut triangles = triangles.into_iter().peekable();
    let origin = triangles
        .peek()
        .map_or(DVec3::ZERO, |t| vertices[t[0] as usize].as_dvec3());
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = corners(vertices, triangle).map(|corner| corner - origin);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.map(of).sum()
}
