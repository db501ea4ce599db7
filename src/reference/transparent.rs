//! Traces waves for which the listener is transparent: they meet only surfaces.

use super::closed_form::{Face, Placed};
use super::exact::{ExactScene, Hit, Left, mirror};
use glam::DVec3;

/// The flight of a wave after its last hit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LastFlight {
    /// Start in world metres.
    pub origin: DVec3,
    /// Unit vector in world axes.
    pub direction: DVec3,
    /// Whether it is known to meet no further surface.
    pub is_free: bool,
    /// Number of surfaces, and boxes around them, that were evaluated before.
    pub asked: u64,
}

impl ExactScene {
    /// Rounding of this scene in metres: see [`super`].
    pub(crate) fn rounding(&self) -> f64 {
        self.error_bound
    }

    /// Follows one wave from `start` (world metres) along the unit vector `direction`, through
    /// the listener, for at most `reflections` reflections; `visit` gets every hit in order.
    ///
    /// The result is the flight after the last hit; `None` if the wave starts in a solid.
    pub(crate) fn follow(
        &self,
        start: DVec3,
        direction: DVec3,
        reflections: u32,
        mut visit: impl FnMut(&Hit),
    ) -> Option<LastFlight> {
        if self.is_in_solid(start, self.error_bound) {
            return None;
        }
        let mut flight = LastFlight {
            origin: start,
            direction,
            is_free: false,
            asked: 0,
        };
        let mut left = None;
        for _ in 0..reflections {
            let (next, asked) =
                self.next_surface(flight.origin, flight.direction, left, f64::INFINITY);
            flight.asked += asked;
            let Some((hit, now_left)) = next else {
                flight.is_free = true;
                break;
            };
            visit(&hit);
            flight.origin = hit.point;
            flight.direction = mirror(flight.direction, hit.normal);
            left = Some(now_left);
        }
        Some(flight)
    }

    /// The first surface nearer than `until` metres on the line from `origin` along the unit
    /// vector `direction`.
    ///
    /// For a line that starts on a surface, `leaving` is its number from 1, and the unit normal
    /// there.
    pub(crate) fn first_surface(
        &self,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<(u32, DVec3)>,
        until: f64,
    ) -> Option<Hit> {
        let left = leaving.and_then(|(surface, normal)| self.left(surface, normal));
        let (met, _) = self.next_surface(origin, direction, left, until);
        met.map(|(hit, _)| hit)
    }

    fn left(&self, surface: u32, normal: DVec3) -> Left {
        let index = (surface as usize).checked_sub(1)?;
        let placed = self.surfaces.get(index)?;
        Some((index, placed.is_room().then(|| wall(placed, normal))))
    }
}

/// The face of a room that has this unit normal into the air, in world axes.
fn wall(room: &Placed, normal: DVec3) -> Face {
    let normal = room.local(normal);
    let size = normal.abs();
    let axis = (1..3).fold(
        0,
        |most, axis| if size[axis] > size[most] { axis } else { most },
    );
    Face {
        axis,
        positive: normal[axis] < 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Room;
    use crate::{Listener, Scene, Source, Surface};
    use glam::Vec3;

    /// Protects waves that the listener does not stop: they meet walls in order, without end, and a
    /// wave that starts in a solid meets none.
    #[test]
    fn waves_fly_through_the_listener() {
        let room = Surface::new(Room {
            size: Vec3::splat(4.0),
        });
        let listener = Listener::at(Vec3::X, 0.5);
        let scene = Scene::new("test", vec![room], Source::at(Vec3::ZERO), listener);
        let exact = ExactScene::new(&scene).expect("a valid scene");
        let mut walls = Vec::new();
        let last = exact.follow(DVec3::ZERO, DVec3::X, 2, |hit| walls.push(hit.point.x));
        let last = last.expect("a start in the air");
        assert_eq!(walls, [2.0, -2.0]);
        assert_eq!(
            (last.origin.x, last.direction, last.is_free),
            (-2.0, DVec3::X, false)
        );
        let inside = exact.follow(DVec3::X * 3.0, DVec3::X, 2, |_| ());
        assert!(inside.is_none());
    }

    /// Protects obstacles: they are found up to the given distance and not beyond it, and the wall
    /// that is left is not one.
    #[test]
    fn the_first_surface_is_nearer_than_asked() {
        let room = Surface::new(Room {
            size: Vec3::splat(4.0),
        });
        let listener = Listener::at(Vec3::X, 0.5);
        let scene = Scene::new("test", vec![room], Source::at(Vec3::ZERO), listener);
        let exact = ExactScene::new(&scene).expect("a valid scene");
        let first = |leaving, until| {
            let hit = exact.first_surface(DVec3::X * 2.0, DVec3::NEG_X, leaving, until);
            hit.map(|hit| (hit.object, hit.t))
        };
        let wall = Some((1, DVec3::NEG_X));
        assert_eq!(first(wall, 3.9), None);
        assert_eq!(first(wall, 4.1), Some((1, 4.0)));
        // Along the wall that it starts on, only the next one is met.
        let along = exact.first_surface(DVec3::X * 2.0, DVec3::Y, wall, 9.0);
        assert_eq!(along.map(|hit| hit.t), Some(2.0));
    }
}
