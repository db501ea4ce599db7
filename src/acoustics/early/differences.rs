//! Derivatives of a tree's value by central differences.
//!
//! Values are rounded: for coordinates up to X the error of a value is about ε X. With features of
//! length ℓ its n-th derivative is about ℓ^(1−n). A difference quotient over steps h has both
//! errors; this h makes them equal:
//! - gradient, of fourth order: rounding ε X / h, truncation h⁴ / ℓ⁴ (÷ 30): h⁵ = ε X ℓ⁴;
//! - second derivatives, of second order: ε X / h² and h² / ℓ³ (÷ 12): h⁴ = 12 ε X ℓ³, extrapolated
//!   from two steps to a step of 0 (Richardson).
//!
//! X = 50 m and ℓ = 0.1 m give a gradient to 4·10⁻¹¹ and second derivatives to 10⁻⁶/m.

use crate::scene::Shape;
use glam::{DMat3, DVec3};

/// Value, gradient and second derivatives at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Derivatives {
    pub value: f64,
    pub gradient: DVec3,
    pub hessian: DMat3,
}

/// A level of a tree's value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Differenced<'a> {
    shape: &'a Shape,
    level: f64,
    gradient_step: f64,
    hessian_step: f64,
}

impl<'a> Differenced<'a> {
    /// The surface where the value of `shape` is `level` metres; `largest` is the largest
    /// coordinate of a point, in metres.
    pub fn new(shape: &'a Shape, level: f64, largest: f64) -> Differenced<'a> {
        let lengths = shape.nodes().into_iter();
        let own = lengths.map(|tree| tree.node.part().own_length());
        let shortest = own.filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        // Without lengths in the shape any step is suitable.
        let feature = if shortest.is_finite() { shortest } else { 1.0 };
        let rounding = f64::EPSILON * largest.max(feature);
        Differenced {
            shape,
            level,
            gradient_step: (rounding * feature.powi(4)).powf(0.2),
            hessian_step: (12.0 * rounding * feature.powi(3)).powf(0.25),
        }
    }

    /// Derivatives at a point in the tree's own axes.
    pub fn derivatives(&self, p: DVec3) -> Derivatives {
        let (h, value) = (self.hessian_step, self.shape.value(p));
        let fine = self.second(p, value, h);
        let coarse = self.second(p, value, 2.0 * h);
        Derivatives {
            value: value - self.level,
            gradient: self.gradient(p),
            hessian: (fine * 4.0 - coarse) * (1.0 / 3.0),
        }
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        let h = self.gradient_step;
        let along = |axis: DVec3| {
            let rise = |steps: f64| {
                self.shape.value(p + axis * (steps * h)) - self.shape.value(p - axis * (steps * h))
            };
            (8.0 * rise(1.0) - rise(2.0)) / (12.0 * h)
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    fn second(&self, p: DVec3, value: f64, h: f64) -> DMat3 {
        let at = |offset: DVec3| self.shape.value(p + offset * h);
        let straight = |axis: DVec3| (at(axis) + at(-axis) - 2.0 * value) / (h * h);
        let mixed =
            |a: DVec3, b: DVec3| (at(a + b) + at(-a - b) - at(a - b) - at(b - a)) / (4.0 * h * h);
        let [x, y, z] = DVec3::AXES;
        let (xy, yz, zx) = (mixed(x, y), mixed(y, z), mixed(z, x));
        DMat3::from_cols(
            DVec3::new(straight(x), xy, zx),
            DVec3::new(xy, straight(y), yz),
            DVec3::new(zx, yz, straight(z)),
        )
    }
}
