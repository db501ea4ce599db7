//! A line against a field, in `f64`: sphere tracing down to the last bits.
//!
//! A field has no closed form in general, so its truth is a march too, but one that shares
//! nothing with the shader's: plain steps of the value divided by the Lipschitz constant,
//! until the value is `TOUCH` of the field's extent. A place where the value is that small
//! counts as a hit only if the line goes into the solid there; a line that leaves the
//! surface is led away from it by steps of at least [`LEAST_STEP`].

use crate::scene::{Bounds3, Shape};
use glam::DVec3;

/// A value that counts as the surface, as a share of the extent.
const TOUCH: f64 = 1e-12;

/// The shortest step, as a share of the extent: the least that still moves a place whose
/// coordinates are a thousand extents.
const LEAST_STEP: f64 = 1e-12;

/// Half the step of difference quotients, as a share of the extent: their error is then below
/// 1e-9, of rounding and curvature alike.
const DIFFERENCE: f64 = 1e-6;

/// How far ahead a line is sampled to decide whether it enters the solid, as a share of the
/// extent: so near that no crease lies between, and a slope of 1e-8 is still resolved.
const AHEAD: f64 = 1e-8;

/// Steps of one march at most. A line that grazes a surface takes thousands.
const STEPS: usize = 200_000;

/// How many extents away a line is given up.
const FAR: f64 = 1e6;

/// A field with what its march needs.
#[derive(Clone, Debug)]
pub(super) struct MarchedField {
    field: Shape,
    inverse_lipschitz: f64,
    extent: f64,
    bounds: Bounds3,
    convex: bool,
}

impl MarchedField {
    pub fn new(field: &Shape) -> MarchedField {
        let properties = field.properties();
        // Of a plane every length is as good.
        let extent = Some(field.extent()).filter(|e| *e > 0.0).unwrap_or(1.0);
        MarchedField {
            field: field.clone(),
            inverse_lipschitz: 1.0 / properties.lipschitz,
            extent,
            bounds: properties.bounds,
            convex: properties.convex,
        }
    }

    /// Whether a wave that leaves it cannot meet it next.
    pub fn is_convex(&self) -> bool {
        self.convex
    }

    /// The largest coordinate that belongs to it, in metres.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// What holds its solid, in its own axes.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Never more than the distance, in metres.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.field.value(p) * self.inverse_lipschitz
    }

    /// Metres along the unit vector `d` from `o`, which is in the air or on the surface; nothing
    /// for what lies farther off than `until` metres.
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

    fn goes_in(&self, p: DVec3, d: DVec3) -> bool {
        self.distance(p + AHEAD * self.extent * d) < self.distance(p)
    }

    /// The gradient. Values may bend at the very surface (that of a quadric goes with F |F|), and
    /// central differences are then off by as much as their step; so those of two steps are taken
    /// to where a step of 0 would be (Richardson).
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

    /// A place next to the surface, set onto it, and the unit normal there.
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
