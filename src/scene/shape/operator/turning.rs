//! Twist and bend: rotations by an angle that is proportional to a coordinate.
//!
//! A twist rotates by rate · y. Its Jacobian is I + s t yᵀ with s = rate · radius and unit vectors t ⟂ y, and its norm
//! is (s + √(s² + 4)) / 2. For a bend, t need not be perpendicular, and the norm is at most 1 + s. Beyond the radius of
//! the child's bounds, the value combines the value at this radius with the distance beyond it.

use super::{Bounds3, Part, Properties, Shape, ShapeFile, part};
use crate::scene::notation::{Fields, Lipschitz, Written};
use glam::DVec3;
use serde::de::{Deserialize, Deserializer};

/// A rotation about an axis (1: y, a twist; 2: z, a bend) by an angle proportional to y or x.
struct Turning {
    pub axis: usize,
    /// Rate of the rotation in radians per metre.
    pub rate: f64,
    /// The stated Lipschitz constant; 0 if it is not stated.
    pub stated: f64,
}

/// The largest Lipschitz constant that can be stated. A march with a larger constant does not end in practice. The
/// smallest is 1, because the constant of a rotation is never smaller.
const LARGEST_LIPSCHITZ: f32 = 1e6;

/// Rejects a stated Lipschitz constant that is out of range; 0 means that it is not stated.
///
/// # Errors
/// A message that states the valid range.
fn check_stated(lipschitz: f32) -> Result<(), String> {
    if lipschitz == 0.0 || (1.0..=LARGEST_LIPSCHITZ).contains(&lipschitz) {
        return Ok(());
    }
    Err(format!("its lipschitz must be 1 to 1e6, not {lipschitz}"))
}

impl Turning {
    /// Rejects a child that extends infinitely far from the axis, because its value would grow without bound.
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
            "its child is unbounded away from the {away} axis, so that its value grows without bound: intersect the child with a bounded shape"
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

    /// Evaluates the child at the point rotated back, which rotates the child by the right-hand rule.
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

    /// Rate, radius of the child's own bounds, and Lipschitz constant.
    pub fn shader_numbers(&self, child: &Shape) -> Vec<f64> {
        /// Replaces infinite values.
        const ENDLESS: f64 = 1e30;
        let radius = child.properties().bounds.radius_about(self.axis);
        let lipschitz = self.properties(child).lipschitz;
        vec![self.rate, radius.min(ENDLESS), lipschitz.min(ENDLESS)]
    }
}

/// The norm of the Jacobian of a twist (axis 1) or a bend (axis 2), for s = rate · radius.
fn norm_of_turning(axis: usize, s: f64) -> f64 {
    match axis {
        1 => 0.5 * (s + (s * s + 4.0).sqrt()),
        _ => 1.0 + s,
    }
}

/// Reads a stated Lipschitz constant; 0 if it is not stated.
fn stated<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    let stated = Option::<Lipschitz>::deserialize(from)?;
    Ok(stated.map_or(0.0, |stated| stated.0))
}

/// Defines a twist or a bend, with the properties of [`Turning`] about one axis.
macro_rules! turning {
    ($(#[$doc:meta])* $part:ident about $axis:literal, $rate:literal) => {
        part! {
            $(#[$doc])*
            $part over (of: Box<ShapeFile>) {
                #[doc = $rate]
                rate: f32 as Rate,
            } and {
                /// The stated Lipschitz constant; 0 if it is to be computed from the bounds.
                #[serde(default, deserialize_with = "stated")]
                lipschitz: f32,
            }
        }

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

turning! {
    /// The child, rotated about y by an angle proportional to y.
    Twist about 1, "Radians per metre of y."
}

turning! {
    /// The child, rotated about z by the right-hand rule, by an angle proportional to x. A bar along x becomes an arc.
    Bend about 2, "Radians per metre of x."
}

#[cfg(test)]
mod tests {
    use super::super::super::Cuboid;
    use super::*;
    use glam::Vec3;

    /// A bar along x that is thin along the other two axes.
    fn bar() -> Shape {
        let size = Vec3::new(4.0, 0.1, 0.1);
        Cuboid { size }.into()
    }

    /// Protects the documented direction of rotation. With a positive rate, a twist rotates the upper part from z
    /// towards x, and a bend rotates the right part from x towards y.
    #[test]
    fn twist_and_bend_are_right_handed() {
        const RATE: f64 = 0.5;
        let (sin, cos) = RATE.sin_cos();
        let twisted = bar().translate(Vec3::Y).twist(RATE as f32);
        assert!(twisted.value(DVec3::new(cos, 1.0, -sin)) < 0.0);
        assert!(twisted.value(DVec3::new(cos, 1.0, sin)) > 0.0);
        let bent = bar().bend(RATE as f32);
        // At x = 1 the bar is rotated by half a radian.
        assert!(bent.value(DVec3::new(1.0, RATE.tan(), 0.0)) < 0.0);
        assert!(bent.value(DVec3::new(1.0, -RATE.tan(), 0.0)) > 0.0);
    }
}
