//! Variables and attributes of an HDF5 file, whose sizes are checked before they are read, and the errors of SOFA
//! files.

use super::{bad_shape, bad_value};
use crate::file_input::InputError;
use crate::file_output::is_bad_place;
use crate::hrtf::{BalloonError, HrirError, HrirSet};
use hdf5_pure::{Dataset, Error, File, FormatError};
use std::path::PathBuf;

/// The reason why a SOFA file cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("cannot use the SOFA file {}: {problem}", path.display())]
#[non_exhaustive]
pub struct SofaError {
    /// The requested file.
    pub path: PathBuf,
    /// The problem with it.
    #[source]
    pub problem: SofaProblem,
}

impl SofaError {
    /// Whether the file or the path is at fault rather than the disk.
    pub(crate) fn is_bad_input(&self) -> bool {
        match &self.problem {
            SofaProblem::NotWritten { reason } => is_bad_place(reason),
            _ => true,
        }
    }
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
    /// A part of the file cannot be read, because it is truncated or inconsistent.
    #[error("{what} cannot be read ({reason}): download or copy the file again")]
    Damaged {
        /// The variable or the part of the file.
        what: String,
        /// The HDF5 reader's error.
        reason: String,
    },
    /// A variable is stored in a form of HDF5 that is not supported.
    #[error(
        "{what} is stored in a form of HDF5 that is not supported ({reason}): rewrite the file with h5repack"
    )]
    NotRead {
        /// The variable or the part of the file.
        what: String,
        /// The unsupported form.
        reason: String,
    },
    /// An attribute of the file does not have a value of a supported convention.
    #[error("its {attribute} is {found}, but only {expected:?} is supported")]
    WrongConvention {
        /// The attribute's name.
        attribute: &'static str,
        /// The attribute's value in the file, quoted, or a statement that the attribute is missing.
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
        /// The dimensions of the variable.
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
    /// The file can be read, but its measurements are not a directivity.
    #[error("{source}")]
    Balloon {
        /// The error of the measurements.
        source: BalloonError,
    },
    /// Impulse responses that do not fit into one file.
    #[error("{what}")]
    NotOneSet {
        /// The reason.
        what: &'static str,
    },
    /// Too many samples for one file.
    #[error(
        "its responses have {samples} samples, but at most {limit} fit: write fewer pairs, fewer channels or a shorter response"
    )]
    TooManySamples {
        /// Number of samples of all responses.
        samples: usize,
        /// Maximum number of samples.
        limit: usize,
    },
    /// The file cannot be written.
    #[error("it cannot be written: {reason}")]
    NotWritten {
        /// The error of the operating system or of the encoder.
        reason: std::io::Error,
    },
}

/// Maximum number of characters shown from a file's text or from the reader's message.
const SHOWN: usize = 120;

/// Maximum size of a number in bytes: the size of `f64`. Wider values cannot be read as numbers.
const WIDEST: u64 = 8;

/// An open file.
pub(super) struct Variables(File);

impl Variables {
    pub(super) fn open(bytes: Vec<u8>) -> Result<Variables, SofaProblem> {
        let file = File::from_bytes(bytes);
        file.map(Variables)
            .map_err(|error| match way_not_read(&error) {
                Some(reason) => SofaProblem::NotRead {
                    what: "the file".into(),
                    reason,
                },
                None => SofaProblem::NotHdf5 {
                    reason: short(&error.to_string()),
                },
            })
    }

    /// Rejects a file unless this attribute has the expected value.
    pub(super) fn expect_global(
        &self,
        attribute: &'static str,
        expected: &'static str,
    ) -> Result<(), SofaProblem> {
        let found = self.global(attribute)?;
        match found.as_deref() == Some(expected) {
            true => Ok(()),
            false => Err(wrong_convention(attribute, found, expected)),
        }
    }

