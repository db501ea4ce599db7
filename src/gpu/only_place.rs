//! Systems that choose the graphics card themselves: contexts are made in one place.

use super::GpuError;

/// Where a context can be made.
#[derive(Debug)]
pub(super) struct Place;

/// The one place.
///
/// # Errors
/// None.
pub(super) fn places() -> Result<Vec<Place>, GpuError> {
    Ok(vec![Place])
}

/// Sees that there is a library: it is there with the system.
///
/// # Errors
/// None.
#[cfg(feature = "demo")]
pub(super) fn prepare() -> Result<(), GpuError> {
    Ok(())
}
