//! Finds the sheets of a tree at a point, by descending to the leaves whose surface contains the point.
//!
//! The surface is the set of points with value = level. Unions, cuts and walls choose a child or change the level.
//! Moves, turns and copies change the axes. The descent ends at operators that blend or distort. The sheet of such an
//! operator is the level of the whole subtree, with derivatives by finite differences of its value.

use super::sheet::{Differenced, Form, Quadratic, Search, Way, outer};
use crate::scene::mesh::TriangleMesh;
use crate::scene::shape::{
    CappedCylinder, Capsule, Cone, Cylinder, Ellipsoid, Elongate, GeneralQuadric, HalfSpace,
    HeightField, Hyperboloid, Mirror, Paraboloid, Prism, Repeat, Room, Sphere, Torus,
};
use crate::scene::{Node, Shape};
use glam::{DMat3, DVec2, DVec3};

impl<'a> Search<'a> {
    /// Adds the sheets of `shape` whose surface is near the point.
    pub fn descend(&mut self, shape: &'a Shape, way: Way) {
        match &shape.node {
            Node::Union(_) => self.nearest(&shape.children, way, 1.0),
            Node::Intersection(_) => self.nearest(&shape.children, way, -1.0),
            Node::Difference(_) => self.difference(&shape.children, way),
            Node::SmoothUnion(_) => self.smooth_union(shape, way),
            Node::Repeat(repeat) => self.repeat(repeat, shape, way),
            Node::Twist(_) | Node::Bend(_) | Node::Morph(_) => self.differenced(shape, way),
            node => match shape.children.first() {
                Some(child) => self.single(node, child, way),
                None => self.leaf(shape, way),
            },
        }
    }

    /// Operators on one child.
    fn single(&mut self, node: &Node, child: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let below = match node {
            Node::Complement(_) => way.turned_out(),
            Node::Offset(offset) => way.at(way.level + f64::from(offset.by)),
            Node::Shell(shell) => {
                let half = way.level + 0.5 * f64::from(shell.thickness);
                match child.value(p) >= 0.0 {
                    true => way.at(half).branch(0),
                    false => way.at(half).turned_out().branch(1),
                }
            }
            Node::Scale(scale) => {
                let by = f64::from(scale.by);
                let smaller = DMat3::from_diagonal(DVec3::splat(by.recip()));
                way.at(way.level / by).turned(smaller, DVec3::ZERO)
            }
            Node::Translate(translate) => way.moved(-translate.by.as_dvec3()),
            Node::Rotate(rotate) => way.turned(rotate.matrix().transpose(), DVec3::ZERO),
            Node::Mirror(mirror) => folded(mirror, p, way),
            Node::Elongate(elongate) => pulled_apart(elongate, p, way),
            _ => return self.differenced(child, way),
        };
        self.descend(child, below);
    }

    /// Descends to the children of a union (`side` 1) or an intersection (−1) whose surface is at `p`.
    fn nearest(&mut self, children: &'a [Shape], way: Way, side: f64) {
        let p = way.frame.place(self.point);
        let values: Vec<f64> = children.iter().map(|child| side * child.value(p)).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        for (index, child) in children.iter().enumerate() {
            if values[index] <= least + self.touch {
                self.descend(child, way.branch(index as u64));
            }
        }
    }

    /// The first child, cut by the complements of all other children.
    fn difference(&mut self, children: &'a [Shape], way: Way) {
        let p = way.frame.place(self.point);
        let outward = |index: usize| if index == 0 { 1.0 } else { -1.0 };
        let value = |(index, child): (usize, &Shape)| outward(index) * child.value(p);
        let values: Vec<f64> = children.iter().enumerate().map(value).collect();
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (index, child) in children.iter().enumerate() {
            if values[index] < most - self.touch {
                continue;
            }
            let way = way.branch(index as u64);
            match index {
                0 => self.descend(child, way),
                _ => self.descend(child, way.turned_out()),
            }
        }
    }

    /// If only one child influences the value, the value is not blended.
    fn smooth_union(&mut self, shape: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let value = shape.value(p);
        let alone = shape.children.iter().position(|c| c.value(p) == value);
        match alone {
            Some(index) => {
                self.descend(&shape.children[index], way.branch(index as u64));
            }
            None => self.differenced(shape, way),
        }
    }

