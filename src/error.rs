//! The one error type that everything public returns.

use crate::scene::SceneError;

/// What can go wrong, by the room it went wrong in.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene that cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl Error {
    /// Whether the input is to blame (the program then exits with 2, else with 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Error::Scene(_) => true,
        }
    }
}
