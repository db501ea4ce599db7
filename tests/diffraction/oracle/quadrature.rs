//! Gauss–Legendre quadrature on panels.

use rustfft::num_complex::Complex64;
use std::sync::LazyLock;

/// Nodes of one panel: a panel integrates a full oscillation to the last digits of `f64`.
const NODES: usize = 24;

/// Nodes and weights on −1 … 1.
static RULE: LazyLock<[(f64, f64); NODES]> = LazyLock::new(|| std::array::from_fn(node_and_weight));

/// Integral of `integrand` over the panels between neighbouring `limits`.
pub fn integrate(limits: &[f64], mut integrand: impl FnMut(f64) -> Complex64) -> Complex64 {
    let mut sum = Complex64::ZERO;
    for pair in limits.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        for &(node, weight) in RULE.iter() {
            sum += integrand(middle + half * node) * (weight * half);
        }
    }
    sum
}

/// Limits 0, `first`, `first`·`ratio` … `last`: panels that shrink towards 0, for integrands that peak or branch there.
pub fn graded(first: f64, ratio: f64, last: f64) -> Vec<f64> {
    let growing = std::iter::successors(Some(first), |limit| Some(limit * ratio));
    let below_last = growing.take_while(|&limit| limit < last);
    std::iter::once(0.0)
        .chain(below_last)
        .chain([last])
        .collect()
}

/// Root number `index` of the Legendre polynomial of degree [`NODES`] by Newton's method, and its weight.
fn node_and_weight(index: usize) -> (f64, f64) {
    /// Newton's method doubles the digits with each step, from two at the start.
    const NEWTON_STEPS: usize = 6;
    let degree = NODES as f64;
    let mut x = (std::f64::consts::PI * (index as f64 + 0.75) / (degree + 0.5)).cos();
    for _ in 0..NEWTON_STEPS {
        let (value, slope) = legendre(x);
        x -= value / slope;
    }
    let (_, slope) = legendre(x);
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

/// Legendre polynomial of degree [`NODES`] and its derivative at `x`.
fn legendre(x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for degree in 2..=NODES {
        let n = degree as f64;
        (before, value) = (
            value,
            ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n,
        );
    }
    (value, NODES as f64 * (x * value - before) / (x * x - 1.0))
}
