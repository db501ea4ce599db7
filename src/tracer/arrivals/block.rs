//! The waves of a block: their progress, places and energies.

use super::super::Grid;
use super::super::start_order::StartOrder;
use super::ArrivalCounts;
use super::passages::Passage;
use crate::bands::{self, BAND_COUNT, Bands};
use std::ops::Range;
use std::rc::Rc;

/// The factor of the fate in a tally, which is the number of crossings plus this factor times the fate
/// (`glsl/arrivals/chunk.frag`).
pub(super) const CROSSINGS: u32 = 16_384;

/// The original's texel where no wave is followed any more (`glsl/arrivals/chunk.frag`).
const NO_WAVE: i32 = -1;

/// A place whose wave is not known yet.
const NO_SOURCE: u32 = u32::MAX;

/// A wave that is drawn again because it has more crossings than records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Number of its texel in the block.
    pub texel: u32,
    /// Crossings already recorded.
    pub passed_over: u32,
}

/// The state of a wave at the end of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    Travelling,
    Gone,
    GivenUp,
    Flown,
}

impl Fate {
    pub fn of(tally: u32) -> Fate {
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
pub(super) struct WaveSoFar {
    pub length: f64,
    pub fate: Fate,
    /// Whether the wave was never scattered, and has passed no solid.
    pub is_mirrored: bool,
}

/// The passages that waves continue ([`Block::of_passages`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Before {
    /// Number of the wave from the source.
    pub wave: u32,
    /// Reflections before the passage.
    pub reflections: u32,
}

/// The waves of a block, and their progress.
#[derive(Debug)]
pub struct Block {
    pub(super) first: u32,
    pub(super) grid: Grid,
    /// The texels of the waves; `None` if each wave is at the texel of its number.
    pub(super) order: Option<Rc<StartOrder>>,
    pub(super) waves: Vec<WaveSoFar>,
    /// The sum over all waves of the initial energy, in the band in which a wave has the most.
    pub(super) energy_at_start: f64,
    /// The remaining energies of the waves; empty if all energies stay 1.
    pub(super) energies: Vec<Bands>,
    /// The waves before they passed solids; empty if the block's waves come from the source.
    pub(super) before: Vec<Before>,
    spare: Spare,
    /// Rows with waves that are still followed.
    pub rows: Range<u32>,
    /// Iterations before the current chunk.
    pub iterations: u32,
}

/// Memory that the next rearrangement of the waves takes.
#[derive(Debug, Default)]
struct Spare {
    waves: Vec<WaveSoFar>,
    energies: Vec<Bands>,
    before: Vec<Before>,
}

/// Puts a copy of the item at the source in each place. `spare` keeps the memory of the old items.
fn rearrange<T: Copy>(all: &mut Vec<T>, spare: &mut Vec<T>, sources: &[(u32, f64)]) {
    spare.clear();
    spare.extend(sources.iter().map(|(source, _)| all[*source as usize]));
    std::mem::swap(all, spare);
}

impl Block {
    /// Waves at the source: the waves of the grid in this order, numbered from `first`, with their initial energies.
    /// The energies are empty if all waves start with 1 and lose nothing.
    pub fn new(
        first: u32,
        (grid, order): (Grid, Option<Rc<StartOrder>>),
        energies: Vec<Bands>,
    ) -> Block {
        let start = WaveSoFar {
            length: 0.0,
            fate: Fate::Travelling,
            is_mirrored: true,
        };
        let most = |energy: &Bands| energy.iter().copied().fold(0.0, f64::max);
        let at_start = energies.iter().map(most).sum();
        Block {
            first,
            grid,
            order,
            energy_at_start: if energies.is_empty() {
                f64::from(grid.waves)
            } else {
                at_start
            },
            waves: vec![start; grid.waves as usize],
            energies,
            before: Vec::new(),
            spare: Spare::default(),
            rows: 0..grid.height,
            iterations: 0,
        }
    }

