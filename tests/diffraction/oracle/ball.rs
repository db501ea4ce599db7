//! Rigid ball and point source: the series of spherical harmonics.
//!
//! J. J. Bowman, T. B. A. Senior, P. L. E. Uslenghi, "Electromagnetic and acoustic scattering by simple shapes",
//! North-Holland 1969, chapter 10.

use super::bessel::spherical;
use super::{distance, length, term_count};
use rustfft::num_complex::Complex64;

/// Total field relative to the free field. Ball of radius `a` in m about the origin; `source` and `receiver` in m, both
/// outside it.
pub fn ball(k: f64, a: f64, source: [f64; 3], receiver: [f64; 3]) -> Complex64 {
    let (r_s, r_r, direct) = (length(source), length(receiver), distance(source, receiver));
    let dot: f64 = source.iter().zip(receiver).map(|(s, r)| s * r).sum();
    let free = Complex64::from_polar(1.0 / direct, k * direct);
    1.0 - Complex64::I * k * series(k, a, r_s, r_r, dot / (r_s * r_r)) / free
}

/// Σ (2n + 1) Pₙ(cosine) hₙ(k rS) hₙ(k rR) jₙ′(ka)/hₙ′(ka).
fn series(k: f64, a: f64, r_s: f64, r_r: f64, cosine: f64) -> Complex64 {
    let terms = term_count(k, a, r_s, r_r);
    let (_, source) = spherical(k * r_s, terms);
    let (_, receiver) = spherical(k * r_r, terms);
    let (bessel, hankel) = spherical(k * a, terms);
    let (mut legendre, mut legendre_next) = (1.0, cosine);
    let mut sum = Complex64::ZERO;
    for n in 0..terms {
        let order = n as f64;
        let reflection = bessel.derivative(n).over(hankel.derivative(n));
        let radial = reflection.by(source.value(n)).by(receiver.value(n));
        sum += radial.to_complex() * ((2.0 * order + 1.0) * legendre);
        let after = ((2.0 * order + 3.0) * cosine * legendre_next - (order + 1.0) * legendre)
            / (order + 2.0);
        (legendre, legendre_next) = (legendre_next, after);
    }
    sum
}
