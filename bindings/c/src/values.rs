//! Numbers that pass the boundary.

use crate::call::Failure;
use echomarch::simulator::Pose;

/// Number of octave bands: 63, 125, 250, 500 Hz, 1, 2, 4 and 8 kHz.
pub const ECHOMARCH_BANDS: usize = 8;

/// The id that a failed call writes. No object has it. 0 is an id like any other.
pub const ECHOMARCH_NO_ID: u64 = u64::MAX;

/// A position and an orientation in the world: 28 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchomarchPose {
    /// World position in metres: x to the right, y up, z towards the viewer. Finite, within 1e9 m.
    pub position: [f32; 3],
    /// Quaternion (x, y, z, w) from the object's own axes to the world axes, of any length except 0. (0, 0, 0, 1)
    /// looks along -z with +y up.
    pub rotation: [f32; 4],
}

const _: () = assert!(size_of::<EchomarchPose>() == 28);
const _: () = assert!(ECHOMARCH_BANDS == echomarch::bands::BAND_COUNT);

impl From<EchomarchPose> for Pose {
    fn from(pose: EchomarchPose) -> Pose {
        Pose::at(pose.position).turned(pose.rotation)
    }
}

/// A value of the caller.
///
/// # Safety
/// `value` is null, or points to a value that is not changed during the call.
pub unsafe fn read<T: Copy>(value: *const T, what: &'static str) -> Result<T, Failure> {
    // SAFETY: it is null or valid. Its memory need not be aligned.
    (!value.is_null())
        .then(|| unsafe { value.read_unaligned() })
        .ok_or(Failure::Null(what))
}

/// Writes a result.
///
/// # Safety
/// `place` is null, or memory for a `T` that nothing else uses during the call.
pub unsafe fn write<T>(place: *mut T, value: T, what: &'static str) -> Result<(), Failure> {
    if place.is_null() {
        return Err(Failure::Null(what));
    }
    // SAFETY: it is not null, and the caller's memory for this type.
    unsafe { place.write_unaligned(value) };
    Ok(())
}
