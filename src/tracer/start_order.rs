//! The order of starts: the texel at which each wave starts.
//!
//! A renderer traces neighbouring texels in lockstep (8 texels in llvmpipe, 32 or 64 on a graphics card), so the
//! slowest wave of such a group determines the group's time. Waves with consecutive numbers start in different
//! directions, in a Fibonacci lattice too. If waves are marched, their starts are therefore sorted: neighbouring texels
//! hold waves of neighbouring directions, which mostly take similar numbers of steps.
//!
//! Directions are sorted along a Hilbert curve over the sphere, and texels by tiles. The numbers, directions and sums
//! of the waves do not depend on the order of starts, because everything that is read back is rearranged into the order
//! of the waves.

use super::Grid;
use crate::shader::Directions;
use glam::{UVec3, Vec2, Vec2Swizzles, Vec3};
use std::f32::consts::TAU;
use std::ops::Range;

/// Side in texels of a tile, whose waves start in neighbouring directions. A tile has 64 waves, the most that a
/// graphics card traces in lockstep. The waves of each quarter of a tile are also neighbours, as are those of each
/// quarter of a quarter, down to 2 × 2 texels.
const TILE: u32 = 8;

/// The waves of a grid, and their directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Starts {
    directions: Directions,
    /// Number of waves in the settings.
    of: u32,
    /// Numbers of the waves in the grid.
    numbers: Range<u32>,
    /// The seed; 0 for a lattice, because a seed only rotates a lattice as a whole.
    seed: u32,
}

impl Starts {
    /// The waves with these numbers, out of a total of `of` waves, in the directions for a seed.
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