    /// The text of an attribute of the file; `None` if it is missing.
    pub(super) fn global(&self, attribute: &str) -> Result<Option<String>, SofaProblem> {
        let attributes = self.0.root().attrs();
        let attributes = attributes.map_err(|error| damaged("its attributes", &error))?;
        let found = attributes.get(attribute).and_then(|value| value.as_str());
        Ok(found.map(|found| trimmed(found).to_owned()))
    }

    /// The text of a variable's attribute; `None` if it is missing.
    pub(super) fn attribute(
        &self,
        variable: &'static str,
        attribute: &str,
    ) -> Result<Option<String>, SofaProblem> {
        let attributes = self.dataset(variable)?.attrs();
        let attributes = attributes.map_err(|error| damaged(variable, &error))?;
        let found = attributes.get(attribute).and_then(|value| value.as_str());
        Ok(found.map(|found| short(trimmed(found))))
    }

    /// Whether the file has the variable, even if the variable is damaged.
    pub(super) fn has(&self, variable: &str) -> bool {
        let is_absent =
            |error: &Error| matches!(error, Error::Format(FormatError::PathNotFound(_)));
        !self
            .0
            .dataset(variable)
            .is_err_and(|error| is_absent(&error))
    }

    pub(super) fn shape(&self, variable: &'static str) -> Result<Vec<u64>, SofaProblem> {
        let shape = self.dataset(variable)?.shape();
        shape.map_err(|error| damaged(variable, &error))
    }

    /// All numbers of a variable that must have `count` numbers.
    pub(super) fn samples(
        &self,
        variable: &'static str,
        count: usize,
    ) -> Result<Vec<f32>, SofaProblem> {
        let dataset = self.dataset(variable)?;
        self.check_storage(&dataset, variable)?;
        let samples = dataset
            .read_f32()
            .map_err(|error| damaged(variable, &error))?;
        expect_count(variable, samples.len(), count)?;
        Ok(samples)
    }

    /// All numbers of a variable that has at most `most` numbers.
    pub(super) fn numbers(
        &self,
        variable: &'static str,
        most: usize,
    ) -> Result<Vec<f64>, SofaProblem> {
        let dataset = self.dataset(variable)?;
        self.check_storage(&dataset, variable)?;
        let shape = self.shape(variable)?;
        let count = shape
            .iter()
            .try_fold(1_u64, |product, size| product.checked_mul(*size));
        let count = count.filter(|count| *count <= most as u64);
        let Some(count) = count else {
            return Err(bad_shape(variable, &shape, "a shape with fewer numbers"));
        };
        let numbers = dataset
            .read_f64()
            .map_err(|error| damaged(variable, &error))?;
        expect_count(variable, numbers.len(), count as usize)?;
        Ok(numbers)
    }

    /// The numbers of a variable with either one row for all `count` measurements or one row for each, and the number
    /// of columns.
    pub(super) fn rows(
        &self,
        variable: &'static str,
        count: usize,
    ) -> Result<(Vec<f64>, usize), SofaProblem> {
        /// Maximum number of columns: coordinates, or ears.
        const MOST_COLUMNS: u64 = 3;
        let shape = self.shape(variable)?;
        match shape[..] {
            [rows, columns]
                if (rows == 1 || rows == count as u64) && (1..=MOST_COLUMNS).contains(&columns) =>
            {
                let columns = columns as usize;
                let numbers = self.numbers(variable, rows as usize * columns)?;
                Ok((numbers, columns))
            }
            _ => Err(bad_shape(
                variable,
                &shape,
                "one row for all measurements, or one for each",
            )),
        }
    }

