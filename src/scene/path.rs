//! Key-framed paths: the pose of something at a given time.
//!
//! Between two keys positions and angles change linearly; before the first key and after the last
//! one they are constant. Angles are taken as written, so a path may turn through more than a full
//! circle.

use glam::Vec3;

/// Keys in order of time; empty for something that stands still.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    keys: Vec<Key>,
}

/// A pose at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Seconds since the start.
    pub time: f64,
    /// World position in metres.
    pub position: Vec3,
    /// Radians, positive to the right; only a listener turns.
    pub yaw: f32,
    /// Radians, positive upwards; only a listener turns.
    pub pitch: f32,
}

impl Path {
    /// A path over `keys`, or `None` when their times are not finite or do not strictly increase.
    pub fn new(keys: Vec<Key>) -> Option<Path> {
        let increasing = keys.windows(2).all(|pair| pair[0].time < pair[1].time);
        let finite = keys.iter().all(|key| key.time.is_finite());
        (increasing && finite).then_some(Path { keys })
    }

    /// The keys in order of time.
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// Whether the path has no keys.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Time of the last key in seconds; 0 without keys.
    pub fn duration(&self) -> f64 {
        self.keys.last().map_or(0.0, |key| key.time.max(0.0))
    }

    /// The pose at `seconds`; `None` without keys.
    pub fn at(&self, seconds: f64) -> Option<Key> {
        let after = self.keys.partition_point(|key| key.time <= seconds);
        if after == 0 {
            return self.keys.first().copied();
        }
        let from = self.keys[after - 1];
        let Some(to) = self.keys.get(after) else {
            return Some(from);
        };
        let share = ((seconds - from.time) / (to.time - from.time)) as f32;
        Some(Key {
            time: seconds,
            position: from.position.lerp(to.position, share),
            yaw: from.yaw + (to.yaw - from.yaw) * share,
            pitch: from.pitch + (to.pitch - from.pitch) * share,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, x: f32, yaw: f32) -> Key {
        Key {
            time,
            position: Vec3::X * x,
            yaw,
            pitch: 0.0,
        }
    }

    /// Protects interpolation, and constant poses outside the keys.
    #[test]
    fn a_path_is_linear_between_keys_and_holds_outside() {
        let path = Path::new(vec![key(1.0, 0.0, 0.0), key(3.0, 4.0, 2.0)]).unwrap();
        assert_eq!(path.at(0.0).unwrap().position.x, 0.0);
        assert_eq!(path.at(2.5).unwrap().position.x, 3.0);
        assert_eq!(path.at(2.0).unwrap().yaw, 1.0);
        assert_eq!(path.at(99.0).unwrap().position.x, 4.0);
        assert_eq!(path.duration(), 3.0);
        assert_eq!(Path::default().at(1.0), None);
    }

    /// Protects the order of keys, which interpolation relies on.
    #[test]
    fn times_must_increase() {
        assert_eq!(
            Path::new(vec![key(1.0, 0.0, 0.0), key(1.0, 1.0, 0.0)]),
            None
        );
        for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(Path::new(vec![key(time, 0.0, 0.0)]), None);
        }
    }
}
