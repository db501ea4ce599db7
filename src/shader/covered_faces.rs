//! Extends the covered faces of boxes into the solids that cover them.
//!
//! A block that stands against a wall has a face in the plane of the wall. At the seam between block and wall, rounding
//! may let a ray enter the block through this face, although no wave can reach the face. Such a face is extended into
//! the solid that covers it: the shape of the air does not change, and the seam disappears.
//!
//! An extension adds a slab to a box. A face is extended only if one convex solid contains all eight corners of the
//! slab, and therefore the whole slab: no air is lost. The slab has the cross-section of the box with its earlier
//! extensions. Faces are extended into walls of rooms and planes first, so that a box between floor and ceiling has its
//! full height when it is extended into another such box.
//!
//! If boxes of the same width stand on each other, the slab's sides would lie in the faces of the cover, and waves that
//! hit the cover there would be reported as hits of the box. A long extension must therefore end deep inside the cover.
//! A short extension is only as long as rounding requires.

use crate::scene::shape::{Cuboid, Room};
use crate::scene::{Bounds3, Node, Shape, Surface};
use glam::{DVec3, Vec3};

/// A face of a box: its axis, and −1 or 1 for the lower and the upper one.
type Face = (usize, f32);

/// Returns the surfaces, with the covered faces of boxes extended into the solids that cover them.
/// `error_bounds` is the rounding error of each surface, in metres.
pub(super) fn extend_covered_faces(surfaces: &[Surface], error_bounds: &[f32]) -> Vec<Surface> {
    let is_half_space = |shape: &Shape| matches!(shape.node, Node::Plane(_) | Node::Room(_));
    let against_walls = round(surfaces, error_bounds, is_half_space);
    let is_solid = |shape: &Shape| shape.is_convex() && !is_half_space(shape);
    round(&against_walls, error_bounds, is_solid)
}

/// Extends every box into the surfaces whose shape satisfies `wanted`.
fn round(
    surfaces: &[Surface],
    error_bounds: &[f32],
    wanted: impl Fn(&Shape) -> bool,
) -> Vec<Surface> {
    let mut grown = surfaces.to_vec();
    let near = Neighbours::new(surfaces, error_bounds, wanted);
    for (index, surface) in surfaces.iter().enumerate() {
        if !matches!(surface.shape.node, Node::Cuboid(_)) {
            continue;
        }
        let covers = near.touching(index);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let against = |cover: &usize| {
                    let error_bound = error_bounds[index].max(error_bounds[*cover]);
                    extension(&grown[index], (axis, side), &surfaces[*cover], error_bound)
                };
                let by = covers.iter().map(against).fold(0.0, f32::max);
                grown[index] = extended(&grown[index], (axis, side), by);
            }
        }
    }
    grown
}

/// Finds the covers that touch a box. The covers are sorted along x, so that many separate boxes cost no more than the
/// sorting.
struct Neighbours {
    bounds: Vec<Bounds3>,
    /// Finite covers, sorted by their least x.
    by_start: Vec<usize>,
    /// Covers without a least x: planes, rooms and infinite surfaces.
    endless: Vec<usize>,
    /// The greatest width of a cover along x.
    widest: f64,
}

impl Neighbours {
    fn new(
        surfaces: &[Surface],
        error_bounds: &[f32],
        wanted: impl Fn(&Shape) -> bool,
    ) -> Neighbours {
        let with_error_bound = |(surface, error_bound): (&Surface, &f32)| {
            surface
                .bounds()
                .grown(DVec3::splat(2.0 * f64::from(*error_bound)))
        };
        let bounds: Vec<Bounds3> = surfaces
            .iter()
            .zip(error_bounds)
            .map(with_error_bound)
            .collect();
        let covers = (0..surfaces.len()).filter(|&index| wanted(&surfaces[index].shape));
        let ends = |index: &usize| (bounds[*index].max.x - bounds[*index].min.x).is_finite();
        let (mut by_start, endless): (Vec<usize>, Vec<usize>) = covers.partition(ends);
        by_start.sort_by(|&a, &b| bounds[a].min.x.total_cmp(&bounds[b].min.x));
        let width = |&index: &usize| bounds[index].max.x - bounds[index].min.x;
        let widest = by_start.iter().map(width).fold(0.0, f64::max);
        Neighbours {
            bounds,
            by_start,
            endless,
            widest,
        }
    }

