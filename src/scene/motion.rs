//! Motion: key-framed paths, and the drivers of a surface's numbers, which are key frames or named values set through
//! the API.
//!
//! The shape stores the current value of each number. A separate [`Driver`] states the number that it sets and the
//! motion of this number. A driven number is a uniform of the shader, so setting it compiles no shader.

use glam::Vec3;

/// Drives one of a surface's numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// The number's name: `position.x`, `rotation.y`, `radius`, `0.by.z` …; see
    /// [`Surface::parameter_names`](super::Surface::parameter_names).
    pub parameter: String,
    /// The motion that sets it.
    pub motion: Motion,
}

/// The motion of a number. Lengths are in metres, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Key frames (seconds, value) with strictly increasing times. The value is interpolated linearly between keys, and
    /// constant before the first and after the last key.
    Keys(Vec<(f64, f32)>),
    /// The value set by [`Scene::set_value`](super::Scene::set_value) under this name, in the unit of a scene file.
    Named(String),
}

impl Motion {
    /// The value at `seconds`; `None` for a named value.
    pub fn at(&self, seconds: f64) -> Option<f32> {
        let Motion::Keys(keys) = self else {
            return None;
        };
        let after = keys.partition_point(|(time, _)| *time <= seconds);
        let Some(from) = after.checked_sub(1).map(|index| keys[index]) else {
            return keys.first().map(|(_, value)| *value);
        };
        let Some(to) = keys.get(after) else {
            return Some(from.1);
        };
        let share = (seconds - from.0) / (to.0 - from.0);
        Some(from.1 + (to.1 - from.1) * share as f32)
    }

    /// Time of the last key in seconds; 0 for a named value.
    pub fn duration(&self) -> f64 {
        match self {
            Motion::Keys(keys) => keys.last().map_or(0.0, |(time, _)| time.max(0.0)),
            Motion::Named(_) => 0.0,
        }
    }
}

/// The quantity of a surface's number. It determines the number's unit in a scene file and its valid range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate or a difference of coordinates, in metres.
    Position,
    /// A length in metres, greater than 0.
    Length,
    /// A factor, greater than 0.
    Factor,
    /// An angle, in degrees.
    Angle,
    /// A turn per length, in degrees per metre.
    Rate,
    /// A share, 0 to 1.
    Share,
    /// A number without a unit or a range.
    Plain,
}

impl Quantity {
    /// The unit of a number in the code, as text that follows the number in a message.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Quantity::Position | Quantity::Length => " metres",
            Quantity::Angle => " radians",
            Quantity::Rate => " radians a metre",
            Quantity::Factor | Quantity::Share | Quantity::Plain => "",
        }
    }

    /// Converts a number from the unit of the code to the unit of the scene file.
    pub fn in_file(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_degrees(),
            _ => value,
        }
    }

    /// Converts a number from the unit of the scene file to the unit of the code.
    pub fn in_code(self, value: f32) -> f32 {
        match self {
            Quantity::Angle | Quantity::Rate => value.to_radians(),
            _ => value,
        }
    }

    /// The rank of the quantity: a higher rank has a narrower valid range.
    pub(super) fn rank(self) -> u8 {
        match self {
            Quantity::Plain => 0,
            Quantity::Position => 1,
            Quantity::Angle | Quantity::Rate => 2,
            Quantity::Length | Quantity::Factor => 3,
            Quantity::Share => 4,
        }
    }
}

/// A key-framed path: keys in order of time. The path of an object without motion is empty.
///
/// Positions and angles are interpolated linearly between two keys. They are constant before the first and after the
/// last key. Angles are not reduced to a full circle, so a path may turn by more than 360°.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    keys: Vec<Key>,
}

/// A pose at a given time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Seconds since the start.
    pub time: f64,
    /// World position in metres.
    pub position: Vec3,
    /// Yaw in radians, positive to the right.
    pub yaw: f32,
    /// Pitch in radians, positive upwards.
    pub pitch: f32,
}

impl Key {
    /// A position at a given time in seconds, with a direction along −z.
    pub fn at(time: f64, position: impl Into<[f32; 3]>) -> Key {
        Key {
            time,
            position: position.into().into(),
            yaw: 0.0,
            pitch: 0.0,
        }
    }
}

impl Path {
    /// Creates a path over `keys`; `None` if their times are not finite or do not strictly increase.
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

    /// Protects the interpolation between keys, and the constant pose outside them.
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

    /// Protects the strict order of keys, which the interpolation requires.
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
