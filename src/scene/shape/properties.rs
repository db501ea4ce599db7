//! Properties of a field, from its leaves up.
//!
//! Exactness on either side, and the Lipschitz constant L of the value: |value| / L never exceeds
//! the distance to the surface, which is what a safe step needs (Hart 1996, theorem 1). Each shape
//! and operator has its own rule. Common rules: where several fields are joined the value is a
//! bound, with the greatest L; moving, turning, mirroring and cutting space never increases a
//! distance.

use super::Bounds3;
use glam::DVec3;

/// The relation of a value to the distance to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exactness {
    /// The value is the Euclidean distance.
    Exact,
    /// The value never exceeds the distance.
    Bound,
    /// Neither: it must be divided by the Lipschitz constant.
    Neither,
}

/// Properties of a field that are known without evaluating it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Properties {
    /// The relation of positive values to the distance.
    pub in_air: Exactness,
    /// The relation of negative values to the distance.
    pub in_solid: Exactness,
    /// The Lipschitz constant of the value; at least 1.
    pub lipschitz: f64,
    /// Bounds of the solid.
    pub bounds: Bounds3,
    /// Whether the solid is convex.
    pub convex: bool,
    /// Whether it is symmetric about x = 0, y = 0, z = 0.
    pub symmetric: [bool; 3],
}

/// The kind of a surface, known without evaluating it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceKind {
    /// Whether all of it lies in planes.
    pub flat: bool,
    /// Whether it has no edges and no corners.
    pub smooth: bool,
    /// Whether it is that of a single child moved, turned or scaled.
    pub moved: bool,
}

impl SurfaceKind {
    /// A surface of unknown kind.
    pub(super) const GENERAL: SurfaceKind = SurfaceKind {
        flat: false,
        smooth: false,
        moved: false,
    };
    /// Planes with edges between them; for an operator, flat if its children are, with edges where these meet.
    pub(super) const FLAT: SurfaceKind = SurfaceKind {
        flat: true,
        ..SurfaceKind::GENERAL
    };
    /// Curved, without edges; for an operator, smooth if its children are.
    pub(super) const SMOOTH: SurfaceKind = SurfaceKind {
        smooth: true,
        ..SurfaceKind::GENERAL
    };
    /// One plane.
    pub(super) const PLANE: SurfaceKind = SurfaceKind {
        flat: true,
        smooth: true,
        moved: false,
    };
    /// The child's, seen from its other side.
    pub(super) const TURNED_INSIDE_OUT: SurfaceKind = SurfaceKind::PLANE;
    /// The child's, moved.
    pub(super) const MOVED: SurfaceKind = SurfaceKind {
        flat: true,
        smooth: true,
        moved: true,
    };
}

use Exactness::{Bound, Exact, Neither};

impl Properties {
    /// A solid with its exact distance on both sides, convex and symmetric.
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

    /// A bound of the distance on both sides, symmetric.
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

    /// A solid about y with its exact distance on both sides.
    pub(super) fn round(radius: f32, half_height: f64) -> Properties {
        let radius = f64::from(radius);
        Properties::exact(DVec3::new(radius, half_height, radius))
    }

    /// Sets the Lipschitz constant; above 1 the value is not even a bound.
    pub(super) fn growing(mut self, lipschitz: f64) -> Properties {
        self.lipschitz = lipschitz.max(1.0);
        if self.lipschitz > 1.0 {
            (self.in_air, self.in_solid) = (Neither, Neither);
        }
        self
    }
}

impl Exactness {
    /// The common relation of several values, with the Lipschitz constant of the steepest.
    pub(super) fn worst(of: impl Iterator<Item = Exactness>, lipschitz: f64) -> Exactness {
        let mut of = of;
        match lipschitz > 1.0 {
            true => Neither,
            false if of.all(|e| e == Exact) => Exact,
            false => Bound,
        }
    }

    /// A bound, if the constant allows it.
    pub(super) fn bound(lipschitz: f64) -> Exactness {
        if lipschitz > 1.0 { Neither } else { Bound }
    }

    /// Turns an exact distance into a bound.
    pub(super) fn or_bound(self) -> Exactness {
        if self == Exact { Bound } else { self }
    }
}

/// Common bounds of all.
pub(super) fn hull(of: &[Properties]) -> Bounds3 {
    let bounds = of.iter().map(|p| p.bounds);
    bounds.reduce(Bounds3::hull).unwrap_or(Bounds3::EVERYWHERE)
}

/// Properties of fields joined to one: a bound with the greatest constant, symmetric if all are.
pub(super) fn merged(of: &[Properties], bounds: Bounds3) -> Properties {
    let lipschitz = of.iter().map(|p| p.lipschitz).fold(1.0, f64::max);
    let every = |axis: usize| of.iter().all(|p| p.symmetric[axis]);
    Properties {
        symmetric: [0, 1, 2].map(every),
        ..Properties::bound(bounds).growing(lipschitz)
    }
}
