//! Parts of a closed mesh that are inside out: furniture whose faces point the same way as the walls of its room.
//!
//! A face with air on both sides, or with solids on both sides, bounds nothing. The number of solids about a place is the
//! sum of the solid angles of all faces over 4π, and one more in a mesh that is surrounded by a solid: 0 in air, 1 or
//! more in solids.

use super::edges::joined;
use super::measures::{area, corners, cross, signed_volume};
use super::report::Defect;
use crate::scene::shape::Bounds3;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Maximum number of solid angles that are computed: one or two seconds. In larger meshes, later parts keep their
/// orientation.
const MOST_ANGLES: usize = 50_000_000;

/// Maximum number of faces of a part that are examined: all triangles of two boxes. The largest ones are.
const MOST_FACES: usize = 24;

/// Maximum number of rooms whose bounding boxes are compared with those of other parts: the largest ones. Other parts are
/// examined in any case.
const MOST_ROOMS: usize = 64;

/// Distance of an examined place from its face, as a share of the square root of the face's area.
const OFF_FACE: f64 = 1e-3;

/// The same distance as a share of the volume of a part over its area, which is at most half of its thickness.
const OFF_PLATE: f64 = 0.1;

/// Triangles that are joined by edges of two faces.
struct Part {
    triangles: Vec<usize>,
    /// Volume behind its faces in m³: negative if it encloses air.
    volume_m3: f64,
    bounds: Bounds3,
}

/// Reverses the parts of a closed mesh that enclose air within air, and in a mesh that is surrounded by a solid those that
/// enclose solids within it. Returns their number.
pub(super) fn reverse_inverted(
    vertices: &[Vec3],
    triangles: &mut [[u32; 3]],
    is_hollow: bool,
) -> Defect {
    let parts: Vec<Part> = joined(triangles)
        .into_iter()
        .map(|part| Part::of(vertices, triangles, part))
        .collect();
    let mut inverted = Defect::default();
    if parts.len() < 2 {
        return inverted;
    }
    let encloses_air = |part: &&Part| part.volume_m3 < 0.0;
    let mut rooms: Vec<&Part> = parts.iter().filter(encloses_air).collect();
    rooms.sort_by(|a, b| a.volume_m3.total_cmp(&b.volume_m3));
    rooms.truncate(MOST_ROOMS);
    let is_in_room = |part: &Part| rooms.iter().any(|room| room.is_about(part));
    let is_suspect = |part: &&Part| encloses_air(part) || (is_hollow && !is_in_room(part));
    let most = MOST_ANGLES / (MOST_FACES * triangles.len());
    let found: Vec<&Part> = parts
        .iter()
        .filter(is_suspect)
        .take(most)
        .filter(|part| part.is_inverted(vertices, triangles, is_hollow))
        .collect();
    for part in found {
        inverted.add(vertices[triangles[part.triangles[0]][0] as usize]);
        for at in &part.triangles {
            triangles[*at].swap(1, 2);
        }
    }
    inverted
}

impl Part {
    fn of(vertices: &[Vec3], all: &[[u32; 3]], triangles: Vec<usize>) -> Part {
        let own = || triangles.iter().map(|at| &all[*at]);
        Part {
            volume_m3: signed_volume(vertices, own()),
            bounds: Bounds3::of_points(own().flat_map(|triangle| corners(vertices, triangle))),
            triangles,
        }
    }

    /// Whether the bounding box of the part contains that of another one.
    fn is_about(&self, other: &Part) -> bool {
        self.bounds.hull(other.bounds) == self.bounds
    }

    /// Whether most of its faces, by area, have air on both sides, or solids. Furniture that reaches into a wall has some
    /// faces in the solid.
    fn is_inverted(&self, vertices: &[Vec3], all: &[[u32; 3]], is_hollow: bool) -> bool {
        let of_face = |at: &usize| (*at, area(vertices, &all[*at]));
        let mut faces: Vec<(usize, f64)> = self.triangles.iter().map(of_face).collect();
        let off_m = OFF_PLATE * self.volume_m3.abs() / faces.iter().map(|face| face.1).sum::<f64>();
        faces.sort_by(|a, b| b.1.total_cmp(&a.1));
        faces.truncate(MOST_FACES);
        let mut balance_m2 = 0.0;
        for (at, area_m2) in faces {
            let off_m = off_m.min(OFF_FACE * area_m2.sqrt());
            let solids = solids_in_front(vertices, (&all[at], off_m), all, is_hollow);
            let is_inverted = match self.volume_m3 < 0.0 {
                true => solids < -0.5,
                false => solids > 0.5,
            };
            balance_m2 += if is_inverted { area_m2 } else { -area_m2 };
        }
        balance_m2 > 0.0
    }
}

/// The number of solids about the place that is `off_m` metres in front of the middle of a face.
fn solids_in_front(
    vertices: &[Vec3],
    (face, off_m): (&[u32; 3], f64),
    all: &[[u32; 3]],
    is_hollow: bool,
) -> f64 {
    let off = cross(vertices, face).normalize_or_zero() * off_m;
    let place = corners(vertices, face).iter().sum::<DVec3>() / 3.0 + off;
    let angles = all
        .iter()
        .map(|triangle| solid_angle(corners(vertices, triangle), place));
    angles.sum::<f64>() / (4.0 * PI) + f64::from(u8::from(is_hollow))
}

/// Solid angle of a triangle seen from a place, positive from behind (A. Van Oosterom and J. Strackee, *The solid angle of a
/// plane triangle*, IEEE Transactions on Biomedical Engineering 30, 1983).
fn solid_angle(corners: [DVec3; 3], place: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| (corner - place).normalize_or_zero());
    let volume = a.dot(b.cross(c));
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}
