//! SOFA files (AES69): sets of head-related impulse responses, and directivities of sources (`balloon.rs`), in
//! netCDF-4, which is HDF5.
//!
//! Supports the convention SimpleFreeFieldHRIR: `Data.IR` \[M\]\[2\]\[N\] at `Data.SamplingRate`, delayed by
//! `Data.Delay` samples, from the M directions of `SourcePosition`, relative to `ListenerPosition`, `ListenerView` and
//! `ListenerUp`. The ear whose `ReceiverPosition` is farther to the left is the left ear. If a file contains several
//! distances, the farthest distance is used in each direction.
//!
//! # Untrusted files
//! At most [`LARGEST_FILE`] bytes are read. Each variable is read only after its shape and the sizes of its chunks have
//! been checked. The HDF5 reader is safe Rust. If it panics at a damaged file, the panic is caught and reported as
//! damage.

use super::{HrirSet, MeasuredHrir};
use crate::file_input::{self, InputError};
use glam::{DMat3, DVec3};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use variables::Variables;

mod balloon;
#[cfg(test)]
mod tests;
mod variables;

pub(crate) use balloon::read_balloon;
pub use variables::{SofaError, SofaProblem};

/// Maximum size of a SOFA file in bytes: twice the size of [`HrirSet::MAX_VALUES`](super::HrirSet::MAX_VALUES) 64-bit
/// numbers, to leave room for all other data.
const LARGEST_FILE: u64 = 2 * 8 * super::HrirSet::MAX_VALUES;

/// The supported convention.
const CONVENTION: &str = "SimpleFreeFieldHRIR";

/// Number of ears of a head.
const EARS: u64 = 2;

impl HrirSet {
    /// Reads a SOFA file of the convention SimpleFreeFieldHRIR (AES69), at the rate of the file.
    ///
    /// # Errors
    /// [`SofaError`]: the file and the problem with it.
    pub fn read_sofa(path: &Path) -> Result<HrirSet, SofaError> {
        read(path, from_bytes)
    }
}

/// Reads a file up to its size limit, and what `parse` finds in its bytes.
fn read<T>(
    path: &Path,
    parse: impl FnOnce(Vec<u8>) -> Result<T, SofaProblem>,
) -> Result<T, SofaError> {
    let bytes = file_input::read(path, LARGEST_FILE);
    bytes
        .map_err(|source: InputError| SofaProblem::Unreadable { source })
        .and_then(parse)
        .map_err(|problem| SofaError {
            path: path.into(),
            problem,
        })
}

/// Calls the reader, and reports a panic as damage.
fn caught<T>(reader: impl FnOnce() -> Result<T, SofaProblem>) -> Result<T, SofaProblem> {
    catch_unwind(AssertUnwindSafe(reader)).unwrap_or_else(|_| {
        Err(SofaProblem::Damaged {
            what: "its structure".into(),
            reason: "the reader failed".into(),
        })
    })
}

fn from_bytes(bytes: Vec<u8>) -> Result<HrirSet, SofaProblem> {
    let (rate_hz, measured) = caught(|| {
        let file = Variables::open(bytes)?;
        file.expect_global("Conventions", "SOFA")?;
        file.expect_global("SOFAConventions", CONVENTION)?;
        measurements(&file)
    })?;
    HrirSet::new(rate_hz, measured).map_err(|source| SofaProblem::Set { source })
}

/// The measurements of a file of the convention SimpleFreeFieldHRIR.
fn measurements(file: &Variables) -> Result<(u32, Vec<MeasuredHrir>), SofaProblem> {
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
    super::check_sizes(count, samples).map_err(|source| SofaProblem::Set { source })?;
    let rate_hz = rate(file)?;
    let delays = delays(file, count, rate_hz)?;
    let (directions, metres) = directions(file, count)?;
    let [left, right] = receivers(file)?;
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
    // If several measurements have the same direction, the first is used. The order puts the farthest measurement
    // first, because it is closest to a plane wave.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| metres[*b].total_cmp(&metres[*a]));
    Ok((rate_hz, order.into_iter().map(measured).collect()))
}

