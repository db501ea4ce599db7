//! Finds paths from candidates.

use super::candidates::Candidates;
use super::check::Checked;
use super::fermat::Chain;
use super::flight::directions;
use super::jobs::{Job, Jobs};
use super::missed::Missed;
use super::paths::{Draft, SpecularPath, is_focus, merged};
use super::sheet::Sheet;
use super::spreading::front_area;
use super::surfaces::{Surfaces, Vertex};
use super::{Ends, NoPath, images};
use crate::reference::ExactScene;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// The paths found from candidates.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Found {
    /// By length, then by surfaces.
    pub paths: Vec<SpecularPath>,
    /// For each candidate the index of its path, or the reason why it has none.
    pub outcomes: Vec<Result<usize, NoPath>>,
    /// Estimate of the early part that the waves have missed.
    pub missed: Missed,
}

impl Found {
    /// A result without paths, for one reason.
    pub(super) fn none(candidates: &Candidates, why: NoPath) -> Found {
        Found {
            paths: Vec::new(),
            outcomes: vec![Err(why); candidates.len()],
            missed: Missed::default(),
        }
    }
}

/// Maximum number of times that a path which leaves the sheet of a candidate may continue on the
/// neighbouring one.
const MOST_CROSSINGS: usize = 6;

/// Surfaces, and walls of rooms.
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
        let checked = Checked {
            points: &draft.points,
            surfaces: &draft.surfaces,
            normals: &draft.normals,
            directions: &draft.directions,
        };
        checked.is_taken(exact, surfaces)
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
        missed: Missed::of(&paths),
        paths,
    }
}

/// The distinct drafts, with the counts of equal ones added, and for each job the index of its
/// draft. At foci every draft is kept: some may be in a shadow.
fn distinct(solved: Vec<Result<Draft, NoPath>>) -> (Vec<Draft>, Vec<Result<usize, NoPath>>) {
    let mut drafts: Vec<Draft> = Vec::new();
    let mut known: HashMap<Sequence, Vec<usize>> = HashMap::new();
    let mut draft_of = Vec::with_capacity(solved.len());
    for solved in solved {
        let draft = match solved {
            Ok(draft) => draft,
            Err(why) => {
                draft_of.push(Err(why));
                continue;
            }
        };
        if draft.is_focus {
            draft_of.push(Ok(drafts.len()));
            drafts.push(draft);
            continue;
        }
        let sequence = (draft.surfaces.clone(), draft.walls.clone());
        let alike = known.entry(sequence).or_default();
        let same = alike
            .iter()
            .find(|&&index| drafts[index].is_same_way(&draft));
        match same {
            Some(&index) => {
                drafts[index].found_by.add(draft.found_by);
                draft_of.push(Ok(index));
            }
            None => {
                alike.push(drafts.len());
                draft_of.push(Ok(drafts.len()));
                drafts.push(draft);
            }
        }
    }
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
        let sheet = |vertex: &Vertex| self.surfaces.sheet(vertex).map_err(|_| NoPath::NotExact);
        vertices.iter().map(sheet).collect()
    }

    fn stationary(&self, vertices: &[Vertex], sheets: &[Sheet]) -> Result<Vec<DVec3>, NoPath> {
        let (source, listener) = (self.ends.source, self.ends.listener);
        if sheets.iter().all(Sheet::is_flat) {
            return images::points(source, listener, self.surfaces.touch, sheets.iter())
                .ok_or(NoPath::NotStationary);
        }
        let chain = Chain {
            source,
            listener,
            sheets,
        };
        let start: Vec<DVec3> = vertices.iter().map(|vertex| vertex.point).collect();
        chain.solve(&start).map_err(|_| NoPath::NotStationary)
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
            directions: directions(&points, &normals, self.surfaces.touch),
            normals,
            is_focus: is_focus(area, self.ends.radius_m),
            points,
            area,
            found_by: job.found_by,
        })
    }
}