    /// The waves that continue passages, in their order.
    pub fn of_passages(
        (grid, order): (Grid, Option<Rc<StartOrder>>),
        passages: &[Passage],
    ) -> Block {
        let energy = |passage: &Passage| passage.energy.map(f64::from);
        let mut block = Block::new(0, (grid, order), passages.iter().map(energy).collect());
        for (wave, passage) in block.waves.iter_mut().zip(passages) {
            wave.length = passage.length_m;
            wave.is_mirrored = false;
        }
        let before = |passage: &Passage| Before {
            wave: passage.wave,
            reflections: passage.reflections,
        };
        block.before = passages.iter().map(before).collect();
        block
    }

    /// The texels with waves in the rows that are still followed.
    pub(super) fn texels(&self) -> Range<u32> {
        let Range { start, end } = self.rows;
        start * self.grid.width..(end * self.grid.width).min(self.grid.waves)
    }

    /// The waves in the rows that are still followed, in their order, each with its texel.
    pub(super) fn waves_in_rows(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (texels, order) = (self.texels(), self.order.clone());
        let numbers = match order {
            None => texels.clone(),
            Some(_) => 0..self.grid.waves,
        };
        let with_texel = move |wave| match &order {
            None => (wave, wave),
            Some(order) => (wave, order.texel(wave)),
        };
        let waves = numbers.map(with_texel);
        waves.filter(move |(_, texel)| texels.contains(texel))
    }

    /// The waves that have more than `records` crossings. A wave is listed once for each further `records` crossings.
    pub fn list(&self, tally: &[f32], records: u32) -> Vec<Listed> {
        let mut list = Vec::new();
        for (_, texel) in self.waves_in_rows() {
            let crossings = tally_of(tally, texel) % CROSSINGS;
            let further = (records..crossings).step_by(records as usize);
            list.extend(further.map(|passed_over| Listed { texel, passed_over }));
        }
        list
    }

    /// The rows in which waves are still followed after the chunk.
    pub fn rows_travelling(&self, tally: &[f32]) -> Range<u32> {
        let travels = |texel: &u32| Fate::of(tally_of(tally, *texel)) == Fate::Travelling;
        let mut travelling = self.texels().filter(travels);
        let first = travelling.next();
        let last = travelling.next_back().or(first);
        let row = |texel: u32| texel / self.grid.width;
        match (first, last) {
            (Some(first), Some(last)) => row(first)..row(last) + 1,
            _ => 0..0,
        }
    }

    /// The wave from the source, and its reflections before it became this wave.
    pub(super) fn before(&self, wave: u32) -> Before {
        let from_source = Before {
            wave: self.first + wave,
            reflections: 0,
        };
        self.before
            .get(wave as usize)
            .copied()
            .unwrap_or(from_source)
    }

    /// The waves that are still followed, in their order. Empty if all energies stay 1.
    pub(super) fn travelling(&self) -> Vec<u32> {
        let waves = (0..self.energies.len() as u32).zip(&self.waves);
        let travelling = waves.filter(|(_, wave)| wave.fate == Fate::Travelling);
        travelling.map(|(number, _)| number).collect()
    }

    /// Number of rows that hold this number of waves.
    pub(super) fn rows_of(&self, waves: u32) -> u32 {
        waves.div_ceil(self.grid.width)
    }

    pub(super) fn texel(&self, wave: u32) -> u32 {
        self.order.as_ref().map_or(wave, |order| order.texel(wave))
    }

    /// The waves whose texels are the first `count` of the grid, in the order of the texels.
    pub(super) fn first_places(&self, count: usize) -> Vec<u32> {
        let mut places = vec![0; count];
        for wave in 0..self.grid.waves {
            if let Some(place) = places.get_mut(self.texel(wave) as usize) {
                *place = wave;
            }
        }
        places
    }

