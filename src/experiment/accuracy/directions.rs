//! Directions for the limit of many waves, and how fast an error falls towards it.

use super::report::{Slope, SlopePoint};
use crate::trace::Directions;
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// A spherical Fibonacci lattice of so many unit vectors, in `f64` until the end
/// (Swinbank and Purser 2006).
///
/// `turned`: by half a turn about (1, 1, 1), which takes its poles to other places and so
/// makes it another lattice: the lattice itself is symmetric about axes through its
/// equator.
pub fn lattice(count: u64, turned: bool) -> Vec<Vec3> {
    let turn = match turned {
        true => DQuat::from_axis_angle(DVec3::ONE.normalize(), PI),
        false => DQuat::IDENTITY,
    };
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let direction = |index: u64| {
        let height = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sin, cos) = (TAU * (index as f64 * golden).fract()).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        (turn * DVec3::new(ring * cos, height, ring * sin)).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// The exponent that the errors fall with: the least-squares line through their
/// logarithms. Errors of 0 are left out; 0 for fewer than two points.
pub fn slope(points: &[SlopePoint]) -> f64 {
    let shown = points.iter().filter(|point| point.rms > 0.0);
    let logs: Vec<(f64, f64)> = shown
        .map(|point| (f64::from(point.waves).ln(), point.rms.ln()))
        .collect();
    let count = logs.len() as f64;
    let (x, y) = logs
        .iter()
        .fold((0.0, 0.0), |(x, y), log| (x + log.0, y + log.1));
    let (x, y) = (x / count, y / count);
    let across: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
    let along: f64 = logs.iter().map(|log| (log.0 - x).powi(2)).sum();
    if along > 0.0 { across / along } else { 0.0 }
}

/// Points with the line through them.
pub fn fitted(directions: Directions, points: Vec<SlopePoint>) -> Slope {
    Slope {
        directions: directions.to_string(),
        slope: slope(&points),
        points,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the exponents in the report.
    #[test]
    fn a_power_law_has_its_exponent() {
        let point = |waves: u32| SlopePoint {
            waves,
            rms: 3.0 * f64::from(waves).powf(-0.75),
        };
        assert!((slope(&[1024, 4096, 65_536].map(point)) + 0.75).abs() < 1e-12);
        assert_eq!(slope(&[point(7)]), 0.0);
        assert_eq!(slope(&[]), 0.0);
    }

    /// Protects the limit from a lattice that is not even: its mean is 0, and so is that of
    /// each axis' square but for a third.
    #[test]
    fn lattices_cover_the_sphere_evenly() {
        for turned in [false, true] {
            let all = lattice(10_000, turned);
            let sum: DVec3 = all.iter().map(|d| d.as_dvec3()).sum();
            let squares: DVec3 = all.iter().map(|d| d.as_dvec3() * d.as_dvec3()).sum();
            assert!((sum / 1e4).abs().max_element() < 1e-4);
            assert!((squares / 1e4 - 1.0 / 3.0).abs().max_element() < 1e-4);
            assert!(all.iter().all(|d| d.is_normalized()));
        }
    }
}
