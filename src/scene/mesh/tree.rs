//! A tree of boxes over the triangles of a mesh, for lines and for distances in `f64`.
//!
//! Each node is divided at the median of its triangles' centres along its longest axis. A line or a point visits the
//! nearer child first.
//!
//! The sign of a distance is that of the angle to a *pseudonormal* at the nearest point: the normal of a face, the sum of
//! the normals at an edge, and the sum of the normals at a corner, weighted by the angles of the triangles there
//! (Bærentzen and Aanæs 2005). It is exact for closed meshes.

use super::TriangleMesh;
use super::edges::Edges;
use super::triangle::{Part, Triangle};
use glam::{DVec3, Vec3};

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

/// Maximum number of boxes that wait during a traversal: one for each halving of 2^32 triangles, and one more.
const WAITING: usize = 33;

/// Growth of boxes as a share of the largest coordinate. It is larger than all roundings of a line in `f64`, and than the
/// rounding of a box to `f32`.
const SPARE: f64 = 1e-6;

#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// Indices of the triangles in the order of the leaves.
    order: Vec<u32>,
    /// Pseudonormals of the corners.
    corner_normals: Vec<Vec3>,
    /// Pseudonormals of the edges opposite of each corner of each triangle.
    edge_normals: Vec<[Vec3; 3]>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    min: Vec3,
    max: Vec3,
    /// The first of the two children, which are consecutive, or the first triangle of a leaf in the order of leaves.
    first: u32,
    /// Number of triangles of a leaf; 0 for an inner node.
    count: u32,
}

impl Tree {
    pub fn of(mesh: &TriangleMesh) -> Tree {
        let centres: Vec<Vec3> = mesh
            .triangles()
            .map(|triangle| triangle.corners.iter().sum::<Vec3>() / 3.0)
            .collect();
        let mut tree = Tree {
            nodes: Vec::with_capacity(centres.len()),
            order: (0..centres.len() as u32).collect(),
            corner_normals: Vec::new(),
            edge_normals: Vec::new(),
        };
        tree.divide(mesh, &centres);
        tree.add_normals(mesh);
        tree
    }

    fn divide(&mut self, mesh: &TriangleMesh, centres: &[Vec3]) {
        let spare = Vec3::splat((SPARE * mesh.extent()) as f32);
        let node = |order: &[u32], first: usize| {
            let corners = order.iter().flat_map(|index| mesh.triangle(*index).corners);
            let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (min, max) = corners.fold(nothing, |(min, max), p| (min.min(p), max.max(p)));
            Node {
                min: min - spare,
                max: max + spare,
                first: first as u32,
                count: order.len() as u32,
            }
        };
        let root = node(&self.order, 0);
        self.nodes.push(root);
        let mut waiting = vec![0];
        while let Some(at) = waiting.pop() {
            let Node { first, count, .. } = self.nodes[at];
            let (first, count) = (first as usize, count as usize);
            if count <= LEAF {
                continue;
            }
            let order = &mut self.order[first..first + count];
            let all = order.iter().map(|index| centres[*index as usize]);
            let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (min, max) = all.fold(nothing, |(min, max), p| (min.min(p), max.max(p)));
            let axis = (max - min).max_position();
            let half = count / 2;
            order.select_nth_unstable_by(half, |a, b| {
                let [a, b] = [a, b].map(|index| (centres[*index as usize][axis], *index));
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
            });
            let child = self.nodes.len();
            let parts = [
                node(&self.order[first..first + half], first),
                node(&self.order[first + half..first + count], first + half),
            ];
            self.nodes.extend(parts);
            self.nodes[at].first = child as u32;
            self.nodes[at].count = 0;
            waiting.extend([child, child + 1]);
        }
    }

