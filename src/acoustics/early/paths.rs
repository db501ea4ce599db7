//! Specular paths, which of them are one, and their order.

use glam::DVec3;
use std::cmp::Ordering;
use std::f64::consts::PI;

/// What found a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct FoundBy {
    /// Waves.
    pub waves: u32,
    /// Whether it was looked for besides the waves.
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
    /// The numbers of the surfaces in order, from 1; none for the direct sound.
    pub surfaces: Vec<u32>,
    /// The wall for each reflection at a room: −x, +x, −y, +y, −z, +z of the room's own axes as
    /// 0 to 5; `None` for other surfaces.
    pub walls: Vec<Option<u8>>,
    /// Where it is mirrored, in world metres.
    pub points: Vec<DVec3>,
    /// Metres from the source to the listener.
    pub length_m: f64,
    /// Unit vector in world axes, from the source; 0 if both ends are one point.
    pub departure: DVec3,
    /// Unit vector of flight in world axes, at the listener; 0 if both ends are one point.
    pub arrival_direction: DVec3,
    /// Energy density at the listener without absorption, in 1/m², for a source of power 1:
    /// 1/(4π A), A the area of the wave front per solid angle. At a focus a bound, see
    /// [`SpecularPath::is_focus`].
    pub spreading: f64,
    /// Whether so much would arrive by 1/(4π A) that a sphere of the listener's radius cannot
    /// hold it: see [`super`], section *Foci*.
    pub is_focus: bool,
    /// How many of the waves found it.
    pub found_by: u32,
    /// Whether it was searched besides the waves, so that it is known whatever these meet.
    pub is_searched: bool,
}

/// A stationary path before all is known of it.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub surfaces: Vec<u32>,
    pub walls: Vec<Option<u8>>,
    /// From source to listener.
    pub points: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    /// Unit vectors of flight, one for each segment.
    pub directions: Vec<DVec3>,
    pub length: f64,
    /// m² per steradian.
    pub area: f64,
    pub is_focus: bool,
    pub found_by: FoundBy,
}

/// Points of two paths closer than this share of their length are one point, and so are lengths:
/// Newton's method leaves less, and paths that differ by less sound the same.
const SAME: f64 = 1e-6;

/// Normals that differ by no more radians are one, and so are directions at the ends: by this they differ at curved
/// surfaces, and along segments that are hardly longer than rounding.
const SAME_DIRECTION: f64 = 1e-3;

/// Lengths in metres that differ by less have no order: then surfaces decide.
const SAME_LENGTH: f64 = 1e-9;

/// The most energy density that a sphere can catch, times the square of its radius, when all
/// waves pass through its centre: chord ÷ volume = 2r / (4/3 π r³).
const MOST_CAUGHT: f64 = 3.0 / (2.0 * PI);

/// Whether a wave front of `area` m² per steradian brings more than a listener of `radius`
/// metres can catch.
pub(super) fn is_focus(area: f64, radius: f64) -> bool {
    // 1/(4π A) > 3/(2π r²), without a division by 0.
    4.0 * PI * area * MOST_CAUGHT < radius * radius
}

impl Draft {
    /// Whether the two are the same points with the same normals, in whatever order, and begin and end alike: in an edge
    /// one path has two sequences of surfaces, and a source there is mirrored in each of them.
    pub fn is_same_way(&self, other: &Draft) -> bool {
        let close = |(a, b): (&DVec3, &DVec3)| a.distance(*b) <= SAME * self.length;
        self.points.len() == other.points.len()
            && self.points.iter().zip(&other.points).all(close)
            && self.has_normals_of(other)
            && self.ends_off(other) <= SAME_DIRECTION
    }

    /// How far the directions at the ends are from those of the other path: the longer of the two differences.
    fn ends_off(&self, other: &Draft) -> f64 {
        let last = self.directions.len() - 1;
        let off = |segment: usize| self.directions[segment].distance(other.directions[segment]);
        off(0).max(off(last))
    }

    /// Whether both are mirrored by the same normals, in whatever order.
    fn has_normals_of(&self, other: &Draft) -> bool {
        let mut left = other.normals.clone();
        self.normals.iter().all(|normal| {
            let same = left
                .iter()
                .position(|other| normal.distance(*other) <= SAME_DIRECTION);
            same.map(|index| left.swap_remove(index)).is_some()
        })
    }

    /// Whether both are of one focus: there a whole area of a surface mirrors the source to the
    /// listener, all by the same length, and every wave finds a point of its own.
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

    /// The path, for a listener of `radius` metres and so many waves altogether.
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

/// Merges what is one path: drafts with the same points (in an edge a path has two sequences
/// of surfaces), and those of one focus. The result are the paths in order, and for each draft
/// the index of its path.
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
