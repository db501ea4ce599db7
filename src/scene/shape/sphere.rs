//! A solid sphere.

use super::part::{part, surface_kind};
use super::{Part, Properties, Shape};
use glam::DVec3;

part! {
    /// A solid sphere.
    Sphere {
        /// Radius in metres.
        radius: f32 as Radius,
    }
}

impl Part for Sphere {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, self.radius.into())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        p.length() - f64::from(self.radius)
    }
}
