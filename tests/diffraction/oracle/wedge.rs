//! Endless rigid wedge and point source: the frequency form of the Biot–Tolstoy–Medwin solution.
//!
//! U. P. Svensson, R. I. Fred, J. Vanderkooy, "An analytic secondary source model of edge diffraction impulse
//! responses", J. Acoust. Soc. Am. 106 (1999), and the integral over the edge's parameter η on a complex contour.

use super::quadrature::{graded, integrate};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// First panel of the contour: the peak at a shadow boundary is as narrow as the angle to it in radians.
const FIRST_PANEL: f64 = 1e-9;
/// End of the contour: the exponent k·ℓ is there beyond 1000 for k·√(rS·rR) = 0.01.
const LAST_PANEL: f64 = 12.0;
/// Ratio of neighbouring panels.
const PANEL_RATIO: f64 = 1.5;

/// Rigid wedge, its edge on the z axis, the air at angles 0 to `exterior_angle`.
#[derive(Clone, Copy, Debug)]
pub struct Wedge {
    /// Angle of the air in radians: 2π is a half plane, π a plane.
    pub exterior_angle: f64,
}

/// Place of source and receiver relative to the edge.
#[derive(Clone, Copy, Debug)]
struct Pair {
    r_s: f64,
    theta_s: f64,
    r_r: f64,
    theta_r: f64,
    z: f64,
}

impl Wedge {
    /// Total field: direct and mirrored where they exist, and diffracted. Source at distance `r_s` in m from the edge
    /// and angle `theta_s`, receiver at `r_r` and `theta_r`, `z` in m the distance between them along the edge.
    pub fn pressure(
        self,
        k: f64,
        r_s: f64,
        theta_s: f64,
        r_r: f64,
        theta_r: f64,
        z: f64,
    ) -> Complex64 {
        self.geometric(k, r_s, theta_s, r_r, theta_r, z)
            + self.diffracted(k, r_s, theta_s, r_r, theta_r, z)
    }

    /// Direct and mirrored fields alone. At a shadow boundary a field counts half.
    pub fn geometric(
        self,
        k: f64,
        r_s: f64,
        theta_s: f64,
        r_r: f64,
        theta_r: f64,
        z: f64,
    ) -> Complex64 {
        let pair = Pair {
            r_s,
            theta_s,
            r_r,
            theta_r,
            z,
        };
        let images = (PI / self.exterior_angle).ceil() as i32 + 1;
        let mut sum = Complex64::ZERO;
        for turn in -images..=images {
            for image in [theta_s, -theta_s] {
                let angle = f64::from(2 * turn) * self.exterior_angle + image - theta_r;
                let share = match angle.abs().total_cmp(&PI) {
                    std::cmp::Ordering::Less => 1.0,
                    std::cmp::Ordering::Equal => 0.5,
                    std::cmp::Ordering::Greater => 0.0,
                };
                sum += share * spherical(k, pair.distance(angle).into());
            }
        }
        pair.relative(k, sum)
    }

    /// Diffracted field alone.
    pub fn diffracted(
        self,
        k: f64,
        r_s: f64,
        theta_s: f64,
        r_r: f64,
        theta_r: f64,
        z: f64,
    ) -> Complex64 {
        let pair = Pair {
            r_s,
            theta_s,
            r_r,
            theta_r,
            z,
        };
        let index = PI / self.exterior_angle;
        let angles = [
            PI + theta_s + theta_r,
            PI + theta_s - theta_r,
            PI - theta_s + theta_r,
            PI - theta_s - theta_r,
        ];
        let limits = graded(FIRST_PANEL, PANEL_RATIO, LAST_PANEL);
        // On η = x + i·atan x the imaginary part of ℓ grows with x, and no pole is crossed: they are at imaginary η.
        let integral = integrate(&limits, |x| {
            let eta = Complex64::new(x, x.atan());
            let slope = Complex64::new(1.0, 1.0 / (1.0 + x * x));
            let length = (pair.squares() + 2.0 * r_s * r_r * eta.cosh()).sqrt();
            let factor: Complex64 = angles
                .iter()
                .map(|&angle| directivity(index, angle, eta))
                .sum();
            factor * spherical(k, length) * slope
        });
        pair.relative(k, integral * (-index / (2.0 * PI)))
    }
}

impl Pair {
    /// rS² + rR² + z² in m².
    fn squares(&self) -> f64 {
        self.r_s * self.r_s + self.r_r * self.r_r + self.z * self.z
    }

    /// Distance in m for the angle `angle` between source and receiver about the edge.
    fn distance(&self, angle: f64) -> f64 {
        (self.squares() - 2.0 * self.r_s * self.r_r * angle.cos()).sqrt()
    }

    /// Quotient of `field` and the free field at the direct distance.
    fn relative(&self, k: f64, field: Complex64) -> Complex64 {
        field / spherical(k, self.distance(self.theta_s - self.theta_r).into())
    }
}

/// Spherical wave e^{ikℓ}/ℓ.
fn spherical(k: f64, length: Complex64) -> Complex64 {
    (Complex64::I * k * length).exp() / length
}

/// sin νφ / (cosh νη − cos νφ), the denominator without cancellation at η = φ = 0.
fn directivity(index: f64, angle: f64, eta: Complex64) -> Complex64 {
    let half = index * angle / 2.0;
    let sinh = (eta * (index / 2.0)).sinh();
    half.sin() * half.cos() / (sinh * sinh + half.sin() * half.sin())
}
