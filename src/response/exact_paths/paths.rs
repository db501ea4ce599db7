//! Specular paths: the spreading of their wave fronts, merging of equal paths, their order, and an estimate of the
//! missed paths.
//!
//! # Spreading
//! Ray differentials (Igehy, *Tracing ray differentials*, 1999): two rays next to the path's ray are followed to first
//! order. They depart at angles of 1 rad per unit along two axes perpendicular to the path. Over a segment p′ grows by
//! t d′. At a surface with unit normal n, both rays are moved to the points where they hit the surface, p′ − d
//! (p′·n)/(d·n), and mirrored with the normals there: d′ − 2 ((d·n) n′ + (d′·n + d·n′) n), n′ = S p′ with the shape
//! operator S, which is ∇²f/|∇f| within the surface. In a room of planes the area is exactly the squared length.
//!
//! # Missed paths
//! A path is found if one of the waves that pass the listener belongs to it. Each such wave belongs to the path with a
//! probability p proportional to the energy that the path brings without absorption. Good (*The population frequencies
//! of species*, Biometrika 40, 1953, after Turing): if n waves found paths, and f₁ of these found a path that no other
//! wave found, then the missed paths have a total probability of about f₁/n. Chao (*Nonparametric estimation of the
//! number of classes in a population*, 1984, in its bias-corrected form): the number of missed paths is at least about
//! f₁ (f₁ − 1) / (2 (f₂ + 1)), where f₂ is the number of paths found by two waves. If most paths are weak, as with
//! balls and pillars, the number of missed paths is much larger than this bound. The first estimate, of the missed
//! energy, remains valid.
//!
//! A path that the search also looks for is known even if no wave finds it. Its waves count among the n waves, but the
//! path does not count as found by only one wave.
//!
//! The estimate does not include paths that no wave can find: paths over users' fields, and paths beyond the maximum
//! order of the waves.

use super::sheet::Sheet;
use crate::scene::Scene;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::f64::consts::PI;

/// The waves and searches that found a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FoundBy {
    /// Number of waves.
    pub waves: u32,
    /// Whether the search also found it.
    pub search: bool,
}

impl FoundBy {
    pub fn add(&mut self, other: FoundBy) {
        self.waves += other.waves;
        self.search |= other.search;
    }
}

/// A path of sound from source to listener, mirrored at surfaces.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[cfg_attr(test, derive(Default))]
#[non_exhaustive]
pub struct SpecularPath {
    /// The numbers of the surfaces in order, from 1; empty for the direct sound.
    pub surfaces: Vec<u32>,
    /// The wall for each reflection at a room: −x, +x, −y, +y, −z, +z of the room's own axes as
    /// 0 to 5; `None` for other surfaces.
    pub walls: Vec<Option<u8>>,
    /// The points of reflection, in world metres.
    pub points: Vec<DVec3>,
    /// Length in metres from the source to the listener.
    pub length_m: f64,
    /// Unit vector in world axes, at the source; 0 if source and listener coincide.
    pub departure: DVec3,
    /// Unit vector of flight in world axes, at the listener; 0 if source and listener coincide.
    pub arrival_direction: DVec3,
    /// Energy density at the listener without absorption, in 1/m², for a source of power 1: 1/(4π A), where A is the
    /// area of the wave front per solid angle. At a focus it is limited, see [`SpecularPath::is_focus`].
    pub spreading: f64,
    /// Whether 1/(4π A) is more than a sphere of the listener's radius r can receive, 3/(2π r²): at a focus A can be 0.
    /// The path's spreading is then this bound times the share of all waves that found the path.
    pub is_focus: bool,
    /// Number of waves that found the path.
    pub found_by: u32,
    /// Whether the path was also searched for, and is thus known regardless of the waves.
    pub is_searched: bool,
}

impl SpecularPath {
    /// Short names of the surfaces in the order of the path, with the wall of a room or the group of a mesh:
    /// `room/floor`. A surface without a name has its number. `scene` is the scene of the response.
    pub fn surface_labels(&self, scene: &Scene) -> Vec<String> {
        let met = self.surfaces.iter().zip(&self.walls);
        let label = |(number, wall): (&u32, &Option<u8>)| {
            let index = (*number as usize).checked_sub(1);
            let surface = index.and_then(|index| Some((index, scene.surfaces.get(index)?)));
            match surface {
                Some((index, surface)) => surface.short_label(index, wall.map(usize::from)),
                None => number.to_string(),
            }
        };
        met.map(label).collect()
    }
}

/// A stationary path whose checks are not yet complete.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub surfaces: Vec<u32>,
    pub walls: Vec<Option<u8>>,
    /// Points from source to listener.
    pub points: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    /// Unit vectors of flight, one for each segment.
    pub directions: Vec<DVec3>,
    pub length: f64,
    /// Area of the wave front in m² per steradian.
    pub area: f64,
    pub is_focus: bool,
    pub found_by: FoundBy,
}

