//! Finds the sequences of surfaces that may have a path: sequences of waves that pass the listener, and sequences of
//! planes.

use super::check::EdgeStart;
use super::sheet::Sheet;
use super::surfaces::{Surfaces, Vertex};
use super::{Ends, fermat};
use crate::geometry::ExactScene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Number of waves that are followed in one task of a thread.
const WAVES_A_SHARE: usize = 16;

/// Number of rounds in which waves are followed, a power of two. The waves of each round are spread evenly over all
/// directions. After each round the limit of work decides whether the next round runs.
const ROUNDS: u32 = 64;

/// The reflections of waves that passed the listener.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    waves: usize,
    vertices: Vec<Vertex>,
    spans: Vec<Span>,
    /// Indices of the waves that were not followed, in order.
    left_out: Vec<u32>,
}

/// The path of a wave up to the listener, as a range of vertices.
#[derive(Clone, Copy, Debug)]
struct Span {
    wave: u32,
    first: usize,
    count: usize,
}

/// A wave that passed the listener after some reflections.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'a> {
    /// Index of the wave.
    pub wave: u32,
    /// The reflections of the wave in order; empty for a wave that came straight from the source.
    pub vertices: &'a [Vertex],
}

impl Candidates {
    /// Creates an empty list, for `waves` waves followed in total.
    pub fn new(waves: usize) -> Candidates {
        Candidates {
            waves,
            ..Candidates::default()
        }
    }

    /// Sets the total number of waves, some of which may have been skipped because they are known not to pass the
    /// listener.
    pub fn among(mut self, waves: usize) -> Candidates {
        self.waves = waves;
        self
    }

    /// Adds a wave that passed the listener after these reflections. If the wave's index is not below
    /// [`Candidates::waves`], the wave gives a path but does not count among the waves that found the path.
    pub fn add(&mut self, wave: u32, vertices: &[Vertex]) {
        let (first, count) = (self.vertices.len(), vertices.len());
        self.vertices.extend_from_slice(vertices);
        self.spans.push(Span { wave, first, count });
    }

    /// Number of waves followed, including those that did not pass the listener.
    pub fn waves(&self) -> usize {
        self.waves
    }

    /// The waves beyond the limit of work, which were not followed, in order; empty without a limit.
    pub(crate) fn left_out(&self) -> &[u32] {
        &self.left_out
    }

    /// Number of times that a wave passed the listener.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// The candidate with this index, ordered by wave, then by number of reflections.
    pub fn get(&self, index: usize) -> Option<Candidate<'_>> {
        let Span { wave, first, count } = *self.spans.get(index)?;
        let vertices = self.vertices.get(first..first + count)?;
        Some(Candidate { wave, vertices })
    }

    /// All candidates in order.
    pub fn iter(&self) -> impl Iterator<Item = Candidate<'_>> {
        (0..self.len()).filter_map(|index| self.get(index))
    }

    /// The vertices of all waves, grouped by wave.
    pub(super) fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// The range of each candidate in [`Candidates::vertices`].
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.spans
            .iter()
            .map(|span| span.first..span.first + span.count)
    }

    /// Drops the vertices of the most recent wave that follow its last candidate.
    fn forget_vertices_behind(&mut self) {
        let end = self.spans.last().map_or(0, |span| span.first + span.count);
        self.vertices.truncate(end);
    }

    /// Appends the candidates of other waves.
    fn append(&mut self, other: Candidates) {
        let before = self.vertices.len();
        self.vertices.extend(other.vertices);
        self.spans.extend(other.spans.into_iter().map(|span| Span {
            first: span.first + before,
            ..span
        }));
    }
}

/// Settings for following waves from the source through the listener.
pub(super) struct Follow<'a> {
    pub exact: &'a ExactScene,
    pub edge: EdgeStart<'a>,
    pub ends: &'a Ends,
    /// Maximum number of reflections.
    pub order: u32,
    /// Maximum distance in metres between a candidate's flight and the listener's centre.
    pub reach_m: f64,
}

