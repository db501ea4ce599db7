//! The one error type that everything public returns.

pub use crate::file_input::{InputError, MalformedText};
#[cfg(feature = "picture")]
pub use crate::file_output::OutputError;

use crate::acoustics::AcousticsError;
#[cfg(feature = "sofa")]
use crate::acoustics::hrir::SofaError;
use crate::audio::AudioError;
use crate::gpu::GpuError;
use crate::scene::SceneError;
use crate::trace::TraceError;

/// What can go wrong, by the room it went wrong in.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene that cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Settings that cannot be traced with.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// A renderer that is not there, or fails.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A sound that cannot be read, or a WAV that cannot be written.
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// Echograms or impulse responses that cannot be made.
    #[error(transparent)]
    Acoustics(#[from] AcousticsError),
    /// A SOFA file that no head-related impulse responses are read from.
    #[cfg(feature = "sofa")]
    #[error(transparent)]
    Sofa(#[from] SofaError),
    /// A picture that cannot be made or kept.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] crate::picture::PictureError),
}

impl Error {
    /// What is wrong with a scene at a time on its paths.
    pub(crate) fn at(self, seconds: f64) -> Error {
        match self {
            Error::Scene(refused) => Error::Scene(refused.at(seconds)),
            other => other,
        }
    }

    /// Whether the input is to blame (the program then exits with 2, else with 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Error::Scene(_) => true,
            Error::Trace(error) => !matches!(
                error,
                TraceError::NothingTraced
                    | TraceError::NoFrameBegun
                    | TraceError::NoFieldTrial { .. }
            ),
            Error::Gpu(error) => error.is_bad_input(),
            Error::Audio(error) => error.is_bad_input(),
            Error::Acoustics(_) => true,
            #[cfg(feature = "sofa")]
            Error::Sofa(_) => true,
            #[cfg(feature = "picture")]
            Error::Picture(error) => error.is_bad_input(),
        }
    }
}
