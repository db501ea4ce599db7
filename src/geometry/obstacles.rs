//! The first surface on a line of sight. Unlike a flight of a wave, a line of sight needs no normal, and past a field it
//! does not march to the limit of precision (`sight.rs`).

use super::exact::ExactScene;
use glam::DVec3;

impl ExactScene {
    /// The first surface nearer than `until` metres on the line from `origin` along a unit vector: its distance in metres,
    /// and its number, from 1.
    pub(crate) fn first_on_line(
        &self,
        origin: DVec3,
        direction: DVec3,
        until: f64,
    ) -> Option<(f64, u32)> {
        let mut met = None;
        let mut nearest = until;
        for hierarchy in &self.hierarchies {
            hierarchy.along(origin, direction, nearest, |index, until| {
                let found = self.surfaces[index].enters(origin, direction, self.error_bound, until);
                // At equal distances, the first surface in the scene is hit.
                let is_before =
                    |t: f64| met.is_some_and(|(other, surface)| t == other && index < surface);
                if let Some(t) = found.filter(|t| *t < until || is_before(*t)) {
                    met = Some((t, index));
                    nearest = t;
                }
                nearest
            });
        }
        met.map(|(t, index)| (t, index as u32 + 1))
    }

    /// Whether no surface lies between two points.
    pub(crate) fn is_in_sight(&self, a: DVec3, b: DVec3) -> bool {
        let (direction, length) = (b - a).normalize_and_length();
        let mut is_free = true;
        for hierarchy in &self.hierarchies {
            hierarchy.along(a, direction, length, |index, until| {
                let surface = &self.surfaces[index];
                let meets = |until: f64| surface.enters(a, direction, self.error_bound, until);
                is_free = is_free && meets(length).is_none_or(|t| t >= length);
                match is_free {
                    true => until,
                    false => f64::NEG_INFINITY,
                }
            });
        }
        is_free
    }
}
