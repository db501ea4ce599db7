//! Start directions on the CPU: the turn of a lattice, and those that a caller gives.

use super::TraceError;
use super::waves::STATUS_DEAD;
use crate::rng::{hash, unit_interval};
use glam::{DQuat, Quat, Vec3};
use std::f64::consts::TAU;

/// A rotation that is uniform over all rotations, one for each seed (Shoemake, *Uniform
/// random rotations*, Graphics Gems III, 1992).
pub(super) fn random_turn(seed: u32) -> Quat {
    let [share, first, second] =
        [0, 1, 2].map(|counter| unit_interval(hash(u64::from(seed) << 32 | counter)));
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    let (sin_first, cos_first) = (TAU * first).sin_cos();
    let (sin_second, cos_second) = (TAU * second).sin_cos();
    DQuat::from_xyzw(a * sin_first, a * cos_first, b * sin_second, b * cos_second)
        .normalize()
        .as_quat()
}

/// The same directions as unit vectors.
pub(super) fn unit_directions(directions: &[Vec3]) -> Result<Vec<Vec3>, TraceError> {
    let unit = |direction: &Vec3| {
        let unit = direction.as_dvec3().try_normalize();
        let unit = unit.filter(|_| direction.is_finite());
        unit.map(|unit| unit.as_vec3())
            .ok_or_else(|| TraceError::BadSetting {
                what: "start direction",
                must: "finite and not 0".to_owned(),
                value: direction.to_string(),
            })
    };
    directions.iter().map(unit).collect()
}

/// The first and the second texture of waves that start in these directions, from one position with one status; the
/// texels beyond the last wave have none.
pub(super) fn start_texels(
    start: [f32; 4],
    directions: impl Iterator<Item = Vec3>,
    texels: usize,
) -> [Vec<[f32; 4]>; 2] {
    let mut headings: Vec<[f32; 4]> = directions.map(|d| d.extend(0.0).to_array()).collect();
    let mut origins = vec![start; headings.len()];
    origins.resize(texels, [0.0, 0.0, 0.0, STATUS_DEAD]);
    headings.resize(texels, [0.0; 4]);
    [origins, headings]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the shaders from directions that are none, and takes any length.
    #[test]
    fn directions_become_unit_vectors() {
        let given = [Vec3::X * 1e-30, Vec3::NEG_Z * 1e30];
        let units = unit_directions(&given).unwrap();
        assert_eq!(units, [Vec3::X, Vec3::NEG_Z]);
        for none in [Vec3::ZERO, Vec3::NAN, Vec3::Y * f32::INFINITY] {
            let error = unit_directions(&[Vec3::X, none]).unwrap_err();
            assert!(error.to_string().contains("start direction"), "{error}");
        }
    }

    /// Protects the lattice from a turn that favours some directions. Over many seeds the
    /// mean of one turned axis is 0 and the mean of its squares 1/3 in each coordinate,
    /// within five standard errors: √(1/3N), and √(4/45N) for the squares of a uniform one.
    #[test]
    fn turns_are_uniform() {
        let seeds = 20_000;
        let sum: Vec3 = (0..seeds).map(|seed| random_turn(seed) * Vec3::Y).sum();
        let standard_error = (3.0 * seeds as f32).sqrt().recip();
        assert!((sum / seeds as f32).abs().max_element() < 5.0 * standard_error);
        let squares: Vec3 = (0..seeds)
            .map(|seed| (random_turn(seed) * Vec3::Y).powf(2.0))
            .sum();
        let off = (squares / seeds as f32 - Vec3::splat(1.0 / 3.0)).abs();
        let standard_error = (4.0 / 45.0 / seeds as f32).sqrt();
        assert!(off.max_element() < 5.0 * standard_error);
    }
}
