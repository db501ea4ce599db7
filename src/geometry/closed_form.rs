//! Intersections of a line with each shape, in the shape's own axes and in `f64`.
//!
//! A line starts in the air. Rounding can move its start up to `error_bound` metres into a solid. A line that points
//! into the solid then hits the surface at once, and a line that points out of the solid leaves it.

use super::in_front::{OpenPlane, box_distance};
use super::intersection::{Face, Intersection};
use super::marched::MarchedField;
use super::placed_mesh::PlacedMesh;
use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Bounds3, Node, Surface};
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::sync::Arc;

/// A shape with its sizes in metres.
#[derive(Clone, Debug)]
enum Form {
    Plane,
    /// `covered` marks the faces that lie on or behind a wall: [negative, positive] side for each axis.
    Box {
        half: DVec3,
        covered: [[bool; 2]; 3],
    },
    Room {
        half: DVec3,
    },
    Sphere {
        radius: f64,
    },
    Cylinder {
        radius: f64,
    },
    Field(Arc<MarchedField>),
    Mesh(PlacedMesh),
}

/// A shape placed in the world.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    form: Form,
    position: DVec3,
    /// Rotation from the shape's axes to the world axes, and its inverse; `None` if the shape is not rotated.
    pub turn: Option<(DMat3, DMat3)>,
}

impl Placed {
    pub fn new(surface: &Surface) -> Placed {
        let form = match surface.shape.node {
            Node::Plane(_) => Form::Plane,
            Node::Cuboid(Cuboid { size }) => Form::Box {
                half: size.as_dvec3() * 0.5,
                covered: [[false; 2]; 3],
            },
            Node::Room(Room { size }) => Form::Room {
                half: size.as_dvec3() * 0.5,
            },
            Node::Sphere(Sphere { radius }) => Form::Sphere {
                radius: radius.into(),
            },
            Node::Cylinder(Cylinder { radius }) => Form::Cylinder {
                radius: radius.into(),
            },
            Node::Mesh(ref of) => Form::Mesh(PlacedMesh::new(&of.mesh)),
            Node::Rooms(ref of) => Form::Mesh(PlacedMesh::new(of.mesh())),
            _ => Form::Field(Arc::new(MarchedField::new(&surface.shape))),
        };
        let [x, y, z, w] = surface.rotation.to_array().map(f64::from);
        let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
        let turn = (rotation != DQuat::IDENTITY).then(|| {
            let to_world = DMat3::from_quat(rotation);
            (to_world, to_world.transpose())
        });
        Placed {
            form,
            position: surface.position.as_dvec3(),
            turn,
        }
    }

    /// The plane surfaces with only solid behind them, as a point in world metres and the unit normal that points into
    /// the air.
    pub fn walls(&self) -> Vec<(DVec3, DVec3)> {
        let at = |point, normal| (self.world(point) + self.position, self.world(normal));
        match self.form {
            Form::Plane => vec![at(DVec3::ZERO, DVec3::Y)],
            Form::Room { half } => DVec3::AXES
                .iter()
                .flat_map(|axis| [(half * *axis, -*axis), (-half * *axis, *axis)])
                .map(|(point, normal)| at(point, normal))
                .collect(),
            _ => Vec::new(),
        }
    }

