//! A cylinder with hemispherical ends.

use super::part::{half, part, surface_kind};
use super::{Part, Properties, Shape};
use glam::{DVec2, DVec3};

part! {
    /// A cylinder about the y axis with hemispherical ends.
    Capsule {
        /// Radius of the cylinder and of the ends, in metres.
        radius: f32 as Radius,
        /// Distance between the centres of the ends, in metres.
        height: f32 as Length,
    }
}

impl Part for Capsule {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, f64::from(self.radius) + half(self.height))
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let up = p.y - p.y.clamp(-half(self.height), half(self.height));
        DVec2::new(p.x, p.z).length().hypot(up) - f64::from(self.radius)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into(), half(self.height)]
    }
}
