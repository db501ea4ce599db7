//! The early part: the arrivals that exact paths replace, and the sound along each path.

mod caught;
mod hidden_reflections;
mod sphere_mean;

pub(super) use caught::Caught;

use super::late::casts_shadows;
use super::source_sound::{
    HeardPath, Medium, PathKind, comes_from, crossing, mirrored_share, passing, radiated_along,
};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::exact_paths::{
    Candidate, Candidates, EarlyPaths, Ends, Missed, NoPath, SpecularPath, Vertex,
};
use crate::response::{Arrival, Tap};
use crate::sampling::lattice;
use crate::scene::{Pair, Scene, Shape};
use crate::tracer::early_band_groups;
use glam::Vec3;
use hidden_reflections::HiddenReflections;
use sphere_mean::{Replaced, unhidden_taps};
use std::f64::consts::PI;
use std::ops::Range;

/// The treatment of an early arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    /// The exact path with this index replaces it.
    Path(usize),
    /// No path replaces it: the arrival remains statistical.
    Itself,
    /// An object hides its reflection at a plane face from the listener's centre: the reflection with this index.
    Hidden(usize),
    /// No path replaces it, because its path was not searched for.
    LeftOut,
    /// No path replaces it, because its wave was not followed to save time. The energies of the followed waves are
    /// scaled up instead.
    NotFollowed,
    /// Another path replaces it: see [`stands_for_itself`].
    Another,
}

/// The paths of the waves that arrived early.
pub(super) struct EarlyPart {
    arrivals: Vec<Arrival>,
    /// One outcome for each arrival.
    outcomes: Vec<Outcome>,
    /// Number of waves used to search for paths.
    waves: u32,
    /// The groups of bands of these waves.
    groups: Vec<Range<usize>>,
    paths: Vec<SpecularPath>,
    /// The paths to other points of the listener's sphere, if an object may hide a part of the sphere.
    replaced: Option<Replaced>,
    /// Reflections at plane faces whose paths an object hides, each face once.
    hidden: Vec<Vertex>,
    /// The share of the directions of [`FLAT_SEARCH`] that were left out.
    search_left_out_share: f64,
}

/// The settings of the search for early paths.
pub(super) struct Search<'a> {
    pub pair: Pair<'a>,
    /// The mirrors of the pair's scene.
    pub paths: &'a EarlyPaths,
    /// Number of all waves.
    pub waves: u32,
    /// Maximum number of reflections.
    pub order: u32,
    /// Whether the hidden reflections are needed, because sound bends.
    pub diffracts: bool,
}

/// A path found only by waves replaces them if at least this number of waves is expected to find it. Fewer than 1 % of
/// such paths are missed. If paths with fewer expected waves also replaced their waves, the energy of the missed paths
/// would be lost.
const EXPECTED_WAVES: f64 = 5.0;

