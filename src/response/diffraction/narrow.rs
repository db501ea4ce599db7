//! Obstacles that are narrow for the wavelength: they disturb a front as a thin screen does.

use num_complex::Complex64;

/// How much a factor counts, from 0 at a narrow obstacle to 1 at a wide one. `phase` is the wave number, times the
/// wavelength over 2π at which the factor counts half.
pub(super) fn wideness(phase: f64) -> f64 {
    match phase.is_finite() {
        true => phase / (phase + 1.0),
        false => 1.0,
    }
}

/// The factor of a way around an obstacle that counts by `wide`, from 1 at a narrow one to `factor` at a wide one.
///
/// Its part without the factor decreases with it: in the deep shadow of a wide body it would otherwise be louder than
/// creeping waves.
pub(super) fn factor_of(factor: Complex64, wide: f64) -> Complex64 {
    factor * wide + factor.norm().min(1.0).powf(wide) * (1.0 - wide)
}
