//! Start directions by importance: more waves where those start that bring the end of the decay.
//!
//! Between two hard walls sound goes to and fro long after all other sound has been absorbed, and the end of the decay
//! is what a few waves in ten thousand bring. So the first waves of a response ([`Pilot`]) tell how
//! much waves of each direction matter. Where there are enough of those that matter the others start as evenly as
//! the first ones. Where there are too few, half of the others start where these did and half evenly, each with the
//! weight that makes up for it: sums stay without bias, and no wave has a weight of more than about 2. The first ones are
//! dropped then, as they have decided where the others start.

mod cells;
mod pilot;

pub(super) use pilot::Pilot;

use crate::rng::{hash, unit_interval};
use crate::trace::{Directions, Settings, Start};
use cells::Cells;
use glam::Vec3;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// One wave of so many is a first one.
const ONE_OF: u32 = 8;

/// The least and the greatest number of first waves: from fewer nothing can be known, and more are not needed.
const FIRST_WAVES: RangeInclusive<u32> = 1024..=65_536;

/// So many waves of one energy are enough behind what comes after each moment: a level is then 0.06 dB off, and a
/// decay time, told from 30 dB, 0.3 %.
const ENOUGH_WAVES: f64 = 5000.0;

/// The share of waves that start evenly.
const EVEN_SHARE: f64 = 0.5;

/// First waves in a cell on average: what is known of a direction is blurred over a cell and those about it.
const WAVES_IN_CELL: f64 = 4.0;

/// How many first waves there are; none where the waves are too few, and where their directions are a lattice, which
/// is even as a whole alone.
pub(super) fn first_waves(trace: &Settings) -> u32 {
    let first = (trace.waves / ONE_OF).min(*FIRST_WAVES.end());
    match FIRST_WAVES.contains(&first) && trace.directions == Directions::Random {
        true => first,
        false => 0,
    }
}

/// Where waves start, after the first ones.
pub(super) struct Importance {
    cells: Cells,
    /// Probability of each cell and those before it.
    cumulative: Vec<f64>,
}

impl Importance {
    /// As the first ones of so many waves tell, which started in these directions; `None` where waves may start evenly.
    pub fn of(pilot: Pilot, starts: &[Vec3], waves: u32) -> Option<Importance> {
        let pilots = starts.len() as f64;
        let importance = pilot.importance(ENOUGH_WAVES * pilots / f64::from(waves))?;
        let cells = Cells::about(pilots / WAVES_IN_CELL);
        let mut wanted = vec![0.0; cells.count()];
        for (start, importance) in starts.iter().zip(&importance) {
            let cell = cells.of(start.as_dvec3());
            let near: Vec<usize> = cells.about_cell(cell).collect();
            // As much in its own cell as in all about it.
            wanted[cell] += importance;
            for cell in &near {
                wanted[*cell] += importance / near.len() as f64;
            }
        }
        let all: f64 = wanted.iter().sum();
        if all <= 0.0 {
            return None;
        }
        let mut sum = 0.0;
        let cumulative = wanted.iter().enumerate().map(|(cell, wanted)| {
            let even = cells.direction(cell, [0.5; 2]).1 / (4.0 * PI);
            sum += EVEN_SHARE * even + (1.0 - EVEN_SHARE) * wanted / all;
            sum
        });
        Some(Importance {
            cumulative: cumulative.collect(),
            cells,
        })
    }

    /// Starts of so many waves, by seed. Each batch of them (wave by wave in turns) is spread over all cells.
    pub fn starts(&self, waves: u32, batches: usize, seed: u32) -> Vec<Start> {
        let numbers = hash(u64::from(seed));
        let all = self.total();
        let start = |wave: usize| {
            let random =
                |which: usize| unit_interval(hash(numbers.wrapping_add((3 * wave + which) as u64)));
            let in_batch = (waves as usize - wave % batches).div_ceil(batches);
            let share = ((wave / batches) as f64 + random(0)) / in_batch as f64;
            self.start(share * all, [random(1), random(2)])
        };
        (0..waves as usize).map(start).collect()
    }

    /// 1 but for the sizes of cells, which are those at their middles.
    fn total(&self) -> f64 {
        self.cumulative[self.cumulative.len() - 1]
    }

