//! From records to arrivals: the waves of a block, chunk by chunk, in `f64`.

use super::super::Grid;
use super::{Arrival, ArrivalCounts};
use crate::bands::BAND_COUNT;
use glam::DVec3;
use std::ops::Range;

/// In a tally crossings count 1, fates this (`glsl/arrivals/chunk.frag`).
const CROSSINGS: u32 = 1024;

/// What arrivals are computed with.
#[derive(Clone, Copy, Debug)]
pub struct Replay {
    /// Reflections of an early arrival at the most.
    pub early_order: u32,
    /// Metres that waves are followed.
    pub length_limit: f64,
    /// Metres of a chord that is recorded as 1.
    pub chord_unit: f64,
    /// Energy density of a metre of chord of a wave that has lost nothing: 1 / (V N), in 1/m³.
    pub density: f64,
}

/// A wave that is drawn once more, because it crosses the listener oftener than is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Number in the block.
    pub wave: u32,
    /// Crossings that are recorded already.
    pub passed_over: u32,
}

/// What became of a wave until the end of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Travelling,
    Gone,
    GivenUp,
    Flown,
}

impl Fate {
    fn of(tally: u32) -> Fate {
        match tally / CROSSINGS {
            0 => Fate::Travelling,
            2 => Fate::GivenUp,
            3 => Fate::Flown,
            _ => Fate::Gone,
        }
    }
}

/// A wave at the end of a chunk.
#[derive(Clone, Copy, Debug)]
struct WaveSoFar {
    length: f64,
    fate: Fate,
}

/// The waves of a block, and how far they have come.
#[derive(Debug)]
pub struct Block {
    first: u32,
    grid: Grid,
    waves: Vec<WaveSoFar>,
    /// Rows that have waves which are followed.
    pub rows: Range<u32>,
    /// Iterations before the chunk.
    pub iterations: u32,
}

/// What the passes of a chunk wrote.
#[derive(Clone, Copy, Debug)]
pub struct Chunk<'a> {
    /// The tally, then the records: four floats a texel.
    pub texels: &'a [Vec<f32>],
    /// What was drawn once more, by number in the block.
    pub list: &'a [Listed],
    /// The records of these.
    pub listed: &'a [Vec<f32>],
    /// Its iterations.
    pub iterations: u32,
}

impl Block {
    /// Waves at the source: those of the grid, from this number on.
    pub fn new(first: u32, grid: Grid) -> Block {
        let start = WaveSoFar {
            length: 0.0,
            fate: Fate::Travelling,
        };
        Block {
            first,
            grid,
            waves: vec![start; grid.waves as usize],
            rows: 0..grid.height,
            iterations: 0,
        }
    }

    fn numbers(&self) -> Range<u32> {
        let Range { start, end } = self.rows;
        start * self.grid.width..(end * self.grid.width).min(self.grid.waves)
    }

    /// The waves that cross the listener oftener than is recorded, once for each so many
    /// crossings.
    pub fn list(&self, texels: &[Vec<f32>]) -> Vec<Listed> {
        let records = texels.len() as u32 - 1;
        let mut list = Vec::new();
        for wave in self.numbers() {
            let crossings = tally(&texels[0], wave) % CROSSINGS;
            let further = (records..crossings).step_by(records as usize);
            list.extend(further.map(|passed_over| Listed { wave, passed_over }));
        }
        list
    }

    /// The rows in which waves are still followed after the chunk.
    pub fn rows_travelling(&self, texels: &[Vec<f32>]) -> Range<u32> {
        let mut travels = self
            .numbers()
            .filter(|&wave| Fate::of(tally(&texels[0], wave)) == Fate::Travelling);
        let first = travels.next();
        let last = travels.next_back().or(first);
        let row = |wave: u32| wave / self.grid.width;
        match (first, last) {
            (Some(first), Some(last)) => row(first)..row(last) + 1,
            _ => 0..0,
        }
    }

    /// Takes the waves through a chunk, and gives their arrivals: wave by wave, in the order of
    /// their flight.
    pub fn replay(&mut self, with: &Replay, chunk: &Chunk, take: &mut dyn FnMut(Arrival)) -> u64 {
        let records = chunk.texels.len() - 1;
        let mut listed = 0;
        let mut taken = 0;
        for wave in self.numbers() {
            let at = 4 * wave as usize;
            let tally = tally(&chunk.texels[0], wave);
            let crossings = (tally % CROSSINGS) as usize;
            for crossing in 0..crossings {
                let record = if crossing < records {
                    &chunk.texels[1 + crossing][at..at + 4]
                } else {
                    let place = 4 * (listed + crossing / records - 1);
                    &chunk.listed[crossing % records][place..place + 4]
                };
                if let Some(arrival) = self.arrival(with, wave, record) {
                    take(arrival);
                    taken += 1;
                }
            }
            listed += (crossings.max(1) - 1) / records;
            let flown = &chunk.texels[0][at..at + 2];
            let so_far = &mut self.waves[wave as usize];
            so_far.length += f64::from(flown[0]) + f64::from(flown[1]);
            so_far.fate = Fate::of(tally);
        }
        debug_assert_eq!(listed, chunk.list.len());
        self.iterations += chunk.iterations;
        taken
    }

    fn arrival(&self, with: &Replay, wave: u32, record: &[f32]) -> Option<Arrival> {
        let length_m = self.waves[wave as usize].length + f64::from(record[0]);
        if length_m > with.length_limit {
            return None;
        }
        let share = f64::from(record[1].abs());
        let (iteration, chord) = (share.floor() as u32, share.fract() * with.chord_unit);
        Some(Arrival {
            wave: self.first + wave,
            order_is_early: self.iterations + iteration <= with.early_order,
            length_m,
            direction: direction(record),
            energy: [chord * with.density; BAND_COUNT],
        })
    }

    /// Adds what became of the waves.
    pub fn count(&self, counts: &mut ArrivalCounts) {
        counts.waves += self.waves.len() as u64;
        counts.iterations = counts.iterations.max(self.iterations);
        for wave in &self.waves {
            *match wave.fate {
                Fate::Travelling => &mut counts.cut_off,
                Fate::Gone => &mut counts.gone,
                Fate::GivenUp => &mut counts.step_limit_reached,
                Fate::Flown => &mut counts.flown,
            } += 1;
        }
    }
}

fn tally(texels: &[f32], wave: u32) -> u32 {
    texels[4 * wave as usize + 2] as u32
}

/// The unit vector of which a record holds x, y and the sign of z.
///
/// Its length is 1 within 2e-7, and so is that of x and y within as much of what it was: the
/// angle is off by 2e-7 / |z|, and by √(4e-7) = 6e-4 (0.04°) at the most, where z is 0.
fn direction(record: &[f32]) -> DVec3 {
    let (x, y) = (f64::from(record[2]), f64::from(record[3]));
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let z = if record[1].is_sign_negative() { -z } else { z };
    DVec3::new(x, y, z).normalize()
}
