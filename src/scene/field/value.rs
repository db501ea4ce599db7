//! The value of a field at a point, in `f64`.
//!
//! Quadrics: the distance r to the surface of F obeys |F| ≤ g r + λ r² with g = |∇F| and λ
//! the norm of the quadratic form (Taylor's theorem, exact for a quadratic). Solved for r,
//! φ = 2 F / (g + √(g² + 4 λ |F|)) is never more than the distance, agrees with it to first
//! order at the surface, and is Lipschitz with constant 1, for |∇g| ≤ 2 λ.

use super::{Bounds3, Copies, Field, Node};
use glam::{DMat3, DVec2, DVec3, EulerRot, Vec3};

impl Field {
    /// The value at a point of the field's own axes (metres): positive in the air. What it
    /// says of the distance stands in [`Field::properties`].
    pub fn value(&self, p: DVec3) -> f64 {
        match &self.node {
            Node::Union => self
                .of
                .iter()
                .map(|f| f.value(p))
                .fold(f64::INFINITY, f64::min),
            Node::Intersection => {
                let values = self.of.iter().map(|f| f.value(p));
                values.fold(f64::NEG_INFINITY, f64::max)
            }
            Node::Difference => {
                let cut = self.of[1..].iter().map(|f| -f.value(p));
                cut.fold(self.of[0].value(p), f64::max)
            }
            Node::SmoothUnion { radius } => {
                let values = self.of[1..].iter().map(|f| f.value(p));
                values.fold(self.of[0].value(p), |a, b| {
                    smooth_min(a, b, (*radius).into())
                })
            }
            Node::Morph { amount } => {
                let (from, to) = (self.of[0].value(p), self.of[1].value(p));
                from + (to - from) * f64::from(*amount)
            }
            Node::Complement => -self.of[0].value(p),
            Node::Shell { thickness } => self.of[0].value(p).abs() - 0.5 * f64::from(*thickness),
            Node::Offset { by } => self.of[0].value(p) - f64::from(*by),
            _ if self.of.is_empty() => self.shape_value(p),
            _ => self.warped_value(p),
        }
    }

    /// Operators on space.
    fn warped_value(&self, p: DVec3) -> f64 {
        let of = &self.of[0];
        match &self.node {
            Node::Translate { by } => of.value(p - by.as_dvec3()),
            Node::Rotate { by } => of.value(turn_matrix(*by).transpose() * p),
            Node::Scale { by } => {
                let by = f64::from(*by);
                of.value(p / by) * by
            }
            Node::Mirror { axes } => {
                let fold = |axis: usize| if axes[axis] { p[axis].abs() } else { p[axis] };
                of.value(DVec3::new(fold(0), fold(1), fold(2)))
            }
            Node::Repeat { period, count } => self.repeated_value(p, period.as_dvec3(), *count),
            Node::Elongate { by } => {
                let by = by.as_dvec3();
                of.value(p - p.clamp(-by, by))
            }
            Node::Twist { rate, .. } => self.turned_value(p, 1, (*rate).into()),
            Node::Bend { rate, .. } => self.turned_value(p, 2, (*rate).into()),
            _ => f64::INFINITY,
        }
    }

    /// A twist (axis 1) or a bend (axis 2). The point is turned back, so that what it is
    /// asked of is turned right-handedly. Beyond the radius of the field's bounds: the value at
    /// them, and the way to them.
    fn turned_value(&self, p: DVec3, axis: usize, rate: f64) -> f64 {
        let of = &self.of[0];
        let lipschitz = self.properties().lipschitz;
        let most = of.properties().bounds.radius_about(axis);
        let mut aside = p;
        aside[axis] = 0.0;
        let radius = aside.length();
        let beyond = (radius - most).max(0.0);
        let mut held = if beyond > 0.0 {
            aside * (most / radius)
        } else {
            aside
        };
        held[axis] = p[axis];
        let along = if axis == 1 { p.y } else { held.x };
        let (sin, cos) = (rate * along).sin_cos();
        let turned = if axis == 1 {
            DVec3::new(
                cos * held.x - sin * held.z,
                held.y,
                sin * held.x + cos * held.z,
            )
        } else {
            DVec3::new(
                cos * held.x + sin * held.y,
                cos * held.y - sin * held.x,
                held.z,
            )
        };
        let value = of.value(turned);
        if beyond == 0.0 {
            return value;
        }
        value.max(0.0).hypot(lipschitz * beyond)
    }

