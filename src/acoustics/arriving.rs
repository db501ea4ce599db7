//! Checks that the numbers of arriving sound are in range.

use super::{AcousticsError, Tap};
use crate::bands::Bands;
use glam::DVec3;

/// The largest energy density, in 1/m²: its amplitude, and sums of squares of such energies, are far within the
/// range of samples (`f32`) and sums (`f64`). The loudest source, of 120 dB, reaches it only within 10⁻²⁴ m.
const LARGEST_ENERGY: f64 = 1e60;

/// Maximum length of a unit vector after rounding to `f32`.
const LONGEST_UNIT: f64 = 1.0 + 1e-5;

/// Checks an energy by bands and its direction of flight. A direction may be shorter than 1: then the sound comes from
/// several sides.
///
/// # Errors
/// [`AcousticsError::BadNumber`] with the first number that is out of range.
pub(super) fn check(energy: &Bands, direction: DVec3) -> Result<(), AcousticsError> {
    let in_range = |energy: &f64| (0.0..=LARGEST_ENERGY).contains(energy);
    if let Some(&value) = energy.iter().find(|energy| !in_range(energy)) {
        return Err(AcousticsError::BadNumber {
            what: "an energy in 1/m²",
            must: "0 to 1e60",
            value,
        });
    }
    let value = direction.length();
    if value <= LONGEST_UNIT {
        return Ok(());
    }
    Err(AcousticsError::BadNumber {
        what: "the length of a direction",
        must: "at most 1",
        value,
    })
}

/// Checks every number of these taps.
///
/// # Errors
/// [`AcousticsError::BadTap`] with the first that is out of range.
pub(crate) fn check_taps<'a>(
    taps: impl IntoIterator<Item = &'a Tap>,
) -> Result<(), AcousticsError> {
    for (index, tap) in taps.into_iter().enumerate() {
        check_tap(tap).map_err(|refused| match refused {
            AcousticsError::BadNumber { what, must, value } => AcousticsError::BadTap {
                index,
                what,
                must,
                value,
            },
            other => other,
        })?;
    }
    Ok(())
}

fn check_tap(tap: &Tap) -> Result<(), AcousticsError> {
    if !(tap.seconds.is_finite() && tap.seconds >= 0.0) {
        return Err(AcousticsError::BadNumber {
            what: "its time in seconds",
            must: "finite and not negative",
            value: tap.seconds,
        });
    }
    check(&tap.energy, tap.direction)
}
