//! The faces around a union of boxes of air along the axes.
//!
//! The planes of all boxes divide space into cells. Each cell is air if a box contains it, otherwise solid. The faces
//! between air and solid cells form the mesh. Because all faces have the corners of cells, no corner lies inside the edge
//! of another face.

use super::MeshFaces;
use glam::{BVec3, DVec3, UVec3};

/// A box by its least and greatest coordinates in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AirCorners {
    pub from: DVec3,
    pub to: DVec3,
}

/// Number of walls of a box: −x, +x, −y, +y, −z, +z.
pub(crate) const WALLS: usize = 6;

/// The cells of a union of boxes.
pub(crate) struct AirCells {
    /// Coordinates of the planes along each axis, in ascending order.
    planes: [Vec<f64>; 3],
    /// Number of cells along each axis.
    count: UVec3,
    /// The index of the first box that contains each cell, x first; `None` for solid.
    box_of: Vec<Option<u32>>,
}

impl AirCells {
    /// The cells of these boxes. Coordinates that differ by at most `touch` metres are one plane.
    pub fn of(boxes: &[AirCorners], touch: f64) -> AirCells {
        let planes = [0, 1, 2].map(|axis| {
            let mut all: Vec<f64> = boxes
                .iter()
                .flat_map(|b| [b.from[axis], b.to[axis]])
                .collect();
            all.sort_by(f64::total_cmp);
            all.dedup_by(|next, kept| *next - *kept <= touch);
            all
        });
        let count = UVec3::from_array([0, 1, 2].map(|axis| planes[axis].len() as u32 - 1));
        let mut cells = AirCells {
            box_of: vec![None; count.to_array().iter().map(|n| *n as usize).product()],
            planes,
            count,
        };
        for (index, of) in boxes.iter().enumerate() {
            let [low, high] = [of.from, of.to].map(|corner| cells.place(corner));
            for cell in cells_between(low, high) {
                let at = cells.index(cell);
                cells.box_of[at].get_or_insert(index as u32);
            }
        }
        cells
    }

    /// Number of cells that these boxes have at most.
    pub fn most(boxes: usize) -> usize {
        (2 * boxes).saturating_sub(1).pow(3)
    }

    /// The box with the coordinates of the planes.
    pub fn in_planes(&self, of: &AirCorners) -> AirCorners {
        AirCorners {
            from: self.corner(self.place(of.from)),
            to: self.corner(self.place(of.to)),
        }
    }

    /// The indices of the planes through a corner of a box.
    fn place(&self, corner: DVec3) -> UVec3 {
        let along = |axis: usize| {
            let below = self.planes[axis].partition_point(|plane| *plane <= corner[axis]);
            below as u32 - 1
        };
        UVec3::new(along(0), along(1), along(2))
    }

