//! Image sources in an empty rectangular room (Allen & Berkley 1979).
//!
//! Cost per wave: one step for each copy that the line crosses, which is order + 1 steps in total.

use crate::scene::shape::Room;
use crate::scene::{IntoPair, Node, Pair};
use crate::tracer::{Settings, TraceError};
use glam::{DQuat, DVec3, Vec3};

/// A source, a listener, and the surrounding room, in the room's own axes.
#[derive(Clone, Copy, Debug)]
pub struct ShoeboxImages {
    half: [f64; 3],
    source: [f64; 3],
    listener: [f64; 3],
    radius: f64,
    /// Rotation from world axes to room axes.
    into_room: DQuat,
}

/// The arrival of a wave at the listener.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Number of reflections before the arrival.
    pub order: u32,
    /// Length of the path from the source to the listener's sphere, in metres.
    pub length: f64,
}

impl ShoeboxImages {
    /// The images of a pair, or of a scene with exactly one source and one listener, in its current state. `None`
    /// unless the scene is valid, its only surface is a [`Node::Room`], and the source is inside the room.
    pub fn new<'a>(pair: impl IntoPair<'a>) -> Option<ShoeboxImages> {
        ShoeboxImages::of_pair(pair.chosen().ok()?)
    }

    fn of_pair(pair: Pair) -> Option<ShoeboxImages> {
        let Pair {
            scene,
            source,
            listener,
            ..
        } = pair;
        scene.validate().ok()?;
        let [surface] = &scene.surfaces[..] else {
            return None;
        };
        let Node::Room(Room { size }) = surface.shape.node else {
            return None;
        };
        let turn = surface.rotation;
        let turn = DQuat::from_xyzw(turn.x.into(), turn.y.into(), turn.z.into(), turn.w.into());
        let into_room = turn.normalize().conjugate();
        let seen = |world: Vec3| {
            let offset = world.as_dvec3() - surface.position.as_dvec3();
            (into_room * offset).to_array()
        };
        let half = size.to_array().map(|size| f64::from(size) / 2.0);
        let source = seen(source.position);
        let inside = (0..3).all(|axis| source[axis].abs() <= half[axis]);
        inside.then(|| ShoeboxImages {
            half,
            source,
            listener: seen(listener.position),
            radius: listener.radius.into(),
            into_room,
        })
    }

    /// The arrival at the listener of the wave that leaves the source along `direction` (world axes, any length),
    /// within `iterations` flights; `None` if the wave is not heard.
    pub(in crate::geometry) fn arrival(
        &self,
        direction: DVec3,
        iterations: u32,
    ) -> Option<Arrival> {
        let u = (self.into_room * direction.try_normalize()?).to_array();
        // Number of walls crossed along each axis, and in total.
        let mut crossed = [0u32; 3];
        let mut entered = 0.0;
        for order in 0..iterations {
            let ahead: [f64; 3] = std::array::from_fn(|axis| self.wall(axis, u, crossed[axis]));
            let axis = (0..3).fold(0, |best, axis| {
                if ahead[axis] < ahead[best] {
                    axis
                } else {
                    best
                }
            });
            if let Some(length) = self.heard_in_copy(u, crossed, entered, ahead[axis]) {
                return Some(Arrival { order, length });
            }
            entered = ahead[axis];
            crossed[axis] += 1;
        }
        None
    }

    /// The numbers of waves that are heard after 0, 1, 2 … reflections, up to `iterations` − 1, for these directions
    /// (world axes).
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] if `iterations` is not in 1 to [`Settings::MAX_ITERATIONS`].
    pub fn hits_by_order(
        &self,
        directions: &[Vec3],
        iterations: u32,
    ) -> Result<Vec<u64>, TraceError> {
        if !(1..=Settings::MAX_ITERATIONS).contains(&iterations) {
            return Err(TraceError::BadSetting {
                what: "iterations",
                must: format!("1 to {}", Settings::MAX_ITERATIONS),
                value: iterations.to_string(),
            });
        }
        let mut hits = vec![0; iterations as usize];
        for direction in directions {
            if let Some(arrival) = self.arrival(direction.as_dvec3(), iterations) {
                hits[arrival.order as usize] += 1;
            }
        }
        Ok(hits)
    }

    /// Distance in metres from the source to the next unfolded wall perpendicular to `axis`, if `crossed` walls have
    /// been crossed along this axis.
    fn wall(&self, axis: usize, u: [f64; 3], crossed: u32) -> f64 {
        if u[axis] == 0.0 {
            return f64::INFINITY;
        }
        let wall = (2.0 * f64::from(crossed) + 1.0) * self.half[axis];
        (wall - self.source[axis] * u[axis].signum()) / u[axis].abs()
    }

    /// Distance in metres to the listener's image in the copy of the room that the line enters at distance `entered`
    /// and leaves at distance `left`; `None` if the line misses the image.
    fn heard_in_copy(
        &self,
        u: [f64; 3],
        crossed: [u32; 3],
        entered: f64,
        left: f64,
    ) -> Option<f64> {
        let offset: [f64; 3] =
            std::array::from_fn(|axis| self.image(axis, u, crossed[axis]) - self.source[axis]);
        let closest_at: f64 = (0..3).map(|axis| offset[axis] * u[axis]).sum();
        // Not computed as |offset|² − closest_at², because this difference suffers from cancellation at long distances.
        let miss_squared: f64 = (0..3)
            .map(|axis| (offset[axis] - closest_at * u[axis]).powi(2))
            .sum();
        let half_chord_squared = self.radius * self.radius - miss_squared;
        if half_chord_squared < 0.0 {
            return None;
        }
        let half_chord = half_chord_squared.sqrt();
        let begins = f64::max(closest_at - half_chord, entered);
        let ends = f64::min(closest_at + half_chord, left);
        (begins <= ends).then_some(begins)
    }

    /// The coordinate along `axis` of the listener's image in the copy that is `crossed` walls away.
    fn image(&self, axis: usize, u: [f64; 3], crossed: u32) -> f64 {
        let shift = 2.0 * self.half[axis] * f64::from(crossed) * u[axis].signum();
        let mirrored = crossed % 2 == 1;
        shift
            + if mirrored {
                -self.listener[axis]
            } else {
                self.listener[axis]
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Plane;
    use crate::scene::{Listener, Scene, Source, Surface};

    fn scene(listener: Vec3) -> Scene {
        Scene::new(
            "test",
            vec![Surface::new(Node::Room(Room {
                size: Vec3::new(10.0, 6.0, 8.0),
            }))],
            Source::at(Vec3::X),
            Listener::at(listener, 0.5),
        )
    }

    /// Protects lengths and orders along one axis, where they can be computed by hand.
    #[test]
    fn a_wave_straight_at_a_wall_comes_back() {
        let images = ShoeboxImages::new(&scene(Vec3::X * -2.0)).expect("a shoebox");
        let direct = images.arrival(DVec3::NEG_X, 4).expect("heard");
        assert_eq!((direct.order, direct.length), (0, 2.5));
        let once = images.arrival(DVec3::X, 4).expect("heard");
        assert_eq!((once.order, once.length), (1, 4.0 + 7.0 - 0.5));
        assert_eq!(images.arrival(DVec3::X, 1), None);
        assert_eq!(images.arrival(DVec3::Y, 9), None);
    }

    /// Protects the rule for a listener that is partly inside a wall: the part inside the wall does not hear.
    #[test]
    fn only_the_part_in_the_room_hears() {
        let images = ShoeboxImages::new(&scene(Vec3::new(5.3, 0.0, 0.0))).expect("a shoebox");
        let inside = images.arrival(DVec3::X, 1).expect("heard");
        assert!((inside.length - 3.8).abs() < 1e-6);
        // The line points to the rim of the sphere at x = 5.3, but hits the wall at x = 5 first.
        let rim = DVec3::new(4.3, 0.45, 0.0);
        assert_eq!(images.arrival(rim, 8), None);
    }

    /// Protects the rejection of scenes that are not a shoebox.
    #[test]
    fn other_scenes_have_no_images() {
        let mut other = scene(Vec3::ZERO);
        other.sources[0].position.x = 5.5;
        assert!(ShoeboxImages::new(&other).is_none());
        other.sources[0].position.x = 1.0;
        other.surfaces.push(Surface::new(Node::Plane(Plane)));
        assert!(ShoeboxImages::new(&other).is_none());
        other.surfaces.remove(0);
        assert!(ShoeboxImages::new(&other).is_none());
    }
}
