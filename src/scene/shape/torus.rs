//! A torus.

use super::part::{part, surface_kind};
use super::{Exactness, Part, Properties, Shape};
use glam::{DVec2, DVec3};

part! {
    /// A torus about the y axis.
    Torus {
        /// Radius of the centre line, in metres.
        ring: f32 as Radius,
        /// Radius of the tube, in metres.
        tube: f32 as Radius,
    }
}

impl Part for Torus {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            // If the tube reaches across the axis, it covers its own inner side. That side is then not part of the
            // surface, but the value is still the distance to it.
            in_solid: match self.tube > self.ring {
                true => Exactness::Bound,
                false => Exactness::Exact,
            },
            convex: false,
            ..Properties::round(self.ring + self.tube, self.tube.into())
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let from_axis = DVec2::new(p.x, p.z).length();
        (from_axis - f64::from(self.ring)).hypot(p.y) - f64::from(self.tube)
    }
}
