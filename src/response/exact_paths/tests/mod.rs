//! Compares early paths with closed forms, exhaustive searches, and bundles of traced rays.

use super::{Candidates, EarlyPaths, Ends, Found, Missed, NoPath, SpecularPath, Vertex};
use crate::geometry::ExactScene;
use crate::scene::shape::{Cuboid, Grid, HalfSpace, Plane, Room, Sphere, User};
use crate::scene::{SampledField, UserField};
use crate::{Listener, Scene, Shape, Source, Surface};
use glam::{DVec3, EulerRot, Quat, UVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

mod curved;
mod plane_sequences;
mod shapes;

/// Maximum error in radians of a specular reflection at a basic shape: the normals of the test are
/// differences over 1e-6 m, with an error of rounding ÷ step.
pub const SPECULAR: f64 = 1e-8;

pub fn scene(surfaces: Vec<Surface>, source: Vec3, listener: Vec3) -> Scene {
    Scene::new(
        "test",
        surfaces,
        Source::at(source),
        Listener::at(listener, 0.3),
    )
}

/// Directions on a spiral over the unit sphere (Vogel 1979), evenly spaced to within a few per cent.
pub fn directions(count: usize) -> Vec<Vec3> {
    let golden_angle = PI * (3.0 - 5f64.sqrt());
    let direction = |index: usize| {
        let height = 1.0 - (2 * index + 1) as f64 / count as f64;
        let ring = (1.0 - height * height).sqrt();
        let (sin, cos) = (golden_angle * index as f64 % TAU).sin_cos();
        DVec3::new(ring * cos, height, ring * sin).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// The paths found by `waves` waves, counting flights within `reach` metres of the listener.
pub fn found(scene: &Scene, waves: usize, order: u32, reach: f64) -> Found {
    let early = EarlyPaths::new(scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let candidates = early.candidates(&ends, &directions(waves), order, reach);
    early.find(&ends, &candidates)
}

/// The paths over these surfaces.
pub fn by_way_of<'a>(found: &'a Found, surfaces: &[u32]) -> Vec<&'a SpecularPath> {
    let paths = found.paths.iter();
    paths.filter(|path| path.surfaces == surfaces).collect()
}

/// The area of the wave front per solid angle that corresponds to the path's spreading.
pub fn area(path: &SpecularPath) -> f64 {
    1.0 / (4.0 * PI * path.spreading)
}

/// The area of the wave front from eight rays around the path's departure, by differences of fourth order, without
/// using curvatures. Four rays deviate by `angle` radians, four by twice that angle.
pub fn traced_area(scene: &Scene, path: &SpecularPath, angle: f64) -> f64 {
    let exact = ExactScene::new(scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let order = path.surfaces.len() as u32;
    let arrival = |offset: DVec3| {
        let direction = (path.departure + offset).normalize();
        let flight = exact.follow(ends.source, direction, order, |_| ());
        let flight = flight.expect("a start in the air");
        let along = path.arrival_direction;
        let t = (ends.listener - flight.origin).dot(along) / flight.direction.dot(along);
        flight.origin + flight.direction * t
    };
    let (a, b) = path.departure.any_orthonormal_pair();
    let rise = |axis: DVec3| arrival(axis * angle) - arrival(-axis * angle);
    let slope = |axis: DVec3| (8.0 * rise(axis) - rise(2.0 * axis)) / (12.0 * angle);
    slope(a).cross(slope(b)).length()
}

/// Roots of a function of an angle over a full turn, found by bisection between `steps` samples.
pub fn roots(steps: usize, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let angle = |step: usize| TAU * step as f64 / steps as f64;
    let has_root = |step: &usize| value(angle(*step)).signum() != value(angle(step + 1)).signum();
    let bisect = |step: usize| {
        let (mut low, mut high) = (angle(step), angle(step + 1));
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            match value(middle).signum() == value(low).signum() {
                true => low = middle,
                false => high = middle,
            }
        }
        0.5 * (low + high)
    };
    (0..steps).filter(has_root).map(bisect).collect()
}

/// Asserts that every reflection is specular, to within `most` radians.
pub fn assert_specular(scene: &Scene, path: &SpecularPath, most: f64) {
    let ends = Ends::of(scene.only_pair().unwrap());
    let mut all = vec![ends.source];
    all.extend(&path.points);
    all.push(ends.listener);
    for (i, window) in all.windows(3).enumerate() {
        let surface = &scene.surfaces[path.surfaces[i] as usize - 1];
        let inward = (window[1] - window[0]).normalize();
        let outward = (window[2] - window[1]).normalize();
        let turn = (outward - inward).normalize();
        let step = 1e-6;
        let distance = |p: DVec3| {
            let rotation = surface.rotation.as_dquat().conjugate();
            surface
                .shape
                .value(rotation * (p - surface.position.as_dvec3()))
        };
        let slope = DVec3::from_array(
            DVec3::AXES
                .map(|axis| distance(window[1] + axis * step) - distance(window[1] - axis * step)),
        );
        let off = turn.cross(slope.normalize()).length();
        assert!(off < most, "reflection {i} of {path:?} is {off} rad off");
    }
}

/// A vertex on a surface with this normal.
pub fn vertex(surface: u32, point: DVec3, normal: DVec3) -> Vertex {
    Vertex {
        point,
        normal: normal.normalize(),
        surface,
    }
}

const SIZE: Vec3 = Vec3::new(8.0, 3.0, 5.0);
const SOURCE: Vec3 = Vec3::new(-2.1, 0.2, -1.3);
const LISTENER: Vec3 = Vec3::new(1.9, -0.4, 1.1);

/// Images of the source in an empty room about the origin, up to an order: the vector from the listener to the image,
/// and the image's order.
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

/// Protects the whole early part of a shoebox: every image to order 3, its length to 1e-9 m, its direction, and 1/(4π
/// L²).
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
    // Positions are f32: their error is 1e-6 m after conversion to the room's axes.
    scene.sources[0].position = place + turn * SOURCE;
    scene.listeners[0].position = place + turn * LISTENER;
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

/// Protects rooms made of other surfaces: six half spaces, or six planes, have all paths of a room.
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

/// Protects the numbers of walls, by the first echo of each wall.
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

/// Protects a path exactly through an edge of a room: it counts as one path, although either wall may come first.
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

/// Protects flat faces of solids: the top of a box mirrors within its edges but not beyond, and no path bends around
/// the edge.
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

/// Protects shadows: a box between both ends blocks the direct sound but not the echo, and a box that reaches to the
/// ground blocks both.
#[test]
fn an_obstacle_blocks_what_it_crosses() {
    let ground = Surface::new(Plane).at(Vec3::Y * -2.0);
    let screen = |height: f32, y: f32| {
        let size = Vec3::new(0.1, height, 8.0);
        Surface::new(Cuboid { size }).at(Vec3::Y * y)
    };
    let (source, listener) = (Vec3::X * -3.0, Vec3::X * 3.0);
    for (screen, direct, echo) in [
        (screen(1.0, 5.0), 1, 1),
        (screen(1.0, 0.0), 0, 1),
        (screen(4.0, 0.0), 0, 0),
        (screen(1.0, -1.5), 1, 0),
    ] {
        let scene = scene(vec![ground.clone(), screen], source, listener);
        let found = found(&scene, 20_000, 1, f64::INFINITY);
        assert_eq!(by_way_of(&found, &[]).len(), direct);
        assert_eq!(by_way_of(&found, &[1]).len(), echo);
    }
}

/// Protects against paths inside solids: a candidate on the far side of a ball has no path.
#[test]
fn a_reflection_comes_from_the_air() {
    let ball = Surface::new(Sphere { radius: 1.0 });
    let scene = scene(
        vec![ball],
        Vec3::new(4.0, 1.0, 0.0),
        Vec3::new(4.0, -1.0, 0.0),
    );
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let mut candidates = Candidates::new(2);
    candidates.add(0, &[vertex(1, DVec3::NEG_X, DVec3::NEG_X)]);
    candidates.add(1, &[vertex(1, DVec3::X, DVec3::X)]);
    let found = early.find(&Ends::of(scene.only_pair().unwrap()), &candidates);
    assert_eq!(found.outcomes, [Err(NoPath::NotFromTheAir), Ok(1)]);
}

/// Protects against claiming exact paths at surfaces that are known only from samples: users' fields and grids.
#[test]
fn sampled_fields_are_not_exact() {
    let text = "float field(vec3 p) { return length(p) - 1.0; }".to_owned();
    let field = UserField::new("ball", text, Vec3::splat(3.0), 1.0);
    let user = Shape::from(User {
        field: Arc::new(field),
    });
    let at = |index: u32| {
        let cell = UVec3::new(index / 49, index / 7 % 7, index % 7);
        (cell.as_vec3() * 0.5 - 1.5).length() - 1.0
    };
    let samples = SampledField::new("ball", UVec3::splat(7), 0.5, (0..343).map(at).collect());
    let grid = Shape::from(Grid {
        field: Arc::new(samples.unwrap()),
    });
    for shape in [user, grid.clone(), grid.shell(0.1)] {
        let scene = scene(vec![Surface::new(shape)], Vec3::X * 4.0, Vec3::Y * 4.0);
        let early = EarlyPaths::new(&scene).expect("a valid scene");
        let normal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let mut candidates = Candidates::new(1);
        candidates.add(0, &[vertex(1, normal, normal)]);
        let found = early.find(&Ends::of(scene.only_pair().unwrap()), &candidates);
        assert_eq!(found.outcomes, [Err(NoPath::NotExact)]);
    }
}

/// Protects the estimate of missed paths: it is small with many waves, large with few waves, and `None` without waves.
#[test]
fn few_waves_say_that_they_miss_much() {
    let size = Vec3::new(20.0, 5.0, 13.0);
    let room = Surface::new(crate::scene::shape::Room { size });
    let scene = scene(
        vec![room],
        Vec3::new(3.0, 1.0, 2.0),
        Vec3::new(-6.0, 0.2, -3.0),
    );
    let share = |waves| Missed::of(&found(&scene, waves, 3, 0.3).paths).energy_share();
    let (few, many) = (share(4000), share(400_000));
    assert!(few > Some(0.1) && many < Some(0.01), "{few:?} {many:?}");
    assert_eq!(share(0), None);
    let paths = found(&scene, 400_000, 3, 0.3).paths;
    let missed = Missed::of(&paths);
    let lacking = 63.0 - paths.len() as f64;
    assert!((missed.paths() - lacking).abs() < 5.0, "{missed:?}");
}
