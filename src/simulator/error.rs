//! Errors of a simulator's calls.

use super::{Pose, SourceId, SurfaceId};
use crate::hrtf::HrirError;

/// The reason why a call of a [`Simulator`](super::Simulator) changes nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulatorError {
    /// The source was removed, or never added.
    #[error("there is no {0:?}: it was removed, or never added")]
    NoSource(SourceId),
    /// The surface was removed, or never added.
    #[error("there is no {0:?}: it was removed, or never added")]
    NoSurface(SurfaceId),
    /// A position or a rotation that is not possible.
    #[error(
        "the pose of a {of} must have a finite position within 1e9 m and a quaternion that is not 0, not {pose:?}"
    )]
    BadPose {
        /// The kind of object.
        of: &'static str,
        /// The refused pose.
        pose: Pose,
    },
    /// A number out of its range.
    #[error("{what} must be {must}, not {value}")]
    BadNumber {
        /// The number, with its unit.
        what: &'static str,
        /// The range.
        must: &'static str,
        /// The refused number.
        value: f64,
    },
    /// An output whose length does not fit the sound.
    #[error("the output for {samples} samples must have {} values ({channels} channels), not {length}", samples * channels)]
    BadLength {
        /// Number of samples of the sound.
        samples: usize,
        /// Number of channels.
        channels: usize,
        /// The refused length.
        length: usize,
    },
    /// Responses of a head that cannot be converted to the sampling rate.
    #[error(transparent)]
    Head(#[from] HrirError),
    /// A thread that cannot be started, or has ended.
    #[error("the simulator's thread does not run: {reason}")]
    NoThread {
        /// The system's reason.
        reason: String,
    },
}

impl SimulatorError {
    /// The pose of an object with a unit quaternion.
    ///
    /// # Errors
    /// [`SimulatorError::BadPose`] for a position that is not finite or beyond 10⁹ m, and for a quaternion that is 0 or
    /// not finite.
    pub(super) fn unless_possible(pose: Pose, of: &'static str) -> Result<Pose, SimulatorError> {
        pose.normalised()
            .ok_or(SimulatorError::BadPose { of, pose })
    }
}
