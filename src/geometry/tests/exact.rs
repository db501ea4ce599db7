//! Tests of flights in closed form: intersections at points computed by hand, and the statuses of waves.

use crate::geometry::closed_form::Placed;
use crate::geometry::exact::*;
use crate::geometry::sequence_hash;
use crate::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere};
use crate::scene::{Listener, Node, Scene, Source, Surface};
use glam::{DVec3, Quat, Vec3};

const ERROR_BOUND: f64 = 1e-12;

fn intersect(shape: Node, origin: DVec3, towards: DVec3) -> Option<(f64, DVec3, DVec3)> {
    let placed = Placed::new(&Surface::new(shape));
    let direction = towards.normalize();
    let intersection = placed.intersect(origin, direction, None, ERROR_BOUND, f64::INFINITY)?;
    let (point, normal) = placed.project(origin, direction, intersection);
    Some((intersection.t, point, normal))
}

/// Protects the nearest hit of each shape, by points computed by hand.
#[test]
fn lines_intersect_shapes_where_they_should() {
    let size = Vec3::new(2.0, 4.0, 6.0);
    let cases = [
        (
            Node::Plane(Plane),
            DVec3::Y * 2.0,
            DVec3::NEG_Y,
            2.0,
            DVec3::Y,
        ),
        (
            Node::Cuboid(Cuboid { size }),
            DVec3::X * 5.0,
            DVec3::NEG_X,
            4.0,
            DVec3::X,
        ),
        (
            Node::Room(Room { size }),
            DVec3::Z,
            DVec3::Z,
            2.0,
            DVec3::NEG_Z,
        ),
        (
            Node::Sphere(Sphere { radius: 2.0 }),
            DVec3::X * -5.0,
            DVec3::X,
            3.0,
            DVec3::NEG_X,
        ),
        (
            Node::Cylinder(Cylinder { radius: 0.5 }),
            DVec3::new(0.0, 9.0, 2.0),
            DVec3::NEG_Z,
            1.5,
            DVec3::Z,
        ),
    ];
    for (shape, origin, towards, t, normal) in cases {
        let met = intersect(shape.clone(), origin, towards);
        assert_eq!(met, Some((t, origin + towards * t, normal)), "{shape:?}");
    }
}

/// Protects against hits behind the start of a line or beside a shape.
#[test]
fn lines_pass_shapes_that_are_behind_or_beside() {
    let shapes = [
        Node::Plane(Plane),
        Node::Cuboid(Cuboid {
            size: Vec3::splat(2.0),
        }),
        Node::Sphere(Sphere { radius: 1.0 }),
        Node::Cylinder(Cylinder { radius: 1.0 }),
    ];
    let origin = DVec3::new(3.0, 3.0, 3.0);
    for shape in shapes {
        assert_eq!(
            intersect(shape.clone(), origin, origin),
            None,
            "{shape:?} behind"
        );
        let beside = DVec3::new(-1.0, 0.0, 1.0);
        assert_eq!(
            intersect(shape.clone(), origin, beside),
            None,
            "{shape:?} beside"
        );
    }
    let along_the_axis = intersect(
        Node::Cylinder(Cylinder { radius: 1.0 }),
        origin,
        DVec3::NEG_Y,
    );
    assert_eq!(along_the_axis, None);
}

/// Protects waves that rounding has moved slightly into a solid: a wave that points into the solid is reflected, and a
/// wave that points out of it is not stopped.
#[test]
fn a_start_just_inside_a_box_counts_as_its_surface() {
    let size = Vec3::splat(2.0);
    let origin = DVec3::new(1.0 - 1e-15, 0.2, 0.0);
    let inwards = intersect(
        Node::Cuboid(Cuboid { size }),
        origin,
        DVec3::new(-1.0, 0.5, 0.0),
    );
    assert_eq!(
        inwards.map(|(t, _, normal)| (t, normal)),
        Some((0.0, DVec3::X))
    );
    let outwards = intersect(
        Node::Cuboid(Cuboid { size }),
        origin,
        DVec3::new(1.0, 0.5, 0.0),
    );
    assert_eq!(outwards, None);
}

/// Protects shapes whose `f32` rotation quaternion does not have a length of exactly 1.
#[test]
fn a_turned_shape_keeps_its_size() {
    let turn = Quat::from_xyzw(0.1, 0.2, 0.3, 0.9273618) * 1.00005;
    let room = Node::Room(Room {
        size: Vec3::splat(2.0),
    });
    let placed = Placed::new(&Surface::new(room).turned(turn));
    let (to_world, _) = placed.turn.expect("turned");
    let intersection = placed.intersect(
        DVec3::ZERO,
        to_world.x_axis,
        None,
        ERROR_BOUND,
        f64::INFINITY,
    );
    assert!((intersection.expect("met").t - 1.0).abs() < 1e-15);
}

fn scene(surfaces: Vec<Surface>) -> ExactScene {
    let scene = Scene::new(
        "test",
        surfaces,
        Source::at(Vec3::ZERO),
        Listener::at(Vec3::new(3.0, 1.0, 0.0), 0.5),
    );
    ExactScene::new(&scene).expect("a valid scene")
}

fn floor() -> Surface {
    Surface::new(Node::Plane(Plane)).at(Vec3::NEG_Y)
}

