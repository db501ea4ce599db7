//! Endless rigid cylinder: the series of the line source, and its integral over the axial wave number for a point
//! source.
//!
//! J. J. Bowman, T. B. A. Senior, P. L. E. Uslenghi, "Electromagnetic and acoustic scattering by simple shapes",
//! North-Holland 1969, chapter 2.

use super::bessel::{cylindrical, hankel, modified_first, modified_second};
use super::quadrature::{graded, integrate};
use super::{distance, term_count};
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, TAU};

/// Phase in radians of one panel of the axial integral: 24 nodes resolve four oscillations to 1e-15.
const PANEL_PHASE: f64 = 4.0 * TAU;
/// Panel next to the axial wave number k, where the integrand has a logarithmic branch point.
const FIRST_PANEL: f64 = 1e-8;
/// Ratio of neighbouring panels at the branch point.
const PANEL_RATIO: f64 = 3.0;

/// Natural logarithm of the last digit of `f64`, without its sign.
const DECAY: f64 = 40.0;

/// Cylinder with the places of source and receiver about it, all in m but the angle between them in radians.
#[derive(Clone, Copy, Debug)]
struct Pair {
    a: f64,
    r_s: f64,
    r_r: f64,
    angle: f64,
    z: f64,
}

impl Pair {
    fn new(a: f64, source: [f64; 3], receiver: [f64; 3]) -> Self {
        let [r_s, r_r] = [source, receiver].map(|place| place[0].hypot(place[1]));
        let angle = source[1].atan2(source[0]) - receiver[1].atan2(receiver[0]);
        Self {
            a,
            r_s,
            r_r,
            angle,
            z: receiver[2] - source[2],
        }
    }
}

/// Total field of a point source relative to its free field. Cylinder of radius `a` in m about the z axis; `source` and
/// `receiver` in m, both outside it.
pub fn cylinder(k: f64, a: f64, source: [f64; 3], receiver: [f64; 3]) -> Complex64 {
    let pair = Pair::new(a, source, receiver);
    let direct = distance(source, receiver);
    let free = Complex64::from_polar(1.0 / direct, k * direct);
    1.0 - Complex64::I * axial_integral(k, &pair) / free
}

/// Total field of a line source parallel to the axis, relative to its free field. Radius `a` and places in m.
pub fn cylinder_line_source(k: f64, a: f64, source: [f64; 2], receiver: [f64; 2]) -> Complex64 {
    let lift = |[x, y]: [f64; 2]| [x, y, 0.0];
    let pair = Pair::new(a, lift(source), lift(receiver));
    let free = hankel(k * distance(lift(source), lift(receiver)), 1);
    1.0 - radiating(k, &pair) / free.value(0).to_complex()
}

/// ∫ cos(k_z z) f(k_z) dk_z from 0 to ∞, f the series of the line source for the wave number √(k² − k_z²).
fn axial_integral(k: f64, pair: &Pair) -> Complex64 {
    let way = pair.r_s + pair.r_r + pair.z.abs();
    // k_z = k cos t: the branch point is at t = 0.
    let limits = refined(
        &graded(FIRST_PANEL, PANEL_RATIO, FRAC_PI_2),
        PANEL_PHASE / (k * way),
    );
    let below = integrate(&limits, |t| {
        let (sin, cos) = t.sin_cos();
        radiating(k * sin, pair) * (k * sin * (k * cos * pair.z).cos())
    });
    // k_z = k cosh t. Beyond the end e^{−k sinh t (rS + rR − 2a)} is below the last digit.
    let end = (DECAY / (k * (pair.r_s + pair.r_r - 2.0 * pair.a))).asinh();
    let limits = refined(
        &graded(FIRST_PANEL, PANEL_RATIO, end),
        PANEL_PHASE / (k * end.cosh() * way),
    );
    let above = integrate(&limits, |t| {
        let (sinh, cosh) = (t.sinh(), t.cosh());
        evanescent(k * sinh, pair) * (k * sinh * (k * cosh * pair.z).cos())
    });
    below + above
}

/// `limits` with each panel divided into equal ones of at most `longest`.
fn refined(limits: &[f64], longest: f64) -> Vec<f64> {
    let mut fine = vec![limits[0]];
    for pair in limits.windows(2) {
        let parts = ((pair[1] - pair[0]) / longest).ceil().max(1.0) as u32;
        let step = (pair[1] - pair[0]) / f64::from(parts);
        fine.extend((1..=parts).map(|part| pair[0] + step * f64::from(part)));
    }
    fine
}

/// Σ εₙ cos nφ Hₙ(κ rS) Hₙ(κ rR) Jₙ′(κa)/Hₙ′(κa).
fn radiating(kappa: f64, pair: &Pair) -> Complex64 {
    let terms = term_count(kappa, pair.a, pair.r_s, pair.r_r);
    let source = hankel(kappa * pair.r_s, terms);
    let receiver = hankel(kappa * pair.r_r, terms);
    let (bessel, outgoing) = cylindrical(kappa * pair.a, terms);
    angular_sum(terms, pair.angle, |n| {
        let reflection = bessel.derivative(n).over(outgoing.derivative(n));
        reflection
            .by(source.value(n))
            .by(receiver.value(n))
            .to_complex()
    })
}

/// The same sum for κ = iq: −(2i/π) Σ εₙ cos nφ Kₙ(q rS) Kₙ(q rR) Iₙ′(qa)/Kₙ′(qa).
fn evanescent(q: f64, pair: &Pair) -> Complex64 {
    let terms = term_count(q, pair.a, pair.r_s, pair.r_r);
    let source = modified_second(q * pair.r_s, terms);
    let receiver = modified_second(q * pair.r_r, terms);
    let (inner, outer) = (
        modified_first(q * pair.a, terms),
        modified_second(q * pair.a, terms),
    );
    let sum = angular_sum(terms, pair.angle, |n| {
        let reflection = inner.derivative(n).over(outer.derivative(n));
        reflection
            .by(source.value(n))
            .by(receiver.value(n))
            .to_complex()
    });
    Complex64::new(0.0, -FRAC_2_PI) * sum
}

/// Σ εₙ cos(n·`angle`) term(n), ε₀ = 1 and εₙ = 2.
fn angular_sum(terms: usize, angle: f64, term: impl Fn(usize) -> Complex64) -> Complex64 {
    let pairs: Complex64 = (1..terms)
        .map(|n| term(n) * (2.0 * (n as f64 * angle).cos()))
        .sum();
    term(0) + pairs
}
