//! Motion of a surface's numbers: key frames in time, or a named value from the API.
//!
//! The numbers themselves are stored in the shape, plain and current. A separate [`Driver`] states
//! which of them it sets, and from what. A driven number is a uniform in the shader, so that
//! setting it compiles nothing.

/// The source of the values of one of a surface's numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// The number's name: `position.x`, `rotation.y`, `radius`, `0.by.z` …; see
    /// [`Surface::parameter_names`](super::Surface::parameter_names).
    pub parameter: String,
    /// The motion that sets it.
    pub motion: Motion,
}

/// The way a number changes. Lengths are in metres, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Key frames (seconds, value), times strictly increasing: linear between them, held
    /// before the first and after the last.
    Keys(Vec<(f64, f32)>),
    /// The value set by [`Scene::set_value`](super::Scene::set_value) for this name, in the unit of a scene file.
    Named(String),
}

impl Motion {
    /// The value at `seconds`; `None` for a named one.
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