    /// Puts copies of waves, each with a share of its original's energy, in `places`, as many as there are travelling
    /// waves. The waves that are not followed any more take the other places. Returns the original's texel for each
    /// texel, or [`NO_WAVE`].
    pub(super) fn replace(&mut self, places: &[u32], copies: &[(u32, f64)]) -> Vec<i32> {
        let mut from = vec![NO_WAVE; (self.grid.width * self.grid.height) as usize];
        let mut sources = vec![(NO_SOURCE, 1.0); self.waves.len()];
        for (place, (original, share)) in places.iter().zip(copies) {
            from[self.texel(*place) as usize] = self.texel(*original) as i32;
            sources[*place as usize] = (*original, *share);
        }
        let ended = (0..).zip(&self.waves);
        let ended = ended.filter(|(_, wave)| wave.fate != Fate::Travelling);
        let others = sources.iter_mut().filter(|(wave, _)| *wave == NO_SOURCE);
        for ((source, _), (wave, _)) in others.zip(ended) {
            *source = wave;
        }
        if self.before.is_empty() {
            self.before = (0..self.grid.waves).map(|wave| self.before(wave)).collect();
        }
        let spare = &mut self.spare;
        rearrange(&mut self.waves, &mut spare.waves, &sources);
        rearrange(&mut self.before, &mut spare.before, &sources);
        rearrange(&mut self.energies, &mut spare.energies, &sources);
        for (energy, (_, share)) in self.energies.iter_mut().zip(&sources) {
            *energy = energy.map(|energy| share * energy);
        }
        from
    }

    /// Number of waves of the block.
    pub(super) fn waves(&self) -> u32 {
        self.grid.waves
    }

    /// Metres that a wave has flown since the source.
    pub(super) fn length_m(&self, wave: u32) -> f64 {
        self.waves[wave as usize].length
    }

    /// The sum over all waves of the initial energy, in the band in which a wave has the most.
    pub(super) fn energy_at_start(&self) -> f64 {
        self.energy_at_start
    }

    /// The remaining energy of the wave with this number.
    pub(super) fn energy(&self, number: usize) -> Bands {
        let left = self.energies.get(number).copied();
        left.unwrap_or([1.0; BAND_COUNT])
    }

    /// Whether, in at least one band, the travelling waves have more than this share of the initial energy of all
    /// waves.
    pub fn has_energy(&self, share: f64) -> bool {
        if self.energies.is_empty() || share == 0.0 {
            return true;
        }
        let mut all = [0.0; BAND_COUNT];
        for (number, wave) in self.waves.iter().enumerate() {
            if wave.fate == Fate::Travelling {
                bands::add(&mut all, &self.energies[number]);
            }
        }
        let least = share * self.energy_at_start;
        all.iter().any(|energy| *energy > least)
    }

    /// Stops tracing all waves, because their remaining energy is negligible. They count as waves that have flown the
    /// requested distance.
    pub fn end_flights(&mut self) {
        for wave in &mut self.waves {
            if wave.fate == Fate::Travelling {
                wave.fate = Fate::Flown;
            }
        }
    }

    /// Distances in metres that the cut-off waves had flown.
    pub fn cut_off_m(&self) -> impl Iterator<Item = f64> + '_ {
        let travelling = |wave: &&WaveSoFar| wave.fate == Fate::Travelling;
        self.waves.iter().filter(travelling).map(|wave| wave.length)
    }

    /// Adds the fates of the waves to the counts.
    pub fn count(&self, counts: &mut ArrivalCounts) {
        counts.waves += self.waves.len() as u64;
        counts.iterations = counts.iterations.max(self.iterations);
        for (number, wave) in self.waves.iter().enumerate() {
            *match wave.fate {
                Fate::Travelling => &mut counts.cut_off,
                Fate::Gone => &mut counts.gone,
                Fate::GivenUp => &mut counts.step_limit_reached,
                Fate::Flown => &mut counts.flown,
            } += 1;
            if matches!(wave.fate, Fate::Travelling | Fate::Flown) {
                bands::add(&mut counts.energy_under_way, &self.energy(number));
            }
        }
    }
}

pub(super) fn tally_of(texels: &[f32], texel: u32) -> u32 {
    texels[4 * texel as usize + 2] as u32
}

/// The crossings of the wave that has the most.
pub(super) fn most_crossings(tally: &[f32]) -> u32 {
    let texels = 0..(tally.len() / 4) as u32;
    let crossings = texels.map(|texel| tally_of(tally, texel) % CROSSINGS);
    crossings.max().unwrap_or(0)
}
