//! Compares sets of responses with a head that is known exactly.

mod interpolation;
pub(crate) mod rigid_sphere;
