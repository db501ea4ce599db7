//! Axis-aligned boxes that enclose a solid; unbounded ones have infinite faces.

use glam::{DMat3, DVec3};

/// The least and greatest coordinates of a solid in metres, ±∞ where it is unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Least x, y, z.
    pub min: DVec3,
    /// Greatest x, y, z.
    pub max: DVec3,
}

impl Bounds3 {
    /// All of space.
    pub const EVERYWHERE: Bounds3 = Bounds3 {
        min: DVec3::NEG_INFINITY,
        max: DVec3::INFINITY,
    };

    /// A box about the origin with this half size.
    pub fn centred(half_size: DVec3) -> Bounds3 {
        Bounds3 {
            min: -half_size,
            max: half_size,
        }
    }

    /// The smallest box that contains the points.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Bounds3 {
        let nothing = Bounds3 {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        points.into_iter().fold(nothing, |all, p| Bounds3 {
            min: all.min.min(p),
            max: all.max.max(p),
        })
    }

    /// The smallest box that contains both.
    pub fn hull(self, other: Bounds3) -> Bounds3 {
        Bounds3 {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The intersection; if it is empty, its minimum may exceed its maximum.
    pub fn common(self, other: Bounds3) -> Bounds3 {
        Bounds3 {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Grown on all sides by a length in metres.
    pub fn grown(self, by: DVec3) -> Bounds3 {
        Bounds3 {
            min: self.min - by,
            max: self.max + by,
        }
    }

    /// Moved by a vector in metres.
    pub fn moved(self, by: DVec3) -> Bounds3 {
        Bounds3 {
            min: self.min + by,
            max: self.max + by,
        }
    }

    /// Scaled about the origin.
    pub fn scaled(self, by: f64) -> Bounds3 {
        Bounds3 {
            min: self.min * by,
            max: self.max * by,
        }
    }

    /// Bounds of the box turned about the origin.
    pub fn turned(self, by: DMat3) -> Bounds3 {
        let mut turned = Bounds3 {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
        };
        for column in 0..3 {
            for row in 0..3 {
                let share = by.col(column)[row];
                // Avoids 0 times infinity; a quarter turn in `f32` leaves 4e-8.
                if share.abs() < 1e-6 {
                    continue;
                }
                let ends = [share * self.min[column], share * self.max[column]];
                turned.min[row] += ends[0].min(ends[1]);
                turned.max[row] += ends[0].max(ends[1]);
            }
        }
        turned
    }

    /// Whether the two do not touch, not even at their faces.
    pub(super) fn is_apart_from(self, other: Bounds3) -> bool {
        self.common(other).is_empty()
    }

    /// Whether the box is empty.
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether it is bounded on every side.
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Half of its size.
    pub fn half_size(self) -> DVec3 {
        0.5 * (self.max - self.min)
    }

    /// Its middle along the axes where both faces are finite; 0 along the others.
    pub fn middle(self) -> DVec3 {
        let middle = 0.5 * (self.min + self.max);
        DVec3::select(middle.is_finite_mask(), middle, DVec3::ZERO)
    }

    /// Distance of a point from the box in metres; 0 inside.
    pub fn distance(self, point: DVec3) -> f64 {
        (self.min - point)
            .max(point - self.max)
            .max(DVec3::ZERO)
            .length()
    }

    /// The greatest distance of any of its points from an axis through the origin (0 = x …); from the origin for other
    /// numbers than 0 to 2.
    pub fn radius_about(self, axis: usize) -> f64 {
        let mut far = self.min.abs().max(self.max.abs());
        if let Some(along) = AsMut::<[f64; 3]>::as_mut(&mut far).get_mut(axis) {
            *along = 0.0;
        }
        far.length()
    }
}

impl Bounds3 {
    /// Signed distance to the box, negative inside.
    pub fn signed_distance(self, point: DVec3) -> f64 {
        let outside = self.distance(point);
        if outside > 0.0 {
            return outside;
        }
        (self.min - point).max(point - self.max).max_element()
    }
}
