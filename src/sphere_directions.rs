//! Directions spread over the sphere.

use glam::DVec3;
use std::f64::consts::TAU;

/// A spherical Fibonacci lattice of `count` unit vectors (Swinbank and Purser, *Fibonacci grids*,
/// QJRMS 132, 2006): heights in equal steps, azimuths by the golden ratio.
pub fn lattice(count: u64) -> impl Iterator<Item = DVec3> {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    (0..count).map(move |index| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sin, cos) = (TAU * (index as f64 * golden).fract()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        DVec3::new(ring * cos, height, ring * sin)
    })
}
