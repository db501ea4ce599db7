//! The general quadric, and the code shared by the special quadrics.
//!
//! The distance r to the surface of F satisfies |F| ≤ g r + λ r², with g = |∇F| and λ the norm of the quadratic form
//! (Taylor's theorem, exact for a quadratic). Solving for r gives φ = 2 F / (g + √(g² + 4 λ |F|)). φ never exceeds the
//! distance, and equals it to first order at the surface. It is Lipschitz continuous with constant 1, because |∇g| ≤ 2
//! λ.

use super::part::{Notation, arguments, parameters};
use super::{Bounds3, Part, Properties, Shape};
use crate::scene::SceneError;
use crate::scene::notation::{Number, Plain, Reader};
use glam::DVec3;
use serde::Deserialize;

/// Solid where A x² + B y² + C z² + D xy + E yz + F zx + G x + H y + I z + J < 0: `Quadric` in
/// scene files.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneralQuadric {
    /// The coefficients A to J, in this order.
    pub coefficients: [f32; 10],
}

/// The notation in a scene file: a list of the coefficients.
#[derive(Deserialize)]
pub(crate) struct File([Number<Plain>; 10]);

impl Notation for GeneralQuadric {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let mut coefficients = [0.0; 10];
        for (index, number) in file.0.into_iter().enumerate() {
            coefficients[index] = reader.number(&format!("coefficients.{index}"), number);
        }
        Ok(Shape::from(GeneralQuadric { coefficients }))
    }
}

parameters!(GeneralQuadric {
    coefficients: Quantity::Plain
});

impl Part for GeneralQuadric {
    fn check(&self) -> Result<(), String> {
        if self.form().norm() > 0.0 {
            return Ok(());
        }
        Err("one of its first six coefficients must not be 0: use HalfSpace for a plane".to_owned())
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            symmetric: [false; 3],
            ..Properties::bound(Bounds3::EVERYWHERE)
        }
    }

    /// The coefficients are not lengths, but roots and quotients of them are.
    fn own_length(&self) -> f64 {
        let form = self.form();
        let (linear, constant) = (form.linear.length(), form.constant.abs());
        (linear / form.norm()).max((constant / form.norm()).sqrt())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        self.form().distance_bound(p)
    }

    /// Diagonal, mixed, linear, constant, norm.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let form = self.form();
        let vectors = [form.diagonal, form.mixed, form.linear];
        let mut numbers = vectors.map(|v| v.to_array()).as_flattened().to_vec();
        numbers.extend([form.constant, form.norm()]);
        numbers
    }

    arguments!(3, 3, 3, 1, 1);
}

impl GeneralQuadric {
    fn form(&self) -> Quadric {
        let [a, b, c, xy, yz, zx, x, y, z, constant] = self.coefficients.map(f64::from);
        Quadric {
            diagonal: DVec3::new(a, b, c),
            mixed: 0.5 * DVec3::new(yz, zx, xy),
            linear: DVec3::new(x, y, z),
            constant,
        }
    }
}

/// The methods of a quadric along the coordinate axes, computed from its `form`.
macro_rules! straight_quadric {
    () => {
        fn value(&self, _: &[Shape], p: DVec3) -> f64 {
            self.form().distance_bound(p)
        }

        fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
            self.form().straight_numbers()
        }

        fn arguments(&self) -> &'static [usize] {
            Quadric::STRAIGHT_ARGUMENTS
        }
    };
}
pub(super) use straight_quadric;

/// The quadratic function pᵀ Q p + b · p + c, with Q symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quadric {
    /// Q's diagonal.
    pub diagonal: DVec3,
    /// Q's off-diagonal elements: yz, zx, xy.
    pub mixed: DVec3,
    /// b.
    pub linear: DVec3,
    /// c.
    pub constant: f64,
}

impl Quadric {
    /// Number of components of each argument in [`Quadric::straight_numbers`].
    pub(super) const STRAIGHT_ARGUMENTS: &[usize] = &[3, 1, 1];

    /// Creates a quadric along the coordinate axes.
    pub(super) fn straight(diagonal: DVec3, linear: DVec3, constant: f64) -> Quadric {
        Quadric {
            diagonal,
            mixed: DVec3::ZERO,
            linear,
            constant,
        }
    }

    /// Diagonal, constant and norm: the numbers in which quadrics of one kind along the coordinate axes differ.
    pub(super) fn straight_numbers(&self) -> Vec<f64> {
        let mut numbers = self.diagonal.to_array().to_vec();
        numbers.extend([self.constant, self.norm()]);
        numbers
    }

    /// A lower bound of the distance to the surface; see the documentation of the module.
    pub(super) fn distance_bound(&self, p: DVec3) -> f64 {
        let (value, gradient) = self.at(p);
        let g = gradient.length();
        let root = (g * g + 4.0 * self.norm() * value.abs()).sqrt();
        if root == 0.0 {
            return 0.0;
        }
        2.0 * value / (g + root)
    }

    /// The product Q p.
    fn form(&self, p: DVec3) -> DVec3 {
        let m = self.mixed;
        let mixed = DVec3::new(
            m.z * p.y + m.y * p.z,
            m.z * p.x + m.x * p.z,
            m.y * p.x + m.x * p.y,
        );
        self.diagonal * p + mixed
    }

    /// Value and gradient.
    pub fn at(&self, p: DVec3) -> (f64, DVec3) {
        let form = self.form(p);
        let value = p.dot(form) + self.linear.dot(p) + self.constant;
        (value, 2.0 * form + self.linear)
    }

    /// Upper bound of the factor by which Q stretches a vector. For a diagonal form this is the largest element.
    /// Otherwise it is the Frobenius norm, which is never smaller than the factor.
    pub fn norm(&self) -> f64 {
        if self.mixed == DVec3::ZERO {
            return self.diagonal.abs().max_element();
        }
        (self.diagonal.length_squared() + 2.0 * self.mixed.length_squared()).sqrt()
    }
}
