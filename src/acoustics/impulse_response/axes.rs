//! A listener's own axes.

use crate::acoustics::AcousticsError;
use crate::scene::Listener;
use glam::DVec3;

/// Shorter vectors, and a forward and an up that are nearer to one line (sine of the angle), say
/// nothing about a direction: beyond it lies the rounding of `f32`, from which they come.
const LEAST_LENGTH: f64 = 1e-6;

/// A listener's axes in the world: unit vectors, at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListenerAxes {
    forward: DVec3,
    right: DVec3,
    up: DVec3,
}

impl ListenerAxes {
    /// The axes of a listener that looks along `forward`, with `up` above it (world axes, any
    /// length): `up` is turned to a right angle with `forward`.
    ///
    /// # Errors
    /// [`AcousticsError::BadAxes`] if one of them has no length or is not finite, or both are on
    /// one line.
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
    /// [`AcousticsError::BadAxes`] for one that is not finite.
    pub fn of(listener: &Listener) -> Result<ListenerAxes, AcousticsError> {
        ListenerAxes::new(listener.forward().as_dvec3(), listener.up().as_dvec3())
    }

    /// Where the listener looks.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Where the right ear points.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// What is above the listener.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// A vector of the world in listener axes, those of AmbiX and SOFA: x ahead, y to the left, z up.
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

    /// Protects left from right, and an up that is not at a right angle.
    #[test]
    fn axes_are_right_handed() {
        let axes = ListenerAxes::new(DVec3::NEG_Z * 3.0, DVec3::new(0.0, 2.0, -5.0));
        let axes = axes.expect("good axes");
        assert!(axes.right().distance(DVec3::X) < 1e-15);
        assert!(axes.up().distance(DVec3::Y) < 1e-15);
        let seen = axes.to_listener(DVec3::new(1.0, 2.0, 3.0));
        assert!(seen.distance(DVec3::new(-3.0, -1.0, 2.0)) < 1e-15);
    }

    /// Protects the refusal of directions that span no axes.
    #[test]
    fn one_line_spans_no_axes() {
        assert!(ListenerAxes::new(DVec3::X, DVec3::X * -2.0).is_err());
        assert!(ListenerAxes::new(DVec3::ZERO, DVec3::Y).is_err());
        assert!(ListenerAxes::new(DVec3::X, DVec3::splat(f64::NAN)).is_err());
    }
}