    fn repeat(&mut self, repeat: &Repeat, shape: &'a Shape, way: Way) {
        let p = way.frame.place(self.point);
        let Some(child) = shape.children.first() else {
            return;
        };
        let places = repeat.places(child, p);
        let values: Vec<f64> = places.iter().map(|place| child.value(*place)).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        for (place, value) in places.into_iter().zip(values) {
            if value > least + self.touch {
                continue;
            }
            let shift = place - p;
            let marks = shift.to_array().map(f64::to_bits);
            let way = marks
                .into_iter()
                .fold(way.moved(shift), Way::branch_of_bits);
            self.descend(child, way);
        }
    }

    /// Adds the subtree's own level as a sheet.
    fn differenced(&mut self, shape: &'a Shape, way: Way) {
        if shape.nodes().iter().any(|tree| tree.node.is_sampled()) {
            self.is_sampled = true;
            return;
        }
        let differenced = Differenced::new(shape, way.level, self.largest);
        self.add(Form::Differenced(differenced), way);
    }

    fn leaf(&mut self, shape: &'a Shape, way: Way) {
        if shape.node.is_sampled() {
            self.is_sampled = true;
            return;
        }
        let before = self.found.len();
        add_leaf(self, &shape.node, way);
        if self.found.len() == before {
            self.differenced(shape, way);
        }
    }
}

fn folded(mirror: &Mirror, p: DVec3, way: Way) -> Way {
    let is_folded = |axis: usize| mirror.axes[axis] && p[axis] < 0.0;
    let sides = [0, 1, 2].map(|axis| if is_folded(axis) { -1.0 } else { 1.0 });
    let number = (0..3).map(|axis| u64::from(is_folded(axis)) << axis).sum();
    let turn = DMat3::from_diagonal(DVec3::from_array(sides));
    way.turned(turn, DVec3::ZERO).branch(number)
}

/// Between its two halves, an elongated shape is constant along the axis.
fn pulled_apart(elongate: &Elongate, p: DVec3, way: Way) -> Way {
    let by = elongate.by.as_dvec3();
    let held = p.clamp(-by, by);
    let mut scale = DVec3::ONE;
    let mut shift = DVec3::ZERO;
    let mut number = 0;
    for axis in 0..3 {
        number *= 3;
        match held[axis] == p[axis] && by[axis] > 0.0 {
            true => scale[axis] = 0.0,
            false => {
                shift[axis] = -held[axis];
                number += if p[axis] > 0.0 { 1 } else { 2 };
            }
        }
    }
    way.turned(DMat3::from_diagonal(scale), shift)
        .branch(number)
}

/// Offers the sheets of the shape that may contain the searched point; sheets without a closed form are not offered.
fn add_leaf(search: &mut Search, node: &Node, way: Way) {
    let p = way.frame.place(search.point);
    let is_itself = way.level == 0.0;
    match node {
        Node::Mesh(of) => facets(search, &of.mesh, p, way),
        Node::Rooms(of) => facets(search, of.mesh(), p, way),
        Node::Plane(_) => search.flat(DVec3::Y, way.level, way, None),
        Node::HalfSpace(HalfSpace { normal, offset }) => {
            let normal = normal.as_dvec3().normalize();
            search.flat(normal, f64::from(*offset) + way.level, way, None);
        }
        Node::Room(Room { size }) => room(search, 0.5 * size.as_dvec3(), way),
        Node::Cuboid(cuboid) => cuboid_sheets(search, 0.5 * cuboid.size.as_dvec3(), p, way),
        Node::RoundedBox(rounded) => {
            let rounding = f64::from(rounded.rounding);
            let core = 0.5 * rounded.size.as_dvec3() - rounding;
            let level = way.level + rounding;
            cuboid_sheets(search, core, p, Way { level, ..way });
        }
        Node::Sphere(Sphere { radius }) => ball(search, DVec3::ZERO, *radius, way),
        Node::Cylinder(Cylinder { radius }) => rod(search, *radius, way),
        Node::CappedCylinder(capped) => capped_cylinder(search, capped, p, way),
        Node::Capsule(Capsule { radius, height }) => {
            let end = DVec3::Y * (0.5 * f64::from(*height));
            rod(search, *radius, way.branch(0));
            ball(search, end, *radius, way.branch(1));
            ball(search, -end, *radius, way.branch(2));
        }
        Node::Torus(Torus { ring, tube }) => {
            torus(search, (*ring).into(), f64::from(*tube) + way.level, way);
        }
        Node::Prism(prism) => prism_faces(search, prism, way),
        Node::Cone(cone) => cone_sheets(search, cone, way),
        Node::Ellipsoid(ellipsoid) if is_itself => search.quadric(of_ellipsoid(ellipsoid), way),
        Node::Paraboloid(bowl) if is_itself => search.quadric(of_paraboloid(bowl), way),
        Node::Hyperboloid(of) if is_itself => search.quadric(of_hyperboloid(of), way),
        Node::GeneralQuadric(quadric) if is_itself => search.quadric(of_coefficients(quadric), way),
        Node::HeightField(field) if is_itself => ground(search, field, p, way),
        _ => (),
    }
}

