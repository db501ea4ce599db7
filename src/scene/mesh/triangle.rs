//! The intersection of a line with one triangle, without gaps between triangles that have a common edge.
//!
//! A line passes an edge on the side that the sign of a triple product states: direction · (corner × edge). Two
//! triangles with a common edge compute the products of the same exact number with opposite signs. The rounding error
//! of a product is bounded, and a product that is not below minus this bound counts as inside. At least one of the two
//! triangles therefore accepts a line through their edge. A point of a hit beyond an edge is moved back
//! onto the triangle, because the distance along a line that grazes the triangle is inexact.

use glam::{DVec3, Vec3};

/// Error bound of a triple product, as a share of the product of the three lengths: ten roundings of half a unit in the
/// last place, for two differences, a cross product and a dot product, and a margin of 3.
const PRODUCT_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Error bound of the height above a plane, as a share of the distance from a corner: five roundings, and a margin.
const HEIGHT_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A triangle of a mesh, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Triangle {
    /// Counterclockwise as seen from the air.
    pub corners: [Vec3; 3],
    /// Unit normal into the air.
    pub normal: Vec3,
    /// Index of the group.
    pub group: u8,
    /// Whether air lies directly behind the face (`sheets.rs`).
    pub is_sheet: bool,
}

impl Triangle {
    /// The corners in `f64`, in metres.
    pub fn exact_corners(&self) -> [DVec3; 3] {
        self.corners.map(|corner| corner.as_dvec3())
    }

    /// The unit normal in `f64`.
    pub fn exact_normal(&self) -> DVec3 {
        let [a, b, c] = self.exact_corners();
        let cross = (b - a).cross(c - a);
        cross.normalize_or(self.normal.as_dvec3())
    }

    /// Area in m².
    pub fn area(&self) -> f64 {
        let [a, b, c] = self.exact_corners();
        0.5 * (b - a).cross(c - a).length()
    }

    /// The triangle with its other side towards the air.
    pub fn reversed(&self) -> Triangle {
        let [a, b, c] = self.corners;
        Triangle {
            corners: [a, c, b],
            normal: -self.normal,
            ..*self
        }
    }

    /// Least distance in metres of a point of the plane from an edge; negative outside of the triangle.
    pub fn depth(&self, place: DVec3) -> f64 {
        let normal = self.exact_normal();
        let [a, b, c] = self.exact_corners();
        let depth = |(from, to): (DVec3, DVec3)| {
            let inward = normal.cross(to - from).normalize_or_zero();
            inward.dot(place - from)
        };
        let depths = [(a, b), (b, c), (c, a)].map(depth);
        depths.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Distance in metres along the unit vector `d` from `o` to the triangle; `None` if the line misses the triangle or
    /// comes from the solid. The start may lie up to `error_bound` metres behind the plane. It lies at
    /// least `error_bound` metres in front of a face of a sheet: a line that starts nearer leaves the other face.
    pub fn hit(&self, o: DVec3, d: DVec3, error_bound: f64) -> Option<f64> {
        let [a, b, c] = self.exact_corners();
        // Most lines come to half of the triangles from behind: this needs no unit normal.
        if (b - a).cross(c - a).dot(d) > 0.0 {
            return None;
        }
        let normal = self.exact_normal();
        let speed = -normal.dot(d);
        if speed <= 0.0 {
            return None;
        }
        let [a, b, c] = self.exact_corners().map(|corner| corner - o);
        let far = a.length().max(b.length()).max(c.length());
        let height = -normal.dot(a);
        let inexact = error_bound + HEIGHT_ROUNDING * far;
        if height < if self.is_sheet { inexact } else { -inexact } {
            return None;
        }
        let passes = |(product, edge): (f64, DVec3)| {
            product >= -(PRODUCT_ROUNDING * far + error_bound) * edge.length()
        };
        let products = self.products(o, d).into_iter().zip(self.edges());
        products
            .into_iter()
            .all(passes)
            .then(|| height.max(0.0) / speed)
    }

    /// The edges opposite of each corner.
    fn edges(&self) -> [DVec3; 3] {
        let [a, b, c] = self.exact_corners();
        [b - c, c - a, a - b]
    }

    /// The triple products of the line with the edges opposite of each corner: positive inside. They are in proportion
    /// to the weights of the corners.
    fn products(&self, o: DVec3, d: DVec3) -> [f64; 3] {
        let [a, b, c] = self.exact_corners().map(|corner| corner - o);
        let [bc, ca, ab] = self.edges();
        [d.dot(c.cross(bc)), d.dot(a.cross(ca)), d.dot(b.cross(ab))]
    }

    /// The point at which the line from `o` along `d` meets the triangle, moved onto the triangle and at least `inset`
    /// metres away from its edges.
    pub fn place(&self, o: DVec3, d: DVec3, inset: f64) -> DVec3 {
        let [a, b, c] = self.exact_corners();
        let (to_b, to_c) = (b - a, c - a);
        let across = to_b.cross(to_c);
        let squared = across.length_squared();
        let normal = self.exact_normal();
        let height = (o - a).dot(normal).max(0.0);
        let from = o + d * (height / -normal.dot(d)) - a;
        let from = from - normal * normal.dot(from);
        let share_b = from.cross(to_c).dot(across) / squared;
        let share_c = to_b.cross(from).dot(across) / squared;
        let shares = [1.0 - share_b - share_c, share_b, share_c];
        let edges = self.edges();
        let least = edges.map(|edge| (inset * edge.length() / squared.sqrt()).min(1.0 / 3.0));
        if from.is_finite() && (0..3).all(|i| shares[i] >= least[i]) {
            return a + from;
        }
        let held: [f64; 3] = std::array::from_fn(|i| shares[i].max(least[i]));
        let whole: f64 = held.iter().sum();
        (a * held[0] + b * held[1] + c * held[2]) / whole
    }

    /// The point of the triangle nearest to `p`, and the part of the triangle that contains it.
    pub fn nearest(&self, p: DVec3) -> (DVec3, Part) {
        nearest_of(self.exact_corners(), p)
    }
}

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The corner with this index.
    Corner(usize),
    /// The edge opposite of the corner with this index.
    Edge(usize),
    /// The face.
    Face,
}

/// The point of a triangle nearest to `p` (Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5).
fn nearest_of([a, b, c]: [DVec3; 3], p: DVec3) -> (DVec3, Part) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Part::Corner(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Part::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Part::Edge(2));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Part::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Part::Edge(1));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (b + (c - b) * share, Part::Edge(0));
    }
    let whole = va + vb + vc;
    (a + (ab * vb + ac * vc) / whole, Part::Face)
}
