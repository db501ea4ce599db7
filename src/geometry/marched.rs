//! Intersections of a line with a field in `f64`, by sphere tracing to the limit of precision.
//!
//! Most fields have no closed-form intersection, so their reference is a march too. It has no code in common with the
//! march of the shader. Its steps are the value divided by the Lipschitz constant, until the value is at most `TOUCH`
//! times the extent of the field. A point with such a small value is a hit only if the line enters the solid there. A
//! line that leaves the surface continues by steps of at least [`LEAST_STEP`].

use super::in_front::OpenPlane;
use super::sight::SightPart;
use crate::scene::{Bounds3, Exactness, Shape};
use glam::DVec3;
use std::sync::OnceLock;

/// Maximum value at a point on the surface, as a share of the extent.
const TOUCH: f64 = 1e-12;

/// Minimum step, as a share of the extent. It is large enough to change a position whose coordinates are a thousand
/// times the extent.
const LEAST_STEP: f64 = 1e-12;

/// Half the step of difference quotients, as a share of the extent. Their errors from rounding and from curvature are
/// then both below 1e-9.
const DIFFERENCE: f64 = 1e-6;

/// Distance ahead at which the value is sampled to decide whether a line enters the solid, as a share of the extent. It
/// is small enough to avoid creases, and large enough to resolve a slope of 1e-8.
const AHEAD: f64 = 1e-8;

/// Maximum number of steps of a march. A line that grazes a surface takes thousands of steps.
const STEPS: usize = 200_000;

/// Maximum length of a line, as a multiple of the extent.
const FAR: f64 = 1e6;

/// A field with the data that its march needs.
#[derive(Clone, Debug)]
pub(super) struct MarchedField {
    field: Shape,
    inverse_lipschitz: f64,
    extent: f64,
    bounds: Bounds3,
    convex: bool,
    has_exact_distance: bool,
    /// The parts for lines of sight, made at the first of them.
    parts: OnceLock<Vec<SightPart>>,
}

impl MarchedField {
    pub fn new(field: &Shape) -> MarchedField {
        let properties = field.properties();
        // A plane has an extent of 0, and any length is suitable instead.
        let extent = Some(field.extent()).filter(|e| *e > 0.0).unwrap_or(1.0);
        MarchedField {
            field: field.clone(),
            inverse_lipschitz: 1.0 / properties.lipschitz,
            extent,
            bounds: properties.bounds,
            convex: properties.convex,
            has_exact_distance: properties.in_air == Exactness::Exact,
            parts: OnceLock::new(),
        }
    }

    /// Whether a wave that leaves the field must hit another object before it can hit the field again.
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// Whether [`MarchedField::distance`] is the distance in the air, and not only a lower bound.
    pub fn has_exact_distance(&self) -> bool {
        self.has_exact_distance
    }

    /// The largest coordinate of the field in metres.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Bounding box of the field's solid, in the field's own axes.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// A lower bound of the distance to the field in metres.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.field.value(p) * self.inverse_lipschitz
    }

    /// A lower bound of the distance in front of an open plane face.
    pub fn distance_in_front(&self, p: DVec3, plane: OpenPlane) -> f64 {
        plane.value(&self.field, p) * self.inverse_lipschitz
    }

    /// Distance in metres to the first hit along the unit vector `d` from `o`, which is in the air or on the surface.
    /// `None` if there is no hit within `until` metres.
    pub fn intersect(&self, o: DVec3, d: DVec3, until: f64) -> Option<f64> {
        let until = until.min(FAR * self.extent);
        let touch = TOUCH * self.extent.max(o.abs().max_element());
        let least = LEAST_STEP * self.extent.max(o.abs().max_element());
        let mut t = 0.0;
        for _ in 0..STEPS {
            let p = o + t * d;
            let distance = self.distance(p);
            if distance <= touch {
                if self.goes_in(p, d) {
                    return Some(t);
                }
                t += distance.abs().max(least);
            } else {
                t += distance;
            }
            if t > until {
                return None;
            }
        }
        None
    }

    /// Distance in metres to the first solid on a line of sight along the unit vector `d` from `o`. `None` if there is none
    /// within `until` metres.
    pub fn enters(&self, o: DVec3, d: DVec3, until: f64) -> Option<f64> {
        let until = until.min(FAR * self.extent);
        let parts = self.parts.get_or_init(|| SightPart::all(&self.field));
        let mut nearest = None;
        for part in parts {
            nearest = part.enters(o, d, nearest.unwrap_or(until)).or(nearest);
        }
        nearest
    }

    fn goes_in(&self, p: DVec3, d: DVec3) -> bool {
        self.distance(p + AHEAD * self.extent * d) < self.distance(p)
    }

    /// The gradient. The value can have a kink exactly at the surface (the value of a quadric has a term F |F|). The
    /// error of central differences is then proportional to their step. The differences of two steps are therefore
    /// extrapolated to a step of 0 (Richardson extrapolation).
    fn gradient(&self, p: DVec3) -> DVec3 {
        let step = DIFFERENCE * self.extent;
        2.0 * self.differences(p, 0.5 * step) - self.differences(p, step)
    }

    fn differences(&self, p: DVec3, step: f64) -> DVec3 {
        let along = |axis: DVec3| {
            let growth = self.distance(p + axis * step) - self.distance(p - axis * step);
            growth / (2.0 * step)
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    /// Projects a point near the surface onto the surface, and returns the unit normal there too.
    pub fn project(&self, p: DVec3, d: DVec3) -> (DVec3, DVec3) {
        let gradient = self.gradient(p);
        let squared = gradient.length_squared();
        if squared == 0.0 {
            return (p, -d);
        }
        let point = p - gradient * (self.distance(p) / squared);
        (point, self.gradient(point).normalize_or(-d))
    }
}