impl EarlyPart {
    /// Finds the paths of `arrivals`, which are in the order of their waves. `starts` has the number and the direction
    /// of each of these waves once.
    pub fn find(search: &Search, starts: &[(u32, Vec3)], arrivals: Vec<Arrival>) -> EarlyPart {
        let Search {
            pair, paths, order, ..
        } = *search;
        let scene = pair.scene;
        let ends = paths.ends(pair);
        let directions: Vec<Vec3> = starts.iter().map(|(_, direction)| *direction).collect();
        let candidates =
            paths.candidates_within(&ends, &directions, order, ends.radius_m, MOST_ASKED);
        let followed_share = followed_share(starts.len(), candidates.left_out().len());
        let waves = (f64::from(search.waves) * followed_share) as u32;
        let mut candidates = candidates.among(waves as usize);
        let lengths = candidate_lengths(&ends, &candidates);
        let of_waves = candidates.len();
        let surfaces = scene.surfaces.iter();
        let have_planes: Vec<bool> = surfaces
            .map(|surface| surface.shape.has_planes_of_leaves())
            .collect();
        let complete = match have_planes.contains(&true) {
            true => paths.add_planes(&ends, order, &mut candidates),
            false => 0,
        };
        let search_left_out_share = match complete < order && flat_search_pays(scene) {
            true => add_flat(paths, &ends, order, &mut candidates),
            false => 0.0,
        };
        let found = paths.find(&ends, &candidates);
        let hidden = match search.diffracts {
            true => HiddenReflections::among(&candidates, &found, (paths, &ends)),
            false => HiddenReflections::default(),
        };
        let groups = early_band_groups(scene, order);
        let expected = |path: &SpecularPath| passing(scene, &groups, path, (ends.radius_m, waves));
        let (paths_known, index_known) = retain(found.paths, |path| {
            path.is_searched || expected(path) >= EXPECTED_WAVES
        });
        let known = Known {
            scene,
            groups: &groups,
            early: paths,
            paths: &paths_known,
            complete,
            have_planes,
            waves,
        };
        let of_candidate = |index: usize| match found.outcomes[index] {
            Ok(path) => index_known[path].map_or(Outcome::Itself, Outcome::Path),
            Err(NoPath::LeftOut) => Outcome::LeftOut,
            Err(NoPath::Blocked) if hidden.of(index).is_some() => {
                hidden.of(index).map_or(Outcome::Itself, Outcome::Hidden)
            }
            Err(why) => {
                let vertices = candidates.get(index).map_or(&[][..], |c| c.vertices);
                let is_kept = stands_for_itself(paths, vertices, why);
                match is_kept || !known.has_image(&ends, vertices) {
                    true => Outcome::Itself,
                    false => Outcome::Another,
                }
            }
        };
        let outcome = |arrival: &Arrival| {
            let wave = starts.partition_point(|(wave, _)| *wave < arrival.wave);
            let index = nearest(&lengths, wave as u32, arrival.length_m, ends.radius_m);
            let without = || match candidates.left_out().binary_search(&(wave as u32)) {
                Ok(_) => Outcome::NotFollowed,
                Err(_) => Outcome::Itself,
            };
            index.map_or_else(without, of_candidate)
        };
        let outcomes = arrivals.iter().map(outcome).collect();
        let arrivals = arrivals.into_iter().map(|arrival| Arrival {
            energy: arrival.energy.map(|energy| energy / followed_share),
            ..arrival
        });
        let replaced = casts_shadows(scene).then(|| {
            let mut named = vec![None; paths_known.len()];
            for index in 0..candidates.len() {
                if let Ok(path) = found.outcomes[index]
                    && let Some(path) = index_known[path]
                {
                    named[path].get_or_insert(index);
                }
            }
            let vertices = |path: usize| Some(candidates.get(named[path]?)?.vertices);
            // A sequence found far from the listener gives arrivals outside the listener's sphere.
            let is_beside = |index: &usize| of_candidate(*index) == Outcome::Another;
            let beside = (0..of_waves).filter(is_beside);
            let beside = beside.filter_map(|index| Some(candidates.get(index)?.vertices));
            Replaced::new(scene, paths.clone(), ends, &paths_known, vertices, beside)
        });
        EarlyPart {
            outcomes,
            arrivals: arrivals.collect(),
            waves,
            groups,
            replaced,
            paths: paths_known,
            hidden: hidden.reflections,
            search_left_out_share,
        }
    }

    /// Number of waves used to search for paths: all waves, or the number that the limit of work allows.
    pub fn waves(&self) -> u32 {
        self.waves
    }

    /// The groups of bands, each traced by that number of waves.
    pub fn groups(&self) -> &[Range<usize>] {
        &self.groups
    }

    /// An estimate of the early sound that the waves missed.
    pub fn missed(&self) -> Missed {
        Missed::of(&self.paths)
    }

    /// The share, 0 … 1, of the directions that the search for paths over planes left out.
    pub fn search_left_out_share(&self) -> f64 {
        self.search_left_out_share
    }

    /// Reflections at plane faces whose paths an object hides, each face once; none unless sound bends.
    pub fn hidden_reflections(&self) -> &[Vertex] {
        &self.hidden
    }

    /// The arrivals that no exact path replaces, and which therefore remain statistical: their surfaces are known only
    /// from samples, or the listener is partly visible but its centre is hidden, or their path was not searched for.
    ///
    /// Arrivals of a hidden reflection are left out if `is_bent` holds for it: diffracted paths replace them.
    pub fn left_over(&self, is_bent: impl Fn(usize) -> bool) -> impl Iterator<Item = &Arrival> {
        let all = self.arrivals.iter().zip(&self.outcomes);
        let is_left = move |outcome: &Outcome| match outcome {
            Outcome::Itself | Outcome::LeftOut => true,
            Outcome::Hidden(reflection) => !is_bent(*reflection),
            _ => false,
        };
        all.filter(move |(_, of)| is_left(of))
            .map(|(arrival, _)| arrival)
    }

    /// The remaining arrivals whose path was not searched for.
    pub fn left_out(&self) -> impl Iterator<Item = &Arrival> {
        self.arrivals_of(Outcome::LeftOut)
    }