/// Protects each status of a wave, and the values of a wave with this status.
#[test]
fn a_wave_is_heard_or_dies_or_goes_on() {
    let exact = scene(vec![floor()]);
    let died = exact.trace(DVec3::ZERO, DVec3::Y, 4);
    assert_eq!((died.status, died.length, died.order), (-1, 0.0, 0));

    let bounced = exact.trace(DVec3::ZERO, DVec3::NEG_Y, 1);
    assert_eq!((bounced.status, bounced.length, bounced.order), (1, 1.0, 1));
    assert_eq!(bounced.direction, DVec3::Y);
    assert_eq!(bounced.incoming_direction, DVec3::NEG_Y);

    let heard = exact.trace(DVec3::ZERO, DVec3::new(3.0, -3.0, 0.0), 4);
    assert_eq!((heard.status, heard.order), (0, 1));
    assert!((heard.length - (18f64.sqrt() - 0.5)).abs() < 1e-14);
    assert_eq!(heard.sequence_hash, sequence_hash(&[1, 0]));
    let from_the_left = exact.arrival_side(&heard).expect("heard");
    assert!((from_the_left + 0.5f64.sqrt()).abs() < 1e-14);
    assert_eq!(exact.arrival_side(&bounced), None);
}

/// Protects waves without a flight: those without direction or iterations, and those that start in a solid or in the
/// listener.
#[test]
fn waves_without_a_flight_stay_at_the_start() {
    let exact = scene(vec![floor()]);
    let nowhere = [DVec3::ZERO, DVec3::NAN, DVec3::X * f64::INFINITY];
    for direction in nowhere {
        let wave = exact.trace(DVec3::X, direction, 4);
        assert_eq!((wave.status, wave.point), (-1, DVec3::X));
    }
    assert_eq!(exact.trace(DVec3::X, DVec3::X, 0).status, -1);
    let stuck = exact.trace(DVec3::Y * -2.0, DVec3::Y, 4);
    assert_eq!((stuck.status, stuck.order, stuck.length), (-1, 0, 0.0));
    let inside = exact.trace(DVec3::new(3.0, 1.2, 0.0), DVec3::Y, 4);
    assert_eq!((inside.status, inside.length), (0, 0.0));
}

/// Protects the number of reflections that multiply errors.
#[test]
fn curved_reflections_are_counted() {
    let pillar = Surface::new(Node::Cylinder(Cylinder { radius: 1.0 })).at(Vec3::X * -4.0);
    let exact = scene(vec![floor(), pillar]);
    let wave = exact.trace(DVec3::ZERO, DVec3::new(-1.0, -0.5, 0.0), 8);
    assert_eq!((wave.status, wave.order, wave.curved_hits), (-1, 2, 1));
    let path = exact.trace_path(DVec3::ZERO, DVec3::new(-1.0, -0.5, 0.0), 8);
    let objects: Vec<u32> = path.iter().map(|vertex| vertex.object).collect();
    assert_eq!(sequence_hash(&objects), wave.sequence_hash);
    assert_eq!(objects, [1, 2]);
}

/// Protects waves that pass through the listener: they hit wall after wall. A wave that starts in a solid hits no wall.
#[test]
fn waves_fly_through_the_listener() {
    let room = Surface::new(Room {
        size: Vec3::splat(4.0),
    });
    let listener = Listener::at(Vec3::X, 0.5);
    let scene = Scene::new("test", vec![room], Source::at(Vec3::ZERO), listener);
    let exact = ExactScene::new(&scene).expect("a valid scene");
    let mut walls = Vec::new();
    let last = exact.follow(DVec3::ZERO, DVec3::X, 2, |hit| walls.push(hit.point.x));
    let last = last.expect("a start in the air");
    assert_eq!(walls, [2.0, -2.0]);
    assert_eq!(
        (last.origin.x, last.direction, last.is_free),
        (-2.0, DVec3::X, false)
    );
    let inside = exact.follow(DVec3::X * 3.0, DVec3::X, 2, |_| ());
    assert!(inside.is_none());
}

/// Protects obstacles: they are found up to the given distance only. The wall on which the line starts is not an
/// obstacle.
#[test]
fn the_first_surface_is_nearer_than_asked() {
    let room = Surface::new(Room {
        size: Vec3::splat(4.0),
    });
    let listener = Listener::at(Vec3::X, 0.5);
    let scene = Scene::new("test", vec![room], Source::at(Vec3::ZERO), listener);
    let exact = ExactScene::new(&scene).expect("a valid scene");
    let first = |leaving, until| {
        let hit = exact.first_surface(DVec3::X * 2.0, DVec3::NEG_X, leaving, until);
        hit.map(|hit| (hit.object, hit.t))
    };
    let wall = Some((1, DVec3::NEG_X));
    assert_eq!(first(wall, 3.9), None);
    assert_eq!(first(wall, 4.1), Some((1, 4.0)));
    // A line along the wall on which it starts hits only the next wall.
    let along = exact.first_surface(DVec3::X * 2.0, DVec3::Y, wall, 9.0);
    assert_eq!(along.map(|hit| hit.t), Some(2.0));
}

/// Protects the limits of a box on the ground: a line that starts in the ground does not hit a side of the box.
#[test]
fn a_box_does_not_go_on_below_its_covered_face() {
    let size = Vec3::splat(2.0);
    let box_on_floor = Surface::new(Node::Cuboid(Cuboid { size }));
    let exact = scene(vec![floor(), box_on_floor]);
    let met_from = |height: f64| {
        let start = DVec3::new(3.0, height - 1.0, 0.0);
        let hit = exact.first_surface(start, DVec3::NEG_X, None, f64::INFINITY);
        hit.map(|hit| hit.t)
    };
    assert_eq!(met_from(1.0), Some(2.0));
    assert_eq!(
        met_from(-1e-14),
        Some(2.0),
        "on the floor, except for rounding"
    );
    assert_eq!(met_from(-0.5), None);
    let (start, up) = (
        DVec3::new(3.0, -4.0, 0.0),
        DVec3::new(-1.0, 1.0, 0.0).normalize(),
    );
    assert_eq!(exact.first_surface(start, up, None, f64::INFINITY), None);
}