/// The sampling rate in hertz: a whole number, the same for all measurements.
fn rate(file: &Variables) -> Result<u32, SofaProblem> {
    const NAME: &str = "Data.SamplingRate";
    let rates = file.numbers(NAME, super::HrirSet::MAX_DIRECTIONS)?;
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

/// Least sine of the angle between view and up. Vectors with a smaller sine do not define axes.
const LEAST_SINE: f64 = 1e-3;

/// The direction of each source, and its distance in metres.
fn directions(file: &Variables, count: usize) -> Result<(Vec<DVec3>, Vec<f64>), SofaProblem> {
    const SOURCE: &str = "SourcePosition";
    let sources = vectors(file, SOURCE, count, None)?;
    let listener = vectors(file, "ListenerPosition", count, Some(DVec3::ZERO))?;
    let view = vectors(file, "ListenerView", count, Some(DVec3::X))?;
    let up = vectors(file, "ListenerUp", count, Some(DVec3::Z))?;
    let mut directions = Vec::with_capacity(count);
    let mut metres = Vec::with_capacity(count);
    for index in 0..count {
        let axes = axes("ListenerView", view[index], up[index])?;
        let from = axes.transpose() * (sources[index] - listener[index]);
        if !from.is_finite() || from.try_normalize().is_none() {
            let reason = format!("measurement {index} has no valid direction");
            return Err(bad_value(SOURCE, reason));
        }
        directions.push(from);
        metres.push(from.length());
    }
    Ok((directions, metres))
}

/// The indices of the receivers at the left and at the right ear.
fn receivers(file: &Variables) -> Result<[usize; 2], SofaProblem> {
    const NAME: &str = "ReceiverPosition";
    const FIRST_IS_LEFT: [usize; 2] = [0, 1];
    if !file.has(NAME) {
        return Ok(FIRST_IS_LEFT);
    }
    // Two receivers with three coordinates, for one or all measurements. The positions of the first measurement are
    // used.
    let shape = file.shape(NAME)?;
    let per_receiver = match shape[..] {
        [2, 3] => 1,
        [2, 3, measurements] => measurements as usize,
        _ => return Ok(FIRST_IS_LEFT),
    };
    let most = super::HrirSet::MAX_DIRECTIONS * 6;
    let numbers = file.numbers(NAME, most)?;
    let coordinate = |receiver: usize, axis: usize| {
        let at = (3 * receiver + axis) * per_receiver;
        numbers.get(at).copied().unwrap_or(0.0)
    };
    let kind = Kind::of(file, NAME)?;
    let y = |receiver| {
        kind.cartesian(std::array::from_fn(|axis| coordinate(receiver, axis)))
            .y
    };
    // In the convention the left ear comes first. Files without positions of the ears use this order.
    let is_swapped = y(0) < 0.0 && y(1) > 0.0;
    Ok(if is_swapped { [1, 0] } else { FIRST_IS_LEFT })
}

/// The axes of a listener or a source as columns; `name` is the variable of the view.
fn axes(name: &'static str, view: DVec3, up: DVec3) -> Result<DMat3, SofaProblem> {
    let bad = || {
        bad_value(
            name,
            format!("with the vector up it does not define axes: {view:?} and {up:?}"),
        )
    };
    let x = view.try_normalize().ok_or_else(bad)?;
    let above = up.try_normalize().ok_or_else(bad)?;
    let y = above.cross(x);
    if y.length() < LEAST_SINE {
        return Err(bad());
    }
    let y = y.normalize();
    Ok(DMat3::from_cols(x, y, x.cross(y)))
}

#[derive(Clone, Copy)]
enum Kind {
    Cartesian,
    Spherical,
}

impl Kind {
    /// The kind of a variable's numbers, by its attributes Type and Units.
    fn of(file: &Variables, variable: &'static str) -> Result<Kind, SofaProblem> {
        let bad = |attribute: &str, found: &str, expected: &str| {
            bad_value(
                variable,
                format!("its {attribute} is {found:?}, not {expected}"),
            )
        };
        let kind = file.attribute(variable, "Type")?;
        let kind = match kind.as_deref() {
            Some("spherical") => Kind::Spherical,
            Some("cartesian") => Kind::Cartesian,
            // Views often have no type; SOFA's default is cartesian.
            None => Kind::Cartesian,
            Some(other) => return Err(bad("Type", other, "\"spherical\" or \"cartesian\"")),
        };
        let units = file.attribute(variable, "Units")?.unwrap_or_default();
        let first = units.split([',', ' ']).next().unwrap_or_default();
        let (expected, is_right) = match kind {
            Kind::Spherical => ("degree", first.starts_with("degree")),
            Kind::Cartesian => (
                "metre",
                matches!(first, "metre" | "meter" | "metres" | "meters"),
            ),
        };
        if !first.is_empty() && !is_right {
            return Err(bad("Units", &units, expected));
        }
        Ok(kind)
    }

    fn cartesian(self, numbers: [f64; 3]) -> DVec3 {
        let [azimuth, elevation, radius] = numbers;
        match self {
            Kind::Cartesian => DVec3::from_array(numbers),
            Kind::Spherical => {
                let (up, flat) = elevation.to_radians().sin_cos();
                let (left, ahead) = azimuth.to_radians().sin_cos();
                radius * DVec3::new(flat * ahead, flat * left, up)
            }
        }
    }
}

/// The vectors of a variable for each of `count` measurements; `missing` if the file has no such variable.
fn vectors(
    file: &Variables,
    variable: &'static str,
    count: usize,
    missing: Option<DVec3>,
) -> Result<Vec<DVec3>, SofaProblem> {
    if let Some(missing) = missing
        && !file.has(variable)
    {
        return Ok(vec![missing; count]);
    }
    let (numbers, columns) = file.rows(variable, count)?;
    if columns != 3 {
        let reason = format!("its rows have {columns} numbers, not 3");
        return Err(bad_value(variable, reason));
    }
    let kind = Kind::of(file, variable)?;
    let rows = numbers.chunks_exact(3);
    let vectors = rows.map(|row| kind.cartesian([row[0], row[1], row[2]]));
    // A single row applies to all measurements.
    Ok(vectors.cycle().take(count).collect())
}