    fn add_normals(&mut self, mesh: &TriangleMesh) {
        let mut corners = vec![DVec3::ZERO; mesh.vertices.len()];
        for (triangle, indices) in mesh.triangles().zip(&mesh.triangles) {
            let normal = triangle.exact_normal();
            let places = triangle.corners.map(|corner| corner.as_dvec3());
            for corner in 0..3 {
                let [own, next, last] = [0, 1, 2].map(|step| places[(corner + step) % 3]);
                let angle = (next - own).angle_between(last - own);
                if angle.is_finite() {
                    corners[indices[corner] as usize] += angle * normal;
                }
            }
        }
        let unit = |sum: DVec3| sum.normalize_or_zero().as_vec3();
        self.corner_normals = corners.into_iter().map(unit).collect();
        self.edge_normals = vec![[Vec3::ZERO; 3]; mesh.triangles.len()];
        let edges = Edges::of(&mesh.triangles);
        for sides in edges.all() {
            let normal = |index: u32| mesh.triangle(index).exact_normal();
            let sum: DVec3 = sides.iter().map(|side| normal(side.triangle)).sum();
            for side in sides {
                let own = &mut self.edge_normals[side.triangle as usize];
                own[usize::from(side.opposite)] = unit(sum);
            }
        }
    }

    /// The signed distance from a point to the nearest of the triangles that count.
    pub fn signed_distance(
        &self,
        mesh: &TriangleMesh,
        p: DVec3,
        counts: impl Fn(&Triangle) -> bool,
    ) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut found = None;
        let mut waiting = Vec::with_capacity(WAITING);
        waiting.push((self.nodes[0].squared_distance(p), 0));
        while let Some((squared, at)) = waiting.pop() {
            if squared >= nearest {
                continue;
            }
            let node = self.nodes[at];
            if node.count == 0 {
                let child = node.first as usize;
                let [a, b] = [child, child + 1].map(|at| (self.nodes[at].squared_distance(p), at));
                let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                waiting.extend([far, near]);
                continue;
            }
            for &index in self.leaf(node) {
                let triangle = mesh.triangle(index);
                let (place, part) = triangle.nearest(p);
                let squared = place.distance_squared(p);
                if squared < nearest && counts(&triangle) {
                    nearest = squared;
                    found = Some((index, place, part));
                }
            }
        }
        let Some((index, place, part)) = found else {
            return f64::INFINITY;
        };
        let normal = self.pseudonormal(mesh, index, part);
        let side = (p - place).dot(normal);
        if side < 0.0 && !mesh.is_sheet[index as usize] {
            -nearest.sqrt()
        } else {
            nearest.sqrt()
        }
    }

    fn pseudonormal(&self, mesh: &TriangleMesh, index: u32, part: Part) -> DVec3 {
        match part {
            Part::Face => mesh.triangle(index).exact_normal(),
            Part::Edge(opposite) => self.edge_normals[index as usize][opposite].as_dvec3(),
            Part::Corner(corner) => {
                let vertex = mesh.triangles[index as usize][corner];
                self.corner_normals[vertex as usize].as_dvec3()
            }
        }
    }

    /// See [`TriangleMesh::first_hit`] and [`TriangleMesh::first_exit`]. `facing` returns a triangle as the line meets
    /// it. At equal distances the triangle with the smaller index is hit.
    pub fn first_hit(
        &self,
        mesh: &TriangleMesh,
        facing: impl Fn(Triangle) -> Triangle,
        (o, d): (DVec3, DVec3),
        error_bound: f64,
        until: f64,
    ) -> Option<(f64, u32)> {
        let inverse = d.recip();
        let mut nearest = until;
        let mut found: Option<(f64, u32)> = None;
        let mut waiting = Vec::with_capacity(WAITING);
        waiting.push((0.0, 0));
        while let Some((enters, at)) = waiting.pop() {
            if enters > nearest {
                continue;
            }
            let node = self.nodes[at];
            if node.count == 0 {
                let child = node.first as usize;
                let entry = |at: usize| {
                    self.nodes[at]
                        .entry(o, inverse, error_bound)
                        .map(|t| (t, at))
                };
                match (entry(child), entry(child + 1)) {
                    (Some(a), Some(b)) if a.0 <= b.0 => waiting.extend([b, a]),
                    (Some(a), Some(b)) => waiting.extend([a, b]),
                    (one, other) => waiting.extend(one.or(other)),
                }
                continue;
            }
            for &index in self.leaf(node) {
                let Some(t) = facing(mesh.triangle(index)).hit(o, d, error_bound) else {
                    continue;
                };
                let is_before = found.is_some_and(|(known, other)| t == known && index < other);
                if t < nearest || is_before {
                    nearest = t;
                    found = Some((t, index));
                }
            }
        }
        found
    }

    /// The triangles within `reach` metres of a point.
    pub fn triangles_near(&self, mesh: &TriangleMesh, p: DVec3, reach: f64) -> Vec<u32> {
        let mut found = Vec::new();
        let mut waiting = vec![0];
        while let Some(at) = waiting.pop() {
            let node = self.nodes[at];
            if node.squared_distance(p) > reach * reach {
                continue;
            }
            if node.count == 0 {
                let child = node.first as usize;
                waiting.extend([child, child + 1]);
                continue;
            }
            let is_near = |index: &&u32| {
                let (place, _) = mesh.triangle(**index).nearest(p);
                place.distance(p) <= reach
            };
            found.extend(self.leaf(node).iter().filter(is_near));
        }
        found
    }

    /// Calls `visit` with each triangle whose box overlaps the box of `own`.
    pub fn each_overlap(&self, own: &Triangle, mut visit: impl FnMut(u32)) {
        let [a, b, c] = own.corners;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        let mut waiting = vec![0];
        while let Some(at) = waiting.pop() {
            let node = self.nodes[at];
            if !(node.min.cmple(max).all() && min.cmple(node.max).all()) {
                continue;
            }
            match node.count {
                0 => waiting.extend([node.first as usize, node.first as usize + 1]),
                _ => self.leaf(node).iter().copied().for_each(&mut visit),
            }
        }
    }

    /// Calls `visit` with each triangle whose box the line from `o` along the unit vector `d` enters.
    pub fn each_on_line(&self, o: DVec3, d: DVec3, mut visit: impl FnMut(u32)) {
        let inverse = d.recip();
        let mut waiting = vec![0];
        while let Some(at) = waiting.pop() {
            let node = self.nodes[at];
            if node.entry(o, inverse, 0.0).is_none() {
                continue;
            }
            match node.count {
                0 => waiting.extend([node.first as usize, node.first as usize + 1]),
                _ => self.leaf(node).iter().copied().for_each(&mut visit),
            }
        }
    }

    fn leaf(&self, node: Node) -> &[u32] {
        let first = node.first as usize;
        &self.order[first..first + node.count as usize]
    }
}

impl Node {
    fn squared_distance(&self, p: DVec3) -> f64 {
        let beyond = (self.min.as_dvec3() - p).max(p - self.max.as_dvec3());
        beyond.max(DVec3::ZERO).length_squared()
    }

    /// Distance at which a line enters the box, at least 0; `None` if the line misses the box (Kay and Kajiya 1986).
    fn entry(&self, o: DVec3, inverse: DVec3, error_bound: f64) -> Option<f64> {
        let mut enters = 0.0_f64;
        let mut leaves = f64::INFINITY;
        for axis in 0..3 {
            let spare = error_bound;
            let (low, high) = (
                f64::from(self.min[axis]) - spare - o[axis],
                f64::from(self.max[axis]) + spare - o[axis],
            );
            if inverse[axis].is_infinite() {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (near, far) = (low * inverse[axis], high * inverse[axis]);
            enters = enters.max(near.min(far));
            leaves = leaves.min(near.max(far));
        }
        (enters <= leaves).then_some(enters)
    }
}
