//! Start directions for the limit of many waves, and the rate at which an error approaches this limit.

use super::report::{Slope, SlopePoint};
use echomarch::internals::sampling;
use echomarch::tracer::Directions;
use glam::{DQuat, DVec3, Vec3};
use std::f64::consts::PI;

/// A spherical Fibonacci lattice of `count` unit vectors, computed in `f64` and rounded at the end.
///
/// If `turned` is true, the lattice is rotated by half a turn about (1, 1, 1). This rotation moves the poles and so
/// gives a different lattice. A half turn about an axis through the equator would not, because of the symmetry of the
/// lattice.
pub fn lattice(count: u64, turned: bool) -> Vec<Vec3> {
    let turn = match turned {
        true => DQuat::from_axis_angle(DVec3::ONE.normalize(), PI),
        false => DQuat::IDENTITY,
    };
    let all = sampling::lattice(count);
    all.map(|direction| (turn * direction).as_vec3()).collect()
}

/// Minimum number of heard waves for a point to count. With fewer heard waves, the error is dominated by frames in
/// which no wave is heard and the panning is 0.
const LEAST_HEARD: f64 = 10.0;

/// Returns the exponent with which the errors fall, and its standard error, from a least-squares line through the
/// logarithms. Points that are not `fitted` are excluded. The exponent is `None` for fewer than two points, and the
/// standard error for fewer than three.
pub fn slope(points: &[SlopePoint]) -> (Option<f64>, Option<f64>) {
    let shown = points.iter().filter(|point| point.fitted);
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
    if along.is_nan() || along <= 0.0 {
        return (None, None);
    }
    let slope = across / along;
    let off = |log: &(f64, f64)| (log.1 - y - slope * (log.0 - x)).powi(2);
    let squares: f64 = logs.iter().map(off).sum();
    let error = (logs.len() > 2).then(|| (squares / (count - 2.0) / along).sqrt());
    (Some(slope), error)
}

/// Returns the points (waves, error), and the line through the points with enough heard waves. `heard` is the share of
/// all waves that are heard.
pub fn fitted(directions: Directions, errors: &[(u32, f64)], heard: f64) -> Slope {
    let point = |&(waves, rms): &(u32, f64)| {
        let heard = heard * f64::from(waves);
        SlopePoint {
            waves,
            rms,
            heard,
            fitted: heard >= LEAST_HEARD && rms > 0.0,
        }
    };
    let points: Vec<SlopePoint> = errors.iter().map(point).collect();
    let (slope, standard_error) = slope(&points);
    Slope {
        directions: directions.to_string(),
        points,
        slope,
        standard_error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(errors: &[(u32, f64)], heard: f64) -> Slope {
        fitted(Directions::Random, errors, heard)
    }

    /// Protects the exponents in the report.
    #[test]
    fn a_power_law_has_its_exponent() {
        let point = |waves: u32| (waves, 3.0 * f64::from(waves).powf(-0.75));
        let law = fit(&[1024, 4096, 65_536].map(point), 1.0);
        assert!((law.slope.unwrap() + 0.75).abs() < 1e-12);
        assert!(law.standard_error.unwrap() < 1e-12);
        let two = fit(&[1024, 4096].map(point), 1.0);
        assert!(two.slope.is_some() && two.standard_error.is_none());
        for few in [&[][..], &[point(1024)]] {
            let few = fit(few, 1.0);
            assert_eq!((few.slope, few.standard_error), (None, None));
        }
    }

    /// Protects the uncertainty of the exponents. The logarithms 0, 1, 0 in steps of ln 10 have a horizontal line. The
    /// squared deviations from the line add up to 2/3, with 1 degree of freedom. The squared deviations along x add up
    /// to 2 (ln 10)².
    #[test]
    fn the_standard_error_is_that_of_least_squares() {
        let points = [(1, 0.0), (10, 1.0), (100, 0.0)];
        let fit = fit(
            &points.map(|(waves, log): (u32, f64)| (waves, log.exp())),
            100.0,
        );
        assert!(fit.slope.unwrap().abs() < 1e-12);
        let error = (2.0f64 / 3.0 / 2.0).sqrt() / 10f64.ln();
        assert!((fit.standard_error.unwrap() - error).abs() < 1e-12);
    }

    /// Protects the exponents from numbers of waves at which almost no wave is heard.
    #[test]
    fn points_that_hear_too_little_are_left_out() {
        let fit = fit(
            &[(100, 1.0), (1000, 0.5), (100_000, 0.05), (1 << 20, 0.0)],
            0.01,
        );
        let fitted: Vec<bool> = fit.points.iter().map(|point| point.fitted).collect();
        assert_eq!(fitted, [false, true, true, false]);
        assert!((fit.slope.unwrap() + 0.5).abs() < 1e-12);
    }

    /// Protects the limit from an uneven lattice: the mean of the vectors is 0, and the mean square of each coordinate
    /// is 1/3.
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
