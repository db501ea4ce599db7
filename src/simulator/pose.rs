//! Positions and orientations in the world.

use crate::scene::Source;
use glam::{DVec3, Quat, Vec3};

/// Maximum magnitude of a coordinate in metres, as in scenes.
const FARTHEST_M: f32 = 1e9;

/// Least length of a quaternion whose direction is known.
const LEAST_LENGTH: f32 = 1e-6;

/// A position and an orientation in the world.
///
/// The identity looks along −z with +y up, like a camera in a right-handed world with y up. A head or a source may also
/// roll.
///
/// ```
/// use echomarch::glam::{Quat, Vec3};
/// use echomarch::simulator::Pose;
///
/// let left = Pose::at([0.0, 1.7, 0.0]).turned(Quat::from_rotation_y(std::f32::consts::FRAC_PI_2));
/// assert!(left.forward().distance(Vec3::NEG_X) < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// World position in metres.
    pub position: Vec3,
    /// Rotation from the object's own axes to the world axes. Its length does not matter.
    pub rotation: Quat,
}

impl Default for Pose {
    /// Returns the origin, looking along −z.
    fn default() -> Pose {
        Pose::at(Vec3::ZERO)
    }
}

impl Pose {
    /// The pose at a position in metres, without a rotation.
    pub fn at(position: impl Into<[f32; 3]>) -> Pose {
        Pose {
            position: position.into().into(),
            rotation: Quat::IDENTITY,
        }
    }

    /// Returns the pose with a rotation, a quaternion (x, y, z, w) of any length except 0.
    #[must_use]
    pub fn turned(mut self, rotation: impl Into<[f32; 4]>) -> Pose {
        self.rotation = Quat::from_array(rotation.into());
        self
    }

    /// Unit vector of the viewing direction.
    pub fn forward(&self) -> Vec3 {
        self.rotation.normalize() * Vec3::NEG_Z
    }

    /// Unit vector upwards.
    pub fn up(&self) -> Vec3 {
        self.rotation.normalize() * Vec3::Y
    }

    /// Azimuth and elevation in radians of a direction of the world, as seen from this pose: the azimuth is positive to
    /// the right, from −π to π; the elevation is positive upwards.
    pub fn angles_of(&self, direction: Vec3) -> (f32, f32) {
        let own = self.rotation.normalize().inverse() * direction;
        (own.x.atan2(-own.z), own.y.atan2(own.x.hypot(own.z)))
    }

    /// The pose with a unit quaternion. `None` for a position that is not finite or beyond 10⁹ m, and for a quaternion
    /// that is 0 or not finite.
    pub(super) fn normalised(self) -> Option<Pose> {
        let length = self.rotation.length();
        let is_near = self.position.abs().max_element() <= FARTHEST_M;
        let is_turned = length.is_finite() && length > LEAST_LENGTH;
        (self.position.is_finite() && is_near && is_turned).then(|| Pose {
            rotation: self.rotation.normalize(),
            ..self
        })
    }

    /// Moves a source of a scene to this pose.
    pub(super) fn place(&self, source: &mut Source) {
        source.position = self.position;
        source.orient(self.rotation.as_dquat());
    }

    /// Distance in metres to another pose.
    pub(super) fn distance(&self, other: &Pose) -> f64 {
        let apart: DVec3 = self.position.as_dvec3() - other.position.as_dvec3();
        apart.length()
    }
}
