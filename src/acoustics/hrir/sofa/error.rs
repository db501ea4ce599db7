//! What can be wrong with a SOFA file.

use crate::acoustics::hrir::HrirError;
use crate::file_input::InputError;
use std::path::PathBuf;

/// A SOFA file that no head-related impulse responses are read from.
#[derive(Debug, thiserror::Error)]
#[error("cannot use head-related impulse responses from {}: {problem}", path.display())]
pub struct SofaError {
    /// The requested file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: SofaProblem,
}

/// What is wrong with a SOFA file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SofaProblem {
    /// The file is missing, too large, or may not be read.
    #[error("{source}")]
    Unreadable {
        /// The operating system's error, or the reason why it is not read.
        source: InputError,
    },
    /// The file is not HDF5, in which SOFA files are written.
    #[error("it is no SOFA file ({reason})")]
    NotHdf5 {
        /// The HDF5 reader's error.
        reason: String,
    },
    /// A part of the file cannot be read: it breaks off, or contradicts itself.
    #[error("{what} cannot be read ({reason}): get the file again")]
    Damaged {
        /// The variable or the part.
        what: String,
        /// The HDF5 reader's error.
        reason: String,
    },
    /// A variable that is stored in a way of HDF5 that is not read here.
    #[error(
        "{what} is stored in a way of HDF5 that is not read here ({reason}): write the file anew with h5repack"
    )]
    NotRead {
        /// The variable or the part.
        what: String,
        /// Which way.
        reason: String,
    },
    /// An attribute of the file is not that of the convention SimpleFreeFieldHRIR with FIR filters.
    #[error("its {attribute} is {found}, where {expected:?} alone is read")]
    WrongConvention {
        /// The attribute's name.
        attribute: &'static str,
        /// What the file contains, quoted, or that it contains nothing.
        found: String,
        /// What it should contain.
        expected: &'static str,
    },
    /// A variable is missing.
    #[error("it has no variable {variable}")]
    Missing {
        /// The variable's name.
        variable: &'static str,
    },
    /// A variable of another shape.
    #[error("{variable} has the shape {found}, not {expected}")]
    BadShape {
        /// The variable's name.
        variable: &'static str,
        /// Its dimensions.
        found: String,
        /// What they should be.
        expected: &'static str,
    },
    /// A variable whose numbers or units make no sense.
    #[error("{variable} cannot be used: {reason}")]
    BadValue {
        /// The variable's name.
        variable: &'static str,
        /// What is wrong with it.
        reason: String,
    },
    /// All of it is read, but makes no set.
    #[error("{source}")]
    Set {
        /// What is wrong with the measurements.
        source: HrirError,
    },
}
