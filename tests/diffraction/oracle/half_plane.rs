//! Rigid half plane and point source: Macdonald's solution, a check of the wedge by other formulas.
//!
//! H. M. Macdonald, "A class of diffraction problems", Proc. London Math. Soc. 14 (1915): each of the direct and the
//! mirrored field is ik ∫ H₁(kR + s²)/√(s² + 2kR) ds from −m to ∞, m = ±√(k(R₁ − R)), R₁ the way over the edge.

use super::quadrature::{graded, integrate};
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Total field for a half plane at the angles 0 and 2π, relative to the free field; arguments as the wedge's.
pub fn pressure(k: f64, r_s: f64, theta_s: f64, r_r: f64, theta_r: f64, z: f64) -> Complex64 {
    let edge_way = (r_s + r_r).hypot(z);
    let way = |angle: f64| {
        let across = r_s * r_s + r_r * r_r - 2.0 * r_s * r_r * angle.cos();
        (across + z * z).sqrt()
    };
    let field = |angle: f64| {
        let distance = way(angle);
        // k(R₁ − R) without cancellation: R₁² − R² = 4 rS rR cos²(angle/2).
        let cosine = (angle / 2.0).cos();
        let limit = 2.0 * cosine.abs() * (k * r_s * r_r / (edge_way + distance)).sqrt();
        let tail = Complex64::I * k * tail_integral(k * distance, limit);
        if cosine < 0.0 {
            tail
        } else {
            spherical(k, distance) - tail
        }
    };
    (field(theta_s - theta_r) + field(theta_s + theta_r)) / spherical(k, way(theta_s - theta_r))
}

/// ∫ H₁(kR + s²)/√(s² + 2kR) ds from `limit` ≥ 0 to ∞, on the ray that leaves `limit` at 45°: e^{is²} decays on it.
fn tail_integral(k_distance: f64, limit: f64) -> Complex64 {
    /// e^{−t²} is below the last digit of `f64`.
    const END: f64 = 7.0;
    /// The first panel and the ratio of neighbouring ones: H₁ varies most where kR + s² is smallest, at the start.
    const FIRST_PANEL: f64 = 0.1;
    const PANEL_RATIO: f64 = 1.5;
    let direction = Complex64::from_polar(1.0, PI / 4.0);
    direction
        * integrate(&graded(FIRST_PANEL, PANEL_RATIO, END), |t| {
            let s = limit + direction * t;
            hankel_1(k_distance + s * s) / (s * s + 2.0 * k_distance).sqrt()
        })
}

/// Hankel function H₁ of the first kind for Im w ≥ 0, |w| > 0.5, as −(2/π) K₁(−iw), with
/// K₁(y) = √(π/2y) e^{−y} (4/√π) ∫ v² √(1 + v²/2y) e^{−v²} dv from 0 to ∞, by the trapezoidal rule.
fn hankel_1(w: Complex64) -> Complex64 {
    /// The rule's error is e^{−2πd/h}, d = Im √(2iw) > 0.7 the distance of the branch point from the real axis.
    const STEP: f64 = 0.1;
    const STEPS: u32 = 65;
    let y = -Complex64::I * w;
    let sum: Complex64 = (1..=STEPS)
        .map(|step| {
            let square = (f64::from(step) * STEP).powi(2);
            (1.0 + square / (2.0 * y)).sqrt() * (square * (-square).exp())
        })
        .sum();
    let bessel_k = (FRAC_PI_2 / y).sqrt() * (-y).exp() * sum * (4.0 * STEP / PI.sqrt());
    bessel_k * (-2.0 / PI)
}

/// Spherical wave e^{ikR}/R.
fn spherical(k: f64, distance: f64) -> Complex64 {
    Complex64::from_polar(1.0 / distance, k * distance)
}
