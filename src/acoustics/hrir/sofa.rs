//! SOFA files (AES69): sets of head-related impulse responses in netCDF-4, which is HDF5.
//!
//! Supports the convention SimpleFreeFieldHRIR: `Data.IR` \[M\]\[2\]\[N\] at `Data.SamplingRate`, delayed by
//! `Data.Delay` samples, from the M directions of `SourcePosition`, relative to `ListenerPosition`,
//! `ListenerView` and `ListenerUp`. The ear whose `ReceiverPosition` is farther to the left is the left one.
//! If a file contains several distances, the farthest is used in each direction.
//!
//! # Files of strangers
//! At most [`LARGEST_FILE`] bytes are read, and each variable only after its shape and the sizes of its
//! chunks have been checked. The HDF5 reader is safe Rust. If it panics at a damaged file, the panic is
//! caught and reported as damage.

mod error;
mod geometry;
#[cfg(test)]
mod tests;
mod variables;

pub use error::{SofaError, SofaProblem};

use super::{HrirSet, MeasuredHrir, check};
use crate::file_input::{self, InputError};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use variables::Variables;

/// Maximum size of a SOFA file in bytes: [`MAX_VALUES`](super::MAX_VALUES) numbers of 64 bits, and
/// the same again for everything else.
const LARGEST_FILE: u64 = 2 * 8 * super::MAX_VALUES;

/// The supported convention.
const CONVENTION: &str = "SimpleFreeFieldHRIR";

/// Number of ears of a head.
const EARS: u64 = 2;

impl HrirSet {
    /// Reads a SOFA file of the convention SimpleFreeFieldHRIR (AES69), at the rate of the file.
    ///
    /// # Errors
    /// [`SofaError`]: the file and what is wrong with it.
    pub fn read_sofa(path: &Path) -> Result<HrirSet, SofaError> {
        let bytes = file_input::read(path, LARGEST_FILE);
        bytes
            .map_err(|source: InputError| SofaProblem::Unreadable { source })
            .and_then(from_bytes)
            .map_err(|problem| SofaError {
                path: path.into(),
                problem,
            })
    }
}

fn from_bytes(bytes: Vec<u8>) -> Result<HrirSet, SofaProblem> {
    let caught = catch_unwind(AssertUnwindSafe(|| measurements(bytes)));
    let (rate_hz, measured) = caught.unwrap_or_else(|_| {
        Err(SofaProblem::Damaged {
            what: "its structure".into(),
            reason: "the reader failed".into(),
        })
    })?;
    HrirSet::new(rate_hz, measured).map_err(|source| SofaProblem::Set { source })
}

fn measurements(bytes: Vec<u8>) -> Result<(u32, Vec<MeasuredHrir>), SofaProblem> {
    let file = Variables::open(bytes)?;
    file.expect_global("Conventions", "SOFA")?;
    file.expect_global("SOFAConventions", CONVENTION)?;
    file.expect_global("DataType", "FIR")?;
    let shape = file.shape("Data.IR")?;
    let [count, ears, samples] = shape[..] else {
        return Err(bad_shape("Data.IR", &shape, "measurements × 2 × samples"));
    };
    if ears != EARS {
        return Err(bad_shape("Data.IR", &shape, "measurements × 2 × samples"));
    }
    let size = |number: u64| usize::try_from(number).unwrap_or(usize::MAX);
    let (count, samples) = (size(count), size(samples));
    check::sizes(count, samples).map_err(|source| SofaProblem::Set { source })?;
    let rate_hz = rate(&file)?;
    let delays = delays(&file, count, rate_hz)?;
    let (directions, metres) = geometry::directions(&file, count)?;
    let [left, right] = geometry::ears(&file)?;
    let responses = file.samples("Data.IR", 2 * count * samples)?;
    let ear = |index: usize, ear: usize| {
        let begins = (2 * index + ear) * samples;
        responses[begins..begins + samples].to_vec()
    };
    let measured = |index: usize| MeasuredHrir {
        from: directions[index],
        ears: [ear(index, left), ear(index, right)],
        delays_s: [delays[index][left], delays[index][right]],
    };
    // Of several from one direction the first is used: the farthest, which is closest to a plane
    // wave.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| metres[*b].total_cmp(&metres[*a]));
    Ok((rate_hz, order.into_iter().map(measured).collect()))
}

/// The sampling rate in hertz: a whole number, the same for all measurements.
fn rate(file: &Variables) -> Result<u32, SofaProblem> {
    const NAME: &str = "Data.SamplingRate";
    let rates = file.numbers(NAME, super::MAX_DIRECTIONS)?;
    let Some(rate_hz) = rates.first().copied() else {
        return Err(bad_value(NAME, "it is empty".into()));
    };
    let whole = rate_hz as u32;
    if f64::from(whole) != rate_hz {
        return Err(bad_value(
            NAME,
            format!("{rate_hz} Hz is not a whole number"),
        ));
    }
    if rates.iter().any(|other| *other != rate_hz) {
        return Err(bad_value(NAME, "it differs between measurements".into()));
    }
    if let Some(units) = file.attribute(NAME, "Units")?
        && !units.eq_ignore_ascii_case("hertz")
    {
        let reason = format!("its unit is {units:?}, not \"hertz\"");
        return Err(bad_value(NAME, reason));
    }
    Ok(whole)
}

/// The delays of both ears in seconds, for each measurement.
fn delays(file: &Variables, count: usize, rate_hz: u32) -> Result<Vec<[f64; 2]>, SofaProblem> {
    const NAME: &str = "Data.Delay";
    if !file.has(NAME) {
        return Ok(vec![[0.0; 2]; count]);
    }
    let (rows, columns) = file.rows(NAME, count)?;
    if columns != 2 {
        let shape = file.shape(NAME)?;
        return Err(bad_shape(NAME, &shape, "1 or all measurements × 2"));
    }
    let of = |index: usize| {
        let at = if rows.len() == 2 { 0 } else { 2 * index };
        [rows[at], rows[at + 1]].map(|samples| samples / f64::from(rate_hz))
    };
    Ok((0..count).map(of).collect())
}

fn bad_shape(variable: &'static str, shape: &[u64], expected: &'static str) -> SofaProblem {
    let found: Vec<String> = shape.iter().map(u64::to_string).collect();
    SofaProblem::BadShape {
        variable,
        found: found.join(" × "),
        expected,
    }
}

fn bad_value(variable: &'static str, reason: String) -> SofaProblem {
    SofaProblem::BadValue { variable, reason }
}