    fn index(&self, cell: UVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|at| at as usize);
        let [nx, ny, _] = self.count.to_array().map(|n| n as usize);
        x + nx * (y + ny * z)
    }

    /// The box of a cell. `place` is the cell's position plus 1, so that 0 is the solid before the first cell.
    fn box_at(&self, place: UVec3) -> Option<u32> {
        let is_outside = place.cmpeq(UVec3::ZERO) | place.cmpgt(self.count);
        match is_outside.any() {
            true => None,
            false => self.box_of[self.index(place - 1)],
        }
    }

    /// A corner of cells at which the air, or the solid, consists of parts that have only an edge or the corner in
    /// common; `None` without such a corner. There the side of a point is not that of the nearest face.
    pub fn pinched_corner(&self) -> Option<DVec3> {
        let corners = cells_between(UVec3::ZERO, self.count + 1);
        let mut pinched = corners.filter(|corner| {
            let around = cells_between(*corner, *corner + 2);
            let air = around
                .enumerate()
                .filter(|(_, place)| self.box_at(*place).is_some())
                .fold(0_u8, |air, (bit, _)| air | 1 << bit);
            !is_connected(air) || !is_connected(!air)
        });
        pinched.next().map(|corner| self.corner(corner))
    }

    fn corner(&self, corner: UVec3) -> DVec3 {
        let along = |axis: usize| self.planes[axis][corner[axis] as usize];
        DVec3::new(along(0), along(1), along(2))
    }

    /// The faces between air and solid, counterclockwise as seen from the air. The group of a face is the number of its
    /// wall, plus six times the index of its box. The groups have no names.
    pub fn faces(&self) -> MeshFaces {
        let mut faces = MeshFaces::default();
        let mut vertex_of = vec![u32::MAX; cells_in(self.count + 1)];
        for cell in cells_between(UVec3::ZERO, self.count) {
            let Some(index) = self.box_of[self.index(cell)] else {
                continue;
            };
            for wall in 0..WALLS {
                if self.box_at(neighbour(cell + 1, wall)).is_some() {
                    continue;
                }
                let corners = corners_of(cell, wall).map(|corner| {
                    let across = self.count + 1;
                    let at = corner.x + across.x * (corner.y + across.y * corner.z);
                    let vertex = &mut vertex_of[at as usize];
                    if *vertex == u32::MAX {
                        *vertex = faces.vertices.len() as u32;
                        faces.vertices.push(self.corner(corner));
                    }
                    *vertex
                });
                let [a, b, c, d] = corners;
                faces.triangles.extend([[a, b, c], [a, c, d]]);
                faces
                    .group_of
                    .extend([WALLS as u32 * index + wall as u32; 2]);
            }
        }
        faces
    }
}

fn cells_in(count: UVec3) -> usize {
    count.to_array().iter().map(|n| *n as usize).product()
}

/// The cells with low ≤ cell < high along each axis, x first.
fn cells_between(low: UVec3, high: UVec3) -> impl Iterator<Item = UVec3> {
    let planes = (low.z..high.z).flat_map(move |z| (low.y..high.y).map(move |y| (y, z)));
    planes.flat_map(move |(y, z)| (low.x..high.x).map(move |x| UVec3::new(x, y, z)))
}

/// The cell on the other side of a wall.
fn neighbour(cell: UVec3, wall: usize) -> UVec3 {
    let mut beside = cell;
    match wall % 2 {
        0 => beside[wall / 2] -= 1,
        _ => beside[wall / 2] += 1,
    }
    beside
}

/// The corners of a wall of a cell, counterclockwise as seen from the inside of the cell.
fn corners_of(cell: UVec3, wall: usize) -> [UVec3; 4] {
    let axis = wall / 2;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let is_far = wall % 2 == 1;
    let corner = |(along_u, along_v): (u32, u32)| {
        let mut corner = cell;
        corner[axis] += u32::from(is_far);
        corner[u] += along_u;
        corner[v] += along_v;
        corner
    };
    // Seen from greater coordinates, u, v and the axis are right-handed.
    match is_far {
        false => [(0, 0), (1, 0), (1, 1), (0, 1)].map(corner),
        true => [(0, 0), (0, 1), (1, 1), (1, 0)].map(corner),
    }
}

/// Whether the marked cells of the eight cells around a corner are connected by faces. Bit x + 2 y + 4 z stands for the
/// cell at (x, y, z).
fn is_connected(marked: u8) -> bool {
    let mut reached = marked & marked.wrapping_neg();
    loop {
        let across = |bits: u8, low: u8, step: u32| (bits & low) << step | (bits & !low) >> step;
        let grown = reached
            | across(reached, 0b0101_0101, 1)
            | across(reached, 0b0011_0011, 2)
            | across(reached, 0b0000_1111, 4);
        let grown = grown & marked;
        if grown == reached {
            return reached == marked;
        }
        reached = grown;
    }
}