    /// The point of each direction in the square of [`place`]. A lattice is not rotated.
    fn places(&self) -> impl Iterator<Item = Vec2> {
        self.numbers.clone().map(|wave| match self.directions {
            Directions::Random => {
                let bits = mix_bits(UVec3::new(wave, self.seed, 0));
                place(unit_interval(bits.x), unit_interval(bits.y))
            }
            Directions::Fibonacci => {
                let share = (f64::from(wave) + 0.5) / f64::from(self.of);
                place(share as f32, unit_interval(wave.wrapping_mul(GOLDEN_RATIO)))
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
    /// The order of waves whose start directions are these unit vectors.
    pub fn of_directions(directions: impl Iterator<Item = Vec3>, grid: Grid) -> StartOrder {
        let of = |direction: Vec3| {
            let turns = direction.z.atan2(direction.x) / TAU;
            place(0.5 - 0.5 * direction.y, turns - turns.floor())
        };
        StartOrder::new(directions.map(of), grid)
    }

    /// The order of waves whose directions have these points in the square, one for each wave of the grid.
    fn new(places: impl Iterator<Item = Vec2>, grid: Grid) -> StartOrder {
        let mut texels = vec![0; grid.waves as usize];
        let waves = sorted_along_curve(places, grid.waves);
        for (wave, texel) in waves.into_iter().zip(texels_by_tile(grid)) {
            texels[wave as usize] = texel;
        }
        StartOrder { grid, texels }
    }

    /// The number of the texel at which a wave starts. Waves are counted from the first wave of the grid.
    pub fn texel(&self, wave: u32) -> u32 {
        self.texels[wave as usize]
    }

    /// Rearranges texels of the grid that were read back, four floats each, into the order of the waves.
    pub fn in_order_of_waves(&self, read: &[f32]) -> Vec<f32> {
        let read = read.as_chunks::<4>().0;
        let texels = self.texels.iter().map(|texel| read[*texel as usize]);
        texels.collect::<Vec<_>>().into_flattened()
    }

    /// The texels of `uOrder` (`glsl/order.glsl`), for a texture of this height. Texels without a wave have their own
    /// number, which is beyond the last wave.
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

/// The numbers of the waves, sorted by their points along a Hilbert curve. The curve visits cells that contain one to
/// four waves on average. Waves in one cell are in the order of their numbers.
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

/// The texels of a grid that have a wave, tile by tile. Tiles follow each other down a column, so that each strip of
/// rows holds waves from all parts of the sphere. The time of one strip therefore predicts that of the next.
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

/// Bits 0, 2 and 4, moved together. They are a coordinate within a tile in Morton order.
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

/// The point of a direction in a square of side 1, which is the sphere unfolded as an octahedron with equal areas (P.
/// Clarberg, *Fast equal-area mapping of the (hemi)sphere using SIMD*, Journal of Graphics Tools 13 (3), 2008). `share`
/// is the share of the sphere's area above the direction, and `turns` its azimuth in turns, 0 … 1.
fn place(share: f32, turns: f32) -> Vec2 {
    // The distance from the nearer pole in the square, which is 1 at the equator, and its division within a quarter
    // turn.
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

/// 2^32 times the fractional part of the golden ratio (`glsl/direction/fibonacci.glsl`).
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

/// The upper 24 bits as a number from 0 to 1, excluding 1.
fn unit_interval(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;
    use std::collections::BTreeSet;

    /// Grids with many numbers of waves: grids that are as square as possible, and the same waves in wider textures.
    fn grids() -> impl Iterator<Item = Grid> {
        let counts = (1..=200).chain([1000, 1023, 4095, 4099, 65_537]);
        counts.flat_map(|waves| {
            let own = Grid::new(waves);
            let wider = Grid {
                width: own.width + 13,
                height: own.height + 5,
                ..own
            };
            [own, wider]
        })
    }

    /// Protects every wave: in any grid each wave has one texel and each texel at most one wave. Texels beyond the last
    /// wave stay empty, and the two halves of the table are inverses of each other.
    #[test]
    fn every_wave_starts_once() {
        for grid in grids() {
            let waves = grid.waves;
            for directions in [Directions::Random, Directions::Fibonacci] {
                let starts = Starts::new(directions, 5, 3 * waves, waves..2 * waves);
                let order = starts.order(grid);
                let texels: BTreeSet<u32> = (0..waves).map(|wave| order.texel(wave)).collect();
                assert!(texels.into_iter().eq(0..waves), "{grid:?}");
                let table = order.table(grid.height);
                assert_eq!(table.len() as u32, grid.width * grid.height);
                for (number, [wave, x, y, _]) in (0..).zip(&table) {
                    let texel = *y as u32 * grid.width + *x as u32;
                    match number < waves {
                        true => assert_eq!(order.texel(number), texel),
                        false => assert_eq!((*wave as u32, texel), (number, number)),
                    }
                    assert_eq!(table[texel as usize][0] as u32, number);
                }
            }
        }
    }

    /// Protects results that are read back: they are in the order of the waves, without the texels beyond the last
    /// wave.
    #[test]
    fn texels_are_put_in_the_order_of_waves() {
        let grid = Grid::new(1001);
        let order = Starts::new(Directions::Random, 1, 1001, 0..1001).order(grid);
        let table = order.table(grid.height);
        let read = order.in_order_of_waves(table.as_flattened());
        assert_eq!(read.len(), 4 * 1001);
        let numbers = read.as_chunks::<4>().0.iter().map(|texel| texel[0]);
        assert!(numbers.eq((0..1001).map(|wave| wave as f32)));
    }

    /// Protects frames that are drawn in parts, whose times are predicted from earlier rows: every strip of eight rows
    /// holds waves of all eight octants.
    #[test]
    fn strips_of_rows_hold_waves_from_all_over_the_sphere() {
        let (waves, strips) = (65_536, 32);
        let grid = Grid::new(waves);
        let directions: Vec<Vec3> = lattice(waves.into()).map(|d| d.as_vec3()).collect();
        let order = StartOrder::of_directions(directions.iter().copied(), grid);
        let mut met = vec![BTreeSet::new(); strips];
        for (wave, direction) in (0..).zip(&directions) {
            let strip = order.texel(wave) / grid.width / TILE;
            met[strip as usize].insert(direction.cmpgt(Vec3::ZERO).bitmask());
        }
        assert!(met.iter().all(|octants| octants.len() == 8));
    }

    /// Protects the Hilbert curve: it visits every cell once, and consecutive cells share a side.
    #[test]
    fn the_curve_goes_from_cell_to_neighbouring_cell() {
        let levels = 5;
        let along = 1 << levels;
        let mut cells = vec![None; 1 << (2 * levels)];
        for (x, y) in (0..along).flat_map(|y| (0..along).map(move |x| (x, y))) {
            let number = place_on_curve(x, y, levels) as usize;
            assert_eq!(cells[number].replace((x, y)), None);
        }
        for pair in cells.windows(2) {
            let [Some(a), Some(b)] = [pair[0], pair[1]] else {
                panic!("a cell without a number");
            };
            assert_eq!(a.0.abs_diff(b.0) + a.1.abs_diff(b.1), 1);
        }
    }

    /// Protects the square of directions: equal areas contain equal numbers of lattice directions, and directions that
    /// are close to each other in the square are close on the sphere.
    #[test]
    fn the_square_has_equal_areas_and_no_gaps() {
        const SIDE: usize = 8;
        let count = 64_000;
        let mut cells = vec![Vec::new(); SIDE * SIDE];
        for direction in lattice(count) {
            let direction = direction.as_vec3();
            let turns = direction.z.atan2(direction.x) / TAU;
            let at = place(0.5 - 0.5 * direction.y, turns - turns.floor());
            assert!(at.min_element() >= 0.0 && at.max_element() <= 1.0);
            let cell = (at * SIDE as f32).min(Vec2::splat(SIDE as f32 - 0.5));
            cells[cell.y as usize * SIDE + cell.x as usize].push(direction);
        }
        for directions in &cells {
            // Lattice directions at the edge of a cell may be in either cell.
            let off = directions.len().abs_diff(count as usize / cells.len());
            assert!(off < 60, "{off}");
            let mean = directions.iter().sum::<Vec3>() / directions.len() as f32;
            let far = directions.iter().map(|direction| direction.distance(mean));
            // A spherical cap with a 64th of the sphere's area has a radius of 0.25.
            assert!(far.fold(0.0, f32::max) < 0.5);
        }
    }
}