impl Follow<'_> {
    /// Follows waves along `directions` (of any length except 0). The index of a wave is the index of its direction.
    /// Once more than `most_asked` surfaces and bounding boxes have been tested, the remaining rounds are left out.
    ///
    /// Runs on the threads of rayon's pool; the result does not depend on the number of threads.
    pub fn all(&self, directions: &[Vec3], most_asked: u64) -> Candidates {
        let mut all = Candidates::new(directions.len());
        let mut asked = 0;
        for round in 0..ROUNDS {
            let waves = waves_of_round(round, directions.len() as u32);
            if asked > most_asked {
                all.left_out.extend(waves);
                continue;
            }
            let shares = waves.par_chunks(WAVES_A_SHARE);
            let shares = shares.map(|waves| self.share(directions, waves));
            for (found, of_share) in shares.collect::<Vec<_>>() {
                all.append(found);
                asked += of_share;
            }
        }
        all.left_out.sort_unstable();
        all.spans.sort_by_key(|span| span.wave);
        all
    }

    /// Follows these waves, and returns the number of surfaces and bounding boxes tested for them.
    fn share(&self, directions: &[Vec3], waves: &[u32]) -> (Candidates, u64) {
        let mut found = Candidates::default();
        let mut asked = 0;
        for wave in waves {
            let direction = directions[*wave as usize].as_dvec3();
            if let Some(start) = direction.try_normalize() {
                asked += self.one(&mut found, *wave, start);
                found.forget_vertices_behind();
            }
        }
        (found, asked)
    }

    /// Follows one wave. Every flight that comes within reach is a candidate; all candidates of the wave share its
    /// vertices. Returns the number of surfaces and bounding boxes tested for its reflections.
    fn one(&self, found: &mut Candidates, wave: u32, start: DVec3) -> u64 {
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
        let Some(flight) = last else { return 0 };
        let listener = self.ends.listener;
        let ahead = (listener - flight.origin).dot(flight.direction).max(0.0);
        let nearest = flight.origin + flight.direction * ahead;
        if nearest.distance(listener) > self.reach_m {
            return flight.asked;
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
        flight.asked
    }

    /// The direction in which a wave with the initial direction `start` leaves the source, and the number of
    /// reflections that it has before at an edge at the source.
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

/// The indices of the waves of a round, out of `waves` waves. Rounds are in bit-reversed order, so that the waves of
/// the first rounds are evenly spaced.
fn waves_of_round(round: u32, waves: u32) -> Vec<u32> {
    let first = round.reverse_bits() >> (ROUNDS.leading_zeros() + 1);
    (first..waves).step_by(ROUNDS as usize).collect()
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

/// Maximum number of images, which take a few tens of milliseconds. All images of a room up to order 8 are fewer.
const MOST_IMAGES: usize = 1 << 17;

/// Maximum number of nodes of a field for which [`MOST_IMAGES`] are tried. With more nodes fewer images are tried,
/// because each image needs the field's value.
const NODES: usize = 16;

/// Maximum product of the numbers of images and planes in one level of images: a few tens of milliseconds with
/// thousands of planes.
const MOST_TRIED: usize = 1 << 24;

/// An image of the source: the image of its parent in a plane.
struct Image {
    place: DVec3,
    plane: usize,
    /// The index of the mirrored image; `None` if the source itself was mirrored.
    parent: Option<usize>,
}

/// Adds each sequence of at most `order` planes of `surfaces` over which sound could travel from the source to the
/// listener if nothing obstructed it. The path of such a sequence counts as searched for. Returns the number of
/// reflections up to which all sequences were tried.
pub(super) fn add_plane_sequences(
    surfaces: &Surfaces,
    ends: &Ends,
    order: u32,
    candidates: &mut Candidates,
) -> u32 {
    let planes = surfaces.planes();
    let most_images = MOST_IMAGES * NODES / surfaces.most_nodes_of_planes().max(NODES);
    let mut tree: Vec<Image> = Vec::new();
    let mut last_level = 0..0;
    let searched = candidates.waves() as u32;
    let source = (ends.source, surfaces.touch);
    for level in 1..=order {
        if last_level.len() * planes.len() > MOST_TRIED {
            return level - 1;
        }
        let begin = tree.len();
        if level == 1 {
            mirror(&mut tree, &planes, source, (ends.source, None));
        }
        for parent in last_level {
            let place = tree[parent].place;
            mirror(&mut tree, &planes, source, (place, Some(parent)));
            if tree.len() > most_images {
                return level - 1;
            }
        }
        last_level = begin..tree.len();
        for image in last_level.clone() {
            if let Some(vertices) = vertices(surfaces, ends, &planes, &tree, image) {
                candidates.add(searched, &vertices);
            }
        }
    }
    order
}

/// Adds the images of a point (the source, or its image with this index) in all planes on whose air side the point
/// lies, except in the plane that made this image. A source on planes, or an image that coincides with it, also counts
/// as on their air side, except for planes that have already mirrored it.
fn mirror(
    tree: &mut Vec<Image>,
    planes: &[(u32, Sheet)],
    (source, touch): (DVec3, f64),
    (place, parent): (DVec3, Option<usize>),
) {
    let (least, mirrored_in) = match place.distance(source) <= touch {
        true => (-touch, usize::MAX),
        false => (0.0, 1),
    };
    let line = std::iter::successors(parent, |image| tree[*image].parent);
    let behind: Vec<usize> = line
        .take(mirrored_in)
        .map(|image| tree[image].plane)
        .collect();
    for (plane, (_, sheet)) in planes.iter().enumerate() {
        let Some((normal, offset)) = sheet.plane() else {
            continue;
        };
        if !behind.contains(&plane) && place.dot(normal) - offset > least {
            tree.push(Image {
                place: fermat::image(place, normal, offset),
                plane,
                parent,
            });
        }
    }
}

/// The points where the line to an image is mirrored; `None` if the line misses one of the surfaces.
fn vertices(
    surfaces: &Surfaces,
    ends: &Ends,
    planes: &[(u32, Sheet)],
    tree: &[Image],
    image: usize,
) -> Option<Vec<Vertex>> {
    let line = std::iter::successors(Some(image), |image| tree[*image].parent);
    let mut found = Vec::new();
    let mut seen_from = ends.listener;
    for image in line.map(|image| &tree[image]) {
        let (surface, sheet) = &planes[image.plane];
        let plane = sheet.plane()?;
        let point = fermat::point_of_image(seen_from, image.place, plane, surfaces.touch)?;
        // Most lines miss the last surface.
        if !surfaces.has(*surface, point) {
            return None;
        }
        found.push(Vertex {
            point,
            normal: plane.0,
            surface: *surface,
        });
        seen_from = point;
    }
    found.reverse();
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Surface;
    use crate::response::exact_paths::EarlyPaths;
    use crate::response::exact_paths::tests::{directions, scene};
    use crate::scene::shape::{Cuboid, Room};

    /// Protects the limit of work: the waves left out are reported and do not depend on the number of threads, and the
    /// results of the other waves are the same as without a limit.
    #[test]
    fn a_limit_leaves_out_whole_waves() {
        let block = |index: usize| {
            let at = Vec3::new(
                (index % 8) as f32,
                (index / 8 % 8) as f32,
                (index / 64) as f32,
            );
            let size = Vec3::splat(0.2);
            Surface::new(Cuboid { size }).at(at - Vec3::splat(3.4))
        };
        let size = Vec3::splat(9.0);
        let mut surfaces = vec![Surface::new(Room { size })];
        surfaces.extend((0..256).map(block));
        let scene = scene(surfaces, Vec3::splat(-4.0), Vec3::splat(4.0));
        let early = EarlyPaths::new(&scene).expect("a valid scene");
        let (ends, waves) = (Ends::of(scene.only_pair().unwrap()), directions(2000));
        let found = |threads, most_asked| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let follow = || early.candidates_within(&ends, &waves, 3, 2.0, most_asked);
            let found = pool.build().expect("threads").install(follow);
            let of = |c: Candidate| (c.wave, c.vertices.to_vec());
            let all: Vec<(u32, Vec<Vertex>)> = found.iter().map(of).collect();
            (all, found.left_out().to_vec())
        };
        let (all, none) = found(1, u64::MAX);
        assert!(none.is_empty() && all.is_sorted_by_key(|(wave, _)| *wave));
        // Each flight tests at least one surface, and a round has some hundred flights.
        let (some, left_out) = found(1, 3000);
        assert!((1..1950).contains(&left_out.len()), "{}", left_out.len());
        let is_followed = |(wave, _): &&(u32, Vec<Vertex>)| left_out.binary_search(wave).is_err();
        assert!(all.iter().filter(is_followed).eq(&some));
        for threads in [2, 3, 7] {
            assert_eq!(found(threads, 3000), (some.clone(), left_out.clone()));
        }
        // With a limit of 0 only the first round was followed.
        assert_eq!(found(2, 0).1.len(), 2000 - waves_of_round(0, 2000).len());
    }

    /// Protects against leaving out whole regions of directions: the first rounds have waves in all directions, and all
    /// rounds together contain every wave once.
    #[test]
    fn rounds_are_spread_evenly() {
        let first: Vec<u32> = (0..4).map(|round| waves_of_round(round, 640)[0]).collect();
        assert_eq!(first, [0, 32, 16, 48]);
        for count in [0, 1, 63, 64, 1000] {
            let rounds = (0..ROUNDS).flat_map(|round| waves_of_round(round, count));
            let mut all: Vec<u32> = rounds.collect();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..count));
        }
    }
}
