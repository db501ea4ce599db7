//! The sound along an exact path.

use crate::acoustics::Tap;
use crate::acoustics::early::SpecularPath;
use crate::bands::Bands;
use crate::scene::Listener;
use glam::{DVec3, Vec3};

/// A specular path from source to listener, and the sound along it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HeardPath {
    /// The path's geometry.
    pub path: SpecularPath,
    /// Seconds from the source's impulse to its arrival.
    pub delay_s: f64,
    /// Energy density at the listener by band, in 1/m² for a source of power 1, including the
    /// losses at the surfaces and in the air, and the source's level.
    pub energy: Bands,
    /// Direction of arrival, to the right of the listener's gaze, in radians from −π to π.
    pub azimuth: f64,
    /// Direction of arrival, above the plane of the listener's ears, in radians.
    pub elevation: f64,
}

impl HeardPath {
    /// Whether it is the direct sound.
    pub fn is_direct(&self) -> bool {
        self.path.surfaces.is_empty()
    }

    /// The path as a tap of an impulse response.
    pub fn tap(&self) -> Tap {
        Tap {
            seconds: self.delay_s,
            energy: self.energy,
            direction: self.path.arrival_direction,
        }
    }
}

/// Azimuth to the right of the gaze and elevation of a direction, in radians; 0 for the zero vector.
pub(super) fn comes_from(listener: &Listener, towards: DVec3) -> (f64, f64) {
    let along = |axis: Vec3| axis.as_dvec3().dot(towards);
    let (right, up, ahead) = (
        along(listener.right()),
        along(listener.up()),
        along(listener.forward()),
    );
    (right.atan2(ahead), up.atan2(right.hypot(ahead)))
}
