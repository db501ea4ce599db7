//! Bessel and Hankel functions of a sequence of orders from 0, for real arguments, by recurrences in their stable
//! direction: upwards for the functions that grow with the order, downwards (J. C. P. Miller) for those that fall.
//!
//! M. Abramowitz, I. A. Stegun, "Handbook of mathematical functions", chapters 9 and 10.

use super::scaled::Scaled;
use rustfft::num_complex::Complex64;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_4};

/// Euler's constant.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Argument from which Hankel's expansion gives H₀ and H₁ to the last digits: its terms fall until number 2x.
const FAR: f64 = 30.0;

/// Functions of the orders 0, 1, … at one argument, with derivatives for all orders but the last.
pub struct Sequence {
    argument: f64,
    values: Vec<Scaled>,
    /// Sign of fₙ₊₁ in fₙ′ = (n/x) fₙ ± fₙ₊₁.
    next_sign: f64,
}

impl Sequence {
    /// Value of order `n`.
    pub fn value(&self, n: usize) -> Scaled {
        self.values[n]
    }

    /// Derivative of order `n` with respect to the argument.
    pub fn derivative(&self, n: usize) -> Scaled {
        let next = self.values[n + 1].times(self.next_sign);
        self.values[n].times(n as f64 / self.argument).plus(next)
    }
}

/// Spherical Bessel functions jₙ and Hankel functions hₙ of the first kind for the orders 0 to `last`.
pub fn spherical(x: f64, last: usize) -> (Sequence, Sequence) {
    let coefficient = |n: usize| (2 * n + 1) as f64 / x;
    let falling = downwards(x, last, coefficient, -1.0);
    let (sin, cos) = x.sin_cos();
    let known = [sin / x, (sin / x - cos) / x];
    // The larger of j₀ and j₁ sets the scale: each has zeros, and for small x only j₀ is free of cancellation.
    let anchor = usize::from(x > 1.0 && known[1].abs() > known[0].abs());
    let scale = Scaled::from(known[anchor]).over(falling[anchor]);
    let bessel = falling
        .into_iter()
        .take(last + 1)
        .map(|value| value.by(scale))
        .collect();
    let growing = [-cos / x, -(cos / x + sin) / x].map(Scaled::from);
    with_hankel(x, bessel, &upwards(growing, last, coefficient, -1.0))
}

/// Bessel functions Jₙ and Hankel functions Hₙ of the first kind for the orders 0 to `last`.
pub fn cylindrical(x: f64, last: usize) -> (Sequence, Sequence) {
    let coefficient = |n: usize| (2 * n) as f64 / x;
    let falling = downwards(x, last, coefficient, -1.0);
    // J₀ + 2 Σ J₂ₖ = 1.
    let even = falling.iter().skip(2).step_by(2);
    let sum = even.fold(falling[0], |sum, value| sum.plus(value.times(2.0)));
    let mut bessel: Vec<Scaled> = falling.into_iter().map(|value| value.over(sum)).collect();
    let growing = neumann(x, &bessel).map(Scaled::from);
    bessel.truncate(last + 1);
    with_hankel(x, bessel, &upwards(growing, last, coefficient, -1.0))
}

/// Hankel functions Hₙ of the first kind for the orders 0 to `last`.
pub fn hankel(x: f64, last: usize) -> Sequence {
    // Below the order x the recurrence is stable upwards for Jₙ too, so the orders above `last` are not needed.
    if x < FAR || last as f64 >= x {
        return cylindrical(x, last).1;
    }
    let start = [far_hankel(x, 0), far_hankel(x, 1)];
    let values = upwards(start, last, |n| (2 * n) as f64 / x, -1.0);
    Sequence {
        argument: x,
        values,
        next_sign: -1.0,
    }
}

/// Modified Bessel functions Iₙ for the orders 0 to `last`.
pub fn modified_first(x: f64, last: usize) -> Sequence {
    let falling = downwards(x, last, |n| (2 * n) as f64 / x, 1.0);
    // I₀ + 2 Σ Iₙ = eˣ.
    let sum = falling[1..]
        .iter()
        .fold(falling[0], |sum, value| sum.plus(value.times(2.0)));
    let scale = Scaled::exp(x).over(sum);
    let values = falling
        .into_iter()
        .take(last + 1)
        .map(|value| value.by(scale))
        .collect();
    Sequence {
        argument: x,
        values,
        next_sign: 1.0,
    }
}

/// Modified Bessel functions Kₙ for the orders 0 to `last`.
pub fn modified_second(x: f64, last: usize) -> Sequence {
    let decay = Scaled::exp(-x);
    let start = [macdonald(x, 0), macdonald(x, 1)].map(|value| Scaled::from(value).by(decay));
    let values = upwards(start, last, |n| (2 * n) as f64 / x, 1.0);
    Sequence {
        argument: x,
        values,
        next_sign: -1.0,
    }
}

