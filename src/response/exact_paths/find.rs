//! Finds paths from candidates.
//!
//! # Limits of the search
//! Newton's method does not start from every wave.
//!
//! A sequence of planes has one path. A sequence with curved surfaces may have many paths, and each path is found from
//! a wave that passes close by. Near a focus every wave passes the listener repeatedly, and a search from all of these
//! waves takes minutes. The search therefore starts from at most [`SOLVED_OF_A_SEQUENCE`] waves of a sequence, spread
//! evenly over its waves. Each other wave gets the result of the starting wave whose reflection points are nearest. A
//! path found by fewer than one in [`SOLVED_OF_A_SEQUENCE`] of its sequence's waves may be missed.
//!
//! In total the search starts from at most [`SOLVED_AT_CURVES`] waves. Sequences with fewer reflections come first, and
//! among these the sequences with more waves. The waves of all other sequences remain statistical.

use super::candidates::Candidates;
use super::check::{Checked, flight_directions};
use super::fermat::Chain;
use super::paths::{Draft, FoundBy, SpecularPath, front_area, is_focus, merged};
use super::sheet::Sheet;
use super::surfaces::{Surfaces, Vertex};
use super::{Ends, NoPath, fermat};
use crate::geometry::ExactScene;
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::HashMap;
use std::ops::Range;

/// The paths found from candidates.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Found {
    /// Sorted by length, then by surfaces.
    pub paths: Vec<SpecularPath>,
    /// For each candidate the index of its path, or the reason why it has none.
    pub outcomes: Vec<Result<usize, NoPath>>,
}

impl Found {
    /// A result without paths, with the same reason for every candidate.
    pub(super) fn none(candidates: &Candidates, why: NoPath) -> Found {
        Found {
            paths: Vec::new(),
            outcomes: vec![Err(why); candidates.len()],
        }
    }
}

/// Maximum number of times that a path which leaves the sheet of a candidate may continue on the neighbouring sheet.
const MOST_CROSSINGS: usize = 6;

/// The surfaces and walls of a path's reflections, in order.
type Sequence = (Vec<u32>, Vec<Option<u8>>);

pub(super) fn find(
    exact: &ExactScene,
    surfaces: &Surfaces,
    ends: &Ends,
    candidates: &Candidates,
) -> Found {
    let Jobs { jobs, job_of, .. } = Jobs::new(surfaces, candidates);
    let solve = |job: &Job| Solver { surfaces, ends }.solve(job);
    let solved: Vec<Result<Draft, NoPath>> = jobs.par_iter().map(solve).collect();
    let (drafts, draft_of) = distinct(solved);
    let check = |draft: &Draft| {
        let path = draft;
        Checked {
            exact,
            surfaces,
            path,
        }
        .is_taken()
    };
    let checks: Vec<Result<(), NoPath>> = drafts.par_iter().map(check).collect();
    let mut taken = Vec::new();
    let mut place = Vec::new();
    for (draft, check) in drafts.into_iter().zip(checks) {
        place.push(check.map(|()| taken.len()));
        if check.is_ok() {
            taken.push(draft);
        }
    }
    let (paths, path_of) = merged(taken);
    let outcome = |job: Result<usize, NoPath>| {
        let draft = draft_of[job?]?;
        place[draft].map(|taken| path_of[taken])
    };
    let finish = |draft: Draft| draft.finished(ends.radius_m, candidates.waves());
    let paths: Vec<SpecularPath> = paths.into_iter().map(finish).collect();
    Found {
        outcomes: job_of.into_iter().map(outcome).collect(),
        paths,
    }
}

/// The distinct drafts, with the counts of equal drafts added up, and for each job the index of its draft. At foci
/// every draft is kept, because some drafts may be obstructed.
fn distinct(solved: Vec<Result<Draft, NoPath>>) -> (Vec<Draft>, Vec<Result<usize, NoPath>>) {
    let mut drafts: Vec<Draft> = Vec::new();
    let mut known: HashMap<Sequence, Vec<usize>> = HashMap::new();
    let mut index_of = |draft: Draft| {
        let sequence = (draft.surfaces.clone(), draft.walls.clone());
        let alike = known.entry(sequence).or_default();
        let is_same = |index: &&usize| !draft.is_focus && drafts[**index].is_same_way(&draft);
        if let Some(&index) = alike.iter().find(is_same) {
            drafts[index].found_by.add(draft.found_by);
            return index;
        }
        if !draft.is_focus {
            alike.push(drafts.len());
        }
        drafts.push(draft);
        drafts.len() - 1
    };
    let all = solved.into_iter();
    let draft_of = all.map(|solved| solved.map(&mut index_of)).collect();
    (drafts, draft_of)
}

struct Solver<'a> {
    surfaces: &'a Surfaces,
    ends: &'a Ends,
}

