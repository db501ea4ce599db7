//! Errors of triangle meshes. Each message is one sentence with the number and the first place of a defect.

use glam::Vec3;

/// The reason why a triangle mesh cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file cannot be read.
    #[error("{why}")]
    Unreadable {
        /// The reason.
        why: String,
    },
    /// The program was built without the readers of mesh files.
    #[error("this program was built without the feature `meshes`, which reads mesh files")]
    NoReaders,
    /// The extension of the file names no known format.
    #[error("a mesh file ends in .obj, .glb or .gltf")]
    UnknownFormat,
    /// The file contradicts its format.
    #[error("line {line}: {why}")]
    BadLine {
        /// Line, counted from 1.
        line: usize,
        /// The reason.
        why: String,
    },
    /// The file contradicts its format, which has no lines.
    #[error("{why}")]
    BadContent {
        /// The reason.
        why: String,
    },
    /// There is nothing to trace.
    #[error("it has no triangles")]
    Empty,
    /// The mesh exceeds a limit.
    #[error("it has more than {most} {what}, the limit")]
    TooMany {
        /// The counted parts.
        what: &'static str,
        /// The limit.
        most: usize,
    },
    /// A coordinate is NaN, infinite or larger than 1e9 m.
    #[error("vertex {vertex} has a coordinate that is not finite or exceeds 1e9 m")]
    NotFinite {
        /// Number of the vertex, counted from 1.
        vertex: usize,
    },
    /// A face refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are {vertices}")]
    NoSuchVertex {
        /// Number of the triangle, counted from 1.
        triangle: usize,
        /// Number of the vertex, counted from 1.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// No orientation of the faces has one side.
    #[error(
        "its faces have no common outer side: they form a band with one side, with an edge at ({:.3}, {:.3}, {:.3})",
        place.x, place.y, place.z
    )]
    OneSided {
        /// Middle of an edge at which the orientations contradict each other, in metres.
        place: Vec3,
    },
    /// The scale is not a positive number.
    #[error("its scale must be greater than 0 and at most 1e9, not {scale}")]
    BadScale {
        /// The stated scale.
        scale: f32,
    },
}