    fn repeated_value(&self, p: DVec3, period: DVec3, count: [u32; 3]) -> f64 {
        let copies = self.copies().unwrap_or([Copies::Own; 3]);
        let along = |axis: usize| offsets(p[axis], period[axis], count[axis], copies[axis]);
        let (xs, ys, zs) = (along(0), along(1), along(2));
        let mut least = self.cap().map_or(f64::INFINITY, |cap| cap.at(p));
        for x in &xs {
            for y in &ys {
                for z in &zs {
                    least = least.min(self.of[0].value(DVec3::new(*x, *y, *z)));
                }
            }
        }
        least
    }

    fn shape_value(&self, p: DVec3) -> f64 {
        let half = |length: f32| 0.5 * f64::from(length);
        let ring = DVec2::new(p.x, p.z).length();
        match &self.node {
            Node::Plane => p.y,
            Node::HalfSpace { normal, offset } => {
                normal.as_dvec3().normalize().dot(p) - f64::from(*offset)
            }
            Node::Box { size } => box_value(p, 0.5 * size.as_dvec3()),
            Node::Room { size } => (0.5 * size.as_dvec3() - p.abs()).min_element(),
            Node::RoundedBox { size, rounding } => {
                let rounding = f64::from(*rounding);
                box_value(p, 0.5 * size.as_dvec3() - rounding) - rounding
            }
            Node::Sphere { radius } => p.length() - f64::from(*radius),
            Node::Cylinder { radius } => ring - f64::from(*radius),
            Node::CappedCylinder { radius, height } => corner_value(DVec2::new(
                ring - f64::from(*radius),
                p.y.abs() - half(*height),
            )),
            Node::Capsule { radius, height } => {
                let up = p.y - p.y.clamp(-half(*height), half(*height));
                ring.hypot(up) - f64::from(*radius)
            }
            Node::Torus { ring: centre, tube } => {
                (ring - f64::from(*centre)).hypot(p.y) - f64::from(*tube)
            }
            Node::Cone { radius, height } => {
                cone_value(DVec2::new(ring, p.y), (*radius).into(), half(*height))
            }
            Node::Prism { corners, depth } => {
                let flat = triangle_value(p.truncate(), corners.map(|c| c.as_dvec2()));
                corner_value(DVec2::new(flat, p.z.abs() - half(*depth)))
            }
            Node::HeightField { image, size } => {
                let size = size.as_dvec3();
                let held = p.clamp(-0.5 * size, 0.5 * size);
                let at = DVec2::new(held.x / size.x + 0.5, held.z / size.z + 0.5);
                let ground = size.y * (image.at(at) - 0.5);
                let slope = size.y * image.steepest(DVec2::new(size.x, size.z));
                let above = (held.y - ground) / 1f64.hypot(slope);
                above.max(box_value(p, 0.5 * size))
            }
            Node::User { field } => {
                let half = 0.5 * field.size.as_dvec3();
                let value = field.value(p) / f64::from(field.lipschitz);
                value.max(box_value(p, half))
            }
            _ => self.quadric_value(p),
        }
    }

    fn quadric_value(&self, p: DVec3) -> f64 {
        let Some(quadric) = Quadric::of(&self.node) else {
            return f64::INFINITY;
        };
        let (value, gradient) = quadric.at(p);
        let g = gradient.length();
        let root = (g * g + 4.0 * quadric.norm() * value.abs()).sqrt();
        if root == 0.0 {
            0.0
        } else {
            2.0 * value / (g + root)
        }
    }
}

/// pᵀ Q p + b · p + c, Q symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quadric {
    /// Q's diagonal.
    pub diagonal: DVec3,
    /// Q's other numbers: yz, zx, xy.
    pub mixed: DVec3,
    pub linear: DVec3,
    pub constant: f64,
}

impl Quadric {
    /// The quadratic form of a node that has one.
    pub fn of(node: &Node) -> Option<Quadric> {
        let straight = |diagonal, linear, constant| Quadric {
            diagonal,
            mixed: DVec3::ZERO,
            linear,
            constant,
        };
        let square = |length: f32| f64::from(length).powi(2);
        Some(match node {
            Node::Ellipsoid { radii } => {
                let radii = radii.as_dvec3();
                straight(1.0 / (radii * radii), DVec3::ZERO, -1.0)
            }
            Node::Paraboloid { focal_length } => {
                let bend = 0.25 / f64::from(*focal_length);
                straight(DVec3::new(bend, 0.0, bend), DVec3::NEG_Y, 0.0)
            }
            Node::Hyperboloid {
                waist,
                rise,
                two_sheets,
            } => {
                let (across, up) = (1.0 / square(*waist), 1.0 / square(*rise));
                let constant = if *two_sheets { 1.0 } else { -1.0 };
                straight(DVec3::new(across, -up, across), DVec3::ZERO, constant)
            }
            Node::Quadric { coefficients } => {
                let [a, b, c, xy, yz, zx, x, y, z, constant] = coefficients.map(f64::from);
                Quadric {
                    diagonal: DVec3::new(a, b, c),
                    mixed: 0.5 * DVec3::new(yz, zx, xy),
                    linear: DVec3::new(x, y, z),
                    constant,
                }
            }
            _ => return None,
        })
    }

