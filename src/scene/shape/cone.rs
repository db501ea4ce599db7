//! A finite cone.

use super::part::{half, part};
use super::{Part, Properties, Shape};
use glam::{DVec2, DVec3};

part! {
    /// A finite cone about the y axis, with its base at −height/2 and its tip at height/2.
    Cone {
        /// Radius of the base, in metres.
        radius: f32 as Radius,
        /// Full height in metres.
        height: f32 as Length,
    }
}

impl Part for Cone {
    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            symmetric: [true, false, true],
            ..Properties::round(self.radius, half(self.height))
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let (radius, half_height) = (f64::from(self.radius), half(self.height));
        // Distance from the axis, and height.
        let p = DVec2::new(DVec2::new(p.x, p.z).length(), p.y);
        let tip = DVec2::new(0.0, half_height);
        let rim = DVec2::new(radius, -half_height);
        let middle = DVec2::new(0.0, -half_height);
        let distance = segment_distance(p, tip, rim).min(segment_distance(p, middle, rim));
        let out_of_side = DVec2::new(2.0 * half_height, radius).dot(p - rim);
        if out_of_side < 0.0 && p.y > -half_height {
            return -distance;
        }
        distance
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into(), half(self.height)]
    }
}

/// Distance of a point from the segment between `a` and `b`, in a plane.
pub(super) fn segment_distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + share * along)
}
