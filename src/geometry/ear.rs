//! The listener of reference waves.

use super::closed_form::intersect_sphere;
use crate::scene::Listener;
use glam::DVec3;

/// The listener, in `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ear {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) right: DVec3,
}

impl Ear {
    pub(super) fn of(listener: &Listener) -> Ear {
        let (sin_yaw, cos_yaw) = f64::from(listener.yaw).sin_cos();
        Ear {
            centre: listener.position.as_dvec3(),
            radius: listener.radius.into(),
            right: DVec3::new(cos_yaw, 0.0, sin_yaw),
        }
    }

    pub(super) fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let offset = origin - self.centre;
        if offset.length_squared() <= self.radius * self.radius {
            return Some(0.0);
        }
        intersect_sphere(self.radius, offset, direction)
    }
}
