//! Covered faces of boxes, sealed.
//!
//! A block that stands against a wall shares a plane with it. Where the two meet, a ray
//! that rounding put a hair to the wrong side would enter the block by the face that lies
//! in the wall, which no wave can reach. Such a face is pushed on into the solid that
//! covers it: the air keeps its shape, and the seam is gone.

use super::{Shape, Surface};
use glam::Vec3;

/// The same surfaces, with the covered faces of boxes pushed into what covers them.
///
/// A face counts as covered when its corners lie in one convex solid (a wall of a room,
/// the ground, a box, …) or within `slack` metres of it.
pub(super) fn sealed(surfaces: &[Surface], slack: f32) -> Vec<Surface> {
    let seal = |(index, surface): (usize, &Surface)| match surface.shape {
        Shape::Box { size } => seal_box(surfaces, index, size, slack),
        _ => surface.clone(),
    };
    surfaces.iter().enumerate().map(seal).collect()
}

fn seal_box(surfaces: &[Surface], index: usize, size: Vec3, slack: f32) -> Surface {
    let surface = &surfaces[index];
    let mut low = -0.5 * size;
    let mut high = 0.5 * size;
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let pushed = push(surfaces, index, size, (axis, sign), slack);
            if sign < 0.0 {
                low[axis] -= pushed;
            } else {
                high[axis] += pushed;
            }
        }
    }
    let mut result = surface.clone();
    result.shape = Shape::Box { size: high - low };
    result.position += surface.rotation * (0.5 * (low + high));
    result
}

/// How far a face may be pushed outwards without leaving what covers it; 0 when nothing
/// does. As far as the box is thick, or a power of two less.
fn push(surfaces: &[Surface], index: usize, size: Vec3, face: (usize, f32), slack: f32) -> f32 {
    const HALVINGS: u32 = 12;
    let covered = |by: f32| {
        let corners = face_corners(&surfaces[index], size, face, by);
        let others = surfaces
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != index);
        others
            .into_iter()
            .any(|(_, other)| covers(other, corners, slack))
    };
    if !covered(0.0) {
        return 0.0;
    }
    let longest = size.max_element();
    let tries = (0..HALVINGS).map(|n| longest * 0.5_f32.powi(n as i32));
    tries.into_iter().find(|&by| covered(by)).unwrap_or(0.0)
}

fn face_corners(surface: &Surface, size: Vec3, (axis, sign): (usize, f32), by: f32) -> [Vec3; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(along_u, along_v)| {
        let mut corner = Vec3::ZERO;
        corner[axis] = sign * (0.5 * size[axis] + by);
        corner[u] = along_u * 0.5 * size[u];
        corner[v] = along_v * 0.5 * size[v];
        surface.position + surface.rotation * corner
    })
}

/// Whether a solid holds all four corners. Of a room each wall is a solid of its own:
/// the corners must lie behind the same one.
fn covers(solid: &Surface, corners: [Vec3; 4], slack: f32) -> bool {
    let Shape::Room { size } = solid.shape else {
        return corners
            .iter()
            .all(|&corner| solid.distance(corner) <= slack);
    };
    let local = corners.map(|corner| solid.rotation.conjugate() * (corner - solid.position));
    (0..3).any(|axis| {
        [-1.0, 1.0].iter().any(|sign| {
            let behind = |corner: &Vec3| 0.5 * size[axis] - sign * corner[axis] <= slack;
            local.iter().all(behind)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// Protects the air: sealing moves no face that a wave can reach.
    #[test]
    fn only_covered_faces_move() {
        let corner = Scene::builtin("corner").unwrap();
        let sealed = sealed(&corner.surfaces, 1e-5);
        assert_eq!(sealed[0], corner.surfaces[0]);
        let Shape::Box { size } = sealed[1].shape else {
            panic!("the block is a box");
        };
        let (low, high) = (
            sealed[1].position - 0.5 * size,
            sealed[1].position + 0.5 * size,
        );
        // Its west face (x = 0) and south face (z = 0) look into the room.
        assert_eq!((low.x, high.z), (0.0, 0.0));
        assert!(high.x > 20.0 && low.z < -20.0 && low.y < -15.0 && high.y > 15.0);
    }

    /// Protects walls that stand against a box: the seal stays within that box.
    #[test]
    fn a_seal_does_not_come_out_at_the_other_side() {
        let obstacles = Scene::builtin("obstacles").unwrap();
        let sealed = sealed(&obstacles.surfaces, 1e-5);
        for x in [1.6, 2.0, 2.4] {
            // In front of the block's south face, where the long wall stands.
            let inside = Vec3::new(x, 0.0, 5.0);
            assert!(sealed[2].distance(inside) < 0.0);
        }
        for (sealed, plain) in sealed.iter().zip(&obstacles.surfaces) {
            for point in [Vec3::new(-8.0, 0.0, -8.0), Vec3::new(10.0, 0.0, 8.0)] {
                assert_eq!(sealed.distance(point) > 0.0, plain.distance(point) > 0.0);
            }
        }
    }
}
