//! The space between source and listener: lines of sight and distances.

use crate::geometry::ExactScene;
use glam::DVec3;

/// The first surface on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Obstacle {
    /// Distance from the start of the line in metres.
    pub metres: f64,
    /// Number of the surface, from 1.
    pub surface: u32,
}

/// The air and the solids of a scene.
pub(super) trait Space {
    /// The first surface nearer than `until` metres on a line from a point in the air along a unit vector.
    fn first(&self, origin: DVec3, direction: DVec3, until: f64) -> Option<Obstacle>;

    /// A lower bound of the distance from a point to the nearest surface in metres, negative in a solid.
    fn distance(&self, point: DVec3) -> f64;

    /// The number, from 1, of the surface nearest to a point; 0 without surfaces.
    fn nearest(&self, point: DVec3) -> u32;

    /// The point of the scene that a point of this space stands for.
    fn in_scene(&self, point: DVec3) -> DVec3 {
        point
    }

    /// The surface from `a` on the way to `b`, if one is in the way.
    fn between(&self, a: DVec3, b: DVec3) -> Option<Obstacle> {
        let (direction, length) = (b - a).normalize_and_length();
        self.first(a, direction, length)
    }

    /// Whether no surface lies between two points.
    fn is_free(&self, a: DVec3, b: DVec3) -> bool {
        self.between(a, b).is_none()
    }

    /// Whether a point sees both ends.
    fn is_seen_from(&self, [a, b]: [DVec3; 2], point: DVec3) -> bool {
        self.is_free(a, point) && self.is_free(b, point)
    }
}

impl Space for ExactScene {
    fn first(&self, origin: DVec3, direction: DVec3, until: f64) -> Option<Obstacle> {
        let (metres, surface) = self.first_on_line(origin, direction, until)?;
        Some(Obstacle { metres, surface })
    }

    fn is_free(&self, a: DVec3, b: DVec3) -> bool {
        self.is_in_sight(a, b)
    }

    fn distance(&self, point: DVec3) -> f64 {
        self.surface_distance(point)
    }

    fn nearest(&self, point: DVec3) -> u32 {
        ExactScene::nearest(self, point)
    }
}
