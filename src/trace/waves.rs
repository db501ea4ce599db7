//! The layout of waves in texels, and the waves that are read back.

use glam::Vec3;

/// Status of a dead wave.
pub const STATUS_DEAD: f32 = -1.0;

/// Status of a wave that reached the listener.
#[cfg(test)]
pub const STATUS_LISTENER: f32 = 0.0;

/// Status of a wave before its first march.
pub(crate) const STATUS_STARTED: f32 = 0.5;

/// Marches that reached the step limit count in multiples of this in a wave's counters (`glsl/wave.glsl`).
const LIMIT_REACHED: u32 = 4096;

/// The largest square of a place in metres² and of a direction that a wave can have (`glsl/contribution.glsl`).
const MOST_SQUARED_PLACE: f32 = 1e30;
const MOST_SQUARED_DIRECTION: f32 = 2.0;

/// The texture that holds a number of waves: rows of `width`, wave by wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Waves.
    pub waves: u32,
    /// Texels in a row.
    pub width: u32,
    /// Rows; texels beyond the last wave hold none.
    pub height: u32,
}

impl Grid {
    /// The squarest texture for `waves` (the thesis' counts are squares: 64 = 8 x 8).
    pub fn new(waves: u32) -> Grid {
        let width = f64::from(waves).sqrt().ceil().max(1.0) as u32;
        Grid {
            waves,
            width,
            height: waves.div_ceil(width),
        }
    }
}

/// What became of a wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It met nothing within the maximum distance, or its march reached the step limit.
    Dead,
    /// It reached the listener.
    Listener,
    /// It is neither heard nor dead after the last iteration.
    Travelling,
    /// Its place or direction is no number, or one that cannot be: something went wrong, and it is heard nowhere.
    NotFinite,
}

impl Fate {
    /// The fate that a status encodes; the margin is figure 8's.
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
    /// Unit vector in which it left the source.
    pub start_direction: Vec3,
    /// Where it is, world metres. A dead wave is where it was last; in the profile
    /// `thesis` it is at the origin.
    pub position: Vec3,
    /// Where it heads: mirrored at the surface it met last. In the profile `thesis` 0 for a
    /// dead wave, and mirrored at the listener too.
    pub direction: Vec3,
    /// −1 dead, 0 at the listener, n at the n-th surface.
    pub status: f32,
    /// Marches that ended at distance 0. Without meaning in a frame that counts evaluations.
    pub zero_length_passes: u32,
    /// Marches that reached the step limit. Without meaning in a frame that counts
    /// evaluations.
    pub step_limit_reached: u32,
}

impl Wave {
    /// What became of it.
    pub fn fate(&self) -> Fate {
        // Comparisons with NaN are false.
        let is_finite = self.position.length_squared() < MOST_SQUARED_PLACE
            && self.direction.length_squared() < MOST_SQUARED_DIRECTION;
        match is_finite {
            true => Fate::of(self.status),
            false => Fate::NotFinite,
        }
    }
}

/// Pairs up what was read back of both textures after the start and at the end; `shader_origin`
/// is the world position of the march's origin.
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

/// Zero-length passes and marches that reached the step limit out of a texel's counters.
pub(super) fn unpack_counters(counters: f32) -> (u32, u32) {
    let counters = counters as u32;
    (counters % LIMIT_REACHED, counters / LIMIT_REACHED)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects odd counts: every wave has a texel and no row is without one.
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
}
