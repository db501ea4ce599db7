//! What rounding alone may cost.

/// How far off a start may be that still counts as the same, as a share of the scene's
/// extent for its place and in radians for its direction: eight units in the last place of
/// an `f32`, what a flight and a reflection may lose.
pub const START_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// What an end point may be off besides, as a share of the scene's extent.
pub const END_ROUNDING: f64 = 16.0 * f32::EPSILON as f64;

/// What a direction's length may be off: normalising in `f32` leaves a unit or two.
pub const LENGTH_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
