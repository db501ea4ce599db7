//! Waves in texels: their layout, start directions that the CPU gives, and waves that are read back.

use super::TraceError;
use crate::sampling::{hash, unit_interval};
use glam::{DQuat, Quat, Vec3};
use std::f64::consts::TAU;

/// Status of a dead wave.
pub const STATUS_DEAD: f32 = -1.0;

/// Status of a wave that reached the listener.
#[cfg(test)]
pub const STATUS_LISTENER: f32 = 0.0;

/// Status of a wave before its first march.
pub(crate) const STATUS_STARTED: f32 = 0.5;

/// Factor of the marches that reached the step limit in a wave's counters, which are one float (`glsl/wave.glsl`).
const LIMIT_REACHED: u32 = 4096;

/// The largest squares of a position, in metres², and of a direction that a wave can have (`glsl/contribution.glsl`).
const MOST_SQUARED_PLACE: f32 = 1e30;
const MOST_SQUARED_DIRECTION: f32 = 2.0;

/// The size of the texture that holds a number of waves in rows of `width` texels, wave by wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Number of waves.
    pub waves: u32,
    /// Texels per row.
    pub width: u32,
    /// Number of rows. Texels beyond the last wave are empty.
    pub height: u32,
}

impl Grid {
    /// The texture for `waves` that is as square as possible. (The numbers of waves in the thesis are squares: 64 = 8 ×
    /// 8.)
    pub fn new(waves: u32) -> Grid {
        let width = f64::from(waves).sqrt().ceil().max(1.0) as u32;
        Grid {
            waves,
            width,
            height: waves.div_ceil(width),
        }
    }
}

/// The state of a wave after the last iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// The wave hit no surface within the maximum distance, or one of its marches reached the step limit.
    Dead,
    /// The wave reached the listener.
    Listener,
    /// The wave is neither heard nor dead after the last iteration.
    Travelling,
    /// The wave's position or direction is not finite or impossible, because of a faulty shader or driver. The wave
    /// contributes to neither ear.
    NotFinite,
}

impl Fate {
    /// The fate that a status represents, with the margin of figure 8.
    #[doc(hidden)]
    pub fn of(status: f32) -> Fate {
        match status {
            s if s > -0.1 && s < 0.1 => Fate::Listener,
            s if s.is_nan() || s < -1.5 => Fate::NotFinite,
            s if s < 0.0 => Fate::Dead,
            _ => Fate::Travelling,
        }
    }
}

/// One wave, from its start to the end of the last iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Wave {
    /// Unit vector of the direction in which the wave left the source.
    pub start_direction: Vec3,
    /// Current position in world metres. A dead wave keeps its last position, except in the profile `thesis`, where it
    /// is at the origin.
    pub position: Vec3,
    /// Current direction, mirrored at the last surface hit. In the profile `thesis`, a dead wave has the direction 0,
    /// and the listener mirrors waves too.
    pub direction: Vec3,
    /// −1 dead, 0 at the listener, n at the n-th surface.
    pub status: f32,
    /// Marches that ended at distance 0. Meaningless in a frame that counts evaluations.
    pub zero_length_passes: u32,
    /// Marches that reached the step limit. Meaningless in a frame that counts evaluations.
    pub step_limit_reached: u32,
}

impl Wave {
    /// The wave's state after the last iteration.
    pub fn fate(&self) -> Fate {
        // Comparisons with NaN are false, so NaN counts as not finite.
        let is_finite = self.position.length_squared() < MOST_SQUARED_PLACE
            && self.direction.length_squared() < MOST_SQUARED_DIRECTION;
        match is_finite {
            true => Fate::of(self.status),
            false => Fate::NotFinite,
        }
    }
}

/// Combines the texels of both textures, read back at the start and at the end, into waves. `shader_origin` is the
/// world position of the march's origin.
pub(super) fn waves(
    starts: &[Vec<f32>; 2],
    ends: &[Vec<f32>; 2],
    shader_origin: Vec3,
) -> Vec<Wave> {
    let texels = |texture: &[f32]| texture.as_chunks::<4>().0.to_vec();
    let starts = texels(&starts[1]);
    let ends = texels(&ends[0]).into_iter().zip(texels(&ends[1]));
    let wave = |(start, (origin, direction)): ([f32; 4], ([f32; 4], [f32; 4]))| {
        let (zero_length_passes, step_limit_reached) = unpack_counters(direction[3]);
        Wave {
            start_direction: xyz(start),
            position: xyz(origin) + shader_origin,
            direction: xyz(direction),
            status: origin[3],
            zero_length_passes,
            step_limit_reached,
        }
    };
    starts.into_iter().zip(ends).map(wave).collect()
}

fn xyz(texel: [f32; 4]) -> Vec3 {
    Vec3::new(texel[0], texel[1], texel[2])
}

/// Unpacks a texel's counters: the marches of length zero, and the marches that reached the step limit.
pub(super) fn unpack_counters(counters: f32) -> (u32, u32) {
    let counters = counters as u32;
    (counters % LIMIT_REACHED, counters / LIMIT_REACHED)
}

/// A rotation drawn uniformly from all rotations, one rotation for each seed (Shoemake, *Uniform random rotations*,
/// Graphics Gems III, 1992).
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

/// The same directions, normalised.
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

/// The texels of both textures for waves that start in these directions, with a common position and status. Texels
/// beyond the last wave are empty.
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

    /// Protects numbers of waves that are not squares: every wave has a texel, and every row has a wave.
    #[test]
    fn a_grid_holds_its_waves_and_no_empty_row() {
        for waves in [1, 2, 3, 64, 1000, 1023, 65_536, 1_048_576, 16_777_216] {
            let grid = Grid::new(waves);
            assert!(grid.width * grid.height >= waves, "{waves}");
            assert!(grid.width * (grid.height - 1) < waves, "{waves}");
            assert!(grid.width <= 4096 && grid.height <= grid.width);
        }
        assert_eq!(Grid::new(64).width, 8);
    }

    /// Protects the packing of two counters in one float.
    #[test]
    fn counters_unpack() {
        assert_eq!(unpack_counters(0.0), (0, 0));
        assert_eq!(unpack_counters(7.0 + 4096.0 * 3.0), (7, 3));
        assert_eq!(unpack_counters(4095.0 + 4096.0 * 4095.0), (4095, 4095));
    }

    /// Protects the shaders from invalid directions. Valid directions may have any length.
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

    /// Protects the lattice from rotations that prefer some directions. Over many seeds the mean of one rotated axis is
    /// 0 in each coordinate, and the mean of its squares is 1/3, within five standard errors. These are √(1/3N) for the
    /// coordinates of a uniform direction, and √(4/45N) for their squares.
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
