//! Distances to shapes in front of a plane face that is open: a space, continued behind the face by its mirror image, has
//! no surface in the plane.
//!
//! # Method
//! A solid in front of the plane joins its image, and what lies behind the plane does not count. A box with a face in the
//! plane becomes a box of twice the depth, or vanishes, also where the box is air (a room, or what is cut out of a solid).
//! Operators join these values as they join those of the shapes.
//!
//! # Deviations
//! Faces of other shapes (prisms, cones, cylinders with ends, rounded boxes), and below other operators, remain closed.

use super::SAME_NORMAL;
use crate::scene::shape::{Cuboid, HalfSpace, Room};
use crate::scene::{Node, Shape};
use glam::DVec3;

/// A plane whose face is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OpenPlane {
    /// A point of the plane.
    pub point: DVec3,
    /// Unit vector into the space in front.
    pub normal: DVec3,
    /// Maximum distance in metres of a face in the plane.
    pub touch: f64,
}

impl OpenPlane {
    /// The plane in axes in which these functions give the places of points and directions.
    pub fn seen(
        self,
        place: impl Fn(DVec3) -> DVec3,
        direction: impl Fn(DVec3) -> DVec3,
    ) -> OpenPlane {
        OpenPlane {
            point: place(self.point),
            normal: direction(self.normal),
            ..self
        }
    }

    /// Signed distance from a point in front of the plane to a box about the origin with these half sizes.
    pub fn box_distance(self, p: DVec3, half: DVec3) -> f64 {
        let Some((axis, side)) = self.side_of_box(half) else {
            return box_distance(p, half);
        };
        if side == self.normal[axis].signum() {
            return f64::INFINITY;
        }
        let (mut centre, mut size) = (DVec3::ZERO, half);
        centre[axis] = side * half[axis];
        size[axis] *= 2.0;
        box_distance(p - centre, size)
    }

    /// The axis and the sign of the face of a box that lies in the plane.
    fn side_of_box(self, half: DVec3) -> Option<(usize, f64)> {
        let axis = (0..3).find(|axis| {
            let sign = self.normal[*axis].signum();
            self.normal.distance(DVec3::AXES[*axis] * sign) <= SAME_NORMAL
        })?;
        let side = self.point[axis].signum();
        let is_in_plane = (self.point[axis] - side * half[axis]).abs() <= self.touch;
        is_in_plane.then_some((axis, side))
    }

    /// Signed distance from a point in front of the plane to the half space that ends at `offset` metres along a unit
    /// normal.
    pub fn half_space_distance(self, p: DVec3, normal: DVec3, offset: f64) -> f64 {
        let is_in_plane = (self.point.dot(normal) - offset).abs() <= self.touch;
        if is_in_plane && self.normal.distance(normal) <= SAME_NORMAL {
            return f64::INFINITY;
        }
        if is_in_plane && self.normal.distance(-normal) <= SAME_NORMAL {
            return f64::NEG_INFINITY;
        }
        normal.dot(p) - offset
    }

    /// The value of a shape at a point in front of the plane. It is at least the shape's own value where the shape is
    /// solid behind its faces in the plane.
    pub fn value(self, shape: &Shape, p: DVec3) -> f64 {
        let children = || shape.children.iter().map(|child| self.value(child, p));
        match &shape.node {
            Node::Union(_) => children().fold(f64::INFINITY, f64::min),
            Node::Intersection(_) => children().fold(f64::NEG_INFINITY, f64::max),
            Node::Difference(_) => {
                let cut = children().skip(1).map(|value| -value);
                cut.fold(self.value(&shape.children[0], p), f64::max)
            }
            Node::Complement(_) => -self.value(&shape.children[0], p),
            Node::Translate(node) => {
                let by = node.by.as_dvec3();
                let moved = self.seen(|point| point - by, |normal| normal);
                moved.value(&shape.children[0], p - by)
            }
            Node::Rotate(node) => {
                let inner = node.matrix().transpose();
                let turned = self.seen(|point| inner * point, |normal| inner * normal);
                turned.value(&shape.children[0], inner * p)
            }
            Node::Scale(node) => {
                let by = f64::from(node.by);
                let scaled = OpenPlane {
                    point: self.point / by,
                    touch: self.touch / by,
                    ..self
                };
                scaled.value(&shape.children[0], p / by) * by
            }
            Node::Cuboid(Cuboid { size }) => self.box_distance(p, half(*size)),
            Node::Room(Room { size }) => -self.box_distance(p, half(*size)),
            Node::Plane(_) => self.half_space_distance(p, DVec3::Y, 0.0),
            Node::HalfSpace(HalfSpace { normal, offset }) => {
                let normal = normal.as_dvec3().normalize();
                self.half_space_distance(p, normal, f64::from(*offset))
            }
            _ => shape.value(p),
        }
    }
}

