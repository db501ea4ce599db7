//! Origin rebasing: the conversion of positions to the coordinates of the shader.
//!
//! The profile `thesis` uses world coordinates. The other profiles use coordinates relative to the listener, so that a
//! scene far from the world's origin loses no precision. Box faces that another solid covers are extended into that
//! solid, so that rounding at the seam cannot open a gap between box and solid (`covered_faces.rs`).

use super::cells::ENDLESS;
use super::covered_faces::extend_covered_faces;
use super::layout::Layout;
use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Listener, Node, ROUNDING, Scene, Shape, Surface};
use glam::{DMat3, DVec3, Quat, Vec3, Vec4};

/// The conversion from world coordinates to a shader's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OriginRebasing {
    /// World position of the shader's origin in metres.
    pub origin: Vec3,
    /// Whether covered faces are extended.
    pub extends_covered_faces: bool,
}

/// Vectors of the box in the record of a marched surface ([`RebasedScene::box_around`]).
pub(super) const BOX_VECTORS: usize = 3;

/// A scene's surfaces in a shader's coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RebasedScene {
    rebasing: OriginRebasing,
    surfaces: Vec<Surface>,
    error_bounds: Vec<f32>,
}

impl OriginRebasing {
    /// Unchanged world coordinates.
    pub fn world() -> OriginRebasing {
        OriginRebasing {
            origin: Vec3::ZERO,
            extends_covered_faces: false,
        }
    }

    /// Coordinates relative to a listener, with covered faces extended.
    pub fn at(listener: &Listener) -> OriginRebasing {
        OriginRebasing {
            origin: listener.position,
            extends_covered_faces: true,
        }
    }

    /// A world point in the shader's coordinates.
    pub fn place(&self, point: Vec3) -> Vec3 {
        (point.as_dvec3() - self.origin.as_dvec3()).as_vec3()
    }

    /// The position of a surface in the shader's coordinates. An infinite repetition is moved by whole periods, so that
    /// the surface's origin is near the listener and no precision is lost to their distance. In world coordinates no
    /// surface is moved.
    fn place_surface(&self, surface: &Surface) -> Vec3 {
        let field = surface.shape.field().filter(|_| self.extends_covered_faces);
        let periods = field.map(Shape::periods).unwrap_or_default();
        let rotation = surface.rotation.as_dquat().normalize();
        let far = surface.position.as_dvec3() - self.origin.as_dvec3();
        let near = periods.into_iter().fold(far, |place, period| {
            let period = rotation * period;
            place - period * (place.dot(period) / period.length_squared()).round()
        });
        near.as_vec3()
    }

    /// The surfaces in the shader's coordinates.
    pub fn apply(&self, scene: &Scene) -> RebasedScene {
        let place = |surface: &Surface| surface.clone().at(self.place_surface(surface));
        let surfaces: Vec<Surface> = scene.surfaces.iter().map(place).collect();
        // The error bounds are derived before the extension, which adds size only where no wave can be.
        let error_bounds: Vec<f32> = surfaces.iter().map(error_bound).collect();
        let surfaces = if self.extends_covered_faces {
            extend_covered_faces(&surfaces, &error_bounds)
        } else {
            surfaces
        };
        RebasedScene {
            rebasing: *self,
            surfaces,
            error_bounds,
        }
    }
}

impl RebasedScene {
    /// The conversion that gave the coordinates of the surfaces.
    pub fn rebasing(&self) -> &OriginRebasing {
        &self.rebasing
    }

    /// The values of `uSurfaces`. Each unrolled surface has its position (with radius or error bound) and then, if it
    /// has them, its half size with error bound, the inverse of its rotation, and the moving numbers of its field.
    pub fn uniform_values(&self, layout: &Layout) -> Vec<Vec4> {
        let mut all = Vec::new();
        for &index in &layout.unrolled {
            let (surface, error_bound) = (&self.surfaces[index], self.error_bounds[index]);
            push_values(surface, error_bound, false, &mut all);
        }
        all
    }

    /// A surface by index.
    pub(super) fn surface(&self, index: usize) -> &Surface {
        &self.surfaces[index]
    }

    /// Appends the values of one surface, given by its index, in the order in which the text of its kind reads them.
    pub(super) fn push_data(&self, index: usize, values: &mut Vec<Vec4>) {
        push_values(
            &self.surfaces[index],
            self.error_bounds[index],
            true,
            values,
        );
    }

