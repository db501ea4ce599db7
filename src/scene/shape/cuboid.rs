//! A box. The type is called `Cuboid` because `Box` is a type of the standard library.

use super::part::{arguments, part, surface_kind};
use super::{Part, Properties, Shape};
use glam::{DVec3, Vec3};

part! {
    /// A solid box: `Box` in scene files.
    Cuboid {
        /// Full width, height and depth in metres.
        size: Vec3 as Side,
    }
}

impl Part for Cuboid {
    surface_kind!(FLAT);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::exact(0.5 * self.size.as_dvec3())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        box_value(p, 0.5 * self.size.as_dvec3())
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        (0.5 * self.size.as_dvec3()).to_array().to_vec()
    }

    arguments!(3);
}

/// The signed distance to a box centred on the origin.
pub(crate) fn box_value(p: DVec3, half_size: DVec3) -> f64 {
    let beyond = p.abs() - half_size;
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
}
