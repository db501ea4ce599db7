//! Selects the paths to solve for: not one for each wave.
//!
//! A sequence of planes has one path. One of curved surfaces may have many, and each is found from a
//! wave that passes close by; but near a focus every wave passes the listener repeatedly, and solving
//! for all of them takes minutes. So at most [`SOLVED_OF_A_SEQUENCE`] waves of a sequence are solved
//! for, spread evenly over its waves, and each other wave gets the result of the one that was mirrored
//! nearest to it. A path found by fewer than one in this number of its sequence's waves may be missed.
//! In total at most [`SOLVED_AT_CURVES`] are solved for, of the sequences with the fewest reflections
//! first, then of those with the most waves; the waves of all other sequences remain statistical.

use super::NoPath;
use super::candidates::Candidates;
use super::paths::FoundBy;
use super::surfaces::{Surfaces, Vertex};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::HashMap;
use std::ops::Range;

/// Maximum number of waves solved for in a sequence with a curved surface.
const SOLVED_OF_A_SEQUENCE: usize = 512;

/// Maximum number of waves solved for at curved surfaces: a few seconds on one core, a fraction of
/// a millisecond each.
const SOLVED_AT_CURVES: usize = 1 << 15;

/// A sequence of surfaces to find a path for, and the points to start from.
pub(super) struct Job<'a> {
    pub vertices: &'a [Vertex],
    /// The candidates that it represents.
    pub found_by: FoundBy,
}

/// The paths to solve for.
pub(super) struct Jobs<'a> {
    pub jobs: Vec<Job<'a>>,
    /// For each candidate the index of its job.
    pub job_of: Vec<Result<usize, NoPath>>,
    candidates: &'a Candidates,
}

/// The kind of sheet at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Mirror {
    NotExact,
    /// A plane, by the surface's number and its sheet's id, which identifies the sheet of a surface. A sequence of
    /// planes has one path for all waves.
    Flat(u32, u64),
    /// A curved sheet, solved for from the wave's own vertices, by the surface's number.
    Curved(u32),
}