/// The sequences f and f + ig of the falling functions f and the growing ones g.
fn with_hankel(x: f64, falling: Vec<Scaled>, growing: &[Scaled]) -> (Sequence, Sequence) {
    let pairs = falling.iter().zip(growing);
    let values = pairs
        .map(|(real, imaginary)| real.plus(imaginary.times_complex(Complex64::I)))
        .collect();
    let hankel = Sequence {
        argument: x,
        values,
        next_sign: -1.0,
    };
    (
        Sequence {
            argument: x,
            values: falling,
            next_sign: -1.0,
        },
        hankel,
    )
}

/// fₙ₊₁ = c(n) fₙ + `sign` fₙ₋₁ from `start`, the orders 0 and 1, to `last`.
fn upwards(
    start: [Scaled; 2],
    last: usize,
    coefficient: impl Fn(usize) -> f64,
    sign: f64,
) -> Vec<Scaled> {
    let mut values = start.to_vec();
    for n in 1..last {
        values.push(
            values[n]
                .times(coefficient(n))
                .plus(values[n - 1].times(sign)),
        );
    }
    values
}

/// fₙ₋₁ = c(n) fₙ + `sign` fₙ₊₁ from far above `last` and the argument, for the orders from 0, up to a common factor.
fn downwards(x: f64, last: usize, coefficient: impl Fn(usize) -> f64, sign: f64) -> Vec<Scaled> {
    let order = x.max(last as f64 + 1.0);
    // From the turning point n = x the function falls over a few x^⅓ orders. Beyond, each order divides it by 2 or more.
    let start = (order + 12.0 * order.cbrt() + 60.0).ceil() as usize;
    let mut values = vec![Scaled::from(0.0); start + 1];
    values[start - 1] = Scaled::from(1.0);
    for n in (1..start).rev() {
        values[n - 1] = values[n]
            .times(coefficient(n))
            .plus(values[n + 1].times(sign));
    }
    values
}

/// Y₀ and Y₁ by Neumann's series of all Jₙ (Abramowitz and Stegun, 9.1.88).
fn neumann(x: f64, bessel: &[Scaled]) -> [f64; 2] {
    let value = |n: usize| bessel[n].to_complex().re;
    let logarithm = (x / 2.0).ln() + EULER_GAMMA;
    let (mut even, mut odd) = (0.0, 0.0);
    for k in (1..(bessel.len() - 1) / 2).rev() {
        let order = k as f64;
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        even += sign * value(2 * k) / order;
        odd += sign * (2.0 * order + 1.0) / (order * (order + 1.0)) * value(2 * k + 1);
    }
    let zero = FRAC_2_PI * (logarithm * value(0) - 2.0 * even);
    let one = FRAC_2_PI * ((logarithm - 1.0) * value(1) - value(0) / x - odd);
    [zero, one]
}

/// H₀ or H₁ by Hankel's expansion (Abramowitz and Stegun, 9.2.7) for x ≥ [`FAR`].
fn far_hankel(x: f64, order: u32) -> Scaled {
    /// The last term is below 1e-18 at [`FAR`].
    const TERMS: u32 = 30;
    let square = f64::from(4 * order * order);
    let (mut sum, mut term) = (Complex64::ONE, Complex64::ONE);
    for k in 1..TERMS {
        let odd = f64::from(2 * k - 1);
        term *= Complex64::I * ((square - odd * odd) / (f64::from(8 * k) * x));
        sum += term;
    }
    let phase = x - FRAC_PI_4 * f64::from(2 * order + 1);
    Scaled::from(1.0).times_complex(sum * Complex64::from_polar((FRAC_2_PI / x).sqrt(), phase))
}

/// eˣ Kₙ(x) = ∫ e^{−x(cosh t − 1)} cosh nt dt from 0 to ∞ by the trapezoidal rule. The integrand is entire and falls
/// doubly exponentially.
fn macdonald(x: f64, order: i32) -> f64 {
    /// The exponent at the end.
    const END: f64 = 45.0;
    /// Longest step h: the error is e^{−π²/h}.
    const STEP: f64 = 1.0 / 16.0;
    /// Least number of steps N: for large x the integrand is a Gaussian function and the error e^{−π²N²/45}.
    const STEPS: f64 = 24.0;
    let end = (1.0 + END / x).acosh();
    let step = STEP.min(end / STEPS);
    let integrand = |number: u32| {
        let t = f64::from(number) * step;
        (-2.0 * x * (t / 2.0).sinh().powi(2)).exp() * (f64::from(order) * t).cosh()
    };
    let inner: f64 = (1..=(end / step).ceil() as u32).map(integrand).sum();
    step * (0.5 + inner)
}