/// Maximum difference between points of two paths that count as equal, and between lengths of two such paths, as a
/// share of the length. The error of Newton's method is smaller, and paths with a smaller difference sound the same.
const SAME: f64 = 1e-6;

/// Maximum difference in radians between normals that count as equal, and between directions at the ends. Equal paths
/// may differ this much at curved surfaces, and along segments hardly longer than the rounding error.
const SAME_DIRECTION: f64 = 1e-3;

/// Maximum difference in metres of lengths that count as equal for sorting. Paths of equal length are sorted by
/// surfaces.
const SAME_LENGTH: f64 = 1e-9;

/// Maximum energy density in a sphere, times the square of its radius, reached if all waves pass through its centre:
/// chord ÷ volume = 2r / (4/3 π r³).
const MOST_CAUGHT: f64 = 3.0 / (2.0 * PI);

/// Whether a wave front of `area` m² per steradian brings more than a listener of `radius` metres
/// can receive.
pub(super) fn is_focus(area: f64, radius: f64) -> bool {
    // 1/(4π A) > 3/(2π r²), without a division by 0.
    4.0 * PI * area * MOST_CAUGHT < radius * radius
}

impl Draft {
    /// Whether both drafts have the same points with the same normals, in any order, and the same directions at the
    /// ends. In an edge one path has two sequences of surfaces, and a source in the edge is mirrored in each of these
    /// surfaces.
    pub fn is_same_way(&self, other: &Draft) -> bool {
        let close = |(a, b): (&DVec3, &DVec3)| a.distance(*b) <= SAME * self.length;
        self.points.len() == other.points.len()
            && self.points.iter().zip(&other.points).all(close)
            && self.has_normals_of(other)
            && self.ends_off(other) <= SAME_DIRECTION
    }

    /// The larger of the differences between the two paths' directions at the two ends.
    fn ends_off(&self, other: &Draft) -> f64 {
        let last = self.directions.len() - 1;
        let off = |segment: usize| self.directions[segment].distance(other.directions[segment]);
        off(0).max(off(last))
    }

    /// Whether both drafts are mirrored by the same normals, in any order.
    fn has_normals_of(&self, other: &Draft) -> bool {
        let mut left = other.normals.clone();
        self.normals.iter().all(|normal| {
            let same = left
                .iter()
                .position(|other| normal.distance(*other) <= SAME_DIRECTION);
            same.map(|index| left.swap_remove(index)).is_some()
        })
    }

    /// Whether both drafts belong to one focus: a whole area of a surface mirrors the source to the listener with equal
    /// lengths, and each wave finds a different point of the area.
    pub fn is_same_focus(&self, other: &Draft) -> bool {
        self.is_focus
            && other.is_focus
            && self.surfaces == other.surfaces
            && self.walls == other.walls
    }

    /// Whether the lengths are equal.
    pub fn is_as_long_as(&self, other: &Draft) -> bool {
        (self.length - other.length).abs() <= SAME * self.length
    }

    /// Orders by length, then by surfaces, walls and points.
    pub fn order(&self, other: &Draft) -> Ordering {
        let rounded = |draft: &Draft| (draft.length / SAME_LENGTH).round();
        let points = |draft: &Draft| draft.points.iter().flat_map(|p| p.to_array()).collect();
        let (own, others): (Vec<f64>, Vec<f64>) = (points(self), points(other));
        let by_points = || own.partial_cmp(&others).unwrap_or(Ordering::Equal);
        let by_length = rounded(self).total_cmp(&rounded(other));
        by_length
            .then_with(|| self.surfaces.cmp(&other.surfaces))
            .then_with(|| self.walls.cmp(&other.walls))
            .then_with(by_points)
    }

    /// Completes the path, for a listener of `radius` metres and `waves` waves in total.
    pub fn finished(self, radius: f64, waves: usize) -> SpecularPath {
        let last = self.points.len() - 1;
        let by_front = 1.0 / (4.0 * PI * self.area);
        let share = match self.found_by.waves {
            0 => 1.0,
            found => (f64::from(found) / waves as f64).min(1.0),
        };
        let bound = share * MOST_CAUGHT / (radius * radius);
        SpecularPath {
            departure: self.directions[0],
            arrival_direction: self.directions[last - 1],
            length_m: self.length,
            spreading: if self.is_focus {
                by_front.min(bound)
            } else {
                by_front
            },
            is_focus: self.is_focus,
            found_by: self.found_by.waves,
            is_searched: self.found_by.search,
            points: self.points[1..last].to_vec(),
            surfaces: self.surfaces,
            walls: self.walls,
        }
    }
}