impl<'a> Jobs<'a> {
    /// Jobs for the direct sound, one for each sequence of planes, and several for each sequence with
    /// a curved surface.
    pub fn new(surfaces: &Surfaces, candidates: &'a Candidates) -> Jobs<'a> {
        let mirror = |vertex: &Vertex| match surfaces.sheet(vertex) {
            Err(_) => Mirror::NotExact,
            Ok(sheet) if sheet.is_flat() => Mirror::Flat(vertex.surface, sheet.id),
            Ok(_) => Mirror::Curved(vertex.surface),
        };
        let all = candidates.vertices();
        let mirrors: Vec<Mirror> = all.par_iter().map(mirror).collect();
        let ranges: Vec<Range<usize>> = candidates.ranges().collect();
        let mut jobs = Jobs {
            jobs: vec![Job {
                vertices: &[],
                // It is searched for, whether a wave finds it or not.
                found_by: FoundBy {
                    waves: 0,
                    search: true,
                },
            }],
            job_of: vec![Err(NoPath::NotExact); candidates.len()],
            candidates,
        };
        let mut flat: HashMap<&[Mirror], usize> = HashMap::from([(&[][..], 0)]);
        let mut curved: HashMap<&[Mirror], Vec<usize>> = HashMap::new();
        for (index, range) in ranges.iter().enumerate() {
            let sequence = &mirrors[range.clone()];
            if sequence.contains(&Mirror::NotExact) {
                continue;
            }
            if sequence.iter().any(|m| matches!(m, Mirror::Curved(_))) {
                curved.entry(sequence).or_default().push(index);
                continue;
            }
            let known = flat.entry(sequence).or_insert(jobs.jobs.len());
            if *known == jobs.jobs.len() {
                jobs.add(&all[range.clone()]);
            }
            jobs.take(index, *known);
        }
        jobs.add_curved(curved.into_values().collect(), all, &ranges);
        jobs
    }

    fn add(&mut self, vertices: &'a [Vertex]) -> usize {
        let found_by = FoundBy::default();
        self.jobs.push(Job { vertices, found_by });
        self.jobs.len() - 1
    }

    /// Assigns a candidate to a job.
    fn take(&mut self, candidate: usize, job: usize) {
        let waves = self.candidates.waves();
        let found = self.candidates.get(candidate);
        let is_wave = found.is_some_and(|found| (found.wave as usize) < waves);
        self.jobs[job].found_by.add(FoundBy {
            waves: u32::from(is_wave),
            search: !is_wave,
        });
        self.job_of[candidate] = Ok(job);
    }

    /// Adds the jobs of sequences with curved surfaces, each given as its candidates.
    fn add_curved(
        &mut self,
        mut sequences: Vec<Vec<usize>>,
        all: &'a [Vertex],
        ranges: &[Range<usize>],
    ) {
        let of = |candidate: usize| &all[ranges[candidate].clone()];
        sequences.sort_by_key(|one| (of(one[0]).len(), Reverse(one.len()), one[0]));
        let mut left = SOLVED_AT_CURVES;
        for sequence in sequences {
            let count = sequence.len().min(SOLVED_OF_A_SEQUENCE);
            if count > left {
                for candidate in sequence {
                    self.job_of[candidate] = Err(NoPath::LeftOut);
                }
                continue;
            }
            left -= count;
            let solved = (0..count).map(|number| sequence[number * sequence.len() / count]);
            let solved: Vec<&[Vertex]> = solved.map(of).collect();
            let first = self.jobs.len();
            for vertices in &solved {
                self.add(vertices);
            }
            let nearest = |candidate: &usize| first + nearest(&solved, of(*candidate));
            let taken: Vec<usize> = sequence.par_iter().map(nearest).collect();
            for (candidate, job) in sequence.into_iter().zip(taken) {
                self.take(candidate, job);
            }
        }
    }
}

/// The index of the wave that was mirrored nearest to these vertices, by the sum of squared
/// distances; the first of several.
fn nearest(waves: &[&[Vertex]], vertices: &[Vertex]) -> usize {
    let apart = |wave: &[Vertex]| -> f64 {
        let pairs = wave.iter().zip(vertices);
        pairs.map(|(a, b)| a.point.distance_squared(b.point)).sum()
    };
    let all = waves.iter().map(|wave| apart(wave)).enumerate();
    let best = all.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(0, |(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acoustics::early::tests::{directions, scene};
    use crate::acoustics::early::{EarlyPaths, Ends};
    use crate::scene::shape::Ellipsoid;
    use crate::{Shape, Surface};
    use glam::Vec3;

    /// Protects the time spent at a focus: of waves that all arrive, after each of three reflections,
    /// the number solved for keeps the limits, and each represents at least one.
    #[test]
    fn a_focus_has_few_jobs() {
        let radii = Vec3::new(10.0, 6.0, 6.0);
        let gallery = Shape::from(Ellipsoid { radii }).complement();
        let scene = scene(vec![Surface::new(gallery)], Vec3::X * -8.0, Vec3::X * 8.0);
        let early = EarlyPaths::new(&scene).expect("a valid scene");
        let waves = directions(2000);
        let candidates = early.candidates(&Ends::of(&scene), &waves, 3, 0.3);
        assert!(candidates.len() > 3 * SOLVED_OF_A_SEQUENCE);
        let jobs = Jobs::new(&early.surfaces, &candidates);
        let sequences = 3;
        assert!(jobs.jobs.len() <= 2 + sequences * SOLVED_OF_A_SEQUENCE);
        let stands_for: u32 = jobs.jobs.iter().map(|job| job.found_by.waves).sum();
        assert_eq!(stands_for as usize, candidates.len());
        assert!(jobs.job_of.iter().all(Result::is_ok));
    }
}