    /// Marks the faces of a box that lie behind a wall, or within `error_bound` metres of it. A wave in the air cannot
    /// hit such a face. However, a wave that ends in the edge between the box and the wall has its end point on the
    /// covered face too, and would appear to hit it.
    pub fn mark_covered_faces(&mut self, walls: &[(DVec3, DVec3)], error_bound: f64) {
        let Form::Box { half, mut covered } = self.form else {
            return;
        };
        // A wall that no corner can reach covers no face. This is the case for most pairs of a box and a wall.
        let reach = half.length() + 2.0 * error_bound;
        let is_near =
            |(point, normal): &&(DVec3, DVec3)| (self.position - *point).dot(*normal) <= reach;
        let walls: Vec<_> = walls.iter().filter(is_near).collect();
        let signs = [-1.0, 1.0];
        for axis in 0..3 {
            for side in 0..2 {
                let corners = signs.map(|u| {
                    signs.map(|v| {
                        let mut corner = DVec3::ZERO;
                        corner[axis] = signs[side];
                        corner[(axis + 1) % 3] = u;
                        corner[(axis + 2) % 3] = v;
                        self.world(half * corner) + self.position
                    })
                });
                covered[axis][side] = walls.iter().any(|(point, normal)| {
                    let height = |corner: &DVec3| (*corner - *point).dot(*normal);
                    corners
                        .iter()
                        .flatten()
                        .all(|corner| height(corner) <= error_bound)
                });
            }
        }
        self.form = Form::Box { half, covered };
    }

    /// Whether intersections are found by marching, and not in closed form.
    pub fn is_marched(&self) -> bool {
        matches!(self.form, Form::Field(_))
    }

    /// Whether the distance from a point in the air is never less than the distance to the bounding box: the value of a
    /// field can be a lower bound.
    pub fn has_exact_distance(&self) -> bool {
        match &self.form {
            Form::Field(field) => field.has_exact_distance(),
            _ => true,
        }
    }

    /// Whether the shape is a room. Only the faces of a room can be hit twice in succession.
    pub fn is_room(&self) -> bool {
        matches!(self.form, Form::Room { .. })
    }

    /// Whether a wave that leaves the shape must hit another object before it can hit the shape again.
    pub fn is_convex(&self) -> bool {
        match &self.form {
            Form::Room { .. } => false,
            Form::Field(field) => field.is_convex(),
            Form::Mesh(_) => false,
            _ => true,
        }
    }

    /// Whether the shape is curved. Reflections at curved shapes spread waves, and therefore increase their errors.
    #[cfg(any(test, feature = "reference"))]
    pub fn is_curved(&self) -> bool {
        matches!(
            self.form,
            Form::Sphere { .. } | Form::Cylinder { .. } | Form::Field(_)
        )
    }

    /// The largest coordinate of the shape in metres.
    pub fn extent(&self) -> f64 {
        let size = match self.form {
            Form::Plane => 0.0,
            Form::Box { half, .. } | Form::Room { half } => half.max_element(),
            Form::Sphere { radius } | Form::Cylinder { radius } => radius,
            Form::Field(ref field) => field.extent(),
            Form::Mesh(ref mesh) => mesh.extent(),
        };
        self.position.abs().max_element() + size
    }

    /// Bounding box of the solid in world axes, in metres; infinite along axes on which the solid is unbounded.
    pub fn bounds(&self) -> Bounds3 {
        let own = match self.form {
            Form::Plane | Form::Room { .. } => return Bounds3::EVERYWHERE,
            Form::Box { half, .. } => Bounds3::centred(half),
            Form::Sphere { radius } => Bounds3::centred(DVec3::splat(radius)),
            Form::Cylinder { radius } => {
                Bounds3::centred(DVec3::new(radius, f64::INFINITY, radius))
            }
            Form::Field(ref field) => field.bounds(),
            Form::Mesh(ref mesh) => mesh.bounds(),
        };
        let turned = self.turn.map_or(own, |(turn, _)| turned(own, turn));
        turned.moved(self.position)
    }

    /// Signed distance from a world point in metres, negative inside the solid.
    pub fn distance(&self, point: DVec3) -> f64 {
        let p = self.local(point - self.position);
        match self.form {
            Form::Plane => p.y,
            Form::Box { half, .. } => box_distance(p, half),
            Form::Room { half } => -box_distance(p, half),
            Form::Sphere { radius } => p.length() - radius,
            Form::Cylinder { radius } => DVec2::new(p.x, p.z).length() - radius,
            Form::Field(ref field) => field.distance(p),
            Form::Mesh(ref mesh) => mesh.distance(p),
        }
    }

