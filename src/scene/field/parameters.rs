//! The numbers of a field: by name for who moves them, in order for who writes shaders.

use super::value::{Quadric, turn_matrix};
use super::{Field, Node};
use glam::{DVec2, DVec3, Vec3};

type Named<'a> = Vec<(String, &'a mut f32)>;

impl Field {
    /// Every number of the tree that may move, by name.
    ///
    /// A node's own are called as in a scene file (`radius`, `size.x`); those of the n-th
    /// field below it (from 0) have `n.` before them (`0.radius`, `1.0.by.y`).
    pub fn parameters_mut(&mut self) -> Vec<(String, &mut f32)> {
        let mut all = self.node.parameters_mut();
        for (index, child) in self.of.iter_mut().enumerate() {
            let named = child.parameters_mut().into_iter();
            all.extend(named.map(|(name, number)| (format!("{index}.{name}"), number)));
        }
        all
    }
}

impl Node {
    /// The node's own numbers by name.
    pub fn parameters_mut(&mut self) -> Vec<(String, &mut f32)> {
        match self {
            Node::HalfSpace { normal, offset } => with(axes("normal", normal), "offset", offset),
            Node::Box { size } | Node::Room { size } => axes("size", size),
            Node::RoundedBox { size, rounding } => with(axes("size", size), "rounding", rounding),
            Node::Sphere { radius } | Node::Cylinder { radius } => one("radius", radius),
            Node::CappedCylinder { radius, height }
            | Node::Capsule { radius, height }
            | Node::Cone { radius, height } => with(one("radius", radius), "height", height),
            Node::Torus { ring, tube } => with(one("ring", ring), "tube", tube),
            Node::Prism { corners, depth } => {
                let mut all = Vec::new();
                for (index, corner) in corners.iter_mut().enumerate() {
                    all.push((format!("corners.{index}.x"), &mut corner.x));
                    all.push((format!("corners.{index}.y"), &mut corner.y));
                }
                with(all, "depth", depth)
            }
            Node::Ellipsoid { radii } => axes("radii", radii),
            Node::Paraboloid { focal_length } => one("focal_length", focal_length),
            Node::Hyperboloid { waist, rise, .. } => with(one("waist", waist), "rise", rise),
            Node::Quadric { coefficients } => {
                let numbered = coefficients.iter_mut().enumerate();
                let name = |index| format!("coefficients.{index}");
                numbered.map(|(i, number)| (name(i), number)).collect()
            }
            Node::HeightField { size, .. } => axes("size", size),
            Node::Shell { thickness } => one("thickness", thickness),
            Node::SmoothUnion { radius } => one("radius", radius),
            Node::Offset { by } | Node::Scale { by } => one("by", by),
            Node::Translate { by } | Node::Rotate { by } | Node::Elongate { by } => axes("by", by),
            Node::Repeat { period, .. } => axes("period", period),
            Node::Twist { rate, .. } | Node::Bend { rate, .. } => one("rate", rate),
            Node::Morph { amount } => one("amount", amount),
            Node::Plane
            | Node::User { .. }
            | Node::Union
            | Node::Intersection
            | Node::Difference
            | Node::Complement
            | Node::Mirror { .. } => Vec::new(),
        }
    }
}

fn one<'a>(name: &str, number: &'a mut f32) -> Named<'a> {
    vec![(name.to_owned(), number)]
}

fn with<'a>(mut all: Named<'a>, name: &str, number: &'a mut f32) -> Named<'a> {
    all.push((name.to_owned(), number));
    all
}

fn axes<'a>(name: &str, vector: &'a mut Vec3) -> Named<'a> {
    let Vec3 { x, y, z } = vector;
    vec![
        (format!("{name}.x"), x),
        (format!("{name}.y"), y),
        (format!("{name}.z"), z),
    ]
}

