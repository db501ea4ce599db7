//! Properties of a field, computed from the leaves to the root, and bounding boxes.
//!
//! The properties state the exactness of the value in the air and in the solid, and the Lipschitz constant L of the
//! value. |value| / L never exceeds the distance to the surface, which makes a step of this length safe (Hart 1996,
//! theorem 1). Each shape and operator has its own rule. Two rules are common. The value of several joined fields is a
//! bound, with the greatest L of the fields. Moving, rotating, mirroring and cutting space never increases a distance.

use Exactness::{Bound, Exact, Neither};
use glam::{DMat3, DVec3};

/// The relation of a value to the distance to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exactness {
    /// The value is the Euclidean distance.
    Exact,
    /// The value never exceeds the distance.
    Bound,
    /// The value is neither, and must be divided by the Lipschitz constant.
    Neither,
}

/// Properties of a field that are known without evaluating it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Properties {
    /// Exactness of positive values.
    pub in_air: Exactness,
    /// Exactness of negative values.
    pub in_solid: Exactness,
    /// Lipschitz constant of the value; at least 1.
    pub lipschitz: f64,
    /// Bounds of the solid.
    pub bounds: Bounds3,
    /// Whether the solid is convex.
    pub convex: bool,
    /// Whether the solid is symmetric about x = 0, y = 0 and z = 0.
    pub symmetric: [bool; 3],
}

/// Properties of a surface that are known without evaluating the field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceKind {
    /// Whether the whole surface consists of planes.
    pub flat: bool,
    /// Whether the surface has neither edges nor corners.
    pub smooth: bool,
    /// Whether the surface is that of a single child, moved, rotated or scaled.
    pub moved: bool,
}

impl SurfaceKind {
    /// A surface without known properties.
    pub(super) const GENERAL: SurfaceKind = SurfaceKind {
        flat: false,
        smooth: false,
        moved: false,
    };
    /// Planes with edges between them. An operator of this kind has a flat surface if its children are flat, with edges
    /// where the surfaces of the children meet.
    pub(super) const FLAT: SurfaceKind = SurfaceKind {
        flat: true,
        ..SurfaceKind::GENERAL
    };
    /// A curved surface without edges. An operator of this kind has a smooth surface if its children are smooth.
    pub(super) const SMOOTH: SurfaceKind = SurfaceKind {
        smooth: true,
        ..SurfaceKind::GENERAL
    };
    /// A single plane.
    pub(super) const PLANE: SurfaceKind = SurfaceKind {
        flat: true,
        smooth: true,
        moved: false,
    };
    /// The child's surface with air and solid exchanged.
    pub(super) const TURNED_INSIDE_OUT: SurfaceKind = SurfaceKind::PLANE;
    /// The child's surface, moved.
    pub(super) const MOVED: SurfaceKind = SurfaceKind {
        flat: true,
        smooth: true,
        moved: true,
    };
}

impl Properties {
    /// Properties of a convex and symmetric solid with exact distances on both sides.
    pub(super) fn exact(half_size: DVec3) -> Properties {
        Properties {
            in_air: Exact,
            in_solid: Exact,
            lipschitz: 1.0,
            bounds: Bounds3::centred(half_size),
            convex: true,
            symmetric: [true; 3],
        }
    }

    /// Properties of a symmetric solid whose value is a bound of the distance on both sides.
    pub(super) fn bound(bounds: Bounds3) -> Properties {
        Properties {
            in_air: Bound,
            in_solid: Bound,
            lipschitz: 1.0,
            bounds,
            convex: false,
            symmetric: [true; 3],
        }
    }

    /// Properties of a solid of revolution about y with exact distances on both sides.
    pub(super) fn round(radius: f32, half_height: f64) -> Properties {
        let radius = f64::from(radius);
        Properties::exact(DVec3::new(radius, half_height, radius))
    }

    /// Sets the Lipschitz constant. A value with a constant above 1 is not a bound.
    pub(super) fn growing(mut self, lipschitz: f64) -> Properties {
        self.lipschitz = lipschitz.max(1.0);
        if self.lipschitz > 1.0 {
            (self.in_air, self.in_solid) = (Neither, Neither);
        }
        self
    }
}

impl Exactness {
    /// The weakest exactness of several values, if `lipschitz` is the greatest of their Lipschitz constants.
    pub(super) fn worst(of: impl Iterator<Item = Exactness>, lipschitz: f64) -> Exactness {
        let mut of = of;
        match lipschitz > 1.0 {
            true => Neither,
            false if of.all(|e| e == Exact) => Exact,
            false => Bound,
        }
    }

