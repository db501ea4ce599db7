//! Errors of SOFA files.

use crate::acoustics::hrir::HrirError;
use crate::file_input::InputError;
use std::path::PathBuf;

/// The reason why head-related impulse responses cannot be read from a SOFA file.
#[derive(Debug, thiserror::Error)]
#[error("cannot use head-related impulse responses from {}: {problem}", path.display())]
pub struct SofaError {
    /// The requested file.
    pub path: PathBuf,
    /// The problem with it.
    #[source]
    pub problem: SofaProblem,
}

/// A problem with a SOFA file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SofaProblem {
    /// The file is missing, too large, or not permitted to be read.
    #[error("{source}")]
    Unreadable {
        /// The operating system's error, or the reason why the file is rejected.
        source: InputError,
    },
    /// The file is not HDF5, the format of SOFA files.
    #[error("it is not a SOFA file ({reason})")]
    NotHdf5 {
        /// The HDF5 reader's error.
        reason: String,
    },
    /// A part of the file cannot be read: it is truncated or inconsistent.
    #[error("{what} cannot be read ({reason}): get the file again")]
    Damaged {
        /// The variable or the part.
        what: String,
        /// The HDF5 reader's error.
        reason: String,
    },
    /// A variable is stored in a form of HDF5 that is not supported.
    #[error(
        "{what} is stored in a form of HDF5 that is not supported ({reason}): rewrite the file with h5repack"
    )]
    NotRead {
        /// The variable or the part.
        what: String,
        /// The unsupported form.
        reason: String,
    },
    /// An attribute of the file is not that of the convention SimpleFreeFieldHRIR with FIR filters.
    #[error("its {attribute} is {found}, but only {expected:?} is supported")]
    WrongConvention {
        /// The attribute's name.
        attribute: &'static str,
        /// Its value in the file, quoted, or that it is missing.
        found: String,
        /// The supported value.
        expected: &'static str,
    },
    /// A variable is missing.
    #[error("it has no variable {variable}")]
    Missing {
        /// The variable's name.
        variable: &'static str,
    },
    /// A variable has a wrong shape.
    #[error("{variable} has the shape {found}, not {expected}")]
    BadShape {
        /// The variable's name.
        variable: &'static str,
        /// Its dimensions.
        found: String,
        /// The expected dimensions.
        expected: &'static str,
    },
    /// A variable has invalid numbers or units.
    #[error("{variable} cannot be used: {reason}")]
    BadValue {
        /// The variable's name.
        variable: &'static str,
        /// The reason.
        reason: String,
    },
    /// The file can be read, but its measurements are not a valid set.
    #[error("{source}")]
    Set {
        /// The error of the measurements.
        source: HrirError,
    },
}