    /// Length in metres along a line, from a point in the air or in the solid, on which it does not change sides: for a mesh
    /// the distance to the next face on the line, for other shapes the distance to the surface.
    pub fn length_on_side(
        &self,
        (origin, direction): (DVec3, DVec3),
        is_inside: bool,
        error_bound: f64,
    ) -> f64 {
        match self.form {
            Form::Mesh(ref mesh) => {
                let (o, d) = (self.local(origin - self.position), self.local(direction));
                mesh.next_face(o, d, is_inside, error_bound)
            }
            _ => self.distance(origin).abs(),
        }
    }

    /// The groups of the faces of a mesh within `reach` metres of a world point, each once; none for other shapes.
    pub fn groups_near(&self, point: DVec3, reach: f64) -> Vec<usize> {
        match self.form {
            Form::Mesh(ref mesh) => mesh.groups_near(self.local(point - self.position), reach),
            _ => Vec::new(),
        }
    }

    /// The group of the first face of a mesh that a line meets within `until` metres from its air side. The start may lie
    /// up to `error_bound` metres behind the face. `None` for other shapes.
    pub fn group_met(
        &self,
        origin: DVec3,
        direction: DVec3,
        (error_bound, until): (f64, f64),
    ) -> Option<usize> {
        let Form::Mesh(ref mesh) = self.form else {
            return None;
        };
        let (o, d) = (self.local(origin - self.position), self.local(direction));
        mesh.group_met(o, d, error_bound, until)
    }

    /// Signed distance in metres from a point of the air in front of an open plane face to the shape, as if the shape were
    /// mirrored at the face. Infinite for the convex solid whose face it is (`is_mirror`).
    pub fn distance_in_front(&self, point: DVec3, plane: OpenPlane, is_mirror: bool) -> f64 {
        let local = |point: DVec3| self.local(point - self.position);
        let (p, own) = (local(point), plane.seen(local, |n| self.local(n)));
        match self.form {
            Form::Plane => own.half_space_distance(p, DVec3::Y, 0.0),
            Form::Box { half, .. } => own.box_distance(p, half),
            Form::Room { half } => -own.box_distance(p, half),
            _ if is_mirror && self.is_convex() => f64::INFINITY,
            Form::Field(ref field) => field.distance_in_front(p, own),
            Form::Mesh(ref mesh) => mesh.distance_in_front(p, own),
            _ => self.distance(point),
        }
    }

    /// The face of a room with this unit normal, which points into the air in world axes.
    pub fn wall(&self, normal: DVec3) -> Face {
        let normal = self.local(normal);
        let size = normal.abs();
        let axis = (1..3).fold(
            0,
            |most, axis| if size[axis] > size[most] { axis } else { most },
        );
        Face {
            axis,
            positive: normal[axis] < 0.0,
        }
    }

    /// The first intersection of a line in world axes with the shape, from the air.
    ///
    /// `left` is the face of this shape on which the line starts. The march of a field can stop beyond `until` metres,
    /// which saves time.
    pub fn intersect(
        &self,
        origin: DVec3,
        direction: DVec3,
        left: Option<Face>,
        error_bound: f64,
        until: f64,
    ) -> Option<Intersection> {
        let o = self.local(origin - self.position);
        let d = self.local(direction);
        let smooth = |t| Intersection {
            t,
            face: None,
            triangle: None,
        };
        let intersection = match self.form {
            Form::Plane => (d.y < 0.0).then(|| smooth((o.y / -d.y).max(0.0))),
            Form::Box { half, covered } => intersect_box(half, covered, o, d, error_bound),
            Form::Room { half } => intersect_room(half, o, d, left),
            Form::Sphere { radius } => intersect_sphere(radius, o, d).map(smooth),
            Form::Cylinder { radius } => intersect_cylinder(radius, o, d).map(smooth),
            Form::Field(ref field) => field.intersect(o, d, until).map(smooth),
            Form::Mesh(ref mesh) => mesh.intersect(o, d, error_bound, until),
        };
        intersection.filter(|intersection| intersection.t.is_finite())
    }

