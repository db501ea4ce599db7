//! Turns of the head against the listener, from any thread.

use super::{Pose, SimulatorError};
use glam::Quat;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Greatest magnitude of a component in 16 bits. A rotation is exact to 0.005°.
const UNIT: f32 = 32_767.0;

/// Turns the head of the listener, for example by the sensor of headphones or by a mouse. Made by
/// [`Simulator::head_tracker`](super::Simulator::head_tracker).
///
/// All copies turn the same head, and may be used on any thread. [`turn`](Self::turn) neither waits, allocates nor frees.
#[derive(Clone, Debug)]
pub struct HeadTracker {
    /// The components x, y, z and w of a unit quaternion, 16 bits each, so that no thread reads a half of a rotation.
    rotation: Arc<AtomicU64>,
}

impl HeadTracker {
    pub(super) fn new() -> HeadTracker {
        HeadTracker {
            rotation: Arc::new(AtomicU64::new(packed(Quat::IDENTITY))),
        }
    }

    /// Turns the head against the listener: `rotation` is a quaternion (x, y, z, w) of any length except 0, from the
    /// axes of the head to those of the listener. It is heard in the next block of each
    /// [`Mix`](super::Mix) and [`Ears`](super::Ears), and needs no commit. The direction of the late part does not
    /// change.
    ///
    /// # Errors
    /// [`SimulatorError::BadPose`] for a quaternion that is 0 or not finite; then the head stays.
    pub fn turn(&self, rotation: impl Into<[f32; 4]>) -> Result<(), SimulatorError> {
        let pose = Pose::default().turned(rotation);
        let rotation = SimulatorError::unless_possible(pose, "head")?.rotation;
        self.rotation.store(packed(rotation), Ordering::Relaxed);
        Ok(())
    }

    /// The rotation, a unit quaternion.
    pub(super) fn rotation(&self) -> Quat {
        unpacked(self.rotation.load(Ordering::Relaxed))
    }
}

fn packed(rotation: Quat) -> u64 {
    let components = rotation
        .to_array()
        .map(|component| (component * UNIT).round() as i16);
    let bits = components.map(|component| u64::from(component as u16));
    bits.into_iter().fold(0, |all, bits| all << 16 | bits)
}

fn unpacked(bits: u64) -> Quat {
    let component = |place: u32| f32::from((bits >> (16 * place)) as u16 as i16) / UNIT;
    Quat::from_array([3, 2, 1, 0].map(component)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the direction of the head: a rotation of any length is exact to 0.005°, and an impossible one changes
    /// nothing.
    #[test]
    fn rotations_are_kept() {
        let tracker = HeadTracker::new();
        assert_eq!(tracker.rotation(), Quat::IDENTITY);
        for step in 0..500 {
            let turn = step as f32 * 0.37;
            let exact = Quat::from_euler(glam::EulerRot::YXZ, turn, 1.3 * turn, 0.7 * turn);
            tracker.turn((exact * 3.0).to_array()).unwrap();
            for axis in [glam::Vec3::X, glam::Vec3::Y, glam::Vec3::Z] {
                let off = (tracker.rotation() * axis).distance(exact * axis);
                assert!(off < 0.005_f32.to_radians() + 1e-6, "{off}");
            }
        }
        let before = tracker.rotation();
        assert!(tracker.turn([0.0; 4]).is_err());
        assert!(tracker.turn([f32::NAN, 0.0, 0.0, 1.0]).is_err());
        assert_eq!(tracker.clone().rotation(), before);
    }
}