/// Merges equal paths: drafts with the same points (in an edge a path has two sequences of surfaces), and drafts of one
/// focus. Returns the paths in order, and for each draft the index of its path.
pub(super) fn merged(drafts: Vec<Draft>) -> (Vec<Draft>, Vec<usize>) {
    let mut order: Vec<usize> = (0..drafts.len()).collect();
    order.sort_by(|&a, &b| drafts[a].order(&drafts[b]));
    let mut paths: Vec<Draft> = Vec::new();
    let mut path_of = vec![0; drafts.len()];
    for index in order {
        let draft = &drafts[index];
        let near = paths.iter().enumerate().rev();
        let mut near = near.take_while(|(_, path)| draft.is_as_long_as(path));
        let same = near.find(|(_, path)| draft.is_same_way(path) || draft.is_same_focus(path));
        let same = same.map(|(path, _)| path);
        match same {
            Some(path) => paths[path].found_by.add(draft.found_by),
            None => paths.push(draft.clone()),
        }
        path_of[index] = same.unwrap_or(paths.len() - 1);
    }
    (paths, path_of)
}

/// A ray next to the path, to first order: changes of position and direction per radian.
#[derive(Clone, Copy)]
struct Neighbour {
    place: DVec3,
    direction: DVec3,
}

impl Neighbour {
    fn flown(self, metres: f64) -> Neighbour {
        Neighbour {
            place: self.place + self.direction * metres,
            ..self
        }
    }
}

/// The area of the wave front at the listener per solid angle at the source, in m² per steradian,
/// for a path along `points` from source to listener over `sheets`; `None` if a sheet has no
/// normal.
pub(super) fn front_area(points: &[DVec3], sheets: &[Sheet]) -> Option<f64> {
    let legs: Vec<DVec3> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if sheets.iter().all(Sheet::is_flat) {
        let length: f64 = legs.iter().map(|leg| leg.length()).sum();
        return Some(length * length);
    }
    let units: Vec<DVec3> = legs.iter().map(|leg| leg.normalize_or_zero()).collect();
    let (a, b) = units.first()?.any_orthonormal_pair();
    let mut pair = [a, b].map(|direction| Neighbour {
        place: DVec3::ZERO,
        direction,
    });
    for (i, sheet) in sheets.iter().enumerate() {
        let at = sheet.at(points[i + 1])?;
        let mirror =
            |n: Neighbour| mirrored(n.flown(legs[i].length()), units[i], at.normal, at.bend);
        pair = pair.map(mirror);
    }
    let (last, unit) = (legs.last()?.length(), units.last()?);
    let [a, b] = pair.map(|neighbour| neighbour.flown(last).place);
    Some(a.cross(b).dot(*unit).abs())
}

fn mirrored(neighbour: Neighbour, d: DVec3, n: DVec3, bend: glam::DMat3) -> Neighbour {
    let place = neighbour.place - d * (neighbour.place.dot(n) / d.dot(n));
    let turned = bend * place;
    let normal = turned - n * turned.dot(n);
    let direction = neighbour.direction;
    let change = normal * d.dot(n) + n * (direction.dot(n) + d.dot(normal));
    Neighbour {
        place,
        direction: direction - 2.0 * change,
    }
}

/// Estimate of the early sound that the waves and the additional search have missed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Missed {
    /// Number of waves that found a path.
    pub waves: u64,
    /// Number of paths found by exactly one wave, and not by the search.
    pub found_once: u64,
    /// Number of paths found by exactly two waves, and not by the search.
    pub found_twice: u64,
}

impl Missed {
    /// Estimates from the waves and searches that found each of these paths.
    pub fn of(paths: &[SpecularPath]) -> Missed {
        let mut missed = Missed::default();
        for path in paths {
            let once_or_twice = |times: u32| !path.is_searched && path.found_by == times;
            missed.waves += u64::from(path.found_by);
            missed.found_once += u64::from(once_or_twice(1));
            missed.found_twice += u64::from(once_or_twice(2));
        }
        missed
    }

    /// The share, 0 to 1, of missed paths in the energy of all paths without absorption. The share is also the
    /// probability that the next wave passing the listener finds a new path. `None` if no wave found a path. The
    /// standard deviation is about √(f₁ + 2 f₂) / n (Good 1953, with f₂ the number of paths found by two waves).
    pub fn energy_share(&self) -> Option<f64> {
        (self.waves > 0).then(|| self.found_once as f64 / self.waves as f64)
    }

    /// Estimated minimum number of missed paths.
    pub fn paths(&self) -> f64 {
        let once = self.found_once as f64;
        once * (once - 1.0).max(0.0) / (2.0 * (self.found_twice as f64 + 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the estimate: paths found by only one wave indicate missed paths, unless a search finds them anyway.
    #[test]
    fn what_a_search_finds_is_not_missed() {
        let found = |by_waves: &[u32], is_searched: bool| {
            let path = |found_by: &u32| SpecularPath {
                found_by: *found_by,
                is_searched,
                ..SpecularPath::default()
            };
            Missed::of(&by_waves.iter().map(path).collect::<Vec<_>>())
        };
        let missed = found(&[1, 1, 2, 6], false);
        assert_eq!(missed.energy_share(), Some(0.2));
        assert_eq!(missed.paths(), 0.5);
        assert_eq!(found(&[1, 1, 2, 6], true).energy_share(), Some(0.0));
        assert_eq!(found(&[0], true).energy_share(), None);
    }
}