    /// The box around a surface, given by its index, in the axes of the surface. The first vector has the centre of the
    /// box in the shader's coordinates. The second vector has half the size of the box along the axes of the scene that
    /// contains this box, and the rounding error of the distance to the surface. The third vector has half the size of
    /// the box. If the box is infinite at one end of an axis, it is made infinite at both ends, with the surface's
    /// position as its centre.
    pub(super) fn box_around(&self, index: usize) -> [Vec4; BOX_VECTORS] {
        let surface = &self.surfaces[index];
        let bounds = surface.shape.properties().bounds;
        let rotation = surface.rotation.as_dquat().normalize();
        let (middle, half) = match bounds.is_empty() {
            true => (DVec3::ZERO, DVec3::ZERO),
            false => (bounds.middle(), bounds.half_size()),
        };
        let ends = half.cmplt(DVec3::splat(ENDLESS));
        let middle = DVec3::select(ends, middle, DVec3::ZERO);
        let half = half.min(DVec3::splat(ENDLESS));
        let place = surface.position.as_dvec3() + rotation * middle;
        let turned = DMat3::from_quat(rotation);
        let along_axes = turned.x_axis.abs() * half.x
            + turned.y_axis.abs() * half.y
            + turned.z_axis.abs() * half.z;
        [
            place.as_vec3().extend(0.0),
            along_axes.as_vec3().extend(self.error_bounds[index]),
            half.as_vec3().extend(0.0),
        ]
    }

    /// Maximum rounding error of the distance to a surface (numbered from 1), in metres.
    pub fn error_bound(&self, object: u32) -> f32 {
        let index = (object as usize).checked_sub(1);
        index
            .and_then(|i| self.error_bounds.get(i))
            .map_or(0.0, |s| *s)
    }
}

/// Maximum rounding error of a distance that is computed from a position, in metres.
pub(super) fn rounding_of(place: Vec3) -> f32 {
    ROUNDING * place.abs().max_element()
}

/// Maximum rounding error of the distance to a surface, in metres. The error of a box or a room is limited to a share
/// of its thickness, so that a thin box is not smaller than its error bound.
fn error_bound(surface: &Surface) -> f32 {
    const SHARE_OF_THICKNESS: f32 = 0.25;
    let place = surface.position.abs().max_element();
    match surface.shape.node {
        Node::Plane(_) => ROUNDING * place,
        Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => (ROUNDING
            * (place + 0.5 * size.max_element()))
        .min(SHARE_OF_THICKNESS * size.min_element()),
        Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => {
            (ROUNDING * (place + radius)).min(SHARE_OF_THICKNESS * radius)
        }
        _ => ROUNDING * (place + surface.shape.extent() as f32),
    }
}

pub(super) fn value_count(surface: &Surface, is_data: bool) -> usize {
    let mut values = Vec::new();
    push_values(surface, 0.0, is_data, &mut values);
    values.len()
}

/// Appends the values of one surface. If the surface is data, all numbers of its field count as moving.
pub(super) fn push_values(
    surface: &Surface,
    error_bound: f32,
    is_data: bool,
    values: &mut Vec<Vec4>,
) {
    let place = |w: f32| surface.position.extend(w);
    match surface.shape.node {
        Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => {
            values.extend([place(0.0), (size * 0.5).extend(error_bound)]);
        }
        Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => {
            values.push(place(radius))
        }
        _ => values.push(place(error_bound)),
    }
    if surface.has_rotation() {
        values.push(inverse(surface.rotation));
    }
    if let Some(field) = surface.shape.field() {
        let moving = match is_data {
            true => vec![true; field.nodes().len()],
            false => surface.moving_nodes(field),
        };
        values.extend(number_vectors(field, &moving));
    }
}

/// The moving numbers of a field, four to a vector.
pub(super) fn number_vectors(field: &Shape, moving: &[bool]) -> Vec<Vec4> {
    let numbers = moving_values(field, moving);
    let vectors = numbers.chunks(4).map(|four| {
        let at = |index: usize| four.get(index).copied().unwrap_or(0.0);
        Vec4::new(at(0), at(1), at(2), at(3))
    });
    vectors.collect()
}

fn inverse(rotation: Quat) -> Vec4 {
    Vec4::from(rotation.conjugate())
}

/// Whether the field has a node that may make the value grow faster than the distance.
pub(super) fn divides(field: &Shape) -> bool {
    let turns = |f: &&Shape| matches!(f.node, Node::Twist(_) | Node::Bend(_));
    field.nodes().iter().any(turns)
}

/// The current values of the moving numbers, in the order of [`Shape::nodes`].
fn moving_values(field: &Shape, moving: &[bool]) -> Vec<f32> {
    let nodes = field.nodes();
    let of_moving = nodes.iter().zip(moving).filter(|(_, moves)| **moves);
    let mut values: Vec<f32> = of_moving
        .flat_map(|(node, _)| node.shader_numbers())
        .map(|number| number as f32)
        .collect();
    if moving.contains(&true) && divides(field) {
        values.push((1.0 / field.properties().lipschitz) as f32);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::ROUNDING;

    /// Protects the rounding constant that Rust and GLSL share.
    #[test]
    fn rounding_is_the_same_in_the_shader() {
        let text = include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/glsl/common/rounding.glsl"
        ));
        let line = text
            .lines()
            .find(|line| line.starts_with("const float ROUNDING"));
        let value = line.and_then(|line| line.split(['=', ';']).nth(1));
        assert_eq!(value.map(|v| v.trim().parse()), Some(Ok(ROUNDING)));
    }
}