impl Solver<'_> {
    fn solve(&self, job: &Job) -> Result<Draft, NoPath> {
        let mut vertices = job.vertices.to_vec();
        for _ in 0..MOST_CROSSINGS {
            let sheets = self.sheets(&vertices)?;
            let points = self.stationary(&vertices, &sheets)?;
            let is_flat = sheets.iter().all(Sheet::is_flat);
            let mut inside = vertices.iter().zip(&points);
            if is_flat || inside.all(|(vertex, p)| self.surfaces.has(vertex.surface, *p)) {
                return self.draft(job, &vertices, &sheets, points);
            }
            let ids: Vec<u64> = sheets.iter().map(|sheet| sheet.id).collect();
            for (vertex, point) in vertices.iter_mut().zip(points) {
                let onto = self.surfaces.onto(vertex.surface, point);
                *vertex = onto.ok_or(NoPath::OffSurface)?;
            }
            let next = self.sheets(&vertices)?;
            if next.iter().map(|sheet| sheet.id).eq(ids) {
                return Err(NoPath::OffSurface);
            }
        }
        Err(NoPath::OffSurface)
    }

    fn sheets(&self, vertices: &[Vertex]) -> Result<Vec<Sheet<'_>>, NoPath> {
        let sheet = |vertex: &Vertex| self.surfaces.sheet(vertex).ok_or(NoPath::NotExact);
        vertices.iter().map(sheet).collect()
    }

    fn stationary(&self, vertices: &[Vertex], sheets: &[Sheet]) -> Result<Vec<DVec3>, NoPath> {
        let (source, listener) = (self.ends.source, self.ends.listener);
        if sheets.iter().all(Sheet::is_flat) {
            return fermat::points_by_images(source, listener, self.surfaces.touch, sheets.iter())
                .ok_or(NoPath::NotStationary);
        }
        let chain = Chain {
            source,
            listener,
            sheets,
        };
        let start = vertices.iter().map(|vertex| vertex.point).collect();
        chain.solve(start).ok_or(NoPath::NotStationary)
    }

    fn draft(
        &self,
        job: &Job,
        vertices: &[Vertex],
        sheets: &[Sheet],
        inner: Vec<DVec3>,
    ) -> Result<Draft, NoPath> {
        let normal = |(sheet, point): (&Sheet, &DVec3)| sheet.at(*point).map(|at| at.normal);
        let normals = sheets.iter().zip(&inner).map(normal);
        let normals: Option<Vec<DVec3>> = normals.collect();
        let normals = normals.ok_or(NoPath::NotStationary)?;
        let mut points = vec![self.ends.source];
        points.extend(inner);
        points.push(self.ends.listener);
        let area = front_area(&points, sheets).ok_or(NoPath::NotStationary)?;
        Ok(Draft {
            surfaces: vertices.iter().map(|vertex| vertex.surface).collect(),
            walls: sheets.iter().map(|sheet| sheet.wall).collect(),
            length: points
                .windows(2)
                .map(|pair| pair[0].distance(pair[1]))
                .sum(),
            directions: flight_directions(&points, &normals, self.surfaces.touch),
            normals,
            is_focus: is_focus(area, self.ends.radius_m),
            points,
            area,
            found_by: job.found_by,
        })
    }
}

/// Maximum number of waves of a sequence with a curved surface that the search starts from.
const SOLVED_OF_A_SEQUENCE: usize = 512;

/// Maximum number of waves at curved surfaces that the search starts from. Each wave takes a fraction of a millisecond,
/// and all waves take a few seconds on one core.
const SOLVED_AT_CURVES: usize = 1 << 15;

/// A sequence of surfaces to find a path for, and the points to start from.
pub(super) struct Job<'a> {
    pub vertices: &'a [Vertex],
    /// The candidates that the job represents.
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
    /// A plane, by the surface's number and the sheet's id, which identifies the sheet of a surface. A sequence of
    /// planes has one path for all waves.
    Flat(u32, u64),
    /// A curved sheet, by the surface's number; solved for from the wave's own vertices.
    Curved(u32),
}

impl<'a> Jobs<'a> {
    /// Jobs for the direct sound, one for each sequence of planes, and several for each sequence with
    /// a curved surface.
    pub fn new(surfaces: &Surfaces, candidates: &'a Candidates) -> Jobs<'a> {
        let mirror = |vertex: &Vertex| match surfaces.sheet(vertex) {
            None => Mirror::NotExact,
            Some(sheet) if sheet.is_flat() => Mirror::Flat(vertex.surface, sheet.id),
            Some(_) => Mirror::Curved(vertex.surface),
        };
        let all = candidates.vertices();
        let mirrors: Vec<Mirror> = all.par_iter().map(mirror).collect();
        let ranges: Vec<Range<usize>> = candidates.ranges().collect();
        let mut jobs = Jobs {
            jobs: vec![Job {
                vertices: &[],
                // The direct sound is always searched for, even if no wave finds it.
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

    /// Adds the jobs of sequences with curved surfaces; each sequence is given as its candidates.
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

/// The index of the wave whose reflection points are nearest to these vertices, by the sum of squared distances. The
/// first index wins if several waves are equally near.
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
    use crate::response::exact_paths::EarlyPaths;
    use crate::response::exact_paths::tests::{directions, scene};
    use crate::scene::shape::Ellipsoid;
    use crate::{Shape, Surface};
    use glam::Vec3;

    /// Protects the time spent at a focus: if all waves arrive after each of three reflections, the number of solved
    /// waves stays within the limits, and each solved wave represents at least one wave.
    #[test]
    fn a_focus_has_few_jobs() {
        let radii = Vec3::new(10.0, 6.0, 6.0);
        let gallery = Shape::from(Ellipsoid { radii }).complement();
        let scene = scene(vec![Surface::new(gallery)], Vec3::X * -8.0, Vec3::X * 8.0);
        let early = EarlyPaths::new(&scene).expect("a valid scene");
        let waves = directions(2000);
        let candidates = early.candidates(&Ends::of(scene.only_pair().unwrap()), &waves, 3, 0.3);
        assert!(candidates.len() > 3 * SOLVED_OF_A_SEQUENCE);
        let jobs = Jobs::new(&early.surfaces, &candidates);
        let sequences = 3;
        assert!(jobs.jobs.len() <= 2 + sequences * SOLVED_OF_A_SEQUENCE);
        let stands_for: u32 = jobs.jobs.iter().map(|job| job.found_by.waves).sum();
        assert_eq!(stands_for as usize, candidates.len());
        assert!(jobs.job_of.iter().all(Result::is_ok));
    }
}