    /// The covers that may touch a surface, in the order of the surfaces.
    fn touching(&self, index: usize) -> Vec<usize> {
        let own = self.bounds[index];
        let start = |cover: &usize| self.bounds[*cover].min.x;
        let from = self
            .by_start
            .partition_point(|c| start(c) < own.min.x - self.widest);
        let to = self.by_start.partition_point(|c| start(c) <= own.max.x);
        let near = self.by_start[from..to].iter().chain(&self.endless);
        let touches =
            |&&cover: &&usize| cover != index && !own.common(self.bounds[cover]).is_empty();
        let mut touching: Vec<usize> = near.filter(touches).copied().collect();
        touching.sort_unstable();
        touching
    }
}

/// Length in metres by which a face of a box can be extended into one solid. A long extension is the length of the box,
/// divided by the smallest power of two for which the solid contains the extension with a margin. Otherwise the
/// extension just exceeds rounding, if the solid contains it, or is 0.
fn extension(surface: &Surface, face: Face, cover: &Surface, error_bound: f32) -> f32 {
    /// The last attempt is 2^-12 of the box's length. A shorter extension is hardly better than a short one.
    const TRIES: i32 = 13;
    /// Length of a short extension, in error bounds. A wave that rounding moved to the wrong side of the seam cannot
    /// reach the face after this extension.
    const SHORT: f32 = 4.0;
    let Node::Cuboid(Cuboid { size }) = surface.shape.node else {
        return 0.0;
    };
    let near = corners(surface, size, face, 0.0);
    if !holds_all(cover, &near, &[], error_bound, error_bound) {
        return 0.0;
    }
    let short = SHORT * error_bound;
    let holds = |by: f32, most: f32| {
        let far = corners(surface, size, face, by);
        holds_all(cover, &near, &far, error_bound, most)
    };
    let mut lengths = (0..TRIES).map(|halvings| size.max_element() * 0.5_f32.powi(halvings));
    let long = lengths.find(|&by| by > short && holds(by, -short));
    match long {
        Some(by) => by,
        None if holds(short, error_bound) => short,
        None => 0.0,
    }
}

/// The box with one face moved outwards.
fn extended(surface: &Surface, (axis, side): Face, by: f32) -> Surface {
    let Node::Cuboid(Cuboid { size }) = surface.shape.node else {
        return surface.clone();
    };
    let mut bigger = size;
    bigger[axis] += by;
    let mut shift = Vec3::ZERO;
    shift[axis] = 0.5 * side * by;
    Surface {
        shape: Node::Cuboid(Cuboid { size: bigger }).into(),
        position: surface.position + surface.rotation * shift,
        ..surface.clone()
    }
}

/// The corners of a face after it is moved outwards by a length.
fn corners(surface: &Surface, size: Vec3, (axis, side): Face, by: f32) -> [Vec3; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(along_u, along_v)| {
        let mut corner = Vec3::ZERO;
        corner[axis] = side * (0.5 * size[axis] + by);
        corner[u] = along_u * 0.5 * size[u];
        corner[v] = along_v * 0.5 * size[v];
        surface.position + surface.rotation * corner
    })
}