    /// `Bound` if the Lipschitz constant is at most 1, otherwise `Neither`.
    pub(super) fn bound(lipschitz: f64) -> Exactness {
        if lipschitz > 1.0 { Neither } else { Bound }
    }

    /// Reduces `Exact` to `Bound`.
    pub(super) fn or_bound(self) -> Exactness {
        if self == Exact { Bound } else { self }
    }
}

/// An axis-aligned bounding box of a solid: its least and greatest coordinates in metres, ±∞ along unbounded axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Least x, y, z.
    pub min: DVec3,
    /// Greatest x, y, z.
    pub max: DVec3,
}

impl Bounds3 {
    pub(super) const fn new(min: DVec3, max: DVec3) -> Bounds3 {
        Bounds3 { min, max }
    }

    /// All of space.
    pub const EVERYWHERE: Bounds3 = Bounds3::new(DVec3::NEG_INFINITY, DVec3::INFINITY);

    /// The box centred on the origin with this half size.
    pub fn centred(half_size: DVec3) -> Bounds3 {
        Bounds3::new(-half_size, half_size)
    }

    /// The smallest box that contains the points.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Bounds3 {
        let nothing = Bounds3::new(DVec3::INFINITY, DVec3::NEG_INFINITY);
        let grow = |all: Bounds3, p| Bounds3::new(all.min.min(p), all.max.max(p));
        points.into_iter().fold(nothing, grow)
    }

    /// The smallest box that contains both boxes.
    #[must_use]
    pub fn hull(self, other: Bounds3) -> Bounds3 {
        Bounds3::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// The intersection of both boxes. If it is empty, its minimum can exceed its maximum.
    #[must_use]
    pub fn common(self, other: Bounds3) -> Bounds3 {
        Bounds3::new(self.min.max(other.min), self.max.min(other.max))
    }

    /// The box grown on each side by a length in metres along each axis.
    #[must_use]
    pub fn grown(self, by: DVec3) -> Bounds3 {
        Bounds3::new(self.min - by, self.max + by)
    }

    /// The box moved by a vector in metres.
    #[must_use]
    pub fn moved(self, by: DVec3) -> Bounds3 {
        Bounds3::new(self.min + by, self.max + by)
    }

    /// The box scaled about the origin.
    #[must_use]
    pub fn scaled(self, by: f64) -> Bounds3 {
        Bounds3::new(self.min * by, self.max * by)
    }

    /// The bounding box of the box rotated about the origin.
    #[must_use]
    pub fn turned(self, by: DMat3) -> Bounds3 {
        let mut turned = Bounds3::new(DVec3::ZERO, DVec3::ZERO);
        for column in 0..3 {
            for row in 0..3 {
                let share = by.col(column)[row];
                // Avoids 0 · ∞. The matrix of a quarter turn in `f32` has residues of 4e-8.
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

    /// Whether the boxes do not touch, including their faces.
    pub(super) fn is_apart_from(self, other: Bounds3) -> bool {
        self.common(other).is_empty()
    }

    /// Whether the box is empty.
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether the box is bounded on every side.
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Half the size.
    pub fn half_size(self) -> DVec3 {
        0.5 * (self.max - self.min)
    }

    /// The middle along axes on which both faces are finite; 0 along other axes.
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

    /// The greatest distance of the box's points from the axis through the origin with this index (0 = x, 1 = y, 2 =
    /// z). Any other index gives the distance from the origin.
    pub fn radius_about(self, axis: usize) -> f64 {
        let mut far = self.min.abs().max(self.max.abs());
        if let Some(along) = AsMut::<[f64; 3]>::as_mut(&mut far).get_mut(axis) {
            *along = 0.0;
        }
        far.length()
    }

    /// Signed distance to the box in metres, negative inside.
    pub fn signed_distance(self, point: DVec3) -> f64 {
        let outside = self.distance(point);
        if outside > 0.0 {
            return outside;
        }
        (self.min - point).max(point - self.max).max_element()
    }
}

/// The smallest box that contains all bounds.
pub(super) fn hull(of: &[Properties]) -> Bounds3 {
    let bounds = of.iter().map(|p| p.bounds);
    bounds.reduce(Bounds3::hull).unwrap_or(Bounds3::EVERYWHERE)
}

/// Properties of several joined fields: a bound with the greatest Lipschitz constant, symmetric if all fields are
/// symmetric.
pub(super) fn merged(of: &[Properties], bounds: Bounds3) -> Properties {
    let lipschitz = of.iter().map(|p| p.lipschitz).fold(1.0, f64::max);
    let every = |axis: usize| of.iter().all(|p| p.symmetric[axis]);
    Properties {
        symmetric: [0, 1, 2].map(every),
        ..Properties::bound(bounds).growing(lipschitz)
    }
}