    /// Distance in metres to the first solid on a line of sight in world axes, from the air; `None` if there is none within
    /// `until` metres.
    pub fn enters(
        &self,
        origin: DVec3,
        direction: DVec3,
        error_bound: f64,
        until: f64,
    ) -> Option<f64> {
        if let Form::Field(ref field) = self.form {
            let (o, d) = (self.local(origin - self.position), self.local(direction));
            return field.enters(o, d, until);
        }
        let found = self.intersect(origin, direction, None, error_bound, until);
        found.map(|found| found.t)
    }

    /// The world point of an intersection, projected onto the surface, and the unit normal there, which points out of
    /// the solid.
    pub fn project(
        &self,
        origin: DVec3,
        direction: DVec3,
        intersection: Intersection,
    ) -> (DVec3, DVec3) {
        if let (Form::Mesh(mesh), Some(triangle)) = (&self.form, intersection.triangle) {
            let (o, d) = (self.local(origin - self.position), self.local(direction));
            let (point, normal) = mesh.project(triangle, o, d);
            return (self.world(point) + self.position, self.world(normal));
        }
        let p = self.local(origin + direction * intersection.t - self.position);
        let (point, normal) = match (&self.form, intersection.face) {
            (Form::Field(field), _) => field.project(p, self.local(direction)),
            (Form::Box { half, .. }, Some(face)) => project_onto_face(*half, p, face, 1.0),
            (Form::Room { half }, Some(face)) => project_onto_face(*half, p, face, -1.0),
            (Form::Sphere { radius }, _) => {
                let normal = p.normalize_or(DVec3::Y);
                (normal * *radius, normal)
            }
            (Form::Cylinder { radius }, _) => {
                let normal = DVec3::new(p.x, 0.0, p.z).normalize_or(DVec3::X);
                (normal * *radius + DVec3::Y * p.y, normal)
            }
            _ => (DVec3::new(p.x, 0.0, p.z), DVec3::Y),
        };
        (self.world(point) + self.position, self.world(normal))
    }

    pub fn local(&self, vector: DVec3) -> DVec3 {
        self.turn.map_or(vector, |(_, to_local)| to_local * vector)
    }

    fn world(&self, vector: DVec3) -> DVec3 {
        self.turn.map_or(vector, |(to_world, _)| to_world * vector)
    }
}

/// Bounding box of a box that is rotated about the origin. If the rotation moves an infinite face towards an axis, the
/// result is infinite along this axis, even for very small rotations. [`Bounds3::turned`] ignores very small rotations.
fn turned(own: Bounds3, turn: DMat3) -> Bounds3 {
    let mut all = Bounds3::centred(DVec3::ZERO);
    for column in 0..3 {
        for row in 0..3 {
            let share = turn.col(column)[row];
            if share == 0.0 {
                continue;
            }
            let (low, high) = (share * own.min[column], share * own.max[column]);
            all.min[row] += low.min(high);
            all.max[row] += low.max(high);
        }
    }
    all
}

/// Distance in metres to a sphere about the origin, hit from outside; `None` if the line misses it.
pub(super) fn intersect_sphere(radius: f64, o: DVec3, d: DVec3) -> Option<f64> {
    let along = o.dot(d);
    if along >= 0.0 {
        return None;
    }
    let beside = (o - d * along).length();
    enter_circle(radius, o.length(), beside, along, 1.0)
}

/// Distance in metres to a cylinder about the y axis. In the projection along y, the cylinder is a circle, and the
/// projection of `d` is shorter than 1.
fn intersect_cylinder(radius: f64, o: DVec3, d: DVec3) -> Option<f64> {
    let (o, d) = (DVec2::new(o.x, o.z), DVec2::new(d.x, d.z));
    let along = o.dot(d);
    if along >= 0.0 {
        return None;
    }
    let speed = d.length();
    let beside = o.perp_dot(d) / speed;
    enter_circle(radius, o.length(), beside, along, speed)
}

