//! Rooms of planes.

use super::{SPECULAR, area, assert_specular, by_way_of, found, scene, traced_area};
use crate::scene::shape::{Cuboid, HalfSpace, Plane, Room};
use crate::{Scene, Shape, Surface};
use glam::{DVec3, EulerRot, Quat, Vec3};
use std::f64::consts::PI;

const SIZE: Vec3 = Vec3::new(8.0, 3.0, 5.0);
const SOURCE: Vec3 = Vec3::new(-2.1, 0.2, -1.3);
const LISTENER: Vec3 = Vec3::new(1.9, -0.4, 1.1);

/// Images of the source in an empty room about the origin, up to an order: vector from the listener
/// to the image, and order.
fn images(order: i32) -> Vec<(DVec3, usize)> {
    let (size, source) = (SIZE.as_dvec3(), SOURCE.as_dvec3());
    let mut all = Vec::new();
    for x in -order..=order {
        for y in -order..=order {
            for z in -order..=order {
                let n = [x, y, z];
                let used: i32 = n.iter().map(|n| n.abs()).sum();
                if used > order {
                    continue;
                }
                let place = |axis: usize| {
                    let sign = if n[axis] % 2 == 0 { 1.0 } else { -1.0 };
                    f64::from(n[axis]) * size[axis] + sign * source[axis]
                };
                let image = DVec3::new(place(0), place(1), place(2));
                all.push((image - LISTENER.as_dvec3(), used as usize));
            }
        }
    }
    all.sort_by(|a, b| a.0.length().total_cmp(&b.0.length()));
    all
}

fn assert_all_images(scene: &Scene, into_room: Quat) {
    let found = found(scene, 16_384, 3, f64::INFINITY);
    let images = images(3);
    assert_eq!(images.len(), 1 + 6 + 18 + 38);
    assert_eq!(found.paths.len(), images.len());
    for (path, (image, order)) in found.paths.iter().zip(images) {
        assert_eq!(path.points.len(), order);
        assert!((path.length_m - image.length()).abs() < 1e-9);
        let from = into_room.as_dquat().normalize() * -path.arrival_direction;
        assert!((from - image.normalize()).length() < 1e-9, "{path:?}");
        let exact = 1.0 / (4.0 * PI * image.length_squared());
        assert!((path.spreading / exact - 1.0).abs() < 1e-9);
        assert!(!path.is_focus);
        assert_specular(scene, path, SPECULAR);
    }
}

/// Protects the whole early part of a shoebox: every image to order 3, its length to 1e-9 m, the
/// direction it comes from, and 1/(4π L²).
#[test]
fn a_shoebox_has_all_its_images() {
    let room = Surface::new(Room { size: SIZE });
    let scene = scene(vec![room], SOURCE, LISTENER);
    assert_all_images(&scene, Quat::IDENTITY);
}

/// Protects rooms that are moved and turned, and the numbers of their walls.
#[test]
fn a_turned_shoebox_has_them_too() {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.7, -0.4, 1.1);
    let place = Vec3::new(30.0, -4.0, 11.0);
    let room = Surface::new(Room { size: SIZE }).at(place).turned(turn);
    let mut scene = scene(vec![room], Vec3::ZERO, Vec3::ZERO);
    // Positions are f32: when converted to the room's axes they are off by 1e-6 m.
    scene.source.position = place + turn * SOURCE;
    scene.listener.position = place + turn * LISTENER;
    let paths = found(&scene, 16_384, 3, f64::INFINITY).paths;
    assert_eq!(paths.len(), 63);
    for (path, (image, _)) in paths.iter().zip(images(3)) {
        assert!((path.length_m - image.length()).abs() < 2e-5);
        let mut counts = [0i32; 3];
        for wall in path.walls.iter().flatten() {
            counts[usize::from(wall / 2)] += 1;
        }
        let crossed = (image + LISTENER.as_dvec3()) / SIZE.as_dvec3();
        assert_eq!(counts.map(f64::from), crossed.round().abs().to_array());
    }
}

