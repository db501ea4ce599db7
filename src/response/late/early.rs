//! Early arrivals: waves past the listeners' own spheres, which find exact paths. Their crossings also predict how often
//! late waves cross the larger spheres.

use super::Heard;
use super::tally::Tally;
use crate::bands;
use crate::error::Error;
use crate::response::{Arrival, ResponseSettings};
use crate::tracer::{ArrivalCounts, ArrivalSettings, Detector, Tracer, WavesToFollow};
use std::cmp::Ordering;
use std::ops::Range;

/// Mean number of crossings of a wave in a chunk. A chunk takes as long as ten iterations, and a wave with more
/// crossings than can be recorded (four) is drawn again. In a room of 8 × 3 × 5 m a response of 65,536 waves takes
/// 0.39, 0.37, 0.35, 0.33 and 0.33 s with 8, 12, 16, 24 and 32 iterations per chunk, which correspond to 0.6 to 2.6
/// crossings.
const CROSSINGS_IN_CHUNK: f64 = 2.0;

/// Minimum number of iterations in a chunk with one listener.
const LEAST_ITERATIONS: u32 = 8;

/// Minimum number of iterations in a chunk with several listeners, whose iterations take longer.
const LEAST_ITERATIONS_SHARED: u32 = 1;

/// Traces the `further` waves of early arrivals past the listeners' own spheres, in each of the groups of bands.
pub(super) fn trace(
    tracer: &mut Tracer,
    heard: &[Heard],
    (groups, further): (&[Range<usize>], Range<u32>),
    (settings, how): (&ResponseSettings, &ArrivalSettings),
    tallies: &mut [Tally],
) -> Result<(), Error> {
    if further.is_empty() {
        return Ok(());
    }
    let few = how.clone().with_iterations(how.early_order + 1);
    let all = WavesToFollow::Numbers(further);
    let own = |one: &Heard| Detector::of(one.pair.listener);
    let own: Vec<Detector> = heard.iter().map(own).collect();
    let mut sort = |arrival: Arrival| {
        let of = arrival.detector as usize;
        match (arrival.is_early, &mut tallies[of].near) {
            (false, Some(near)) => heard[of].medium.add(&mut near.own, &arrival),
            _ => tallies[of].early.push(arrival),
        }
    };
    let pair = heard[0].pair;
    let heard_in = (pair, &own[..]);
    let mut counts = ArrivalCounts::of_none();
    for bands in groups {
        let few = few.clone().with_bands(bands.clone());
        let followed =
            tracer.arrivals_through(heard_in, &settings.trace, &few, &all, &mut sort, None)?;
        counts = counts.and(followed.counts());
    }
    // With scattering, sound is late after fewer reflections.
    let travel_on = (!pair.scene.scatters()).then_some(counts.cut_off > 0);
    let crossings = crossings_an_iteration(&counts) / heard.len() as f64;
    for tally in tallies {
        (tally.crossings, tally.travel_on) = (crossings, travel_on);
    }
    Ok(())
}

/// Sorts arrivals that came in chunks of iterations for each band group in turn, and merges the same crossings.
pub(super) fn sort(early: &mut Vec<Arrival>) {
    early.sort_by(in_order);
    early.dedup_by(|second, first| is_added(first, second));
}

/// Orders arrivals by wave, and along each wave by time.
fn in_order(a: &Arrival, b: &Arrival) -> Ordering {
    let by_length = || a.length_m.total_cmp(&b.length_m);
    a.wave.cmp(&b.wave).then_with(by_length)
}

/// Adds the energies of the second arrival to the first if both are the same crossing of the same wave, followed for
/// different bands.
fn is_added(first: &mut Arrival, second: &Arrival) -> bool {
    let is_same = first.wave == second.wave && first.length_m == second.length_m;
    if is_same {
        bands::add(&mut first.energy, &second.energy);
    }
    is_same
}

/// Iterations of a chunk of late arrivals.
pub(super) fn chunk(heard: &[Heard], tallies: &[Tally], how: &ArrivalSettings) -> u32 {
    let least = match heard.len() {
        1 => LEAST_ITERATIONS,
        _ => LEAST_ITERATIONS_SHARED,
    };
    let of_own = tallies.iter().map(|tally| tally.crossings);
    let crossings = growth(heard) * of_own.sum::<f64>();
    iterations_in_chunk(crossings, least, how.iterations_in_chunk)
}

/// The ratio of the cross sections of the detectors of late arrivals and of the listeners.
fn growth(heard: &[Heard]) -> f64 {
    let square = |radius_m: f32| f64::from(radius_m).powi(2);
    let late: f64 = heard.iter().map(|one| square(one.late.radius_m)).sum();
    let own = heard.iter().map(|one| square(one.pair.listener.radius));
    late / own.sum::<f64>()
}

/// Mean crossings of the listener per wave and iteration.
fn crossings_an_iteration(counts: &ArrivalCounts) -> f64 {
    counts.arrivals as f64 / (counts.waves as f64 * f64::from(counts.iterations)).max(1.0)
}

/// Iterations of a chunk for the given crossings per iteration, at least `least`, but at most `most`.
fn iterations_in_chunk(crossings: f64, least: u32, most: u32) -> u32 {
    let fit = CROSSINGS_IN_CHUNK / crossings;
    (fit as u32).max(least).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the time that late arrivals take: a chunk has several crossings, at least one iteration and at most the
    /// limit.
    #[test]
    fn chunks_are_short_where_waves_cross_often() {
        for (crossings, iterations) in [(0.0, 64), (0.01, 64), (0.1, 20), (0.25, 8), (3.0, 8)] {
            assert_eq!(
                iterations_in_chunk(crossings, 8, 64),
                iterations,
                "{crossings}"
            );
        }
        // The loop limit may allow fewer iterations than intended.
        assert_eq!(iterations_in_chunk(0.01, 8, 20), 20);
        assert_eq!(iterations_in_chunk(3.0, 8, 5), 5);
    }
}