/// Signed distance in metres to a box about the origin with these half sizes.
pub(super) fn box_distance(p: DVec3, half: DVec3) -> f64 {
    let beyond = p.abs() - half;
    beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
}

fn half(size: glam::Vec3) -> DVec3 {
    0.5 * size.as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    const FLOOR: OpenPlane = OpenPlane {
        point: DVec3::ZERO,
        normal: DVec3::Y,
        touch: 1e-6,
    };

    fn value(shape: &str, p: [f64; 3]) -> f64 {
        let text = format!(
            "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: (0, 0, 0)), listener: Listener(position: (1, 0, 0), radius: 0.1))"
        );
        let shape = Scene::from_ron(&text, "shape")
            .expect("a scene")
            .surfaces
            .remove(0)
            .shape;
        FLOOR.value(&shape, DVec3::from_array(p))
    }

    /// Protects openings that end on the floor: the nearest surface is a jamb, not the floor, whether the cut ends there,
    /// or the solid goes on below it.
    #[test]
    fn openings_are_bounded_by_their_jambs() {
        for wall in [
            "Translate(of: Box(size: (0.2, 3, 4)), by: (0, 1.5, 0))",
            "Translate(of: Box(size: (0.2, 4, 4)), by: (0, 1, 0))",
        ] {
            for cut in [
                "Translate(of: Box(size: (1, 2, 0.9)), by: (0, 1, 0))",
                "Translate(of: Box(size: (1, 3, 0.9)), by: (0, 0.5, 0))",
            ] {
                let wall = format!("Difference(from: {wall}, cut: [{cut}])");
                let found = value(&wall, [0.0, 0.01, 0.1]);
                assert!((found - 0.35).abs() < 1e-6, "{wall}: {found}");
                // In the jamb: half the thickness of the wall lies between the point and the air.
                let found = value(&wall, [0.0, 0.01, 1.0]);
                assert!((found + 0.1).abs() < 1e-6, "{wall}: {found}");
            }
        }
    }

    /// Protects ground of several parts: those with their upper face in the plane are open, those above it are not, and
    /// those below it count no less than without the plane.
    #[test]
    fn faces_in_the_plane_are_open() {
        let tile = "Translate(of: Box(size: (1, 1, 1)), by: (0, -0.5, 0))";
        let infinite = [
            tile,
            "Plane",
            "HalfSpace(normal: (0, 2, 0))",
            "Rotate(of: HalfSpace(normal: (1, 0, 0)), by: (0, 0, 90))",
            "Scale(of: HalfSpace(normal: (0, 1, 0)), by: 2)",
        ];
        for shape in infinite {
            assert_eq!(value(shape, [0.2, 0.3, 0.1]), f64::INFINITY, "{shape}");
        }
        let block = "Translate(of: Box(size: (1, 1, 1)), by: (2, 0.5, 0))";
        let both = format!("Union(of: [{tile}, {block}])");
        assert!((value(&both, [0.0, 0.3, 0.0]) - 1.5).abs() < 1e-6);
        let room = "Translate(of: Room(size: (4, 3, 4)), by: (0, 1.5, 0))";
        assert!((value(room, [0.0, 0.1, 0.0]) - 2.0).abs() < 1e-6);
        let sphere = "Translate(of: Sphere(radius: 1), by: (0, -1, 0))";
        assert!((value(sphere, [0.0, 0.3, 0.0]) - 0.3).abs() < 1e-6);
    }
}