    /// Q p.
    fn form(&self, p: DVec3) -> DVec3 {
        let m = self.mixed;
        let mixed = DVec3::new(
            m.z * p.y + m.y * p.z,
            m.z * p.x + m.x * p.z,
            m.y * p.x + m.x * p.y,
        );
        self.diagonal * p + mixed
    }

    /// Value and gradient.
    pub fn at(&self, p: DVec3) -> (f64, DVec3) {
        let form = self.form(p);
        let value = p.dot(form) + self.linear.dot(p) + self.constant;
        (value, 2.0 * form + self.linear)
    }

    /// What Q stretches a vector by at the most: of a diagonal form its largest number, else
    /// the Frobenius norm, which is never less.
    pub fn norm(&self) -> f64 {
        if self.mixed == DVec3::ZERO {
            return self.diagonal.abs().max_element();
        }
        (self.diagonal.length_squared() + 2.0 * self.mixed.length_squared()).sqrt()
    }
}

/// Outer axes from the inner ones of a `Rotate`.
pub(crate) fn turn_matrix(by: Vec3) -> DMat3 {
    let by = by.as_dvec3();
    DMat3::from_euler(EulerRot::XYZEx, by.x, by.y, by.z)
}

/// The coordinates along one axis, relative to each copy that can be the nearest.
fn offsets(q: f64, period: f64, count: u32, copies: Copies) -> Vec<f64> {
    if copies == Copies::None || period == 0.0 {
        return vec![q];
    }
    // An even number of copies lies about the origin with none at it.
    let shift = if count > 0 && count.is_multiple_of(2) {
        0.5 * period
    } else {
        0.0
    };
    let q = q - shift;
    let (first, last) = match count {
        0 => (f64::NEG_INFINITY, f64::INFINITY),
        count => {
            let first = -f64::from(count / 2);
            (first, first + f64::from(count - 1))
        }
    };
    let own = (q / period).round().clamp(first, last);
    let copy = |index: f64| q - period * index.clamp(first, last);
    let side = if q >= period * own { 1.0 } else { -1.0 };
    match copies {
        Copies::None | Copies::Own => vec![copy(own)],
        Copies::OwnAndNext => vec![copy(own), copy(own + side)],
        Copies::Around(reach) => {
            let reach = i64::from(reach);
            (-reach..=reach)
                .map(|step| copy(own + step as f64))
                .collect()
        }
    }
}

/// The polynomial smooth minimum (Quilez): a quarter of `radius` lower where both are equal.
fn smooth_min(a: f64, b: f64, radius: f64) -> f64 {
    let blend = (radius - (a - b).abs()).max(0.0);
    a.min(b) - 0.25 * blend * blend / radius
}

/// The distance to a box.
pub(crate) fn box_value(p: DVec3, half_size: DVec3) -> f64 {
    let beyond = p.abs() - half_size;
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
}

/// The distance to a quarter plane, from the distances to its two edges' lines.
fn corner_value(beyond: DVec2) -> f64 {
    beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
}

fn segment_distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + share * along)
}

/// `p` is the distance from the axis, and the height.
fn cone_value(p: DVec2, radius: f64, half_height: f64) -> f64 {
    let (tip, rim) = (
        DVec2::new(0.0, half_height),
        DVec2::new(radius, -half_height),
    );
    let middle = DVec2::new(0.0, -half_height);
    let distance = segment_distance(p, tip, rim).min(segment_distance(p, middle, rim));
    let out_of_side = DVec2::new(2.0 * half_height, radius).dot(p - rim);
    if out_of_side < 0.0 && p.y > -half_height {
        -distance
    } else {
        distance
    }
}

fn triangle_value(p: DVec2, corners: [DVec2; 3]) -> f64 {
    let [a, b, c] = corners;
    let turn = (b - a).perp_dot(c - a).signum();
    let edges = [(a, b), (b, c), (c, a)];
    let distance = edges.map(|(from, to)| segment_distance(p, from, to));
    let inside = edges
        .iter()
        .all(|(from, to)| turn * (to - from).perp_dot(p - from) > 0.0);
    let nearest = distance.into_iter().fold(f64::INFINITY, f64::min);
    if inside { -nearest } else { nearest }
}

impl Bounds3 {
    /// The distance to the box, negative inside.
    pub fn signed_distance(self, point: DVec3) -> f64 {
        let outside = self.distance(point);
        if outside > 0.0 {
            return outside;
        }
        (self.min - point).max(point - self.max).max_element()
    }
}