/// The planes of a mesh's triangles.
fn facets(search: &mut Search, mesh: &TriangleMesh, p: DVec3, way: Way) {
    for (number, facet) in mesh.facets_near(p, search.touch) {
        let way = way.branch(number.into());
        search.flat(facet.normal, facet.offset, way, Some(facet.group));
    }
}

fn room(search: &mut Search, half: DVec3, way: Way) {
    for (wall, axis, outward) in faces() {
        let inward = -outward * DVec3::AXES[axis];
        search.flat(
            inward,
            way.level - half[axis],
            way.branch(wall),
            Some(wall as u8),
        );
    }
}

/// The faces −x, +x, −y, +y, −z, +z, each with number, axis and side.
fn faces() -> impl Iterator<Item = (u64, usize, f64)> {
    (0..6).map(|face| {
        (
            face,
            face as usize / 2,
            if face % 2 == 0 { -1.0 } else { 1.0 },
        )
    })
}

/// Offers the faces and, if the box has grown, the rounded edges and corners next to `p`.
fn cuboid_sheets(search: &mut Search, half: DVec3, p: DVec3, way: Way) {
    for (face, axis, side) in faces() {
        let outward = side * DVec3::AXES[axis];
        search.flat(outward, half[axis] + way.level, way.branch(face), None);
    }
    if way.level <= 0.0 {
        return;
    }
    let octant = (0..3)
        .map(|axis| u64::from(p[axis] < 0.0) << axis)
        .sum::<u64>();
    let corner = half * p.signum();
    for axis in 0..3 {
        let edge = Quadratic::rod(DVec3::AXES[axis], corner, way.level);
        search.quadric(edge, way.branch(8 + 8 * axis as u64 + octant));
    }
    search.quadric(Quadratic::ball(corner, way.level), way.branch(32 + octant));
}

fn ball(search: &mut Search, centre: DVec3, radius: f32, way: Way) {
    let radius = f64::from(radius) + way.level;
    if radius > 0.0 {
        search.quadric(Quadratic::ball(centre, radius), way);
    }
}

fn rod(search: &mut Search, radius: f32, way: Way) {
    let radius = f64::from(radius) + way.level;
    if radius > 0.0 {
        search.quadric(Quadratic::rod(DVec3::Y, DVec3::ZERO, radius), way);
    }
}

fn torus(search: &mut Search, ring: f64, tube: f64, way: Way) {
    if tube > 0.0 {
        search.offer(Form::Torus { ring, tube }, way, None);
    }
}

/// Offers the side and the ends; if the cylinder has grown, its rims are half rings.
fn capped_cylinder(search: &mut Search, capped: &CappedCylinder, p: DVec3, way: Way) {
    let half = 0.5 * f64::from(capped.height);
    rod(search, capped.radius, way.branch(0));
    search.flat(DVec3::Y, half + way.level, way.branch(1), None);
    search.flat(DVec3::NEG_Y, half + way.level, way.branch(2), None);
    if way.level > 0.0 {
        let rim = DVec3::NEG_Y * half.copysign(p.y);
        let number = if p.y < 0.0 { 4 } else { 3 };
        torus(
            search,
            capped.radius.into(),
            way.level,
            way.moved(rim).branch(number),
        );
    }
}

fn prism_faces(search: &mut Search, prism: &Prism, way: Way) {
    let [a, b, c] = prism.corners.map(|corner| corner.as_dvec2());
    let sense = (b - a).perp_dot(c - a).signum();
    for (number, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
        let outward = DVec2::new(to.y - from.y, from.x - to.x).normalize() * sense;
        let offset = outward.dot(from) + way.level;
        search.flat(outward.extend(0.0), offset, way.branch(number as u64), None);
    }
    let half = 0.5 * f64::from(prism.depth);
    search.flat(DVec3::Z, half + way.level, way.branch(3), None);
    search.flat(DVec3::NEG_Z, half + way.level, way.branch(4), None);
}

