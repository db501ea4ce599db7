//! Specular paths: merging of equal ones, and their order.

use glam::DVec3;
use std::cmp::Ordering;
use std::f64::consts::PI;

/// The waves and searches that found a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FoundBy {
    /// Number of waves.
    pub waves: u32,
    /// Whether it was also searched for.
    pub search: bool,
}

impl FoundBy {
    pub fn add(&mut self, other: FoundBy) {
        self.waves += other.waves;
        self.search |= other.search;
    }
}

/// A path of sound from point to point, mirrored at surfaces.
#[derive(Clone, Debug, PartialEq)]
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
    /// Unit vector in world axes, at the source; 0 if both ends are one point.
    pub departure: DVec3,
    /// Unit vector of flight in world axes, at the listener; 0 if both ends are one point.
    pub arrival_direction: DVec3,
    /// Energy density at the listener without absorption, in 1/m², for a source of power 1: 1/(4π
    /// A), where A is the area of the wave front per solid angle. At a focus it is limited, see
    /// [`SpecularPath::is_focus`].
    pub spreading: f64,
    /// Whether 1/(4π A) is more than a sphere of the listener's radius can receive: see [`super`],
    /// section *Foci*.
    pub is_focus: bool,
    /// Number of waves that found it.
    pub found_by: u32,
    /// Whether it was also searched for, so that it is known regardless of the waves.
    pub is_searched: bool,
}

/// A stationary path that is not yet checked completely.
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

/// Maximum difference between points of two paths that count as equal, as a share of their length,
/// and between lengths: Newton's method leaves less, and paths that differ by less sound the same.
const SAME: f64 = 1e-6;

/// Maximum difference in radians between normals that count as equal, and between directions at the ends: they
/// differ by this at curved surfaces, and along segments that are hardly longer than rounding.
const SAME_DIRECTION: f64 = 1e-3;

/// Maximum difference of lengths in metres that count as equal in the order: then the surfaces
/// decide.
const SAME_LENGTH: f64 = 1e-9;

/// Maximum energy density that a sphere can receive, times the square of its radius, when all waves
/// pass through its centre: chord ÷ volume = 2r / (4/3 π r³).
const MOST_CAUGHT: f64 = 3.0 / (2.0 * PI);

/// Whether a wave front of `area` m² per steradian brings more than a listener of `radius` metres
/// can receive.
pub(super) fn is_focus(area: f64, radius: f64) -> bool {
    // 1/(4π A) > 3/(2π r²), without a division by 0.
    4.0 * PI * area * MOST_CAUGHT < radius * radius
}

impl Draft {
    /// Whether the two have the same points with the same normals, in any order, and the same directions at the ends:
    /// in an edge one path has two sequences of surfaces, and a source there is mirrored in each of them.
    pub fn is_same_way(&self, other: &Draft) -> bool {
        let close = |(a, b): (&DVec3, &DVec3)| a.distance(*b) <= SAME * self.length;
        self.points.len() == other.points.len()
            && self.points.iter().zip(&other.points).all(close)
            && self.has_normals_of(other)
            && self.ends_off(other) <= SAME_DIRECTION
    }

    /// The larger difference between the two paths' directions at either end.
    fn ends_off(&self, other: &Draft) -> f64 {
        let last = self.directions.len() - 1;
        let off = |segment: usize| self.directions[segment].distance(other.directions[segment]);
        off(0).max(off(last))
    }

    /// Whether both are mirrored by the same normals, in any order.
    fn has_normals_of(&self, other: &Draft) -> bool {
        let mut left = other.normals.clone();
        self.normals.iter().all(|normal| {
            let same = left
                .iter()
                .position(|other| normal.distance(*other) <= SAME_DIRECTION);
            same.map(|index| left.swap_remove(index)).is_some()
        })
    }

    /// Whether both belong to one focus: there a whole area of a surface mirrors the source to the
    /// listener with equal lengths, and every wave finds a point of its own.
    pub fn is_same_focus(&self, other: &Draft) -> bool {
        self.is_focus
            && other.is_focus
            && self.surfaces == other.surfaces
            && self.walls == other.walls
    }

    /// Whether the lengths are the same.
    pub fn is_as_long_as(&self, other: &Draft) -> bool {
        (self.length - other.length).abs() <= SAME * self.length
    }

    /// By length, then by surfaces, walls and points.
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

    /// The path, for a listener of `radius` metres and `waves` waves in total.
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

/// Merges equal paths: drafts with the same points (in an edge a path has two sequences of
/// surfaces), and those of one focus. Returns the paths in order, and for each draft the index of
/// its path.
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
