//! The axes of a study: numbers, positions and seeds. The values of an axis are computed one by one.
//!
//! Only the settings are stored as a list. The values on all other axes are computed when they are needed. A study of
//! 10⁹ points therefore takes no more memory than a study of ten points.

use super::file::{Numbers, Places, Seeds};
use glam::{DVec3, Vec3};

impl Numbers {
    /// Number of values.
    pub fn len(&self) -> u64 {
        match self {
            Numbers::List(list) => list.len() as u64,
            Numbers::Range { count, .. } | Numbers::Geometric { count, .. } => *count,
        }
    }

    /// The number at an index, from 0.
    pub fn get(&self, index: u64) -> f64 {
        match self {
            Numbers::List(list) => list[index as usize],
            Numbers::Range { from, to, count } => between(*from, *to, index, *count),
            Numbers::Geometric { from, to, count } => match index {
                0 => *from,
                index if index + 1 == *count => *to,
                index => from * (to / from).powf(share(index, *count)),
            },
        }
    }
}

/// The position of an index within `count` values, from 0 to 1, where 0 and 1 are exact.
fn share(index: u64, count: u64) -> f64 {
    index as f64 / count.saturating_sub(1).max(1) as f64
}

fn between(from: f64, to: f64, index: u64, count: u64) -> f64 {
    match index {
        0 => from,
        index if index + 1 == count => to,
        index => from + (to - from) * share(index, count),
    }
}

impl Places {
    /// Number of positions; `None` if it exceeds `u64`.
    pub fn len(&self) -> Option<u64> {
        match self {
            Places::AsInScene => Some(1),
            Places::List(list) => Some(list.len() as u64),
            Places::Grid { counts, .. } => {
                counts.iter().try_fold(1u64, |all, &n| all.checked_mul(n))
            }
            Places::Path { count, .. } => Some(*count),
        }
    }

    /// The position at an index, from 0, in metres; `None` if the axis keeps the position in the scene.
    pub fn get(&self, index: u64) -> Option<Vec3> {
        match self {
            Places::AsInScene => None,
            Places::List(list) => Some(Vec3::from(list[index as usize])),
            Places::Grid { from, to, counts } => {
                let [nx, _, nz] = *counts;
                let steps = [index % nx, index / nx / nz, index / nx % nz];
                let along = |axis: usize| {
                    let (from, to) = (f64::from(from[axis]), f64::from(to[axis]));
                    between(from, to, steps[axis], counts[axis]) as f32
                };
                Some(Vec3::new(along(0), along(1), along(2)))
            }
            Places::Path { through, count } => Some(on_path(through, share(index, *count))),
        }
    }
}

/// The point of a polyline at the given share of its length.
fn on_path(through: &[[f32; 3]], share: f64) -> Vec3 {
    let points: Vec<DVec3> = through
        .iter()
        .map(|point| Vec3::from(*point).as_dvec3())
        .collect();
    let legs = || points.windows(2).map(|ends| (ends[0], ends[1]));
    let length: f64 = legs().map(|(from, to)| from.distance(to)).sum();
    let mut left = share * length;
    for (from, to) in legs() {
        let leg = from.distance(to);
        if left < leg {
            return from.lerp(to, left / leg).as_vec3();
        }
        left -= leg;
    }
    through.last().map_or(Vec3::ZERO, |last| Vec3::from(*last))
}

impl Seeds {
    /// Number of seeds.
    pub fn len(&self) -> u64 {
        match self {
            Seeds::List(list) => list.len() as u64,
            Seeds::Range { count, .. } => *count,
        }
    }

    /// The seed at an index, from 0.
    pub fn get(&self, index: u64) -> u32 {
        match self {
            Seeds::List(list) => list[index as usize],
            // The checks of the study ensure that the last seed fits `u32`.
            Seeds::Range { from, .. } => from.wrapping_add(index as u32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the ends of ranges, and the order of grids: x changes fastest, y slowest.
    #[test]
    fn axes_meet_their_ends_and_grids_are_in_order() {
        let range = Numbers::Range {
            from: 0.1,
            to: 0.7,
            count: 4,
        };
        assert_eq!((range.get(0), range.get(3)), (0.1, 0.7));
        assert!((range.get(1) - 0.3).abs() < 1e-15);
        let geometric = Numbers::Geometric {
            from: 1.0,
            to: 16.0,
            count: 5,
        };
        assert_eq!((geometric.get(0), geometric.get(4)), (1.0, 16.0));
        assert!((geometric.get(2) - 4.0).abs() < 1e-12);
        let grid = Places::Grid {
            from: [0.0, 5.0, -1.0],
            to: [2.0, 5.0, 1.0],
            counts: [3, 1, 2],
        };
        let at = |index| grid.get(index).unwrap().to_array();
        assert_eq!(grid.len(), Some(6));
        assert_eq!(at(1), [1.0, 5.0, -1.0]);
        assert_eq!(at(5), [2.0, 5.0, 1.0]);
        let path = Places::Path {
            through: vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 0.0, 2.0]],
            count: 5,
        };
        let at = |index| path.get(index).unwrap().to_array();
        assert_eq!(at(1), [1.0, 0.0, 0.0]);
        assert_eq!(at(3), [2.0, 0.0, 1.0]);
        assert_eq!(at(4), [2.0, 0.0, 2.0]);
    }
}
