//! A paraboloid.

use super::part::{part, surface_kind};
use super::quadric::straight_quadric;
use super::{Bounds3, Part, Properties, Quadric, Shape};
use glam::DVec3;

part! {
    /// A solid paraboloid that opens towards +y: y > (x² + z²) / (4 `focal_length`).
    Paraboloid {
        /// Distance of the focus from the vertex at the origin, in metres.
        focal_length: f32 as Length,
    }
}

impl Part for Paraboloid {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            convex: true,
            symmetric: [true, false, true],
            // Below the vertex, the value grows with the square root of the distance. No multiple of the value
            // therefore bounds the distance of a level set from y = 0.
            ..Properties::bound(Bounds3::EVERYWHERE)
        }
    }

    fn own_length(&self) -> f64 {
        self.focal_length.into()
    }

    straight_quadric!();
}

impl Paraboloid {
    fn form(&self) -> Quadric {
        let bend = 0.25 / f64::from(self.focal_length);
        Quadric::straight(DVec3::new(bend, 0.0, bend), DVec3::NEG_Y, 0.0)
    }
}
