//! A plane.

use super::part::{part, surface_kind};
use super::{Bounds3, Part, Properties, Shape};
use glam::DVec3;

part! {
    /// The plane y = 0, with the solid below it.
    Plane
}

impl Part for Plane {
    surface_kind!(PLANE);

    fn properties(&self, _: &[Shape]) -> Properties {
        let endless = f64::INFINITY;
        Properties {
            bounds: Bounds3 {
                max: DVec3::new(endless, 0.0, endless),
                ..Bounds3::EVERYWHERE
            },
            symmetric: [true, false, true],
            ..Properties::exact(DVec3::ZERO)
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        p.y
    }
}