/// Distance along a line to the circle that the line enters. `distance` is the distance of the line's start from the
/// centre, `beside` is the least distance of the line from the centre, and `speed` is the length of its direction.
/// `along` is the position of the start relative to the point closest to the centre, multiplied by `speed`.
fn enter_circle(radius: f64, distance: f64, beside: f64, along: f64, speed: f64) -> Option<f64> {
    let half_chord_squared = (radius - beside) * (radius + beside);
    if half_chord_squared < 0.0 {
        return None;
    }
    let tangent_squared = (distance - radius) * (distance + radius);
    Some((tangent_squared / (half_chord_squared.sqrt() * speed - along)).max(0.0))
}

fn intersect_box(
    half: DVec3,
    covered: [[bool; 2]; 3],
    o: DVec3,
    d: DVec3,
    error_bound: f64,
) -> Option<Intersection> {
    let (half, o, d) = (half.to_array(), o.to_array(), d.to_array());
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    // Both the covered face and a line along the wall can be off the wall by the error bound. Together they can be off
    // by twice the bound.
    let cover_error = 2.0 * error_bound;
    // Up to this distance, the line is below the plane of a covered face.
    let mut covered_until = f64::NEG_INFINITY;
    let mut axis = 0;
    for i in 0..3 {
        if d[i] == 0.0 {
            let is_covered = covered[i][usize::from(o[i] > 0.0)];
            let beyond = if is_covered { cover_error } else { 0.0 };
            if o[i].abs() > half[i] + beyond {
                return None;
            }
            continue;
        }
        let far_side = half[i].copysign(d[i]);
        let near = (-far_side - o[i]) / d[i];
        if covered[i][usize::from(d[i] < 0.0)] {
            covered_until = covered_until.max(near - cover_error / d[i].abs());
        } else if near > enter {
            (enter, axis) = (near, i);
        }
        leave = leave.min((far_side - o[i]) / d[i]);
    }
    if enter > leave || leave <= 0.0 {
        return None;
    }
    // The start is inside the box. If this is due to rounding, the line enters the box here. Otherwise it leaves the
    // box.
    if enter < 0.0 && (-enter > leave || -enter * d[axis].abs() > error_bound) {
        return None;
    }
    let t = enter.max(0.0);
    if covered_until > t {
        return None;
    }
    let positive = d[axis] < 0.0;
    Some(Intersection {
        t,
        face: Some(Face { axis, positive }),
        triangle: None,
    })
}

fn intersect_room(half: DVec3, o: DVec3, d: DVec3, left: Option<Face>) -> Option<Intersection> {
    let (half, o, d) = (half.to_array(), o.to_array(), d.to_array());
    let (mut nearest, mut met) = (f64::INFINITY, None);
    for axis in 0..3 {
        let positive = d[axis] > 0.0;
        let face = Some(Face { axis, positive });
        // Only rounding can direct a reflected wave towards the face that it has just left.
        if d[axis] == 0.0 || face == left {
            continue;
        }
        // The distance is 0 in an edge, or if the start is beyond a face due to rounding. Therefore no wave leaves the
        // room.
        let t = ((half[axis].copysign(d[axis]) - o[axis]) / d[axis]).max(0.0);
        if t < nearest {
            (nearest, met) = (t, face);
        }
    }
    met.map(|face| Intersection {
        t: nearest,
        face: Some(face),
        triangle: None,
    })
}

/// Projects a point onto a face, limited to the area of the face. `outward` is 1 for a solid box and −1 for a room.
fn project_onto_face(half: DVec3, p: DVec3, face: Face, outward: f64) -> (DVec3, DVec3) {
    let side = if face.positive { 1.0 } else { -1.0 };
    let mut point = p.clamp(-half, half);
    point[face.axis] = half[face.axis] * side;
    let mut normal = DVec3::ZERO;
    normal[face.axis] = side * outward;
    (point, normal)
}
