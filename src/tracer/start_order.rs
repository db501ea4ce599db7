//! The order of starts: which wave starts at which texel.
//!
//! A renderer traces neighbouring texels in lockstep (llvmpipe 8, a graphics card 32 or 64), so that the slowest
//! wave of such a group determines its time. Waves with consecutive numbers start in different directions, also
//! those of a Fibonacci lattice. If waves are marched, they therefore start sorted: neighbouring texels hold waves
//! of neighbouring directions, which mostly take about as many steps.
//!
//! Directions are sorted along a Hilbert curve over the sphere, and texels by tiles. Numbers, directions and sums of
//! the waves do not depend on the order: everything that is read back is in the order of the waves.

use super::Grid;
use crate::shader::Directions;
use glam::{UVec3, Vec2, Vec2Swizzles, Vec3};
use std::f32::consts::TAU;
use std::ops::Range;

/// Side in texels of a tile, whose waves start in neighbouring directions: 64 waves, as many as a graphics card
/// traces in lockstep at most. Its quarters and their quarters are neighbours, too, down to 2 x 2 texels.
const TILE: u32 = 8;

/// The waves of a grid, and their directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Starts {
    directions: Directions,
    /// Number of waves of the settings.
    of: u32,
    /// Waves of the grid.
    numbers: Range<u32>,
    /// Seed; 0 for a lattice, which a seed only rotates as a whole.
    seed: u32,
}

impl Starts {
    /// The waves `numbers` out of `of` waves, in the directions for a seed.
    pub fn new(directions: Directions, seed: u32, of: u32, numbers: Range<u32>) -> Starts {
        let seed = match directions {
            Directions::Random => seed,
            Directions::Fibonacci => 0,
        };
        Starts {
            directions,
            of,
            numbers,
            seed,
        }
    }

    /// The place of each direction on the square of [`place`]. A lattice is not rotated.
    fn places(&self) -> impl Iterator<Item = Vec2> {
        self.numbers.clone().map(|wave| match self.directions {
            Directions::Random => {
                let bits = mix_bits(UVec3::new(wave, self.seed, 0));
                place(unit_interval(bits.x), unit_interval(bits.y))
            }
            Directions::Fibonacci => {
                let share = (f64::from(wave) + 0.5) / f64::from(self.of);
                place(
                    share as f32,
                    unit_interval(wave.wrapping_mul(GOLDEN_RATIO)),
                )
            }
        })
    }

    /// The order of these waves in a grid.
    pub fn order(&self, grid: Grid) -> StartOrder {
        StartOrder::new(self.places(), grid)
    }
}

/// The texel at which each wave of a grid starts.
#[derive(Debug)]
pub(super) struct StartOrder {
    grid: Grid,
    texels: Vec<u32>,
}

impl StartOrder {
    /// The order of waves that start in these unit vectors.
    pub fn of_directions(directions: impl Iterator<Item = Vec3>, grid: Grid) -> StartOrder {
        let of = |direction: Vec3| {
            let turns = direction.z.atan2(direction.x) / TAU;
            place(0.5 - 0.5 * direction.y, turns - turns.floor())
        };
        StartOrder::new(directions.map(of), grid)
    }

    /// The order of waves with these places on the square, one for each wave of the grid.
    fn new(places: impl Iterator<Item = Vec2>, grid: Grid) -> StartOrder {
        let mut texels = vec![0; grid.waves as usize];
        let waves = sorted_along_curve(places, grid.waves);
        for (wave, texel) in waves.into_iter().zip(texels_by_tile(grid)) {
            texels[wave as usize] = texel;
        }
        StartOrder { grid, texels }
    }

    /// The number of the texel at which a wave starts; waves are counted from the first one in the grid.
    pub fn texel(&self, wave: u32) -> u32 {
        self.texels[wave as usize]
    }

    /// Read-back texels of the grid, four floats each, in the order of the waves.
    pub fn in_order_of_waves(&self, read: &[f32]) -> Vec<f32> {
        let read = read.as_chunks::<4>().0;
        let texels = self.texels.iter().map(|texel| read[*texel as usize]);
        texels.collect::<Vec<_>>().into_flattened()
    }

    /// The texels of `uOrder` (`glsl/order.glsl`), for a texture of this height. Texels without a wave are numbered
    /// like in any grid, beyond the last wave.
    pub fn table(&self, height: u32) -> Vec<[f32; 4]> {
        let width = self.grid.width;
        let of = |texel: u32| [(texel % width) as f32, (texel / width) as f32];
        let own = (0..width * height).map(|texel| {
            let [x, y] = of(texel);
            [texel as f32, x, y, 0.0]
        });
        let mut table: Vec<[f32; 4]> = own.collect();
        for (wave, texel) in self.texels.iter().enumerate() {
            table[*texel as usize][0] = wave as f32;
            let [x, y] = of(*texel);
            (table[wave][1], table[wave][2]) = (x, y);
        }
        table
    }
}