    /// The arrivals that exact paths replace, except at foci. Each arrival comes with the index of its path, or with `None`
    /// if another path over planes replaces it.
    pub fn caught(&self) -> impl Iterator<Item = (&Arrival, Option<usize>)> {
        let all = self.arrivals.iter().zip(&self.outcomes);
        all.filter_map(|(arrival, outcome)| match outcome {
            Outcome::Path(path) => (!self.paths[*path].is_focus).then_some((arrival, Some(*path))),
            Outcome::Another => Some((arrival, None)),
            Outcome::Itself | Outcome::Hidden(_) | Outcome::LeftOut | Outcome::NotFollowed => None,
        })
    }

    /// The sound along each path. At a focus the energy is the energy of the waves that found the path.
    pub fn heard(&self, pair: Pair, medium: &Medium) -> Vec<HeardPath> {
        let paths = self.paths.iter().enumerate();
        let heard = |(index, path): (usize, &SpecularPath)| {
            // The waves of a focus carry the directivity.
            let at_listener = match path.is_focus {
                true => self.energy_of_waves(index),
                false => radiated_along(pair, path).map(|energy| energy * path.spreading),
            };
            let emitted = at_listener.map(|energy| energy * medium.level);
            let (azimuth, elevation) = comes_from(pair.listener, -path.arrival_direction);
            let kind = match path.surfaces.is_empty() {
                true => PathKind::Direct,
                false => PathKind::Mirrored,
            };
            HeardPath {
                kind,
                path: path.clone(),
                reflections: (0..path.points.len()).collect(),
                delay_s: path.length_m / medium.speed,
                energy: bands::through_air(&emitted, &medium.air, path.length_m),
                in_samples: [1.0; BAND_COUNT],
                errors_db: [0.0; BAND_COUNT],
                azimuth,
                elevation,
            }
        };
        paths.map(heard).collect()
    }

    /// The mean energy of the paths over the listener's sphere, as taps, without the paths for which `is_left_out`
    /// holds; `heard` is the sound along all paths, with the `changes` of their energies by edges.
    pub fn mean_taps(
        &self,
        pair: Pair,
        medium: &Medium,
        (heard, changes): (&[HeardPath], &[Bands]),
        is_left_out: &dyn Fn(&SpecularPath) -> bool,
    ) -> Vec<Tap> {
        match &self.replaced {
            Some(replaced) => replaced.mean_taps(pair, medium, (heard, changes), is_left_out),
            None => unhidden_taps(heard, pair.listener.radius.into(), is_left_out),
        }
    }

    fn energy_of_waves(&self, path: usize) -> Bands {
        let of_path = self.arrivals_of(Outcome::Path(path));
        bands::sum(of_path.map(|arrival| &arrival.energy))
    }

    fn arrivals_of(&self, outcome: Outcome) -> impl Iterator<Item = &Arrival> {
        let all = self.arrivals.iter().zip(&self.outcomes);
        all.filter(move |(_, of)| **of == outcome)
            .map(|(arrival, _)| arrival)
    }
}

/// The share of waves that were followed, above 0.
fn followed_share(waves: usize, left_out: usize) -> f64 {
    match left_out {
        0 => 1.0,
        _ => waves.saturating_sub(left_out).max(1) as f64 / waves as f64,
    }
}

/// The candidate of a wave (its index among the followed waves) whose length is nearest to `length_m` and differs from
/// it by at most the listener's radius. `lengths` are in the order of the waves.
fn nearest(lengths: &[(u32, f64)], wave: u32, length_m: f64, radius_m: f64) -> Option<usize> {
    let first = lengths.partition_point(|(of, _)| *of < wave);
    let end = lengths.partition_point(|(of, _)| *of <= wave);
    let off = |index: &usize| (lengths[*index].1 - length_m).abs();
    let nearest = (first..end).min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.filter(|index| off(index) <= radius_m)
}

/// Whether an arrival without a path is kept. It is kept if the listener's centre is hidden, if the centre or the
/// source is in a solid, if the path begins or ends in an edge that points into the air, and at curved or sampled
/// surfaces. It is dropped beyond the edge of a plane: next to the edge between two walls, a wave that passes beside
/// the centre hits the walls in the opposite order, and the path with this order already has the whole energy, if that
/// path is known ([`Known::has_image`]). An arrival without a candidate is also kept: its wave misses the listener in
/// `f64`, which happens often at users' fields and after many curved surfaces.
fn stands_for_itself(paths: &EarlyPaths, vertices: &[Vertex], why: NoPath) -> bool {
    let is_kept = matches!(
        why,
        NoPath::NotExact | NoPath::Blocked | NoPath::EndInSolid | NoPath::AtEdge
    );
    is_kept || !paths.are_flat(vertices)
}

/// Relative difference up to which two lengths count as equal: the vertices of waves are rounded.
const SAME_LENGTH: f64 = 1e-6;

