//! Errors of the library as Python exceptions with the same sentences.

use echomarch::Error;
use echomarch_lab::study::StudyError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The module that defines the exceptions of the package.
const MODULE: &str = "echomarch._errors";

/// Returns the exception with this name from the package and this message.
fn named(class: &str, message: String) -> PyErr {
    Python::attach(|py| {
        let class = py
            .import(MODULE)
            .and_then(|module| module.getattr(class))
            .and_then(|class| class.call1((&message,)));
        match class {
            Ok(exception) => PyErr::from_value(exception),
            // The package is damaged, or the extension module was loaded without the package.
            Err(_) => PyRuntimeError::new_err(message),
        }
    })
}

/// The exception of a library error.
pub fn of(error: &Error) -> PyErr {
    let class = match error {
        Error::Scene(_) => "SceneError",
        Error::Gpu(_) => "RendererError",
        Error::Sofa(_) => "SofaError",
        error if error.is_bad_input() => "SettingsError",
        _ => "EchomarchError",
    };
    named(class, error.to_string())
}

/// The exception of a library error of any module.
pub fn from(error: impl Into<Error>) -> PyErr {
    of(&error.into())
}

/// The exception for a scene that the binding itself refuses.
pub fn scene(message: String) -> PyErr {
    named("SceneError", message)
}

/// The exception of an error of a study.
pub fn of_study(error: &StudyError) -> PyErr {
    named("StudyError", error.to_string())
}

/// The exception for settings that the binding itself refuses.
pub fn settings(message: String) -> PyErr {
    named("SettingsError", message)
}

/// The exception for the use of OpenGL in a forked process.
pub fn forked(message: String) -> PyErr {
    named("ForkError", message)
}

/// The exception for a fault of this package.
pub fn internal(message: String) -> PyErr {
    named("EchomarchError", message)
}
