//! The space of a scene, continued by its images behind faces in which edges and pillars end.

use super::bend::Abutment;
use super::space::{Obstacle, Space};
use glam::DVec3;

/// The space in front of faces at right angles to edges or pillars, and its images behind them.
pub(super) struct Images<'a, S> {
    pub space: &'a S,
    pub faces: &'a [Abutment],
    /// Distance in metres up to which a point counts as on a face.
    pub error_m: f64,
}

impl<S: Space> Space for Images<'_, S> {
    fn first(&self, origin: DVec3, direction: DVec3, until: f64) -> Option<Obstacle> {
        let (mut origin, mut direction) = Abutment::in_front(self.faces, origin, direction);
        let mut passed_m = 0.0;
        let mut last = None;
        for _ in 0..Abutment::MOST_IMAGES {
            let met = self.space.first(origin, direction, until - passed_m)?;
            let point = origin + direction * met.metres;
            let is_passed = |face: &&Abutment| face.is_entered(point, direction, self.error_m);
            let Some(face) = self.faces.iter().find(is_passed) else {
                return Some(Obstacle {
                    metres: passed_m + met.metres,
                    ..met
                });
            };
            passed_m += met.metres;
            last = Some(Obstacle {
                metres: passed_m,
                ..met
            });
            (origin, direction) = face.reflected(point, direction, self.error_m);
        }
        // The line counts as blocked, because it is unknown what lies beyond the last image.
        last
    }

    fn distance(&self, point: DVec3) -> f64 {
        self.space.distance(self.in_scene(point))
    }

    fn nearest(&self, point: DVec3) -> u32 {
        self.space.nearest(self.in_scene(point))
    }

    fn in_scene(&self, point: DVec3) -> DVec3 {
        let (point, _) = Abutment::in_front(self.faces, point, DVec3::ZERO);
        self.space.in_scene(point)
    }
}