    /// The start at a place in the cell in which this much of the probability ends.
    fn start(&self, until: f64, place: [f64; 2]) -> Start {
        let cell = self.cumulative.partition_point(|sum| *sum <= until);
        let cell = cell.min(self.cumulative.len() - 1);
        let before = if cell == 0 {
            0.0
        } else {
            self.cumulative[cell - 1]
        };
        let probability = (self.cumulative[cell] - before) / self.total();
        let (direction, steradians) = self.cells.direction(cell, place);
        Start {
            direction: direction.as_vec3(),
            weight: steradians / (4.0 * PI * probability),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;
    use crate::sphere::lattice;
    use glam::DVec3;

    const WAVES: u32 = 1 << 15;

    /// What the waves near the z axis tell that alone bring the end of a decay.
    fn importance_of_few() -> Importance {
        let directions: Vec<Vec3> = lattice(u64::from(WAVES / ONE_OF))
            .map(|d| d.as_vec3())
            .collect();
        let mut pilot = Pilot::new(directions.len() as u32, 1.0);
        for (wave, direction) in directions.iter().enumerate() {
            pilot.add(wave as u32, 0.1, &[1.0; BAND_COUNT]);
            if is_important(direction.as_dvec3()) {
                pilot.add(wave as u32, 0.9, &[1.0; BAND_COUNT]);
            }
        }
        Importance::of(pilot, &directions, WAVES).expect("few waves bring the end")
    }

    /// Within 0.08 of the z axis: 0.32 % of all directions.
    fn is_important(direction: DVec3) -> bool {
        direction.truncate().length() < 0.08
    }

    /// Protects sums over waves from bias: the weights of those in any part of the sphere add up to its solid angle, and
    /// none is much above 2.
    #[test]
    fn weights_make_up_for_uneven_directions() {
        const MANY: u32 = 1 << 18;
        let starts = importance_of_few().starts(MANY, 16, 7);
        let heaviest = starts.iter().map(|start| start.weight).fold(0.0, f64::max);
        assert!(heaviest < 2.2, "{heaviest}");
        let share = |part: &dyn Fn(DVec3) -> bool| {
            let inside = starts
                .iter()
                .filter(|start| part(start.direction.as_dvec3()));
            inside.map(|start| start.weight).sum::<f64>() / f64::from(MANY)
        };
        let part = 1.0 - (1.0_f64 - 0.08 * 0.08).sqrt();
        // Some 20,000 waves: 0.7 %.
        let found = share(&is_important) / part;
        assert!((found - 1.0).abs() < 0.03, "{found}");
        assert!((share(&|_| true) - 1.0).abs() < 0.005);
        for normal in [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, 2.0)] {
            let half = share(&|direction| direction.dot(normal) > 0.0);
            assert!((half - 0.5).abs() < 0.01, "{half}");
        }
    }

    /// Protects what this is for: many more waves go where few brought the end, in each batch as many.
    #[test]
    fn more_waves_start_where_they_matter() {
        const BATCHES: usize = 16;
        let starts = importance_of_few().starts(WAVES, BATCHES, 7);
        let mut found = [0; BATCHES];
        for (wave, start) in starts.iter().enumerate() {
            found[wave % BATCHES] += usize::from(is_important(start.direction.as_dvec3()));
        }
        // Evenly there would be 6 or 7 in a batch.
        assert!(found.iter().all(|found| *found > 100), "{found:?}");
        let most = found.iter().max().zip(found.iter().min());
        assert!(
            most.is_some_and(|(most, least)| most - least < 40),
            "{found:?}"
        );
    }

    /// Protects lattices, which are even as a whole alone, and runs of few waves.
    #[test]
    fn some_waves_tell_nothing_of_others() {
        let first = |waves: u32, directions| {
            first_waves(
                &Settings::default()
                    .with_waves(waves)
                    .with_directions(directions),
            )
        };
        assert_eq!(first(1 << 18, Directions::Random), 1 << 15);
        assert_eq!(first(1 << 24, Directions::Random), 1 << 16);
        assert_eq!(first(8191, Directions::Random), 0);
        assert_eq!(first(1 << 18, Directions::Fibonacci), 0);
    }
}
