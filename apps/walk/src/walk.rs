//! Walking through a scene: a step never ends inside a wall, and a step against a wall slides along it.
//!
//! The code is independent of windows and keys: from a [`MoveInput`] and a time it computes a new pose.

use echomarch::scene::{Listener, Scene};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Minimum distance between a walker's eye and a surface, in metres.
pub const BODY: f32 = 0.35;

/// Walking speed, in metres per second.
const WALKING: f32 = 3.5;
/// Running speed, in metres per second.
const RUNNING: f32 = 9.0;
/// Turning speed with the arrow keys, in radians per second.
const TURNING: f32 = 1.6;
/// Maximum elevation of the gaze, in radians. A vertical gaze has no horizontal forward direction.
const STEEPEST: f32 = FRAC_PI_2 - 0.05;
/// Step of the finite differences that approximate the gradient, in metres.
const DIFFERENCE: f32 = 0.005;
/// Tolerance of the distance [`BODY`] and margin of a correction, in metres. The margin covers rounding errors, and
/// fields whose value changes more slowly than the true distance.
const MARGIN: f32 = 1e-3;
/// Maximum number of corrections of one step. A corner of three walls needs three.
const CORRECTIONS: usize = 6;
/// Maximum walking time in one frame, in seconds. The limit prevents a jump after a delayed frame.
const LONGEST: f32 = 0.1;

/// The requested movement. Each component is between −1 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MoveInput {
    /// Horizontal movement in the direction of the gaze.
    pub forward: f32,
    /// Movement to the right.
    pub right: f32,
    /// Movement upwards.
    pub up: f32,
    /// Rotation to the right.
    pub turn: f32,
    /// Rotation of the gaze upwards.
    pub tilt: f32,
    /// Whether to run.
    pub run: bool,
}

impl MoveInput {
    /// Replaces components that are not finite by 0.
    fn finite(&self) -> MoveInput {
        MoveInput {
            forward: or_zero(self.forward),
            right: or_zero(self.right),
            up: or_zero(self.up),
            turn: or_zero(self.turn),
            tilt: or_zero(self.tilt),
            run: self.run,
        }
    }

    /// Whether no movement is requested.
    pub fn is_rest(&self) -> bool {
        let MoveInput {
            forward,
            right,
            up,
            turn,
            tilt,
            ..
        } = *self;
        [forward, right, up, turn, tilt]
            .iter()
            .all(|&input| input == 0.0)
    }
}

/// Replaces a number that is not finite by 0. Otherwise it would remain in the pose permanently.
fn or_zero(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}

/// Position and gaze of the walker.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walker {
    /// Position of the eye, in world metres.
    pub position: Vec3,
    /// Rotation about the vertical axis in radians, positive to the right.
    pub yaw: f32,
    /// Elevation of the gaze in radians.
    pub pitch: f32,
}

impl Walker {
    /// Creates a walker with the listener's position and gaze.
    pub fn of(listener: &Listener) -> Walker {
        Walker {
            position: listener.position,
            yaw: listener.yaw,
            pitch: listener.pitch,
        }
    }

    /// Sets the listener's position and gaze to those of the walker.
    pub fn place(&self, listener: &mut Listener) {
        listener.position = self.position;
        listener.yaw = self.yaw;
        listener.pitch = self.pitch;
    }

    /// Rotates the gaze to the right and upwards, by angles in radians. A number that is not finite counts as 0.
    pub fn look(&mut self, right: f32, up: f32) {
        let (right, up) = (or_zero(right), or_zero(up));
        self.yaw = (self.yaw + right + PI).rem_euclid(TAU) - PI;
        self.pitch = (self.pitch + up).clamp(-STEEPEST, STEEPEST);
    }

