//! What rounding alone may cost.

/// How far off a start may be that still counts as the same, as a share of the scene's
/// extent for its place and in radians for its direction: eight units in the last place of
/// an `f32`, what a flight and a reflection may lose.
pub const START_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;

/// What an end point may be off besides, as a share of the scene's extent.
pub const END_ROUNDING: f64 = 16.0 * f32::EPSILON as f64;

/// What a direction's length may be off: what GLSL allows. `inversesqrt` may be 2 units in the last place
/// off, a division 2.5 and a square root both (GLSL 4.60, section 4.7.1): `normalize` 4 units with the dot product
/// and the products, and a reflection at such a normal has twice its error. A unit is [`f32::EPSILON`] at most.
pub const LENGTH_ROUNDING: f64 = 8.0 * f32::EPSILON as f64;