    /// Rejects values that are not numbers, and chunks larger than a set's maximum or than the file, because the reader
    /// allocates as much memory as a chunk declares.
    fn check_storage(&self, dataset: &Dataset, variable: &'static str) -> Result<(), SofaProblem> {
        let failed = |error: hdf5_pure::Error| damaged(variable, &error);
        let width = dataset.element_size().map_err(failed)?;
        if width > WIDEST {
            return Err(bad_value(
                variable,
                format!("its values have {width} bytes each, where numbers have at most {WIDEST}"),
            ));
        }
        let Some(chunk) = dataset.chunk_shape().map_err(failed)? else {
            return Ok(());
        };
        let too_large = |what: &str| SofaProblem::Damaged {
            what: variable.into(),
            reason: format!("it is stored in chunks that are larger than {what}"),
        };
        let mut values = chunk.iter().copied();
        let values = values.try_fold(1_u64, |product, size| product.checked_mul(size));
        if values.is_none_or(|values| values > HrirSet::MAX_VALUES) {
            return Err(too_large("any set"));
        }
        let chunks = dataset.chunks().map_err(failed)?;
        if chunks
            .iter()
            .any(|chunk| chunk.storage_size > self.0.file_size())
        {
            return Err(too_large("the file"));
        }
        Ok(())
    }

    fn dataset(&self, variable: &'static str) -> Result<Dataset, SofaProblem> {
        self.0.dataset(variable).map_err(|error| {
            // The reader returns the same error for a missing variable as for a damaged variable.
            match self.0.root().datasets() {
                Ok(names) if !names.iter().any(|name| name == variable) => {
                    SofaProblem::Missing { variable }
                }
                _ => damaged(variable, &error),
            }
        })
    }
}

/// The error for an attribute with this text, or without text.
pub(super) fn wrong_convention(
    attribute: &'static str,
    found: Option<String>,
    expected: &'static str,
) -> SofaProblem {
    SofaProblem::WrongConvention {
        attribute,
        found: match found {
            Some(found) => format!("{:?}", short(&found)),
            None => "missing".into(),
        },
        expected,
    }
}

fn expect_count(variable: &'static str, found: usize, count: usize) -> Result<(), SofaProblem> {
    if found == count {
        return Ok(());
    }
    Err(SofaProblem::Damaged {
        what: variable.into(),
        reason: format!("it has {found} numbers, but its shape has {count}"),
    })
}

fn damaged(what: &str, error: &Error) -> SofaProblem {
    match way_not_read(error) {
        Some(reason) => SofaProblem::NotRead {
            what: what.into(),
            reason,
        },
        None => SofaProblem::Damaged {
            what: what.into(),
            reason: short(&error.to_string()),
        },
    }
}

/// The reason why the reader does not support the file's form of HDF5; `None` for any other error.
fn way_not_read(error: &Error) -> Option<String> {
    /// The newest supported version of the data layout message. HDF5 2.0 writes version 5 for compressed chunks, unless
    /// the file must be readable by older versions.
    const NEWEST_LAYOUT: u8 = 4;
    /// A part of the reader's message about chunks that are indexed by a version 2 B-tree. HDF5 uses this tree for data
    /// with two or more unlimited dimensions.
    const TREE_OF_PIECES: &str = "version 2 B-tree";
    let Error::Format(error) = error else {
        return None;
    };
    match error {
        FormatError::InvalidLayoutVersion(version) if *version > NEWEST_LAYOUT => Some(format!(
            "version {version} of its data layout; up to {NEWEST_LAYOUT} is read"
        )),
        FormatError::ChunkedReadError(text) if text.contains(TREE_OF_PIECES) => {
            Some("chunks listed in a version 2 B-tree".into())
        }
        FormatError::UnsupportedVersion(_)
        | FormatError::UnsupportedMessage(_)
        | FormatError::UnsupportedFilter(_)
        | FormatError::UnsupportedZfp(_)
        | FormatError::UnsupportedVirtualLayout
        | FormatError::UnsupportedExternalStorage
        | FormatError::UnsupportedFilteredHeapObject
        | FormatError::InvalidDatatypeVersion { .. } => Some(short(&error.to_string())),
        _ => None,
    }
}

/// The text without the padding that some writers add.
fn trimmed(text: &str) -> &str {
    text.trim_end_matches('\0').trim()
}

fn short(text: &str) -> String {
    text.chars().take(SHOWN).collect()
}
