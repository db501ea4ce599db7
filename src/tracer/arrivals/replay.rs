//! Computes arrivals from the records of the waves of a block, chunk by chunk, in `f64`.

use super::super::Grid;
use super::super::start_order::StartOrder;
use super::events::{EventTable, Events};
use super::passages::Passage;
use super::{ArrivalCounts, OpenVolumes};
use crate::arrival::Arrival;
use crate::bands::{self, BAND_COUNT, Bands};
use glam::DVec3;
use std::ops::Range;
use std::rc::Rc;

/// The factor of the fate in a tally, which is the number of crossings plus this factor times the fate
/// (`glsl/arrivals/chunk.frag`).
const CROSSINGS: u32 = 16_384;

/// The factor of the detector in the whole part of a record, which also holds the iteration (`glsl/arrivals/flight.glsl`).
const ITERATIONS: u32 = 64;

/// The original's texel where no wave is followed any more (`glsl/arrivals/chunk.frag`).
const NO_WAVE: i32 = -1;

/// A record with a greater fraction is a passage. The fraction of a crossing is at most 0.5, and that of a passage is
/// 0.75 (`glsl/arrivals/passages.glsl`).
const MOST_CHORD: f32 = 0.6;

/// The constants from which arrivals are computed.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Maximum reflections of an early arrival.
    pub early_order: u32,
    /// Distance in metres for which waves are followed.
    pub length_limit: f64,
    /// Length in metres of a chord recorded as 1.
    pub chord_unit: f64,
    /// The spheres in which crossings are counted.
    pub detectors: Vec<DetectorDensity>,
    /// Whether records hold the chord in an inner sphere.
    pub has_inner_spheres: bool,
    /// The effect of reflections; `None` if no surface absorbs or scatters.
    pub events: Option<EventTable>,
    /// World position of the shaders' origin in metres.
    pub origin: DVec3,
}

/// The energy densities of crossings of a detector.
#[derive(Clone, Copy, Debug)]
pub struct DetectorDensity {
    /// Energy density per metre of chord of a wave without losses: 1 / (V N), in 1/m³; 0 if the volume is.
    pub density: f64,
    /// The ratio of the open volumes of the detector's sphere and of its inner sphere; `None` without an inner sphere.
    pub inner: Option<f64>,
}

impl DetectorDensity {
    /// The densities of `waves` waves in these volumes.
    pub fn of(volumes: &OpenVolumes, waves: u32) -> DetectorDensity {
        let density = match volumes.whole > 0.0 {
            true => 1.0 / (volumes.whole * f64::from(waves)),
            false => 0.0,
        };
        let ratio = |inner| {
            if inner > 0.0 {
                volumes.whole / inner
            } else {
                0.0
            }
        };
        DetectorDensity {
            density,
            inner: volumes.inner.map(ratio),
        }
    }
}

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
    /// Whether the wave was never scattered, and has passed no solid.
    is_mirrored: bool,
}

/// The passages that waves continue ([`Block::of_passages`]).
#[derive(Clone, Copy, Debug)]
struct Before {
    /// Number of the wave from the source.
    wave: u32,
    /// Reflections before the passage.
    reflections: u32,
}

/// The waves of a block, and their progress.
#[derive(Debug)]
pub struct Block {
    first: u32,
    grid: Grid,
    /// The texels of the waves; `None` if each wave is at the texel of its number.
    order: Option<Rc<StartOrder>>,
    waves: Vec<WaveSoFar>,
    /// The sum over all waves of the initial energy, in the band in which a wave has the most.
    energy_at_start: f64,
    /// The remaining energies of the waves; empty if all energies stay 1.
    energies: Vec<Bands>,
    /// The waves before they passed solids; empty if the block's waves come from the source.
    before: Vec<Before>,
    /// Rows with waves that are still followed.
    pub rows: Range<u32>,
    /// Iterations before the current chunk.
    pub iterations: u32,
}

