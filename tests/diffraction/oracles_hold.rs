//! The exact solutions against known values, against each other and against what holds for every rigid body.

mod anchors;
mod functions;
mod round_bodies;
mod stored;
mod wedges;
