//! What a field promises, from its leaves up.
//!
//! Exactness on either side, and the Lipschitz constant L of the value: |value| / L never
//! exceeds the distance to the surface, which is what a safe step needs (Hart 1996,
//! theorem 1). The rules, for fields a and b:
//!
//! - a union is exact in the air if both are (Hart, section 3.3), an intersection in the
//!   solid; elsewhere both are bounds, with the greater L;
//! - a smooth union mixes the gradients of the two: L stays the greater one;
//! - moving, turning, mirroring and cutting space (elongate, clamp) never grow a distance;
//! - a twist turns by rate · y, so its Jacobian is I + s t yᵀ with s = rate · radius and
//!   unit vectors t ⟂ y: its norm is (s + √(s² + 4)) / 2. A bend's t need not be
//!   perpendicular: its norm is at most 1 + s. Beyond the radius of the field's own bounds
//!   the value is that at the bounds, and the way there.

use super::{Bounds3, Field, Node};
use glam::{DVec2, DVec3};

/// What a value says about the distance to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exactness {
    /// It is the Euclidean distance.
    Exact,
    /// It is never more.
    Bound,
    /// Neither: it must be divided by the Lipschitz constant.
    Neither,
}

/// What is known of a field without evaluating it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// What positive values say.
    pub in_air: Exactness,
    /// What negative values say.
    pub in_solid: Exactness,
    /// How much faster than the way the value changes at the most; at least 1.
    pub lipschitz: f64,
    /// What holds the solid.
    pub bounds: Bounds3,
    /// Whether the solid is convex.
    pub convex: bool,
    /// Whether it is the same mirrored at x = 0, y = 0, z = 0.
    pub symmetric: [bool; 3],
}

use Exactness::{Bound, Exact, Neither};

impl Properties {
    /// A solid with its exact distance on both sides, convex and symmetric.
    fn exact(half_size: DVec3) -> Properties {
        Properties {
            in_air: Exact,
            in_solid: Exact,
            lipschitz: 1.0,
            bounds: Bounds3::centred(half_size),
            convex: true,
            symmetric: [true; 3],
        }
    }

    fn bound(bounds: Bounds3) -> Properties {
        Properties {
            in_air: Bound,
            in_solid: Bound,
            lipschitz: 1.0,
            bounds,
            convex: false,
            symmetric: [true; 3],
        }
    }

    /// With a Lipschitz constant; above 1 the value is not even a bound.
    fn growing(mut self, lipschitz: f64) -> Properties {
        self.lipschitz = lipschitz.max(1.0);
        if self.lipschitz > 1.0 {
            (self.in_air, self.in_solid) = (Neither, Neither);
        }
        self
    }
}

impl Field {
    /// What the field promises.
    pub fn properties(&self) -> Properties {
        if self.of.is_empty() {
            return self.shape_properties();
        }
        let of: Vec<Properties> = self.of.iter().map(Field::properties).collect();
        self.operator_properties(&of)
    }

    /// How far the solid may reach out of its bounds when its surface is moved to a value
    /// of 1 m, along any axis. 1 m where the value is the distance; a bound of the distance
    /// can be slower, and its levels further apart.
    ///
    /// An ellipsoid: with m = |p / radii|, F = m² - 1 and g ≤ 2 m / least, its value is at
    /// least (m - 1) least / (1 + √2), while no axis is left by more than (m - 1) greatest.
    pub(super) fn slowness(&self) -> f64 {
        let slowest = || self.of.iter().map(Field::slowness).fold(1.0, f64::max);
        match &self.node {
            Node::Ellipsoid { radii } => {
                let stretch = f64::from(radii.max_element()) / f64::from(radii.min_element());
                (1.0 + std::f64::consts::SQRT_2) * stretch
            }
            // The other side of everywhere.
            Node::Complement => 1.0,
            // A corner of a box that grows along its axes moves by √3 of that.
            Node::Rotate { .. } if self.of[0].properties().in_air != Exact => {
                3f64.sqrt() * slowest()
            }
            _ => slowest(),
        }
    }

