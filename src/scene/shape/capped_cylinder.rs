//! A finite cylinder: in a scene file a `Cylinder` with a height.

use super::part::parameters;
use super::{Part, Properties, Shape};
use crate::scene::Quantity;
use glam::{DVec2, DVec3};

/// A finite cylinder about y.
#[derive(Clone, Debug, PartialEq)]
pub struct CappedCylinder {
    /// Radius in metres.
    pub radius: f32,
    /// Full height in metres.
    pub height: f32,
}

parameters!(CappedCylinder {
    radius: Quantity::Length,
    height: Quantity::Length
});

impl Part for CappedCylinder {
    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, self.half_height())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let ring = DVec2::new(p.x, p.z).length() - f64::from(self.radius);
        corner_value(DVec2::new(ring, p.y.abs() - self.half_height()))
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into(), self.half_height()]
    }
}

impl CappedCylinder {
    fn half_height(&self) -> f64 {
        0.5 * f64::from(self.height)
    }
}

/// The signed distance to a quarter plane, from the signed distances to the lines of its two edges.
pub(super) fn corner_value(beyond: DVec2) -> f64 {
    beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
}
