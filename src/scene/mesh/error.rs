//! Errors of triangle meshes and of rooms, whose walls are a mesh. Each message is one sentence with the number and the
//! first place of a defect.

use glam::{DVec3, Vec3};

/// The reason why a triangle mesh, or [`Rooms`](crate::scene::shape::Rooms), cannot be used.
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
    /// The number of boxes of rooms is 0 or too large.
    #[error("Rooms have 1 to {most} boxes, not {count}")]
    BadBoxCount {
        /// Number of boxes.
        count: usize,
        /// Maximum number of boxes.
        most: usize,
    },
    /// A corner is not finite or exceeds 1e9 m, or `from` is not less than `to` along every axis.
    #[error(
        "the box {name:?} of Rooms must have finite corners of at most 1e9 m, with `from` less than `to` along each axis, not from {from} to {to}"
    )]
    BadBox {
        /// Name of the box.
        name: String,
        /// Its first corner in metres.
        from: Vec3,
        /// Its second corner in metres.
        to: Vec3,
    },
    /// Two boxes have one name, or the name of a box contains `/`.
    #[error(
        "the name {name:?} of a box of Rooms must be different from all others, and contain no `/`"
    )]
    BadBoxName {
        /// The name.
        name: String,
    },
    /// Parts of the air of rooms, or of the solid, touch only along an edge or in a corner.
    #[error(
        "Rooms touch only along an edge or in a corner at ({}, {}, {}): let them overlap, or leave a wall between them",
        place.x, place.y, place.z
    )]
    Pinched {
        /// A corner at that place in metres.
        place: DVec3,
    },
}