    /// Applies the movement for `seconds`, within the air of `scene`. Numbers that are not finite count as 0.
    pub fn walk(&mut self, scene: &Scene, input: &MoveInput, seconds: f32) {
        let seconds = or_zero(seconds).clamp(0.0, LONGEST);
        let input = input.finite();
        self.look(
            input.turn * TURNING * seconds,
            input.tilt * TURNING * seconds,
        );
        let (sin, cos) = self.yaw.sin_cos();
        let ahead = Vec3::new(sin, 0.0, -cos);
        let right = Vec3::new(cos, 0.0, sin);
        let way = ahead * input.forward + right * input.right + Vec3::Y * input.up;
        let speed = if input.run { RUNNING } else { WALKING };
        self.step(scene, way.clamp_length_max(1.0) * speed * seconds);
    }

    /// Moves by the vector `way`, in metres, or as far as the surfaces allow.
    fn step(&mut self, scene: &Scene, way: Vec3) {
        // Each part is at most half of the distance `BODY`, so that no part crosses a wall.
        let parts = (way.length() / (0.5 * BODY)).ceil().max(1.0);
        for _ in 0..parts as usize {
            let wanted = self.position + way / parts;
            self.position = slide(scene, self.position, wanted);
        }
    }
}

/// Returns a point near `wanted` that keeps the minimum distance from all surfaces; `from` if there is none.
fn slide(scene: &Scene, from: Vec3, wanted: Vec3) -> Vec3 {
    let clearance = |point| scene.surface_distance(point).distance;
    // If the walker is already too close to a surface, the distance must not decrease at all. Otherwise many small
    // steps would add up and cross the wall.
    let least = clearance(from).min(BODY - MARGIN);
    let mut point = wanted;
    for _ in 0..=CORRECTIONS {
        let clear = clearance(point);
        if clear >= least {
            return point;
        }
        point += outwards(scene, point) * (least + MARGIN - clear);
    }
    from
}

/// The unit vector away from the nearest surface; zero if the scene has no surface.
fn outwards(scene: &Scene, point: Vec3) -> Vec3 {
    let along = |axis: Vec3| {
        let step = axis * DIFFERENCE;
        scene.surface_distance(point + step).distance
            - scene.surface_distance(point - step).distance
    };
    Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or_zero()
}

