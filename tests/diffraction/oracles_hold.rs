//! The exact solutions against known values, against each other and against what holds for every rigid body.

mod anchors;
mod wedges;
