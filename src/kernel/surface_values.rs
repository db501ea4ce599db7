//! The vectors that the text of a surface reads: uniforms, or data of the scene.

use super::cells::Lists;
use super::layout::{GRID_VECTORS, Layout};
use crate::scene::shape::{Cuboid, Cylinder, Room, Sphere};
use crate::scene::{Node, Scene, Shape, Surface};
use glam::{Quat, Vec4};

/// Vectors that a scene's surfaces take in the uniforms at most, with those of the grids that
/// they lie in.
pub fn uniform_count(scene: &Scene) -> usize {
    let of = |lists| {
        let layout = Layout::of(&scene.surfaces, lists);
        let unrolled = layout.unrolled.iter().map(|&index| &scene.surfaces[index]);
        let values: usize = unrolled.map(|surface| value_count(surface, false)).sum();
        values + GRID_VECTORS * layout.instanced.len()
    };
    of(Lists::Lines).max(of(Lists::NearestCandidates))
}

pub(super) fn value_count(surface: &Surface, is_data: bool) -> usize {
    let mut values = Vec::new();
    push_values(surface, 0.0, is_data, &mut values);
    values.len()
}

/// The values of one surface; of a field that is data all numbers move.
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
        let numbers = moving_values(field, &moving);
        let vectors = numbers.chunks(4).map(|four| {
            let at = |index: usize| four.get(index).copied().unwrap_or(0.0);
            Vec4::new(at(0), at(1), at(2), at(3))
        });
        values.extend(vectors);
    }
}

fn inverse(rotation: Quat) -> Vec4 {
    Vec4::from(rotation.conjugate())
}

/// Whether a node of it may make its value grow faster than the distance.
pub(super) fn divides(field: &Shape) -> bool {
    let turns = |f: &&Shape| matches!(f.node, Node::Twist(_) | Node::Bend(_));
    field.nodes().iter().any(turns)
}

/// The numbers that move, as they stand: in the order of [`Shape::nodes`].
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