/// The position of an object that a listener carries. The object is in front of the listener, outside the listener's
/// sphere if the walls allow.
pub fn carried(scene: &Scene, listener: &Listener) -> Vec3 {
    let gaze = listener.forward();
    let reach = listener.radius + 0.8;
    let mut gone = 0.0;
    for _ in 0..32 {
        let clear = scene
            .surface_distance(listener.position + gone * gaze)
            .distance
            - 0.5 * BODY;
        if clear < 1e-3 || gone >= reach {
            break;
        }
        gone += clear;
    }
    listener.position + gone.clamp(0.0, reach) * gaze
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walked(input: MoveInput, yaw: f32, seconds: f32) -> Walker {
        let scene = Scene::builtin("corner").unwrap();
        let mut walker = Walker::of(&scene.listeners[0]);
        walker.yaw = yaw;
        for _ in 0..(seconds * 30.0) as usize {
            walker.walk(&scene, &input, 1.0 / 30.0);
        }
        walker
    }

    /// Protects the direction of the keys: forward follows the gaze, right is to the right of it.
    #[test]
    fn a_walker_goes_where_the_gaze_and_the_keys_say() {
        let ahead = MoveInput {
            forward: 1.0,
            ..MoveInput::default()
        };
        let back = walked(ahead, std::f32::consts::PI, 1.0);
        assert!((back.position - Vec3::new(10.0, 0.0, 11.5)).length() < 1e-3);
        let aside = MoveInput {
            right: -1.0,
            ..MoveInput::default()
        };
        let left = walked(aside, 0.0, 1.0);
        assert!((left.position - Vec3::new(6.5, 0.0, 8.0)).length() < 1e-3);
    }

    /// Protects walls. The block of the corner scene begins at z = 0, x = 0. Even after running against it for a long
    /// time, the eye stays outside. The eye slides along the wall if the walker meets the wall at an angle.
    #[test]
    fn walls_stop_a_walker_who_slides_along() {
        let at_the_wall = MoveInput {
            forward: 1.0,
            run: true,
            ..MoveInput::default()
        };
        let stopped = walked(at_the_wall, 0.0, 10.0);
        assert!((stopped.position.z - BODY).abs() < 0.01, "{stopped:?}");
        assert!((stopped.position.x - 10.0).abs() < 0.05, "{stopped:?}");
        let slid = walked(at_the_wall, -0.7, 1.5);
        assert!((slid.position.z - BODY).abs() < 0.01, "{slid:?}");
        assert!(slid.position.x < 5.0, "{slid:?}");
    }

    /// Protects every corner: no walk in any scene ends inside a solid.
    #[test]
    fn no_walk_ends_in_a_solid() {
        for name in echomarch::Scene::BUILTIN_NAMES {
            let scene = Scene::builtin(name).unwrap();
            // Users' fields have no distance on the CPU in this test.
            if scene.user_fields().next().is_some() {
                continue;
            }
            for heading in 0..12 {
                let mut walker = Walker::of(&scene.listeners[0]);
                walker.yaw = heading as f32 * 0.53;
                let input = MoveInput {
                    forward: 1.0,
                    up: if heading % 3 == 0 { -1.0 } else { 0.0 },
                    run: true,
                    ..MoveInput::default()
                };
                let start = scene.surface_distance(walker.position).distance;
                let least = start.min(BODY - MARGIN);
                for _ in 0..200 {
                    walker.walk(&scene, &input, 0.05);
                    let clear = scene.surface_distance(walker.position).distance;
                    assert!(clear >= least, "{name}, heading {heading}: {clear}");
                }
            }
        }
    }

    /// Protects walls of fields whose value changes more slowly than the true distance: a listener that walks against
    /// the wall for minutes does not cross it.
    #[test]
    fn leaning_against_a_field_brings_nobody_through() {
        let scene = Scene::builtin("cave").unwrap();
        for heading in 0..4 {
            let mut walker = Walker::of(&scene.listeners[0]);
            walker.yaw = heading as f32 * 1.6;
            let input = MoveInput {
                forward: 1.0,
                run: true,
                ..MoveInput::default()
            };
            let start = scene.surface_distance(walker.position).distance;
            for _ in 0..120 * 30 {
                walker.walk(&scene, &input, 1.0 / 30.0);
            }
            let clear = scene.surface_distance(walker.position).distance;
            assert!(
                clear >= start.min(BODY - MARGIN),
                "heading {heading}: {clear}"
            );
        }
    }

    /// Protects the view: the elevation stays within ±90°.
    #[test]
    fn the_gaze_stops_short_of_straight_up() {
        let mut walker = Walker::default();
        walker.look(0.0, 9.0);
        assert!(walker.pitch < FRAC_PI_2);
        walker.look(-0.5 - TAU, -99.0);
        assert!(walker.pitch > -FRAC_PI_2 && walker.yaw < 0.0);
    }

    /// Protects a carried source from being pushed into a wall.
    #[test]
    fn what_is_carried_stays_in_the_air() {
        let mut scene = Scene::builtin("corner").unwrap();
        assert!(
            (carried(&scene, &scene.listeners[0]) - scene.listeners[0].position).length()
                > scene.listeners[0].radius
        );
        scene.listeners[0].position.z = 0.5;
        assert!(
            scene
                .surface_distance(carried(&scene, &scene.listeners[0]))
                .distance
                > 0.0
        );
    }

    /// Protects a walk from inputs that are not finite: they do not move the walker.
    #[test]
    fn what_is_no_number_moves_nobody() {
        let scene = Scene::builtin("corner").unwrap();
        let start = Walker::of(&scene.listeners[0]);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let input = MoveInput {
                forward: bad,
                right: bad,
                up: bad,
                turn: bad,
                tilt: bad,
                run: true,
            };
            let mut walker = start;
            walker.walk(&scene, &input, 0.1);
            walker.look(bad, bad);
            let forward = MoveInput {
                forward: 1.0,
                ..MoveInput::default()
            };
            walker.walk(&scene, &forward, bad);
            assert_eq!(walker.position, start.position);
            assert!((walker.yaw - start.yaw).abs() < 1e-5 && walker.pitch == start.pitch);
        }
    }
}
