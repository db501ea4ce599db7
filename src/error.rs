//! The error type of all public functions.

pub use crate::file_input::{InputError, MalformedText};
#[cfg(feature = "picture")]
pub use crate::file_output::OutputError;

use crate::audio::AudioError;
use crate::gl::GpuError;
#[cfg(feature = "sofa")]
use crate::hrtf::SofaError;
use crate::response::ResponseError;
use crate::scene::SceneError;
use crate::tracer::TraceError;

/// An error, by the module that it comes from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene that cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Invalid settings for tracing.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// A renderer that is missing or fails.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A sound that cannot be read, or a WAV that cannot be written.
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// Echograms or impulse responses that cannot be computed.
    #[error(transparent)]
    Acoustics(#[from] ResponseError),
    /// A SOFA file whose head-related impulse responses cannot be read.
    #[cfg(feature = "sofa")]
    #[error(transparent)]
    Sofa(#[from] SofaError),
    /// A picture that cannot be drawn or saved.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] crate::picture::PictureError),
}

impl Error {
    /// The error of a scene, at a time on its paths.
    pub(crate) fn at(self, seconds: f64) -> Error {
        match self {
            Error::Scene(refused) => Error::Scene(refused.at(seconds)),
            other => other,
        }
    }

    /// Whether the input is at fault (the program then exits with 2, otherwise with 1).
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