/// For each box, the number of its body of air: boxes that overlap or share a part of a face belong to one body.
pub(crate) fn bodies(boxes: &[AirCorners], touch: f64) -> Vec<usize> {
    let mut body: Vec<usize> = (0..boxes.len()).collect();
    for (index, one) in boxes.iter().enumerate() {
        for (before, other) in boxes[..index].iter().enumerate() {
            let (from, to) = (body[index], body[before]);
            if from != to && share_a_face(one, other, touch) {
                body.iter_mut()
                    .filter(|body| **body == from)
                    .for_each(|body| *body = to);
            }
        }
    }
    body
}

/// Whether boxes have an area in common: they meet along all axes, and overlap along at least two.
fn share_a_face(a: &AirCorners, b: &AirCorners, touch: f64) -> bool {
    let common = a.to.min(b.to) - a.from.max(b.from);
    let overlaps: BVec3 = common.cmpgt(DVec3::splat(touch));
    common.min_element() >= -touch && overlaps.bitmask().count_ones() >= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(from: [f64; 3], to: [f64; 3]) -> AirCorners {
        let [from, to] = [from, to].map(DVec3::from_array);
        AirCorners { from, to }
    }

    /// Protects the side of a face and its wall: each face of a box has its normal into the box, and the number of its
    /// wall.
    #[test]
    fn the_faces_of_a_box_look_into_it() {
        let one = corners([0.0, 1.0, 2.0], [3.0, 5.0, 7.0]);
        let faces = AirCells::of(&[one], 1e-6).faces();
        assert_eq!((faces.vertices.len(), faces.triangles.len()), (8, 12));
        let middle = 0.5 * (one.from + one.to);
        for (triangle, group) in faces.triangles.iter().zip(&faces.group_of) {
            let [a, b, c] = triangle.map(|at| faces.vertices[at as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(middle - a) > 0.0);
            let wall = *group as usize;
            let side = if wall.is_multiple_of(2) { 1.0 } else { -1.0 };
            assert!(normal[wall / 2] * side > 0.0, "{wall}: {normal}");
        }
    }

    /// Protects the signs of distances: air that meets only in an edge or a corner is found, and air around an edge is
    /// not.
    #[test]
    fn boxes_that_meet_in_an_edge_or_a_corner_are_found() {
        let first = corners([0.0; 3], [1.0; 3]);
        let beside = |x, y, z| corners([x, y, z], [x + 1.0, y + 1.0, z + 1.0]);
        let pinched = |others: &[AirCorners]| {
            let all: Vec<AirCorners> = std::iter::once(first)
                .chain(others.iter().copied())
                .collect();
            AirCells::of(&all, 1e-6).pinched_corner()
        };
        assert!(pinched(&[beside(1.0, 1.0, 0.0)]).is_some());
        assert_eq!(pinched(&[beside(1.0, 1.0, 1.0)]), Some(DVec3::ONE));
        assert_eq!(pinched(&[beside(1.0, 0.0, 0.0)]), None);
        assert_eq!(
            pinched(&[beside(1.0, 0.0, 0.0), beside(1.0, 1.0, 0.0)]),
            None
        );
        assert_eq!(pinched(&[beside(0.5, 0.5, 0.5)]), None);
        assert_eq!(pinched(&[beside(1.5, 0.0, 0.0)]), None);
    }

    /// Protects the warning about rooms without a way between them: only a common area connects boxes.
    #[test]
    fn boxes_with_a_common_area_are_one_body() {
        let room = corners([0.0; 3], [4.0, 3.0, 5.0]);
        let other = corners([4.2, 0.0, 0.0], [9.0, 3.0, 5.0]);
        let door = corners([4.0, 0.0, 1.0], [4.2, 2.1, 1.9]);
        let below = corners([4.0, -1.0, 1.0], [4.2, 0.0, 1.9]);
        let of = |boxes: &[AirCorners]| bodies(boxes, 1e-6);
        let [a, b] = of(&[room, other])[..] else {
            panic!()
        };
        assert_ne!(a, b);
        assert!(
            of(&[room, other, door])
                .iter()
                .all(|body| *body == of(&[room, other, door])[0])
        );
        let [a, b] = of(&[room, below])[..] else {
            panic!()
        };
        assert_ne!(a, b);
    }
}