/// The texels that the passes of a chunk wrote, four floats each.
#[derive(Clone, Copy, Debug)]
pub struct Chunk<'a> {
    pub tally: &'a [f32],
    /// Further words of events, if there is a texture for them.
    pub words: Option<&'a [f32]>,
    pub records: &'a [Vec<f32>],
    /// The records of the waves that were drawn again, in the order of the list.
    pub listed: &'a [Vec<f32>],
    /// Iterations of the chunk.
    pub iterations: u32,
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
    fn texels(&self) -> Range<u32> {
        let Range { start, end } = self.rows;
        start * self.grid.width..(end * self.grid.width).min(self.grid.waves)
    }

    /// The waves in the rows that are still followed, in their order, each with its texel.
    fn waves_in_rows(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
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

    /// Replays the waves through a chunk, and passes their arrivals to `take`: wave by wave, and for each wave in the
    /// order of its flight. Returns the number of arrivals. Passages at solids are added to `passages`.
    pub fn replay(
        &mut self,
        with: &Replay,
        chunk: &Chunk,
        passages: &mut Vec<Passage>,
        take: &mut dyn FnMut(Arrival),
    ) -> u64 {
        let records = chunk.records.len();
        let mut listed = 0;
        let mut taken = 0;
        for (wave, texel) in self.waves_in_rows() {
            if self.waves[wave as usize].fate != Fate::Travelling {
                continue;
            }
            let at = 4 * texel as usize;
            let tally = tally_of(chunk.tally, texel);
            let crossings = (tally % CROSSINGS) as usize;
            let words = chunk.words.map(|words| &words[at..at + 4]);
            let mut events = with
                .events
                .as_ref()
                .map(|table| table.events(chunk.tally[at + 3], words));
            let record = |crossing: usize| {
                let (texels, place) = match crossing < records {
                    true => (&chunk.records[crossing], at),
                    false => {
                        let entry = listed + crossing / records - 1;
                        (&chunk.listed[crossing % records], 4 * entry)
                    }
                };
                &texels[place..place + 4]
            };
            let mut crossing = 0;
            while crossing < crossings {
                let here = record(crossing);
                crossing += 1;
                let iteration = here[1].abs() as u32 % ITERATIONS;
                self.suffer(wave, events.as_mut(), iteration);
                if here[1].abs().fract() > MOST_CHORD {
                    if crossing < crossings {
                        let records = [here, record(crossing)];
                        passages.extend(self.passage(with, wave, iteration, records));
                    }
                    crossing += 1;
                    continue;
                }
                let record = here;
                if let Some(arrival) = self.arrival(with, wave, iteration, record) {
                    take(arrival);
                    taken += 1;
                }
            }
            listed += crossings.saturating_sub(1) / records;
            self.suffer(wave, events.as_mut(), chunk.iterations);
            let so_far = &mut self.waves[wave as usize];
            so_far.length += f64::from(chunk.tally[at]) + f64::from(chunk.tally[at + 1]);
            so_far.fate = Fate::of(tally);
        }
        self.iterations += chunk.iterations;
        taken
    }

    /// Applies the reflections before iteration `until` of the chunk to a wave.
    fn suffer(&mut self, wave: u32, events: Option<&mut Events>, until: u32) {
        let Some(events) = events else {
            return;
        };
        let energy = &mut self.energies[wave as usize];
        let is_mirrored = &mut self.waves[wave as usize].is_mirrored;
        events.suffer(until, energy, is_mirrored);
    }

    /// The recorded arrival; `None` if it is beyond the distance limit or has no energy.
    fn arrival(&self, with: &Replay, wave: u32, iteration: u32, record: &[f32]) -> Option<Arrival> {
        let so_far = &self.waves[wave as usize];
        let length_m = so_far.length + f64::from(record[0]);
        if length_m > with.length_limit {
            return None;
        }
        let number = record[1].abs() as u32 / ITERATIONS;
        let detector = with.detectors.get(number as usize)?;
        let chord = f64::from(record[1].abs().fract());
        let density = chord * with.chord_unit * detector.density;
        let energy = match self.energies.get(wave as usize) {
            Some(left) => left.map(|left| left * density),
            None => [density; BAND_COUNT],
        };
        // Planes may limit a crossing to nothing.
        if energy == [0.0; BAND_COUNT] || chord == 0.0 {
            return None;
        }
        let reflections = self.iterations + iteration;
        let (x, inner_chord) = match with.has_inner_spheres {
            false => (record[2], chord),
            true => {
                let steps = record[2].floor();
                (steps / X_STEPS, f64::from(record[2] - steps))
            }
        };
        let inner = detector
            .inner
            .map_or(1.0, |volumes| inner_chord / chord * volumes);
        Some(Arrival {
            wave: self.before(wave).wave,
            is_early: so_far.is_mirrored && reflections <= with.early_order,
            reflections: self.before(wave).reflections + reflections,
            length_m,
            direction: direction(record[1], x, record[3]),
            energy,
            inner,
            detector: number,
        })
    }

    /// The recorded passage: a record like that of a crossing, and the place. `None` if the passage is beyond the
    /// distance limit or has no energy.
    fn passage(
        &self,
        with: &Replay,
        wave: u32,
        iteration: u32,
        records: [&[f32]; 2],
    ) -> Option<Passage> {
        let [way, place] = records;
        let length_m = self.waves[wave as usize].length + f64::from(way[0]);
        let energy = self.energy(wave as usize);
        if length_m > with.length_limit || energy == [0.0; BAND_COUNT] {
            return None;
        }
        let local = DVec3::new(place[0].into(), place[1].into(), place[2].into());
        let before = self.before(wave);
        Some(Passage {
            wave: before.wave,
            surface: place[3] as u32,
            reflections: before.reflections + self.iterations + iteration,
            point: with.origin + local,
            direction: direction(way[1], way[2], way[3]).as_vec3(),
            length_m,
            energy: energy.map(|energy| energy as f32),
        })
    }

    /// The wave from the source, and its reflections before it became this wave.
    fn before(&self, wave: u32) -> Before {
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

    fn texel(&self, wave: u32) -> u32 {
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

    /// Puts copies of waves with new energies in `places`, as many as there are travelling waves. The waves that are not
    /// followed any more take the other places. Returns the original's texel for each texel, or [`NO_WAVE`].
    pub(super) fn replace(&mut self, places: &[u32], copies: &[(u32, Bands)]) -> Vec<i32> {
        let mut from = vec![NO_WAVE; (self.grid.width * self.grid.height) as usize];
        let (waves, energies) = (self.waves.clone(), self.energies.clone());
        let before: Vec<Before> = (0..self.grid.waves).map(|wave| self.before(wave)).collect();
        self.before.clone_from(&before);
        let mut is_place = vec![false; waves.len()];
        for place in places {
            is_place[*place as usize] = true;
        }
        let others = (0..waves.len()).filter(|wave| !is_place[*wave]);
        let ended = (0..waves.len()).filter(|wave| waves[*wave].fate != Fate::Travelling);
        for (to, wave) in others.zip(ended) {
            self.waves[to] = waves[wave];
            self.energies[to] = energies[wave];
            self.before[to] = before[wave];
        }
        for (place, (original, energy)) in places.iter().zip(copies) {
            from[self.texel(*place) as usize] = self.texel(*original) as i32;
            let (to, original) = (*place as usize, *original as usize);
            self.waves[to] = waves[original];
            self.energies[to] = *energy;
            self.before[to] = before[original];
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

fn tally_of(texels: &[f32], texel: u32) -> u32 {
    texels[4 * texel as usize + 2] as u32
}

/// The steps of a direction's x per unit in a record with a chord in the inner sphere (`glsl/arrivals/flight.glsl`).
const X_STEPS: f32 = 512.0;

/// The unit vector of a record, from x, y and a number with the sign of z.
///
/// The recorded vector has length 1 within 2e-7, and the length of (x, y) has an error of the same amount. The error of
/// the angle is therefore 2e-7 / |z|, and at most √(4e-7) = 6e-4 (0.04°) where z is 0.
fn direction(signed: f32, x: f32, y: f32) -> DVec3 {
    let (x, y) = (f64::from(x), f64::from(y));
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let z = if signed.is_sign_negative() { -z } else { z };
    DVec3::new(x, y, z).normalize()
}
