//! A listener's own axes.

use crate::acoustics::AcousticsError;
use crate::scene::Listener;
use glam::DVec3;

/// Least length of a vector, and least sine of the angle between forward and up: below it the
/// direction is lost in the rounding of `f32`, in which the vectors are given.
const LEAST_LENGTH: f64 = 1e-6;

/// A listener's axes in the world: orthogonal unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListenerAxes {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

impl ListenerAxes {
    /// The axes of a listener that looks along `forward`, with `up` upwards (world axes, any
    /// length): `up` is made perpendicular to `forward`.
    ///
    /// # Errors
    /// [`AcousticsError::BadAxes`] if one of them has no length or is not finite, or both are
    /// parallel.
    pub fn new(forward: DVec3, up: DVec3) -> Result<ListenerAxes, AcousticsError> {
        let bad = AcousticsError::BadAxes { forward, up };
        let unit = |vector: DVec3| {
            let told = vector.is_finite() && vector.length() > LEAST_LENGTH;
            told.then(|| vector.normalize())
        };
        let (Some(ahead), Some(above)) = (unit(forward), unit(up)) else {
            return Err(bad);
        };
        let Some(right) = unit(ahead.cross(above)) else {
            return Err(bad);
        };
        Ok(ListenerAxes {
            forward: ahead,
            right,
            up: right.cross(ahead),
        })
    }

    /// The axes of a scene's listener.
    ///
    /// # Errors
    /// [`AcousticsError::BadAxes`] if they are not finite.
    pub fn of(listener: &Listener) -> Result<ListenerAxes, AcousticsError> {
        ListenerAxes::new(listener.forward().as_dvec3(), listener.up().as_dvec3())
    }

    /// The viewing direction.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The direction of the right ear.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The upward direction.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Converts a world vector to listener axes, those of AmbiX and SOFA: x ahead, y to the left, z
    /// up.
    pub fn to_listener(&self, world: DVec3) -> DVec3 {
        DVec3::new(
            world.dot(self.forward),
            -world.dot(self.right),
            world.dot(self.up),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects left and right, and an up that is not perpendicular.
    #[test]
    fn axes_are_right_handed() {
        let axes = ListenerAxes::new(DVec3::NEG_Z * 3.0, DVec3::new(0.0, 2.0, -5.0));
        let axes = axes.expect("good axes");
        assert!(axes.right().distance(DVec3::X) < 1e-15);
        assert!(axes.up().distance(DVec3::Y) < 1e-15);
        let seen = axes.to_listener(DVec3::new(1.0, 2.0, 3.0));
        assert!(seen.distance(DVec3::new(-3.0, -1.0, 2.0)) < 1e-15);
    }

    /// Protects the refusal of directions that do not define axes.
    #[test]
    fn one_line_spans_no_axes() {
        assert!(ListenerAxes::new(DVec3::X, DVec3::X * -2.0).is_err());
        assert!(ListenerAxes::new(DVec3::ZERO, DVec3::Y).is_err());
        assert!(ListenerAxes::new(DVec3::X, DVec3::splat(f64::NAN)).is_err());
    }
}
