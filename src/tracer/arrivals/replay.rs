//! Computes arrivals from the records of the waves of a block, chunk by chunk, in `f64`.

use super::OpenVolumes;
use super::block::{Block, CROSSINGS, Fate, tally_of};
use super::events::{EventTable, Events};
use super::passages::Passage;
use crate::arrival::Arrival;
use crate::bands::BAND_COUNT;
use glam::DVec3;

/// The factor of the detector in the whole part of a record, which also holds the iteration (`glsl/arrivals/flight.glsl`).
const ITERATIONS: u32 = 64;

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