impl Field {
    /// The numbers that the shader's text of this node uses, in its order: what follows
    /// from the parameters (halves, squares, sines) is computed here, in `f64`.
    pub(crate) fn shader_numbers(&self) -> Vec<f64> {
        let half = |length: f32| 0.5 * f64::from(length);
        let wide = |numbers: &[f32]| numbers.iter().copied().map(f64::from).collect();
        match &self.node {
            Node::HalfSpace { normal, offset } => {
                let normal = normal.as_dvec3().normalize();
                vec![normal.x, normal.y, normal.z, f64::from(*offset)]
            }
            Node::Box { size } | Node::Room { size } | Node::HeightField { size, .. } => {
                let mut numbers = (0.5 * size.as_dvec3()).to_array().to_vec();
                if let Node::HeightField { image, .. } = &self.node {
                    let flat = DVec2::new(size.x.into(), size.z.into());
                    let slope = f64::from(size.y) * image.steepest(flat);
                    numbers.push(1.0 / 1f64.hypot(slope));
                }
                numbers
            }
            Node::RoundedBox { size, rounding } => {
                let core = 0.5 * size.as_dvec3() - f64::from(*rounding);
                vec![core.x, core.y, core.z, (*rounding).into()]
            }
            Node::Sphere { radius } | Node::Cylinder { radius } => wide(&[*radius]),
            Node::CappedCylinder { radius, height }
            | Node::Capsule { radius, height }
            | Node::Cone { radius, height } => vec![f64::from(*radius), half(*height)],
            Node::Torus { ring, tube } => wide(&[*ring, *tube]),
            Node::Prism { corners, depth } => prism_numbers(corners.map(|c| c.as_dvec2()), *depth),
            Node::Ellipsoid { .. }
            | Node::Paraboloid { .. }
            | Node::Hyperboloid { .. }
            | Node::Quadric { .. } => quadric_numbers(&self.node),
            Node::User { field } => {
                let half = 0.5 * field.size.as_dvec3();
                vec![half.x, half.y, half.z, 1.0 / f64::from(field.lipschitz)]
            }
            Node::Shell { thickness } => vec![half(*thickness)],
            Node::SmoothUnion { radius } => wide(&[*radius]),
            Node::Offset { by } | Node::Scale { by } => wide(&[*by]),
            Node::Translate { by } | Node::Elongate { by } => wide(&by.to_array()),
            // The inner axes from the outer ones, a column after the other.
            Node::Rotate { by } => turn_matrix(*by).transpose().to_cols_array().to_vec(),
            Node::Repeat { period, .. } => {
                let mut numbers: Vec<f64> = wide(&period.to_array());
                if let Some(cap) = self.cap() {
                    numbers.extend(cap.half_size.to_array());
                    numbers.extend([cap.near, cap.inverse_slowness]);
                }
                numbers
            }
            Node::Twist { rate, .. } => self.turning_numbers(1, *rate),
            Node::Bend { rate, .. } => self.turning_numbers(2, *rate),
            Node::Morph { amount } => wide(&[*amount]),
            Node::Plane
            | Node::Union
            | Node::Intersection
            | Node::Difference
            | Node::Complement
            | Node::Mirror { .. } => Vec::new(),
        }
    }

    /// Rate, radius of the field's own bounds, Lipschitz constant.
    fn turning_numbers(&self, axis: usize, rate: f32) -> Vec<f64> {
        /// Stands for a radius without end.
        const ENDLESS: f64 = 1e30;
        let radius = self.of[0].properties().bounds.radius_about(axis);
        let lipschitz = self.properties().lipschitz;
        vec![f64::from(rate), radius.min(ENDLESS), lipschitz.min(ENDLESS)]
    }
}

/// The corners in positive sense, and half the depth.
fn prism_numbers(corners: [DVec2; 3], depth: f32) -> Vec<f64> {
    let [a, b, c] = corners;
    let (b, c) = if (b - a).perp_dot(c - a) < 0.0 {
        (c, b)
    } else {
        (b, c)
    };
    vec![a.x, a.y, b.x, b.y, c.x, c.y, 0.5 * f64::from(depth)]
}

/// Diagonal, mixed, linear, constant, norm; of a straight one without what is 0 in its kind.
fn quadric_numbers(node: &Node) -> Vec<f64> {
    let Some(quadric) = Quadric::of(node) else {
        return Vec::new();
    };
    let list = |v: DVec3| v.to_array();
    let mut numbers = list(quadric.diagonal).to_vec();
    if let Node::Quadric { .. } = node {
        numbers.extend(list(quadric.mixed));
        numbers.extend(list(quadric.linear));
    }
    numbers.extend([quadric.constant, quadric.norm()]);
    numbers
}
