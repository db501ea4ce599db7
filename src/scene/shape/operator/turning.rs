//! Common code of a twist and a bend: a turn proportional to a coordinate.
//!
//! A twist turns by rate · y, so its Jacobian is I + s t yᵀ with s = rate · radius and unit vectors
//! t ⟂ y: its norm is (s + √(s² + 4)) / 2. A bend's t need not be perpendicular: its norm is at
//! most 1 + s. Beyond the radius of the child's own bounds the value is that at the bounds plus the
//! distance to them.

use super::{Bounds3, Properties, Shape};
use glam::DVec3;

/// A turn about an axis (1: y, a twist; 2: z, a bend) proportional to y or x.
pub(super) struct Turning {
    pub axis: usize,
    /// Radians per metre.
    pub rate: f64,
    /// The stated Lipschitz constant; 0 if it is not stated.
    pub stated: f64,
}

/// The largest constant that may be stated. The least is 1: a turn never has less; with more than
/// the largest no march ends.
const LARGEST_LIPSCHITZ: f32 = 1e6;

/// Rejects a stated constant that is out of range; 0 stands for none.
///
/// # Errors
/// A message that states the valid range.
pub(super) fn check_stated(lipschitz: f32) -> Result<(), String> {
    if lipschitz == 0.0 || (1.0..=LARGEST_LIPSCHITZ).contains(&lipschitz) {
        return Ok(());
    }
    Err(format!("its lipschitz must be 1 to 1e6, not {lipschitz}"))
}

impl Turning {
    /// Rejects an unbounded child: its turned value would grow without bound.
    ///
    /// # Errors
    /// A message that states the requirement.
    pub fn check_over(&self, child: &Shape) -> Result<(), String> {
        let away = ["x", "y", "z"][self.axis];
        let bounds = child.properties().bounds;
        if bounds.radius_about(self.axis).is_finite() {
            return Ok(());
        }
        Err(format!(
            "what it turns has no end away from the {away} axis, so that its value grows without bound: intersect it with something that ends"
        ))
    }

    pub fn properties(&self, child: &Shape) -> Properties {
        let of = child.properties();
        let radius = of.bounds.radius_about(self.axis);
        let mut half = DVec3::splat(radius);
        half[self.axis] = 0.0;
        let mut bounds = Bounds3::centred(half);
        bounds.min[self.axis] = of.bounds.min[self.axis];
        bounds.max[self.axis] = of.bounds.max[self.axis];
        let lipschitz = match self.stated > 0.0 {
            true => self.stated,
            false => of.lipschitz * norm_of_turning(self.axis, self.rate.abs() * radius),
        };
        Properties {
            symmetric: [false; 3],
            ..Properties::bound(bounds).growing(lipschitz)
        }
    }

    /// The point is turned back, so that the child is turned right-handedly.
    pub fn value(&self, child: &Shape, p: DVec3) -> f64 {
        let most = child.properties().bounds.radius_about(self.axis);
        let mut aside = p;
        aside[self.axis] = 0.0;
        let radius = aside.length();
        let beyond = (radius - most).max(0.0);
        let mut held = match beyond > 0.0 {
            true => aside * (most / radius),
            false => aside,
        };
        held[self.axis] = p[self.axis];
        let value = child.value(self.turned_back(p, held));
        if beyond == 0.0 {
            return value;
        }
        let lipschitz = self.properties(child).lipschitz;
        value.max(0.0).hypot(lipschitz * beyond)
    }

    fn turned_back(&self, p: DVec3, held: DVec3) -> DVec3 {
        if self.axis == 1 {
            let (sin, cos) = (self.rate * p.y).sin_cos();
            let (x, z) = (held.x, held.z);
            return DVec3::new(cos * x - sin * z, held.y, sin * x + cos * z);
        }
        let (sin, cos) = (self.rate * held.x).sin_cos();
        let (x, y) = (held.x, held.y);
        DVec3::new(cos * x + sin * y, cos * y - sin * x, held.z)
    }

    /// Rate, radius of the child's own bounds, Lipschitz constant.
    pub fn shader_numbers(&self, child: &Shape) -> Vec<f64> {
        /// Represents an infinite radius.
        const ENDLESS: f64 = 1e30;
        let radius = child.properties().bounds.radius_about(self.axis);
        let lipschitz = self.properties(child).lipschitz;
        vec![self.rate, radius.min(ENDLESS), lipschitz.min(ENDLESS)]
    }
}

/// The norm of the Jacobian of a twist (axis 1) or a bend, for s = rate · radius.
fn norm_of_turning(axis: usize, s: f64) -> f64 {
    match axis {
        1 => 0.5 * (s + (s * s + 4.0).sqrt()),
        _ => 1.0 + s,
    }
}

/// A twist or a bend: the struct, its form in a scene file, and its properties, all from
/// [`Turning`] about one axis.
macro_rules! turning {
    ($(#[$doc:meta])* $part:ident about $axis:literal, a metre of $along:literal) => {
        use super::part::parameters;
        use super::turning::{Turning, check_stated};
        use super::{Part, Properties, Shape, ShapeFile};
        use crate::scene::notation::{Angle, Fields, Lipschitz, Number, Reader, Written};
        use crate::scene::shape::{FromFile, Operands};
        use crate::scene::{Quantity, SceneError};
        use glam::DVec3;
        use serde::Deserialize;

        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part {
            #[doc = concat!("Radians per metre of ", $along, ".")]
            pub rate: f32,
            /// The stated Lipschitz constant; 0 to compute it from the bounds.
            pub lipschitz: f32,
        }

        /// Its form in a scene file.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(crate) struct File {
            of: Box<ShapeFile>,
            rate: Number<Angle>,
            #[serde(default)]
            lipschitz: Option<Lipschitz>,
        }

        impl FromFile for File {
            fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
                let rate = reader.number("rate", self.rate);
                let lipschitz = self.lipschitz.map_or(0.0, |stated| stated.0);
                let part = $part { rate, lipschitz };
                Ok(Shape::over(part, self.of.read(reader)?))
            }
        }

        parameters!($part over (1, 1) { rate: Quantity::Rate });

        impl Part for $part {
            fn words(&self) -> Fields {
                let lipschitz = self.stated_lipschitz().into_iter();
                lipschitz.map(|stated| ("lipschitz", Written::Number(stated))).collect()
            }

            fn check(&self) -> Result<(), String> {
                check_stated(self.lipschitz)
            }

            fn check_over(&self, children: &[Shape]) -> Result<(), String> {
                self.turning().check_over(&children[0])
            }

            fn properties(&self, children: &[Shape]) -> Properties {
                self.turning().properties(&children[0])
            }

            fn value(&self, children: &[Shape], p: DVec3) -> f64 {
                self.turning().value(&children[0], p)
            }

            fn shader_numbers(&self, children: &[Shape]) -> Vec<f64> {
                self.turning().shader_numbers(&children[0])
            }

            fn stated_lipschitz(&self) -> Option<f32> {
                (self.lipschitz > 0.0).then_some(self.lipschitz)
            }
        }

        impl $part {
            fn turning(&self) -> Turning {
                Turning {
                    axis: $axis,
                    rate: self.rate.into(),
                    stated: self.lipschitz.into(),
                }
            }
        }
    };
}
pub(super) use turning;
