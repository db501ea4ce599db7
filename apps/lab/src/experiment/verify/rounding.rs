//! Tolerances for rounding errors.

/// Maximum displacement of a start that still counts as the same start: a share of the scene's extent for the position,
/// and radians for the direction. The value is eight units in the last place of an `f32`, which is the error of one
/// flight and one reflection.
pub const START_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// Additional error of an end point, as a share of the scene's extent.
pub const END_ROUNDING: f64 = 16.0 * f32::EPSILON as f64;

/// Maximum error of a direction's length that GLSL allows. `inversesqrt` may have an error of 2 units in the last
/// place, a division has 2.5, and a square root has the error of both (GLSL 4.60, section 4.7.1). Together with the dot
/// product and the multiplications, `normalize` has an error of 4 units. A reflection at such a normal has twice that
/// error. A unit is at most [`f32::EPSILON`].
pub const LENGTH_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;
