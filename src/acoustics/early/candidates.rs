//! Which sequences of surfaces may have a path: those of waves that pass by the listener.

use super::Ends;
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

    /// Follows one wave; every flight of it that comes near enough is a candidate, and all of
    /// them share its vertices.
    fn follow(
        &mut self,
        exact: &ExactScene,
        ends: &Ends,
        wave: u32,
        start: DVec3,
        how: (u32, f64),
    ) {
        let (order, reach) = how;
        let first = self.vertices.len();
        let mut from = ends.source;
        let mut count = 0;
        let (vertices, spans) = (&mut self.vertices, &mut self.spans);
        let last = exact.follow(ends.source, start, order, |hit| {
            if passes(from, hit.point, ends.listener, reach) {
                spans.push(Span { wave, first, count });
            }
            from = hit.point;
            count += 1;
            vertices.push(Vertex {
                point: hit.point,
                normal: hit.normal,
                surface: hit.object,
            });
        });
        let Some(flight) = last else { return };
        let ahead = (ends.listener - flight.origin)
            .dot(flight.direction)
            .max(0.0);
        let nearest = flight.origin + flight.direction * ahead;
        if nearest.distance(ends.listener) > reach {
            return;
        }
        let leaving = vertices[first..]
            .last()
            .map(|last| (last.surface, last.normal));
        let met = match flight.is_free {
            true => None,
            false => exact.first_surface(flight.origin, flight.direction, leaving, ahead),
        };
        let end = met.map_or(nearest, |hit| hit.point);
        if passes(flight.origin, end, ends.listener, reach) {
            spans.push(Span { wave, first, count });
        }
    }
}

/// Follows waves from the source along `directions` (of any length but 0) through the
/// listener, for at most `order` reflections. Each flight that comes within `reach` metres of
/// the listener's centre is a candidate; the index of a wave is that of its direction.
///
/// On the threads of rayon's pool; the result does not depend on their number.
pub(super) fn follow_all(
    exact: &ExactScene,
    ends: &Ends,
    directions: &[Vec3],
    order: u32,
    reach: f64,
) -> Candidates {
    let shares = directions.par_chunks(WAVES_A_SHARE).enumerate();
    let shares = shares.map(|(share, directions)| {
        let mut found = Candidates::new(directions.len());
        for (index, direction) in directions.iter().enumerate() {
            let wave = (share * WAVES_A_SHARE + index) as u32;
            if let Some(start) = direction.as_dvec3().try_normalize() {
                found.follow(exact, ends, wave, start, (order, reach));
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