    fn shape_properties(&self) -> Properties {
        let wide = |v: glam::Vec3| v.as_dvec3();
        let round = |radius: f32, half_height: f64| {
            let radius = f64::from(radius);
            Properties::exact(DVec3::new(radius, half_height, radius))
        };
        let endless = f64::INFINITY;
        match &self.node {
            Node::Plane => Properties {
                bounds: Bounds3 {
                    max: DVec3::new(endless, 0.0, endless),
                    ..Bounds3::EVERYWHERE
                },
                symmetric: [true, false, true],
                ..Properties::exact(DVec3::ZERO)
            },
            Node::HalfSpace { .. } => Properties {
                bounds: Bounds3::EVERYWHERE,
                symmetric: [false; 3],
                ..Properties::exact(DVec3::ZERO)
            },
            Node::Box { size } => Properties::exact(0.5 * wide(*size)),
            Node::RoundedBox { size, .. } => Properties::exact(0.5 * wide(*size)),
            Node::Room { .. } => Properties {
                in_air: Exact,
                convex: false,
                ..Properties::bound(Bounds3::EVERYWHERE)
            },
            Node::Sphere { radius } => round(*radius, f64::from(*radius)),
            Node::Cylinder { radius } => round(*radius, endless),
            Node::CappedCylinder { radius, height } => round(*radius, 0.5 * f64::from(*height)),
            Node::Capsule { radius, height } => {
                round(*radius, f64::from(*radius) + 0.5 * f64::from(*height))
            }
            Node::Torus { ring, tube } => Properties {
                // A tube that reaches over the axis covers its own inner side: that is no
                // surface, but the value is the distance to it.
                in_solid: if tube > ring { Bound } else { Exact },
                convex: false,
                ..round(ring + tube, f64::from(*tube))
            },
            Node::Cone { radius, height } => Properties {
                symmetric: [true, false, true],
                ..round(*radius, 0.5 * f64::from(*height))
            },
            Node::Prism { corners, depth } => prism(corners.map(|c| c.as_dvec2()), *depth),
            Node::Ellipsoid { radii } => Properties {
                convex: true,
                ..Properties::bound(Bounds3::centred(wide(*radii)))
            },
            Node::Paraboloid { .. } => Properties {
                convex: true,
                symmetric: [true, false, true],
                // Below the vertex its value grows as the root of the way: no multiple of it
                // bounds how far a level lies from y = 0.
                ..Properties::bound(Bounds3::EVERYWHERE)
            },
            Node::Hyperboloid { .. } => Properties::bound(Bounds3::EVERYWHERE),
            Node::Quadric { .. } => Properties {
                symmetric: [false; 3],
                ..Properties::bound(Bounds3::EVERYWHERE)
            },
            Node::HeightField { size, .. } => Properties {
                symmetric: [false; 3],
                ..Properties::bound(Bounds3::centred(0.5 * wide(*size)))
            },
            Node::User { field } => Properties {
                symmetric: [false; 3],
                ..Properties::bound(Bounds3::centred(0.5 * wide(field.size)))
            },
            // An operator over nothing; refused when it is checked.
            _ => Properties::bound(Bounds3::EVERYWHERE),
        }
    }

    fn operator_properties(&self, of: &[Properties]) -> Properties {
        let first = of[0];
        let lipschitz = of.iter().map(|p| p.lipschitz).fold(1.0, f64::max);
        let merged = |bounds: Bounds3| {
            let every = |axis: usize| of.iter().all(|p| p.symmetric[axis]);
            Properties {
                symmetric: [0, 1, 2].map(every),
                ..Properties::bound(bounds).growing(lipschitz)
            }
        };
        let slowest = || self.of.iter().map(Field::slowness).fold(1.0, f64::max);
        let hull = || of[1..].iter().fold(first.bounds, |b, p| b.hull(p.bounds));
        let common = || of[1..].iter().fold(first.bounds, |b, p| b.common(p.bounds));
        match &self.node {
            Node::Union => Properties {
                in_air: worst(of.iter().map(|p| p.in_air), lipschitz),
                convex: of.len() == 1 && first.convex,
                ..merged(hull())
            },
            Node::Intersection => Properties {
                in_solid: worst(of.iter().map(|p| p.in_solid), lipschitz),
                convex: of.iter().all(|p| p.convex),
                ..merged(common())
            },
            Node::Difference => merged(first.bounds),
            Node::SmoothUnion { radius } => {
                let reach = slowest() * blend_reach(*radius, of.len());
                merged(hull().grown(DVec3::splat(reach)))
            }
            Node::Morph { .. } => merged(hull()),
            Node::Complement => Properties {
                in_air: first.in_solid,
                in_solid: first.in_air,
                bounds: Bounds3::EVERYWHERE,
                convex: false,
                ..first
            },
            Node::Shell { thickness } => Properties {
                in_air: both(first),
                in_solid: if lipschitz > 1.0 { Neither } else { Bound },
                bounds: first
                    .bounds
                    .grown(DVec3::splat(slowest() * 0.5 * f64::from(*thickness))),
                convex: false,
                ..first
            },
            Node::Offset { by } => offset(first, f64::from(*by), slowest()),
            _ => self.warped(first),
        }
    }

    /// Operators on space.
    fn warped(&self, of: Properties) -> Properties {
        match &self.node {
            Node::Translate { by } => Properties {
                bounds: of.bounds.moved(by.as_dvec3()),
                symmetric: [0, 1, 2].map(|axis| of.symmetric[axis] && by[axis] == 0.0),
                ..of
            },
            Node::Rotate { by } => Properties {
                bounds: of.bounds.turned(super::value::turn_matrix(*by)),
                symmetric: [false; 3],
                ..of
            },
            Node::Scale { by } => Properties {
                bounds: of.bounds.scaled(f64::from(*by)),
                ..of
            },
            Node::Mirror { axes } => mirrored(of, *axes),
            Node::Repeat { period, count } => repeated(of, period.as_dvec3(), *count),
            Node::Elongate { by } => Properties {
                in_air: if of.lipschitz > 1.0 { Neither } else { Bound },
                in_solid: if of.lipschitz > 1.0 { Neither } else { Bound },
                bounds: of.bounds.grown(by.as_dvec3()),
                // Pulled apart, a slanted side that crosses the cut gets a step; a solid
                // that is the same on both sides is the sum with a box of half size `by`.
                convex: of.convex && (0..3).all(|a| by[a] == 0.0 || of.symmetric[a]),
                ..of
            },
            Node::Twist { rate, lipschitz } => turned(of, 1, *rate, *lipschitz),
            Node::Bend { rate, lipschitz } => turned(of, 2, *rate, *lipschitz),
            _ => of,
        }
    }
}

