//! How hollow the level sets of a field are: bounds of the second derivative of its value along lines.
//!
//! Beside a convex solid the distance is a convex function along every line. Other fields bend downwards there, but at most
//! by a known curvature if their parts are smooth. A line of sight takes long steps with such a bound (`sight.rs`).

use crate::scene::{Node, Shape};

/// A bound of the second derivative of a value along any line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hollow {
    /// Greatest curvature in 1/m.
    pub bend: f64,
    /// Distance from the surface in metres up to which the bound is valid.
    pub reach_m: f64,
}

/// A value that is convex along every line.
const CONVEX: Hollow = Hollow {
    bend: 0.0,
    reach_m: f64::INFINITY,
};

/// Curvature of an ellipsoid's value, times the square of the least radius, divided by the greatest: 2 on a ball outside.
const ELLIPSOID: f64 = 2.0;

impl Hollow {
    /// A bound of −f″ for the value f of a shape in the air; `None` for shapes without a known bound.
    pub fn in_air(shape: &Shape) -> Option<Hollow> {
        if shape.has_convex_value() {
            return Some(CONVEX);
        }
        match &shape.node {
            Node::Ellipsoid(of) => Some(Hollow {
                bend: ellipsoid_bend(of.radii.as_dvec3()),
                reach_m: f64::INFINITY,
            }),
            Node::Torus(of) => {
                let hole = f64::from(of.ring) - f64::from(of.tube);
                (hole > 0.0).then(|| Hollow::round(hole))
            }
            Node::Translate(_) | Node::Rotate(_) => Hollow::in_air(&shape.children[0]),
            Node::Scale(of) => Some(Hollow::in_air(&shape.children[0])?.scaled(of.by.into())),
            Node::Complement(_) => Hollow::in_solid(&shape.children[0]),
            Node::Intersection(_) => most(shape, Hollow::in_air),
            Node::SmoothUnion(of) => {
                let of_parts = most(shape, Hollow::in_air)?;
                // Only where all parts have the bound in all air: a blend also contains parts that are farther away.
                let blends = shape.children.len().saturating_sub(1) as f64;
                (of_parts.reach_m == f64::INFINITY).then(|| Hollow {
                    // Slopes of two parts differ by 2 at most.
                    bend: of_parts.bend + blends * 2.0 / f64::from(of.radius),
                    ..of_parts
                })
            }
            _ => None,
        }
    }

    /// A bound of f″ for the value f of a shape, in the solid and in the air; `None` for shapes without a known bound.
    fn in_solid(shape: &Shape) -> Option<Hollow> {
        match &shape.node {
            Node::Plane(_) | Node::HalfSpace(_) => Some(CONVEX),
            Node::Sphere(of) => Some(Hollow::round(of.radius.into())),
            Node::Cylinder(of) => Some(Hollow::round(of.radius.into())),
            Node::Capsule(of) => Some(Hollow::round(of.radius.into())),
            Node::Ellipsoid(of) => Some(Hollow {
                bend: ellipsoid_bend(of.radii.as_dvec3()),
                reach_m: 0.25 * f64::from(of.radii.min_element()),
            }),
            Node::Translate(_) | Node::Rotate(_) => Hollow::in_solid(&shape.children[0]),
            Node::Scale(of) => Some(Hollow::in_solid(&shape.children[0])?.scaled(of.by.into())),
            // A minimum, blended or not, does not bend upwards more than its parts.
            Node::Union(_) | Node::SmoothUnion(_) => most(shape, Hollow::in_solid),
            _ => None,
        }
    }

    /// The bound within half the least radius of curvature in metres.
    fn round(radius: f64) -> Hollow {
        Hollow {
            bend: 2.0 / radius,
            reach_m: 0.5 * radius,
        }
    }

    /// The bound of a value that is divided by `by`, or whose shape is scaled by it.
    pub fn scaled(self, by: f64) -> Hollow {
        Hollow {
            bend: self.bend / by,
            reach_m: self.reach_m * by,
        }
    }
}

fn ellipsoid_bend(radii: glam::DVec3) -> f64 {
    ELLIPSOID * radii.max_element() / radii.min_element().powi(2)
}

/// The bound of all children of a shape.
fn most(shape: &Shape, of: fn(&Shape) -> Option<Hollow>) -> Option<Hollow> {
    shape.children.iter().try_fold(CONVEX, |most, child| {
        let child = of(child)?;
        Some(Hollow {
            bend: most.bend.max(child.bend),
            reach_m: most.reach_m.min(child.reach_m),
        })
    })
}
