//! Systems that choose the graphics card themselves: there is one place to make contexts.

use super::GpuError;

/// The place where a context can be made.
#[derive(Debug)]
pub(super) struct Place;

/// Returns the one place.
///
/// # Errors
/// None.
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    Ok(vec![Place])
}

/// Checks for the library, which is part of the system.
///
/// # Errors
/// None.
#[cfg(feature = "window")]
pub(super) fn prepare() -> Result<(), GpuError> {
    Ok(())
}