fn worst(of: impl Iterator<Item = Exactness>, lipschitz: f64) -> Exactness {
    if lipschitz > 1.0 {
        return Neither;
    }
    let mut of = of;
    if of.all(|e| e == Exact) { Exact } else { Bound }
}

fn both(of: Properties) -> Exactness {
    worst([of.in_air, of.in_solid].into_iter(), of.lipschitz)
}

/// How far a smooth union reaches beyond the plain one: a quarter of the radius for each
/// field that is blended in.
fn blend_reach(radius: f32, fields: usize) -> f64 {
    0.25 * f64::from(radius) * fields.saturating_sub(1) as f64
}

fn offset(of: Properties, by: f64, slowness: f64) -> Properties {
    let bound = |side: Exactness| if side == Exact { Bound } else { side };
    // The surface moves towards one side; on that side distances stay what they were.
    let (in_air, in_solid) = if by >= 0.0 {
        (of.in_air, bound(of.in_solid))
    } else {
        (bound(of.in_air), of.in_solid)
    };
    Properties {
        in_air,
        in_solid,
        bounds: if by > 0.0 {
            of.bounds.grown(DVec3::splat(slowness * by))
        } else {
            of.bounds
        },
        // By distances a convex solid stays convex; the levels of a bound need not be.
        convex: of.convex
            && match by {
                by if by > 0.0 => of.in_air == Exact,
                by if by < 0.0 => of.in_solid == Exact,
                _ => true,
            },
        ..of
    }
}

fn mirrored(of: Properties, axes: [bool; 3]) -> Properties {
    let mut result = of;
    result.convex = of.convex && axes == [false; 3];
    for (axis, mirrors) in axes.into_iter().enumerate() {
        if !mirrors {
            continue;
        }
        result.symmetric[axis] = true;
        let far = of.bounds.max[axis];
        (result.bounds.min[axis], result.bounds.max[axis]) = (-far, far);
        if of.symmetric[axis] {
            continue;
        }
        let bound = |side: Exactness| if side == Exact { Bound } else { side };
        // What reaches over the mirror is cut off there, but its distance is not.
        if of.bounds.min[axis] < 0.0 {
            result.in_air = bound(result.in_air);
        }
        // What touches the mirror grows together with its image: its face there is gone.
        if of.bounds.min[axis] <= 0.0 {
            result.in_solid = bound(result.in_solid);
        }
    }
    result
}

fn repeated(of: Properties, period: DVec3, count: [u32; 3]) -> Properties {
    let mut result = of;
    result.convex = false;
    result.in_solid = if of.lipschitz > 1.0 { Neither } else { Bound };
    for axis in 0..3 {
        if period[axis] == 0.0 {
            continue;
        }
        let reach = match count[axis] {
            0 => f64::INFINITY,
            count => 0.5 * f64::from(count - 1) * period[axis],
        };
        result.bounds.min[axis] -= reach;
        result.bounds.max[axis] += reach;
    }
    result
}

/// A twist (about y) or a bend (about z).
fn turned(of: Properties, axis: usize, rate: f32, stated: f32) -> Properties {
    let radius = of.bounds.radius_about(axis);
    let mut half = DVec3::splat(radius);
    half[axis] = 0.0;
    let mut bounds = Bounds3::centred(half);
    (bounds.min[axis], bounds.max[axis]) = (of.bounds.min[axis], of.bounds.max[axis]);
    let needed = of.lipschitz * norm_of_turning(axis, f64::from(rate).abs() * radius);
    let lipschitz = if stated > 0.0 {
        f64::from(stated)
    } else {
        needed
    };
    Properties {
        symmetric: [false; 3],
        ..Properties::bound(bounds).growing(lipschitz)
    }
}

/// The norm of the Jacobian of a twist (axis 1) or a bend, for s = rate · radius.
pub(super) fn norm_of_turning(axis: usize, s: f64) -> f64 {
    match axis {
        1 => 0.5 * (s + (s * s + 4.0).sqrt()),
        _ => 1.0 + s,
    }
}

fn prism(corners: [DVec2; 3], depth: f32) -> Properties {
    let half = 0.5 * f64::from(depth);
    let flat = corners.map(|c| [c.extend(-half), c.extend(half)]);
    Properties {
        bounds: Bounds3::of_points(flat.into_iter().flatten()),
        symmetric: [false, false, true],
        ..Properties::exact(DVec3::ZERO)
    }
}
