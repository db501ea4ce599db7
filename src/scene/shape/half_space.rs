//! A half space with any normal.

use super::part::{arguments, part, surface_kind};
use super::{Bounds3, Part, Properties, Shape};
use glam::{DVec3, Vec3};

part! {
    /// Solid where `normal · p < offset`, with the normal scaled to a unit vector.
    HalfSpace {
        /// Normal that points out of the solid; any length.
        normal: Vec3 as Plain,
        /// Distance of the boundary from the origin along the unit normal, in metres.
        offset: f32 as Metres = default,
    }
}

/// Minimum length of a normal. `f32` cannot resolve the direction of a shorter vector.
const SHORTEST_NORMAL: f32 = 1e-6;

impl Part for HalfSpace {
    surface_kind!(PLANE);

    fn check(&self) -> Result<(), String> {
        if self.normal.length() < SHORTEST_NORMAL {
            return Err("its normal must have a length".to_owned());
        }
        Ok(())
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            bounds: Bounds3::EVERYWHERE,
            symmetric: [false; 3],
            ..Properties::exact(DVec3::ZERO)
        }
    }

    fn own_length(&self) -> f64 {
        f64::from(self.offset.abs())
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        self.normal.as_dvec3().normalize().dot(p) - f64::from(self.offset)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let normal = self.normal.as_dvec3().normalize();
        vec![normal.x, normal.y, normal.z, f64::from(self.offset)]
    }

    arguments!(3, 1);
}
