//! Compares the caller's own function on the CPU with the values of the text.

use super::{DEPTH, Error, TraceError, WaveDomain};
use crate::scene::UserField;

/// Greatest difference, as a share of the largest difference that is possible between two points of the box: a
/// hundred times the rounding error of a value on the GPU, for texts that add many numbers.
const AGREES: f64 = 1e-4;

/// Rejects a field whose function on the CPU differs from the samples of its text: then exact paths and waves would meet
/// different surfaces. Deep in the solid the samples may be replacements, and are not compared.
pub(super) fn compare(field: &UserField, waves: WaveDomain) -> Result<(), Error> {
    let (Some(function), Some(samples)) = (field.cpu(), field.samples()) else {
        return Ok(());
    };
    let size = field.size.as_dvec3();
    let most = f64::from(field.lipschitz) * size.max_element();
    let solid = match waves {
        WaveDomain::Air => -f64::from(DEPTH) * most,
        WaveDomain::BothSides => f64::NEG_INFINITY,
    };
    let compared = samples.places().zip(&samples.values);
    let differs = compared
        .map(|(share, sample)| (size * (share - 0.5), f64::from(*sample)))
        .filter(|(_, sample)| *sample > solid)
        .map(|(place, sample)| (place, sample, function(place)))
        .find(|(_, sample, value)| !value.is_finite() || (value - sample).abs() > AGREES * most);
    match differs {
        None => Ok(()),
        Some((place, text, cpu)) => Err(TraceError::FieldDiffers {
            file: field.file.display().to_string(),
            place: place.as_vec3(),
            text,
            cpu,
        }
        .into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::UserSamples;
    use glam::{DVec3, Vec3};
    use std::sync::Arc;

    /// A plane at height 0 in a box of 2 m, with its samples, and a function of the caller.
    fn field(cpu: impl Fn(DVec3) -> f64 + Send + Sync + 'static) -> UserField {
        let field = UserField::new("plane.glsl", String::new(), Vec3::splat(2.0), 1.0);
        let side = 5;
        let height = |index: usize| (index / side % side) as f32 * 0.5 - 1.0;
        let values = (0..side * side * side).map(height).collect();
        field.set_samples(Arc::new(UserSamples { side, values }));
        field.with_cpu(cpu)
    }

    /// Protects exact paths: a function that is not that of the text is refused, with the place and both values; one that
    /// differs deep in the solid only is accepted for waves in the air.
    #[test]
    fn the_function_must_be_that_of_the_text() {
        let compare = |cpu: fn(DVec3) -> f64, waves| compare(&field(cpu), waves);
        assert!(compare(|p| p.y + 1e-5, WaveDomain::BothSides).is_ok());
        let error = compare(|p| p.y + 0.01 * p.x.max(0.0), WaveDomain::Air).unwrap_err();
        assert_eq!(
            error.to_string(),
            "plane.glsl: the function on the CPU is 0.005 at (0.500, 0.000, -1.000), where the text is 0"
        );
        assert!(compare(|_| f64::NAN, WaveDomain::Air).is_err());
        assert!(compare(|p| p.y.max(-0.4), WaveDomain::Air).is_ok());
        assert!(compare(|p| p.y.max(-0.4), WaveDomain::BothSides).is_err());
    }
}
