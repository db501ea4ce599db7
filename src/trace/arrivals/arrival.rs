//! One crossing of the listener's sphere.

use crate::bands::Bands;
use glam::DVec3;

/// One crossing of the listener's sphere by one wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The wave's number.
    pub wave: u32,
    /// Whether the wave was mirrored alone, and no oftener than asked for.
    pub order_is_early: bool,
    /// Metres flown from the source to the middle of the chord through the sphere.
    pub length_m: f64,
    /// Direction of flight: a unit vector, world axes.
    pub direction: DVec3,
    /// This crossing's share of the energy density for a source of unit power, over the speed of
    /// sound, in 1/m²: reflectances × chord ÷ (open volume of the sphere × waves). Without air.
    pub energy: Bands,
}
