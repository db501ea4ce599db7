//! The intersection of a line with a shape.

/// One of the six faces of a box: its axis and side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Face {
    pub axis: usize,
    pub positive: bool,
}

/// The intersection of a line with a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intersection {
    /// Distance in metres along the unit direction, at least 0.
    pub t: f64,
    /// The face that is hit, for a box or a room.
    pub face: Option<Face>,
    /// The index of the triangle that is hit, for a mesh.
    pub triangle: Option<u32>,
}