/// The paths that replace their waves.
struct Known<'a> {
    scene: &'a Scene,
    /// The groups of bands of the waves of early arrivals.
    groups: &'a [Range<usize>],
    early: &'a EarlyPaths,
    /// Sorted by length.
    paths: &'a [SpecularPath],
    /// Number of reflections up to which all paths over planes of [leaves](Shape::has_planes_of_leaves) are known.
    complete: u32,
    /// For each surface, whether it consists only of such planes.
    have_planes: Vec<bool>,
    waves: u32,
}

impl Known<'_> {
    /// Whether the source's image in these planes, mirrored in any order, has a path. Without such a path, all waves
    /// from the image that pass beside the listener's centre would be lost.
    fn has_image(&self, ends: &Ends, vertices: &[Vertex]) -> bool {
        let is_flat = |vertex: &Vertex| self.have_planes[vertex.surface as usize - 1];
        if vertices.len() <= self.complete as usize && vertices.iter().all(is_flat) {
            return true;
        }
        let length_m = self.early.image(ends, vertices).distance(ends.listener);
        let spreading = 1.0 / (4.0 * PI * length_m * length_m);
        let walls = self.early.walls(vertices);
        let surfaces = vertices.iter().map(|vertex| vertex.surface);
        let mirrored = spreading * mirrored_share(self.scene, self.groups, surfaces.zip(walls));
        if crossing(mirrored, ends.radius_m, self.waves) >= EXPECTED_WAVES {
            return true;
        }
        let rounding = SAME_LENGTH * length_m;
        let first = self
            .paths
            .partition_point(|path| path.length_m < length_m - rounding);
        let next = self.paths.get(first);
        next.is_some_and(|path| path.length_m <= length_m + rounding)
    }
}

/// Keeps the items for which `is_kept` holds, and returns the new index of each item, or `None` for a removed item.
fn retain<T>(all: Vec<T>, is_kept: impl Fn(&T) -> bool) -> (Vec<T>, Vec<Option<usize>>) {
    let mut kept = Vec::new();
    let mut index = Vec::with_capacity(all.len());
    for one in all {
        let is_kept = is_kept(&one);
        index.push(is_kept.then_some(kept.len()));
        kept.extend(is_kept.then_some(one));
    }
    (kept, index)
}

/// Number of directions in which paths over planes are searched for, in addition to the directions of the waves that
/// arrived. Any wave over the same sequence of planes gives the path, even if the wave passes far from the listener. A
/// few waves therefore find paths that many arriving waves miss.
const FLAT_SEARCH: u64 = 1 << 14;

/// Maximum number of surfaces and bounding boxes tested while arrived waves are followed. The search has a second
/// budget of this size. Each budget takes one or two seconds on one core. Among 50,000 separate boxes the search tests
/// a tenth of this number, among 500 planes two thirds.
const MOST_ASKED: u64 = 1 << 27;

/// Whether to search all directions for paths over planes: only if the scene has planes and every other surface has a
/// closed form. Marching a field in `f64` takes a thousand times as long as a closed form.
fn flat_search_pays(scene: &Scene) -> bool {
    let mut shapes = scene.surfaces.iter().map(|surface| &surface.shape);
    shapes.clone().all(Shape::is_basic) && shapes.any(Shape::is_flat)
}

/// Adds the sequences of planes hit along an even lattice of directions. Returns the share of the directions left out.
fn add_flat(paths: &EarlyPaths, ends: &Ends, order: u32, candidates: &mut Candidates) -> f64 {
    let search: Vec<Vec3> = lattice(FLAT_SEARCH).map(|d| d.as_vec3()).collect();
    let first = candidates.waves() as u32;
    let more = paths.candidates_within(ends, &search, order, f64::INFINITY, MOST_ASKED);
    for candidate in more
        .iter()
        .filter(|candidate| paths.are_flat(candidate.vertices))
    {
        candidates.add(first + candidate.wave, candidate.vertices);
    }
    more.left_out().len() as f64 / search.len() as f64
}

/// For each candidate, its wave and the length in metres to the wave's closest point to the listener.
fn candidate_lengths(ends: &Ends, candidates: &Candidates) -> Vec<(u32, f64)> {
    let of = |candidate: Candidate| (candidate.wave, length_m(ends, candidate.vertices));
    candidates.iter().map(of).collect()
}

/// Length in metres from one end through these vertices to the other.
fn length_m(ends: &Ends, vertices: &[Vertex]) -> f64 {
    let mut from = ends.source;
    let mut length = 0.0;
    for vertex in vertices {
        length += from.distance(vertex.point);
        from = vertex.point;
    }
    length + from.distance(ends.listener)
}
