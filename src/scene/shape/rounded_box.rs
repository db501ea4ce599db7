//! A box with round edges.

use super::cuboid::box_value;
use super::part::{arguments, part};
use super::{Part, Properties, Shape};
use glam::{DVec3, Vec3};

part! {
    /// A box with rounded edges and vertices.
    RoundedBox {
        /// Full width, height and depth in metres, including the rounding.
        size: Vec3 as Side,
        /// Radius of the rounding in metres, at most half the smallest side.
        rounding: f32 as Radius,
    }
}

impl Part for RoundedBox {
    fn check(&self) -> Result<(), String> {
        let least = self.size.min_element();
        if 2.0 * self.rounding <= least {
            return Ok(());
        }
        Err(format!(
            "its rounding of {} m must be at most half its least size of {least} m",
            self.rounding
        ))
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::exact(0.5 * self.size.as_dvec3())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let rounding = f64::from(self.rounding);
        box_value(p, 0.5 * self.size.as_dvec3() - rounding) - rounding
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let rounding = f64::from(self.rounding);
        let core = 0.5 * self.size.as_dvec3() - rounding;
        vec![core.x, core.y, core.z, rounding]
    }

    arguments!(3, 1);
}