/// Offers the base and the side. The side is the set of points with x² + z² = (radius/height)² (height/2 − y)².
fn cone_sheets(search: &mut Search, cone: &Cone, way: Way) {
    let (radius, height) = (f64::from(cone.radius), f64::from(cone.height));
    search.flat(DVec3::NEG_Y, 0.5 * height + way.level, way.branch(0), None);
    if way.level != 0.0 {
        return;
    }
    let slope = (radius / height).powi(2);
    let side = Quadratic {
        form: DMat3::from_diagonal(DVec3::new(1.0, -slope, 1.0)),
        linear: DVec3::Y * (slope * height),
        constant: -slope * 0.25 * height * height,
    };
    search.quadric(side, way.branch(1));
}

fn of_ellipsoid(ellipsoid: &Ellipsoid) -> Quadratic {
    let radii = ellipsoid.radii.as_dvec3();
    Quadratic {
        form: DMat3::from_diagonal((radii * radii).recip()),
        linear: DVec3::ZERO,
        constant: -1.0,
    }
}

fn of_paraboloid(paraboloid: &Paraboloid) -> Quadratic {
    let bend = 0.25 / f64::from(paraboloid.focal_length);
    Quadratic {
        form: DMat3::from_diagonal(DVec3::new(bend, 0.0, bend)),
        linear: DVec3::NEG_Y,
        constant: 0.0,
    }
}

fn of_hyperboloid(hyperboloid: &Hyperboloid) -> Quadratic {
    let across = f64::from(hyperboloid.waist).powi(-2);
    let up = f64::from(hyperboloid.rise).powi(-2);
    Quadratic {
        form: DMat3::from_diagonal(DVec3::new(across, -up, across)),
        linear: DVec3::ZERO,
        constant: if hyperboloid.two_sheets { 1.0 } else { -1.0 },
    }
}

fn of_coefficients(quadric: &GeneralQuadric) -> Quadratic {
    let [a, b, c, xy, yz, zx, x, y, z, constant] = quadric.coefficients.map(f64::from);
    Quadratic {
        form: DMat3::from_cols(
            DVec3::new(a, 0.5 * xy, 0.5 * zx),
            DVec3::new(0.5 * xy, b, 0.5 * yz),
            DVec3::new(0.5 * zx, 0.5 * yz, c),
        ),
        linear: DVec3::new(x, y, z),
        constant,
    }
}

/// Offers the cell of the ground around `p`, and the sides of the box. Within a cell the height is bilinear, so that
/// the ground in the cell is a quadric.
fn ground(search: &mut Search, field: &HeightField, p: DVec3, way: Way) {
    let size = field.size.as_dvec3();
    let image = field.image.size();
    let cells = (image - 1).as_dvec2();
    let cell_size = DVec2::new(size.x, size.z) / cells;
    let corner = -0.5 * DVec2::new(size.x, size.z);
    let place = ((DVec2::new(p.x, p.z) - corner) / cell_size).clamp(DVec2::ZERO, cells);
    let cell = place.floor().min(cells - 1.0);
    let first = cell.as_uvec2();
    let height = |dx: u32, dz: u32| {
        let index = (first.y + dz) * image.x + first.x + dx;
        let share = f64::from(field.image.heights()[index as usize]);
        size.y * (share - 0.5)
    };
    let origin = corner + cell * cell_size;
    let number = u64::from(first.y) * u64::from(image.x) + u64::from(first.x);
    let patch = bilinear(
        [[height(0, 0), height(1, 0)], [height(0, 1), height(1, 1)]],
        cell_size,
    );
    let moved = way.moved(DVec3::new(-origin.x, 0.0, -origin.y));
    search.quadric(patch, moved.branch(8 + number));
    for (face, axis, side) in faces() {
        let outward = side * DVec3::AXES[axis];
        search.flat(outward, 0.5 * size[axis], way.branch(face), None);
    }
}

/// y minus the height over a cell that begins at the origin; heights are indexed by z, then x.
fn bilinear(heights: [[f64; 2]; 2], cell: DVec2) -> Quadratic {
    let [[h00, h10], [h01, h11]] = heights;
    let along = DVec2::new(h10 - h00, h01 - h00) / cell;
    let twist = (h11 - h10 - h01 + h00) / (cell.x * cell.y);
    let mixed = outer(DVec3::X, DVec3::Z) + outer(DVec3::Z, DVec3::X);
    Quadratic {
        form: mixed * (-0.5 * twist),
        linear: DVec3::new(-along.x, 1.0, -along.y),
        constant: -h00,
    }
}