/// Protects walls of other kinds: six half spaces and six planes form a room as well.
#[test]
fn rooms_of_half_spaces_and_planes_are_rooms() {
    let axes = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    let half_space = |axis: Vec3| {
        let offset = -0.5 * SIZE.dot(axis.abs());
        // The normal need not have length 1.
        Surface::new(Shape::from(HalfSpace {
            normal: 2.0 * axis,
            offset,
        }))
    };
    let surfaces = axes.clone().map(half_space).collect();
    assert_all_images(&scene(surfaces, SOURCE, LISTENER), Quat::IDENTITY);

    let plane = |axis: Vec3| {
        let place = -0.5 * SIZE * axis;
        Surface::new(Plane)
            .at(place)
            .turned(Quat::from_rotation_arc(Vec3::Y, axis))
    };
    let surfaces = axes.map(plane).collect();
    let paths = found(&scene(surfaces, SOURCE, LISTENER), 16_384, 3, f64::INFINITY).paths;
    assert_eq!(paths.len(), 63);
    for (path, (image, _)) in paths.iter().zip(images(3)) {
        // Turns are in f32.
        assert!((path.length_m - image.length()).abs() < 1e-5);
    }
}

/// Protects the numbers of walls: the first echo of each.
#[test]
fn walls_are_numbered_by_axis_and_side() {
    let room = Surface::new(Room { size: SIZE });
    let scene = scene(vec![room], SOURCE, LISTENER);
    let found = found(&scene, 1024, 1, f64::INFINITY);
    for path in found.paths.iter().filter(|path| path.points.len() == 1) {
        let wall = usize::from(path.walls[0].expect("a wall"));
        let (axis, side) = (wall / 2, if wall % 2 == 0 { -0.5 } else { 0.5 });
        assert!((path.points[0][axis] - side * f64::from(SIZE[axis])).abs() < 1e-14);
    }
    assert_eq!(by_way_of(&found, &[1]).len(), 6);
}

/// Protects a path exactly through an edge of a room: there is one, though either wall may come
/// first.
#[test]
fn an_edge_is_one_path() {
    let room = Surface::new(Room {
        size: Vec3::splat(4.0),
    });
    let (source, listener) = (Vec3::new(1.5, 1.0, 0.0), Vec3::X);
    let scene = scene(vec![room], source, listener);
    // For +x and +y the image is (2.5, 3, 0): its line goes through the edge at (2, 2, 0).
    let found = found(&scene, 4096, 2, f64::INFINITY);
    let seconds = found.paths.iter().filter(|path| path.points.len() == 2);
    assert_eq!(seconds.count(), 18);
    let through = found
        .paths
        .iter()
        .find(|path| path.points.len() == 2 && path.points[0].distance(path.points[1]) < 1e-9);
    let through = through.expect("a path through the edge");
    assert!(
        (through.length_m - 11.25f64.sqrt()).abs() < 1e-12,
        "{through:?}"
    );
}

/// Protects flat faces of solids: the top of a box mirrors, beyond its edge it does not, and no
/// path goes over the edge.
#[test]
fn a_box_mirrors_within_its_faces() {
    let size = Vec3::new(4.0, 1.0, 4.0);
    let turn = Quat::from_rotation_y(0.3);
    let solid = Surface::new(Cuboid { size }).turned(turn);
    for (x, is_on) in [(0.0, true), (1.5, true), (2.6, false)] {
        let ends = [Vec3::new(x, 2.0, -1.0), Vec3::new(x, 2.0, 1.0)];
        let scene = scene(vec![solid.clone()], ends[0], ends[1]);
        let found = found(&scene, 4096, 1, f64::INFINITY);
        let echoes = by_way_of(&found, &[1]);
        assert_eq!(echoes.len(), usize::from(is_on), "at x = {x}");
        for path in echoes {
            assert!((path.length_m - 13f64.sqrt()).abs() < 1e-12);
            assert!((area(path) / traced_area(&scene, path, 1e-5) - 1.0).abs() < 1e-6);
        }
    }
}