/// Whether one convex solid contains all points. The near points may be outside by at most `error_bound`. The distance
/// to the solid at the far points must be at most `most`. Each wall of a room counts as a separate solid.
fn holds_all(solid: &Surface, near: &[Vec3], far: &[Vec3], error_bound: f32, most: f32) -> bool {
    let held_by = |distance: &dyn Fn(Vec3) -> f32| {
        near.iter().all(|&point| distance(point) <= error_bound)
            && far.iter().all(|&point| distance(point) <= most)
    };
    let Node::Room(Room { size }) = solid.shape.node else {
        return held_by(&|point| solid.distance(point));
    };
    let inverse = solid.rotation.conjugate();
    let mut walls = (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]);
    walls.any(|(axis, side)| {
        held_by(&|point| {
            let local = inverse * (point - solid.position);
            0.5 * size[axis] - side * local[axis]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use proptest::prelude::*;

    fn extended_by(surfaces: &[Surface], error_bound: f32) -> Vec<Surface> {
        extend_covered_faces(surfaces, &vec![error_bound; surfaces.len()])
    }

    fn distance(surfaces: &[Surface], point: Vec3) -> f32 {
        let all = surfaces.iter().map(|surface| surface.distance(point));
        all.fold(f32::INFINITY, f32::min)
    }

    /// Protects the seams of the thesis' scenes: covered faces are extended into their covers.
    #[test]
    fn covered_faces_move_and_others_do_not() {
        let corner = Scene::builtin("corner").unwrap();
        let extended = extended_by(&corner.surfaces, 1e-5);
        assert_eq!(extended[0], corner.surfaces[0]);
        let Node::Cuboid(Cuboid { size }) = extended[1].shape.node else {
            panic!("the block is a box");
        };
        let low = extended[1].position - 0.5 * size;
        let high = extended[1].position + 0.5 * size;
        // Its west face (x = 0) and south face (z = 0) face the room.
        assert_eq!((low.x, high.z), (0.0, 0.0));
        assert!(high.x > 20.0 && low.z < -20.0 && low.y < -15.0 && high.y > 15.0);
    }

    /// Protects seams between two boxes: the long wall of `obstacles` stands against the block, and both stand between
    /// floor and ceiling.
    #[test]
    fn a_wall_is_extended_into_the_block_it_stands_at() {
        let obstacles = Scene::builtin("obstacles").unwrap();
        let extended = extended_by(&obstacles.surfaces, 1e-5);
        assert!(extended[2].distance(Vec3::new(2.0, 0.0, -0.2)) < 0.0);
        assert!(extended[4].distance(Vec3::new(-15.2, 0.0, 0.0)) < 0.0);
    }

    proptest! {
        /// Protects the shape of the air: extending the faces of boxes on a grid, which cover each other in all ways,
        /// turns no point of air into solid and no point of a solid into air.
        #[test]
        fn extending_keeps_the_shape_of_the_air(
            boxes in prop::collection::vec((0..3i32, 0..3i32, 0..3i32, 1..3i32, 1..3i32, 1..3i32), 1..6),
            in_a_room in any::<bool>(),
        ) {
            let mut surfaces: Vec<Surface> = boxes
                .iter()
                .map(|&(x, y, z, width, height, depth)| {
                    let size = Vec3::new(width as f32, height as f32, depth as f32);
                    let low = Vec3::new(x as f32, y as f32, z as f32);
                    Surface::new(Node::Cuboid(Cuboid { size })).at(low + 0.5 * size)
                })
                .collect();
            if in_a_room {
                let size = Vec3::splat(4.0);
                surfaces.push(Surface::new(Node::Room(Room { size })).at(Vec3::splat(2.0)));
            }
            let extended = extended_by(&surfaces, 1e-6);
            for index in 0..11 * 11 * 11 {
                let cell = Vec3::new((index % 11) as f32, (index / 11 % 11) as f32, (index / 121) as f32);
                let point = 0.5 * cell - Vec3::splat(0.25);
                prop_assert_eq!(distance(&surfaces, point) > 0.0, distance(&extended, point) > 0.0, "{}", point);
            }
        }
    }
}
