//! Edges and vertices that waves hit from inside and from outside.

use super::super::{Case, Planted};
use super::build::{aims, block, builtin, hall, listener_outside, scene};
use echomarch::scene::Surface;
use glam::{DVec3, Quat, Vec3};

pub fn cases() -> Vec<Case> {
    vec![
        concave_edge(),
        concave_vertex(),
        flush_edge(),
        convex_edge(),
        convex_vertex(),
        turned_vertex(),
    ]
}

const SIGNS: [f32; 2] = [-1.0, 1.0];

fn concave_edge() -> Case {
    let source = Vec3::new(-8.0, 1.0, -8.0);
    let mut points = Vec::new();
    for (a, b) in SIGNS.into_iter().flat_map(|a| SIGNS.map(|b| (a, b))) {
        points.extend([
            Vec3::new(15.0 * a, 3.0, 15.0 * b),
            Vec3::new(15.0 * a, 10.0 * b, 3.0),
            Vec3::new(3.0, 10.0 * a, 15.0 * b),
        ]);
    }
    let directions = aims(source, &points);
    let answers = unfolded(source, &directions, 4);
    Case::spread(
        "concave-edge",
        "a ray into the edge of two walls hits both simultaneously",
        "both reflect it, in any order: it returns parallel to its path",
        scene("hall", vec![hall()], source, listener_outside()),
        directions,
        4,
    )
    .planted(1e-6, answers)
}

fn concave_vertex() -> Case {
    let source = Vec3::new(-8.0, 1.0, -8.0);
    let directions = aims(source, &vertices(Vec3::new(15.0, 10.0, 15.0)));
    let answers = unfolded(source, &directions, 6);
    Case::spread(
        "concave-vertex",
        "a ray into the corner of three walls hits all three simultaneously",
        "all three reflect it: it returns along its path",
        scene("hall", vec![hall()], source, listener_outside()),
        directions,
        6,
    )
    .planted(1e-6, answers)
}

/// The positions of waves in the hall after `flights` flights. The room is unfolded into a grid of its mirror images,
/// in which the path is straight and every plane of the grid ends a flight. If a wave hits several walls
/// simultaneously, their order does not matter.
fn unfolded(source: Vec3, directions: &[Vec3], flights: usize) -> Vec<Planted> {
    let half = DVec3::new(15.0, 10.0, 15.0);
    let start = source.as_dvec3();
    let answer = |direction: &Vec3| {
        let way = direction.as_dvec3().normalize();
        let mut ends: Vec<f64> = (0..3)
            .flat_map(|axis| (0..flights).map(move |image| (axis, image as f64)))
            .map(|(axis, image)| {
                let (half, way) = (half[axis], way[axis]);
                (half * (1.0 + 2.0 * image) - start[axis] * way.signum()) / way.abs()
            })
            .collect();
        ends.sort_by(f64::total_cmp);
        let at = start + way * ends[flights - 1];
        let fold =
            |at: f64, half: f64| half - ((at + half).rem_euclid(4.0 * half) - 2.0 * half).abs();
        let end = DVec3::new(fold(at.x, half.x), fold(at.y, half.y), fold(at.z, half.z));
        Planted {
            objects: vec![1; flights],
            end,
        }
    };
    directions.iter().map(answer).collect()
}

fn flush_edge() -> Case {
    let mut scene = builtin("corner");
    scene.sources[0].position = Vec3::new(7.0, 0.0, 9.0);
    scene.listeners[0].position = Vec3::new(-10.0, 0.0, -10.0);
    let heights = [-10.0, -3.0, 0.0, 4.0, 10.0];
    let points: Vec<Vec3> = heights
        .into_iter()
        .flat_map(|y| [Vec3::new(15.0, y, 0.0), Vec3::new(0.0, y, -15.0)])
        .chain(heights.map(|y| Vec3::new(0.0, y, 0.0)))
        .collect();
    let directions = aims(scene.sources[0].position, &points);
    Case::spread(
        "flush-edge",
        "a block touches a wall: a ray into the seam must not pass between them",
        "wall and block reflect it, in any order",
        scene,
        directions,
        6,
    )
}

fn convex_edge() -> Case {
    let source = Vec3::new(-8.0, 1.0, -8.0);
    let points: Vec<Vec3> = [-1.9, -0.5, 0.0, 1.7]
        .into_iter()
        .flat_map(|along| {
            [
                Vec3::new(-1.0, along, -3.0),
                Vec3::new(1.0, along, -3.0),
                Vec3::new(-1.0, along, 3.0),
                Vec3::new(-1.0, 2.0, along),
                Vec3::new(0.5 * along, 2.0, -3.0),
            ]
        })
        .collect();
    Case::spread(
        "convex-edge",
        "a ray onto the edge of a block belongs to neither face",
        "either face reflects it, or it just passes",
        scene(
            "block",
            standing(Quat::IDENTITY),
            source,
            listener_outside(),
        ),
        aims(source, &points),
        4,
    )
}

fn convex_vertex() -> Case {
    let source = Vec3::new(-8.0, 5.0, -8.0);
    Case::spread(
        "convex-vertex",
        "a ray onto the vertex of a block belongs to none of its faces",
        "any of the faces reflects it, or it just passes",
        scene(
            "block",
            standing(Quat::IDENTITY),
            source,
            listener_outside(),
        ),
        aims(source, &vertices(Vec3::new(1.0, 2.0, 3.0))),
        4,
    )
}

fn turned_vertex() -> Case {
    let source = Vec3::new(-8.0, 5.0, -8.0);
    let turn = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(0.3);
    let mut points = vertices(Vec3::new(1.0, 2.0, 3.0));
    let edges: Vec<Vec3> = points.windows(2).map(|p| 0.5 * (p[0] + p[1])).collect();
    points.extend(edges);
    let points: Vec<Vec3> = points.into_iter().map(|p| turn * p).collect();
    Case::spread(
        "turned-edges",
        "edges and vertices of a rotated block",
        "any face reflects it, or it just passes",
        scene("block", standing(turn), source, listener_outside()),
        aims(source, &points),
        4,
    )
}

/// A block in the hall.
fn standing(turn: Quat) -> Vec<Surface> {
    vec![hall(), block(2.0, 4.0, 6.0).turned(turn)]
}

fn vertices(half: Vec3) -> Vec<Vec3> {
    let mut vertices = Vec::new();
    for x in SIGNS {
        for y in SIGNS {
            vertices.extend(SIGNS.map(|z| half * Vec3::new(x, y, z)));
        }
    }
    vertices
}