/// The numbers of the waves with these places, sorted along a Hilbert curve that visits cells with one to four waves
/// on average; waves of a cell are in their order.
fn sorted_along_curve(places: impl Iterator<Item = Vec2>, waves: u32) -> Vec<u32> {
    let levels = waves.max(1).ilog2() / 2;
    let along = (1_u32 << levels) as f32;
    let cell = |place: Vec2| {
        let cell = (place * along).min(Vec2::splat(along - 1.0));
        place_on_curve(cell.x as u32, cell.y as u32, levels)
    };
    let cells: Vec<u32> = places.map(cell).collect();
    // A counting sort.
    let mut next = vec![0_u32; 1 << (2 * levels)];
    for cell in &cells {
        next[*cell as usize] += 1;
    }
    let mut before = 0;
    for next in &mut next {
        before += std::mem::replace(next, before);
    }
    let mut sorted = vec![0; cells.len()];
    for (wave, cell) in cells.iter().enumerate() {
        let next = &mut next[*cell as usize];
        sorted[*next as usize] = wave as u32;
        *next += 1;
    }
    sorted
}

/// The texels of a grid that have a wave, tile by tile. Tiles follow each other down a column, so that each strip
/// of rows holds waves from all over the sphere, and the time of one predicts that of the next.
fn texels_by_tile(grid: Grid) -> impl Iterator<Item = u32> {
    let rows = grid.waves.div_ceil(grid.width);
    let tiles = move |side: u32| (0..side.div_ceil(TILE)).map(|tile| tile * TILE);
    let corners = tiles(grid.width).flat_map(move |x| tiles(rows).map(move |y| (x, y)));
    let texels = corners.flat_map(|(x, y)| {
        (0..TILE * TILE).map(move |place| (x + even_bits(place), y + even_bits(place >> 1)))
    });
    let number = move |(x, y): (u32, u32)| (x < grid.width).then_some(y * grid.width + x);
    texels
        .filter_map(number)
        .filter(move |texel| *texel < grid.waves)
}

/// Bits 0, 2 and 4, moved together: a coordinate within a tile in Morton order.
fn even_bits(place: u32) -> u32 {
    place & 1 | place >> 1 & 2 | place >> 2 & 4
}

/// The number of a cell along the Hilbert curve over a square of 2^`levels` cells along each side (D. Hilbert, *Ueber
/// die stetige Abbildung einer Linie auf ein Flächenstück*, 1891).
fn place_on_curve(mut x: u32, mut y: u32, levels: u32) -> u32 {
    let mut number = 0;
    for level in (0..levels).rev() {
        let (right, up) = (x >> level & 1, y >> level & 1);
        number = number << 2 | (3 * right) ^ up;
        if up == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
    }
    number
}

/// The place of a direction on a square of side 1 that shows the sphere unfolded as an octahedron, with equal areas
/// (P. Clarberg, *Fast equal-area mapping of the (hemi)sphere using SIMD*, Journal of Graphics Tools 13 (3), 2008).
/// The direction is given by the share of the sphere's area above it, and its azimuth in turns, 0 … 1.
fn place(share: f32, turns: f32) -> Vec2 {
    // Distance from the nearer pole in the square, 1 at the equator, and its division within a quarter of a turn.
    let ring = (2.0 * share.min(1.0 - share)).max(0.0).sqrt();
    let quarter = (4.0 * turns).floor();
    let across = ring * (4.0 * turns - quarter);
    let mut at = Vec2::new(ring - across, across);
    if share > 0.5 {
        at = Vec2::ONE - at.yx();
    }
    let turned = match quarter as u32 % 4 {
        0 => at,
        1 => Vec2::new(-at.y, at.x),
        2 => -at,
        _ => Vec2::new(at.y, -at.x),
    };
    0.5 + 0.5 * turned
}

/// 2^32 times the golden ratio less 1 (`glsl/direction/fibonacci.glsl`).
const GOLDEN_RATIO: u32 = 2_654_435_769;

/// The hash of `glsl/common/hash.glsl`.
fn mix_bits(v: UVec3) -> UVec3 {
    let [mut x, mut y, mut z] = v
        .to_array()
        .map(|bits| bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    [x, y, z] = [x, y, z].map(|bits| bits ^ bits >> 16);
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    UVec3::new(x, y, z)
}

/// The upper 24 bits as a number in 0 … 1, excluding 1.
fn unit_interval(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}
