//! An ellipsoid.

use super::part::{part, surface_kind};
use super::quadric::straight_quadric;
use super::{Bounds3, Part, Properties, Quadric, Shape};
use glam::{DVec3, Vec3};

part! {
    /// An ellipsoid.
    Ellipsoid {
        /// Half axes along x, y and z, in metres.
        radii: Vec3 as Radius,
    }
}

impl Part for Ellipsoid {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            convex: true,
            ..Properties::bound(Bounds3::centred(self.radii.as_dvec3()))
        }
    }

    /// Let m = |p / radii|; then F = m² − 1 and g ≤ 2 m / least, with the least radius. The value is at least (m − 1)
    /// least / (1 + √2). The distance from p to the bounds along any axis is at most (m − 1) times the greatest radius.
    fn slowness(&self, _: &[Shape]) -> f64 {
        let stretch = f64::from(self.radii.max_element()) / f64::from(self.radii.min_element());
        (1.0 + std::f64::consts::SQRT_2) * stretch
    }

    straight_quadric!();
}

impl Ellipsoid {
    fn form(&self) -> Quadric {
        let radii = self.radii.as_dvec3();
        Quadric::straight(1.0 / (radii * radii), DVec3::ZERO, -1.0)
    }
}
