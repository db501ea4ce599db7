//! The error type of all public functions. Each function returns [`Error`], or one of the types that [`Error`]
//! contains.

pub use crate::file_input::{InputError, MalformedText};
#[cfg(feature = "picture")]
pub use crate::file_output::OutputError;

#[cfg(feature = "audio")]
use crate::audio::AudioError;
#[cfg(feature = "live")]
use crate::audio::live::LiveError;
use crate::gl::GpuError;
use crate::hrtf::HrirError;
#[cfg(feature = "sofa")]
use crate::hrtf::SofaError;
use crate::response::ResponseError;
use crate::scene::SceneError;
#[cfg(all(feature = "simulator", not(target_arch = "wasm32")))]
use crate::simulator::SimulatorError;
use crate::tracer::TraceError;

/// Any error of the crate, with one variant for each module.
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
    #[cfg(feature = "audio")]
    #[error(transparent)]
    Audio(#[from] AudioError),
    /// Echograms or impulse responses that cannot be computed.
    #[error(transparent)]
    Acoustics(#[from] ResponseError),
    /// A call of a simulator that cannot be carried out.
    #[cfg(all(feature = "simulator", not(target_arch = "wasm32")))]
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
    /// An unknown name of a profile, or of a kind of start directions.
    #[error("{message}")]
    UnknownName {
        /// The given name.
        name: String,
        /// The message: the kind of name, the given name, and the known names.
        message: String,
    },
    /// Live sound that cannot be played or recorded.
    #[cfg(feature = "live")]
    #[error(transparent)]
    Live(#[from] LiveError),
    /// A SOFA file that cannot be read or written.
    #[cfg(feature = "sofa")]
    #[error(transparent)]
    Sofa(#[from] SofaError),
    /// A picture that cannot be drawn or saved.
    #[cfg(feature = "picture")]
    #[error(transparent)]
    Picture(#[from] crate::picture::PictureError),
}

impl Error {
    /// Adds the time on the scene's paths to a scene error. Returns other errors unchanged.
    #[cfg(feature = "audio")]
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
            #[cfg(feature = "audio")]
            Error::Audio(error) => error.is_bad_input(),
            Error::Acoustics(_) | Error::UnknownName { .. } => true,
            #[cfg(all(feature = "simulator", not(target_arch = "wasm32")))]
            Error::Simulator(error) => !matches!(error, SimulatorError::NoThread { .. }),
            #[cfg(feature = "live")]
            Error::Live(error) => error.is_bad_input(),
            #[cfg(feature = "sofa")]
            Error::Sofa(error) => error.is_bad_input(),
            #[cfg(feature = "picture")]
            Error::Picture(error) => error.is_bad_input(),
        }
    }
}

impl From<HrirError> for Error {
    fn from(error: HrirError) -> Error {
        ResponseError::from(error).into()
    }
}

#[cfg(feature = "picture")]
impl From<OutputError> for Error {
    fn from(error: OutputError) -> Error {
        crate::picture::PictureError::from(error).into()
    }
}

/// Protects callers that store errors or send them between threads.
const _: () = {
    const fn may_be_kept<T: std::error::Error + Send + Sync + 'static>() {}
    may_be_kept::<Error>();
    may_be_kept::<InputError>();
    may_be_kept::<MalformedText>();
    may_be_kept::<HrirError>();
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use crate::gl::Api;
    use crate::scene::HeightImage;
    use crate::tracer::{Directions, Profile};
    use glam::UVec2;

    /// Protects callers that use one error type: the errors of all modules convert into it, keep their messages and
    /// report whether the input is at fault.
    #[test]
    fn refusals_of_all_modules_convert_and_name_bad_input() {
        fn refused<T, E: Into<Error> + ToString>(result: Result<T, E>) {
            let error = result.err().expect("it is refused");
            let words = error.to_string();
            let error: Error = error.into();
            assert_eq!(error.to_string(), words);
            assert!(error.is_bad_input(), "{error}");
        }
        refused("vulkan".parse::<Api>());
        refused("fast".parse::<Profile>());
        refused("spiral".parse::<Directions>());
        refused(Scene::builtin("nowhere"));
        refused(HeightImage::new("h", UVec2::ONE, vec![0.5]));
        #[cfg(feature = "audio")]
        refused("hum".parse::<crate::audio::SoundSpec>());
        refused(crate::hrtf::HrirSet::new(48_000, Vec::new()));
        refused(crate::response::Echogram::new(-1.0, 1));
        #[cfg(feature = "live")]
        refused(Err::<(), _>(LiveError::NotRecording));
    }
}
