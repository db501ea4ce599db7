//! A triangular prism.

use super::cone::segment_distance;
use super::cylinder::corner_value;
use super::part::{arguments, half, part, surface_kind};
use super::{Bounds3, Part, Properties, Shape};
use glam::{DVec2, DVec3, Vec2};

part! {
    /// A triangle in the xy plane, extruded along z.
    Prism {
        /// Corners of the triangle (x, y) in metres, clockwise or counter-clockwise.
        corners: [Vec2; 3] as Metres,
        /// Full length along z in metres.
        depth: f32 as Length,
    }
}

/// Minimum area of a triangle, as a share of the square of its longest side. The corners of a triangle with a smaller
/// area count as collinear, because `f32` cannot resolve the area.
const LEAST_AREA: f64 = 1e-6;

impl Part for Prism {
    surface_kind!(FLAT);

    fn check(&self) -> Result<(), String> {
        let [a, b, c] = self.flat();
        let area = 0.5 * (b - a).perp_dot(c - a).abs();
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        if area > LEAST_AREA * longest * longest {
            return Ok(());
        }
        Err("its corners must not lie on one line".to_owned())
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        let half = half(self.depth);
        let ends = self.flat().map(|c| [c.extend(-half), c.extend(half)]);
        Properties {
            bounds: Bounds3::of_points(ends.into_iter().flatten()),
            symmetric: [false, false, true],
            ..Properties::exact(DVec3::ZERO)
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let flat = triangle_value(p.truncate(), self.flat());
        corner_value(DVec2::new(flat, p.z.abs() - half(self.depth)))
    }

    /// The corners in counter-clockwise order, and half the depth.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let [a, b, c] = self.flat();
        let (b, c) = match (b - a).perp_dot(c - a) < 0.0 {
            true => (c, b),
            false => (b, c),
        };
        vec![a.x, a.y, b.x, b.y, c.x, c.y, half(self.depth)]
    }

    arguments!(2, 2, 2, 1);
}

impl Prism {
    fn flat(&self) -> [DVec2; 3] {
        self.corners.map(|corner| corner.as_dvec2())
    }
}

/// The signed distance of a point from a triangle, in a plane.
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
