//! Which sequences of surfaces may have a path: those of waves that pass by the listener.

use super::Ends;
use super::edge_start::EdgeStart;
use super::surfaces::Vertex;
use crate::reference::ExactScene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Waves that are followed together on one thread.
const WAVES_A_SHARE: usize = 512;

/// The reflections of waves that passed by the listener.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    waves: usize,
    vertices: Vec<Vertex>,
    spans: Vec<Span>,
}

/// One wave up to the listener: some vertices in a row.
#[derive(Clone, Copy, Debug)]
struct Span {
    wave: u32,
    first: usize,
    count: usize,
}

/// A wave that passed by the listener after some reflections.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Index of the wave.
    pub wave: u32,
    /// Its reflections in order; none for a wave that came straight from the source.
    pub vertices: &'a [Vertex],
}

impl Candidates {
    /// None so far, of `waves` waves that are followed altogether.
    pub fn new(waves: usize) -> Candidates {
        Candidates {
            waves,
            ..Candidates::default()
        }
    }

    /// The same, of so many waves altogether: some may have been left out, as they are known to pass
    /// by nowhere.
    pub fn among(mut self, waves: usize) -> Candidates {
        self.waves = waves;
        self
    }

    /// Adds a wave that passed by the listener after these reflections. One whose index is not below
    /// [`Candidates::waves`] names its path, but does not count among those that found it.
    pub fn add(&mut self, wave: u32, vertices: &[Vertex]) {
        let (first, count) = (self.vertices.len(), vertices.len());
        self.vertices.extend_from_slice(vertices);
        self.spans.push(Span { wave, first, count });
    }

    /// How many waves were followed, those included that passed by nowhere.
    pub fn waves(&self) -> usize {
        self.waves
    }

    /// How many times a wave passed by.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Whether no wave passed by.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// The candidate with this index, in the order of the waves, then of their reflections.
    pub fn get(&self, index: usize) -> Option<Candidate<'_>> {
        let Span { wave, first, count } = *self.spans.get(index)?;
        let vertices = self.vertices.get(first..first + count)?;
        Some(Candidate { wave, vertices })
    }

    /// All of them in order.
    pub fn iter(&self) -> impl Iterator<Item = Candidate<'_>> {
        (0..self.len()).filter_map(|index| self.get(index))
    }

    /// The vertices of all waves, each wave's in order.
    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Which of [`Candidates::vertices`] each candidate has.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.spans
            .iter()
            .map(|span| span.first..span.first + span.count)
    }

    /// Drops the vertices that the last wave has behind its last candidate.
    fn forget_vertices_behind(&mut self) {
        let end = self.spans.last().map_or(0, |span| span.first + span.count);
        self.vertices.truncate(end);
    }

    fn append(&mut self, other: Candidates) {
        let before = self.vertices.len();
        self.waves += other.waves;
        self.vertices.extend(other.vertices);
        self.spans.extend(other.spans.into_iter().map(|span| Span {
            first: span.first + before,
            ..span
        }));
    }
}

/// How waves are followed from the source through the listener.
pub(super) struct Follow<'a> {
    pub exact: &'a ExactScene,
    pub edge: EdgeStart<'a>,
    pub ends: &'a Ends,
    /// Reflections at most.
    pub order: u32,
    /// Metres from the listener's centre within which a flight is a candidate.
    pub reach_m: f64,
}

impl Follow<'_> {
    /// Follows waves along `directions` (of any length but 0); the index of a wave is that of its direction.
    ///
    /// On the threads of rayon's pool; the result does not depend on their number.
    pub fn all(&self, directions: &[Vec3]) -> Candidates {
        let shares = directions.par_chunks(WAVES_A_SHARE).enumerate();
        let shares = shares.map(|(share, directions)| {
            let mut found = Candidates::new(directions.len());
            for (index, direction) in directions.iter().enumerate() {
                let wave = (share * WAVES_A_SHARE + index) as u32;
                if let Some(start) = direction.as_dvec3().try_normalize() {
                    self.one(&mut found, wave, start);
                    found.forget_vertices_behind();
                }
            }
            found
        });
        let shares: Vec<Candidates> = shares.collect();
        let mut all = Candidates::default();
        for share in shares {
            all.append(share);
        }
        all
    }

    /// Follows one wave; every flight of it that comes near enough is a candidate, and all of
    /// them share its vertices.
    fn one(&self, found: &mut Candidates, wave: u32, start: DVec3) {
        let first = found.vertices.len();
        let mut from = self.ends.source;
        let (vertices, spans) = (&mut found.vertices, &mut found.spans);
        let mut visit = |vertex: Vertex| {
            if self.passes(from, vertex.point) {
                let count = vertices.len() - first;
                spans.push(Span { wave, first, count });
            }
            from = vertex.point;
            vertices.push(vertex);
        };
        let (start, reflections) = self.leave_edge(start, &mut visit);
        let left = self.order - reflections;
        let last = self.exact.follow(self.ends.source, start, left, |hit| {
            visit(Vertex {
                point: hit.point,
                normal: hit.normal,
                surface: hit.object,
            });
        });
        let Some(flight) = last else { return };
        let listener = self.ends.listener;
        let ahead = (listener - flight.origin).dot(flight.direction).max(0.0);
        let nearest = flight.origin + flight.direction * ahead;
        if nearest.distance(listener) > self.reach_m {
            return;
        }
        let leaving = found.vertices[first..]
            .last()
            .map(|last| (last.surface, last.normal));
        let exact = self.exact;
        let met = match flight.is_free {
            true => None,
            false => exact.first_surface(flight.origin, flight.direction, leaving, ahead),
        };
        let end = met.map_or(nearest, |hit| hit.point);
        if self.passes(flight.origin, end) {
            let count = found.vertices.len() - first;
            found.spans.push(Span { wave, first, count });
        }
    }

    /// The direction in which a wave leaves the source along `start`, and how many reflections at an edge there come
    /// first.
    fn leave_edge(&self, start: DVec3, visit: &mut impl FnMut(Vertex)) -> (DVec3, u32) {
        let mut direction = start;
        for reflections in 0..self.order {
            let Some(vertex) = self.edge.reflection(direction) else {
                return (direction, reflections);
            };
            visit(*vertex);
            direction = direction.reflect(vertex.normal);
        }
        (direction, self.order)
    }

    /// Whether the segment comes within reach of the listener's centre.
    fn passes(&self, from: DVec3, to: DVec3) -> bool {
        passes(from, to, self.ends.listener, self.reach_m)
    }
}

/// Whether the segment comes within `reach` metres of a point.
fn passes(from: DVec3, to: DVec3, point: DVec3, reach: f64) -> bool {
    if reach == f64::INFINITY {
        return true;
    }
    let along = to - from;
    let squared = along.length_squared();
    let share = match squared > 0.0 {
        true => ((point - from).dot(along) / squared).clamp(0.0, 1.0),
        false => 0.0,
    };
    (from + along * share).distance_squared(point) <= reach * reach
}
