//! Compares the exact references with each other, with the distance functions, and with constructed hits.

mod exact;
pub(crate) mod march32;

use super::{ExactScene, Hit, ShoeboxImages};
use crate::scene::shape::{Cuboid, Cylinder, Ellipsoid, Plane, Room, Sphere};
use crate::test_common::Random;
use crate::{Listener, Node, Scene, Shape, Source, Surface};
use glam::{DVec3, EulerRot, Quat, Vec3};
use proptest::prelude::*;

fn rotation(random: &mut Random) -> Quat {
    let [a, b, c] = std::array::from_fn(|_| (random.signed() * 3.0) as f32);
    Quat::from_euler(EulerRot::YXZ, a, b, c)
}

fn scene(surfaces: Vec<Surface>, source: Vec3, listener: Listener) -> Scene {
    Scene::new("test", surfaces, Source::at(source), listener)
}

fn exact(scene: &Scene) -> ExactScene {
    ExactScene::new(scene).expect("a valid scene")
}

fn start(scene: &Scene) -> DVec3 {
    scene.sources[0].position.as_dvec3()
}

/// A listener that is too far away to be hit.
fn listener_outside() -> Listener {
    Listener::at(Vec3::splat(3e6), 0.5)
}

/// A rotated room that contains every kind of basic surface, some of them rotated.
fn furnished() -> Scene {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.4, 0.3, -0.2);
    let size = Vec3::new(14.0, 8.0, 18.0);
    let surfaces = vec![
        Surface::new(Node::Room(Room { size })).turned(turn),
        Surface::new(Node::Plane(Plane)).at(Vec3::Y * -3.0),
        Surface::new(Node::Cuboid(Cuboid {
            size: Vec3::new(1.0, 3.0, 2.0),
        }))
        .at(Vec3::new(3.0, -0.5, 2.0))
        .turned(turn.conjugate()),
        Surface::new(Node::Sphere(Sphere { radius: 1.3 })).at(Vec3::new(-3.0, 0.0, 3.0)),
        Surface::new(Node::Cylinder(Cylinder { radius: 0.7 }))
            .at(Vec3::new(0.0, 0.0, -4.0))
            .turned(Quat::from_rotation_x(0.3)),
    ];
    let listener = Listener::at(Vec3::new(2.0, 1.0, -2.0), 0.9);
    scene(surfaces, Vec3::new(-1.0, 0.2, 0.3), listener)
}

fn shoeboxes() -> Vec<(&'static str, Scene)> {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.7, -0.4, 1.1);
    let place = Vec3::new(40.0, -7.0, 12.0);
    let room = |x, y, z| {
        Surface::new(Node::Room(Room {
            size: Vec3::new(x, y, z),
        }))
    };
    let turned = scene(
        vec![room(9.0, 5.0, 7.0).at(place).turned(turn)],
        place + turn * Vec3::new(-3.0, 1.0, 2.0),
        Listener::at(place + turn * Vec3::new(2.0, -1.0, 0.5), 0.8),
    );
    let near_wall = scene(
        vec![room(8.0, 6.0, 10.0)],
        Vec3::new(-2.0, 1.0, 3.0),
        Listener::at(Vec3::new(3.6, -2.5, -4.7), 1.0),
    );
    let in_wall = scene(
        vec![room(8.0, 6.0, 10.0)],
        Vec3::new(-2.0, 1.0, 3.0),
        Listener::at(Vec3::new(4.3, 0.3, -1.0), 1.0),
    );
    let corridor = scene(
        vec![room(60.0, 2.0, 1.5)],
        Vec3::new(-25.0, 0.0, 0.1),
        Listener::at(Vec3::new(20.0, 0.2, 0.0), 0.3),
    );
    vec![
        ("shoebox", Scene::builtin("shoebox").unwrap()),
        ("turned", turned),
        ("listener near a wall", near_wall),
        ("listener in a wall", in_wall),
        ("corridor", corridor),
    ]
}

/// Protects the two references from each other's errors: they share no code, and must agree for every wave.
#[test]
fn closed_form_and_image_sources_agree_wave_for_wave() {
    const ITERATIONS: u32 = 24;
    for (name, scene) in shoeboxes() {
        let directions = Random(7).directions(120_000);
        let waves = exact(&scene).trace_all(start(&scene), &directions, ITERATIONS);
        let images = ShoeboxImages::new(&scene).expect("a shoebox");
        let mut by_order = vec![0; ITERATIONS as usize];
        for (wave, direction) in waves.iter().zip(&directions) {
            let context = format!("{name}, {direction:?}: {wave:?}");
            match images.arrival(direction.as_dvec3(), ITERATIONS) {
                Some(arrival) => {
                    assert_eq!((wave.status, wave.order), (0, arrival.order), "{context}");
                    assert!((wave.length - arrival.length).abs() < 1e-9, "{context}");
                    by_order[wave.order as usize] += 1;
                }
                None => assert_eq!((wave.status, wave.order), (1, ITERATIONS), "{context}"),
            }
        }
        assert_eq!(
            images.hits_by_order(&directions, ITERATIONS).unwrap(),
            by_order
        );
        assert!(by_order[3] > 0, "{name} has nothing to compare");
    }
}

/// Protects the counts from which the project's scenes were reconstructed. These are the numbers of heard waves among
/// 65,536, counted by a model that is independent of this crate.
#[test]
fn corner_hits_agree_with_an_independent_count() {
    let scene = Scene::builtin("corner").unwrap();
    let exact = exact(&scene);
    let directions = Random(2011).directions(1 << 20);
    for (iterations, of_65536) in [(4, 967.0), (8, 4188.0)] {
        let waves = exact.trace_all(start(&scene), &directions, iterations);
        let heard = waves.iter().filter(|wave| wave.status == 0).count() as f64;
        println!("corner, {iterations} iterations: {heard} of 1048576 heard");
        // Both counts are random, and this one uses 16 times as many waves.
        let deviation = f64::sqrt(of_65536 * (1.0 + 1.0 / 16.0));
        assert!((heard / 16.0 - of_65536).abs() < 4.0 * deviation, "{heard}");
    }
}

/// Protects against hits that are not on a surface, and against waves that pass through a surface, by comparison with
/// the `f32` distance functions.
#[test]
fn hits_lie_on_the_nearest_zero_of_the_distance_function() {
    let scene = furnished();
    let exact = exact(&scene);
    let mut random = Random(3);
    let mut met = [0; 6];
    for _ in 0..20_000 {
        let origin = DVec3::from_array(std::array::from_fn(|_| 8.0 * random.signed()));
        let direction = random.direction();
        if scene.surface_distance(origin.as_vec3()).distance < 1e-3 {
            continue;
        }
        let hit = exact
            .closest_hit(origin, direction)
            .expect("a room is shut");
        met[hit.object as usize] += 1;
        let distance = |t: f64| scene.surface_distance((origin + direction * t).as_vec3());
        for step in 0..64 {
            let passed = distance(hit.t * f64::from(step) / 64.0);
            assert!(passed.distance > -1e-5, "{passed:?} before {hit:?}");
        }
        if hit.object == 0 {
            continue;
        }
        assert!(distance(hit.t).distance.abs() < 1e-5, "{hit:?}");
        assert!(exact.surface_distance(hit.point).abs() < 1e-13, "{hit:?}");
        assert_bisection_finds(&hit, |t| distance(t).distance, direction);
        assert!((hit.normal.length() - 1.0).abs() < 1e-14, "{hit:?}");
        let into_air = (hit.point + hit.normal * 1e-3).as_vec3();
        assert!(scene.surfaces[hit.object as usize - 1].distance(into_air) > 9e-4);
    }
    assert!(met.iter().all(|count| *count > 50), "{met:?}");
}

fn assert_bisection_finds(hit: &Hit, distance: impl Fn(f64) -> f32, direction: DVec3) {
    let steepness = -hit.normal.dot(direction);
    let (mut air, mut solid) = (f64::max(hit.t - 0.02, 0.0), hit.t + 0.02);
    if steepness < 0.1 || distance(air) < 0.0 || distance(solid) > 0.0 {
        return;
    }
    for _ in 0..40 {
        let middle = 0.5 * (air + solid);
        if distance(middle) > 0.0 {
            air = middle;
        } else {
            solid = middle;
        }
    }
    assert!((air - hit.t).abs() < 1e-5 / steepness, "{air} != {hit:?}");
}

/// Protects the law of reflection, the unit length of directions, and the walls, over hundreds of reflections.
#[test]
fn waves_stay_mirrored_and_shut_in() {
    let scene = furnished();
    let exact = exact(&scene);
    for direction in Random(5).directions(2_000) {
        let mut last = exact.trace(start(&scene), direction.as_dvec3(), 0);
        let path = exact.trace_path(start(&scene), direction.as_dvec3(), 200);
        for (index, vertex) in path.iter().enumerate() {
            assert!(exact.surface_distance(vertex.point).abs() < 1e-12 || vertex.object == 0);
            if index % 40 != 39 || vertex.object == 0 {
                continue;
            }
            last = exact.trace(start(&scene), direction.as_dvec3(), index as u32 + 1);
            assert_eq!(last.point, vertex.point);
            assert!((last.direction.length() - 1.0).abs() < 1e-12);
            let arrives = last.incoming_direction.dot(vertex.normal);
            let departs = last.direction.dot(vertex.normal);
            assert!(arrives <= 0.0 && (arrives + departs).abs() < 1e-12);
            let plane = last.incoming_direction.cross(vertex.normal);
            assert!(last.direction.dot(plane).abs() < 1e-12);
        }
        assert!(last.point.is_finite());
    }
}

/// Protects lengths and walls in a room without curved surfaces. After 200 flights, the end of the unfolded straight
/// line still agrees with the position of the wave.
#[test]
fn two_hundred_reflections_keep_their_place() {
    let size = Vec3::new(12.0, 6.0, 16.0);
    let room = Surface::new(Node::Room(Room { size }));
    let scene = scene(vec![room], Vec3::new(-3.5, 0.5, -5.0), listener_outside());
    let half = size.as_dvec3() * 0.5;
    for direction in Random(11).directions(5_000) {
        let wave = exact(&scene).trace(start(&scene), direction.as_dvec3(), 200);
        assert_eq!((wave.status, wave.order), (1, 200));
        assert!((wave.direction.length() - 1.0).abs() < 1e-13);
        assert!(wave.point.abs().cmple(half).all());
        let straight = start(&scene) + direction.as_dvec3().normalize() * wave.length;
        assert!(
            folded(straight, half).distance(wave.point) < 1e-9,
            "{wave:?}"
        );
    }
}

/// Folds a straight line back into a room. Each coordinate becomes a triangle wave.
fn folded(straight: DVec3, half: DVec3) -> DVec3 {
    let turns = (straight / half + 1.0).rem_euclid(DVec3::splat(4.0));
    half * (1.0 - (turns - 2.0).abs())
}

/// Protects edges and corners, and waves almost parallel to a wall, also in rotated rooms: no wave escapes, skips a
/// wall or becomes NaN.
#[test]
fn corners_and_edges_do_not_leak() {
    let size = Vec3::new(12.0, 6.0, 16.0);
    let half = size.as_dvec3() * 0.5;
    let mut random = Random(13);
    for case in 0..20_000 {
        let turn = [Quat::IDENTITY, rotation(&mut random)][case % 2];
        let into_world = turn.as_dquat().normalize();
        let room = Surface::new(Node::Room(Room { size })).turned(turn);
        let exact = exact(&scene(vec![room], Vec3::ZERO, listener_outside()));
        let mut signed = || DVec3::from_array(std::array::from_fn(|_| random.signed()));
        let origin = half * signed() * 0.99;
        let side = signed().signum();
        let direction = match case / 2 % 4 {
            0 => half * side - origin,
            1 => half * side.with_y(signed().y) - origin,
            2 => half * side.with_z(signed().z) - origin,
            _ => DVec3::new(signed().x, signed().x, 1e-16 * signed().x),
        }
        .normalize();
        for flights in [1, 2, 3, 4, 40] {
            let wave = exact.trace(into_world * origin, into_world * direction, flights);
            assert_eq!((wave.status, wave.order), (1, flights));
            assert!(exact.surface_distance(wave.point).abs() < 1e-13, "{wave:?}");
            let end = into_world.conjugate() * wave.point;
            let straight = origin + direction * wave.length;
            let off = folded(straight, half).distance(end);
            assert!(off < 1e-10, "{case}, {flights} flights: {off} {wave:?}");
        }
    }
}

/// Protects solids that touch a wall of the room, as in `corner`, and lines along their shared planes.
#[test]
fn flush_surfaces_do_not_leak() {
    let scene = Scene::builtin("corner").unwrap();
    let exact = exact(&scene);
    let mut random = Random(17);
    for _ in 0..50_000 {
        let origin = DVec3::new(
            14.0 * random.unit(),
            9.0 * random.signed(),
            14.0 * random.unit(),
        );
        let height = [10.0, -10.0, 10.0 * random.signed()][(random.unit() * 3.0) as usize];
        // The edge between the block and a wall, or an edge of the block itself.
        let edge = DVec3::new([15.0, 0.0][(random.unit() * 2.0) as usize], height, 0.0);
        let spread = [0.0, 1e-16, 1e-15, 1e-14, 1e-12][(random.unit() * 5.0) as usize];
        let direction = (edge - origin).normalize() + random.direction() * spread;
        for vertex in exact.trace_path(origin, direction, 12) {
            let distance = exact.surface_distance(vertex.point);
            assert!(vertex.object == 0 || distance.abs() < 1e-11, "{vertex:?}");
        }
        let met = exact.trace(origin, direction, 3);
        if edge.x == 15.0 && met.status != 0 {
            // Wall and block both reflect the wave, so the order of the hits does not matter.
            let back = if height.abs() == 10.0 { 3 } else { 2 };
            let back = exact.trace(origin, direction, back).direction;
            assert!(
                (back.x + direction.x).abs() < 1e-10,
                "{direction:?} {met:?}"
            );
            assert!(
                (back.z + direction.z).abs() < 1e-10,
                "{direction:?} {met:?}"
            );
        }
    }
    let along = exact.trace(DVec3::new(-8.0, 10.0, -8.0), DVec3::X, 50);
    assert!(along.point.is_finite() && along.direction.is_finite());
}

/// Protects results from depending on the number of threads.
#[test]
fn threads_do_not_change_a_wave() {
    let scene = furnished();
    let exact = exact(&scene);
    let directions = Random(19).directions(10_001);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let trace = || exact.trace_all(start(&scene), &directions, 12);
        pool.unwrap().install(trace)
    };
    let alone = on(1);
    assert_eq!(alone, exact.trace_all(start(&scene), &directions, 12));
    for threads in [2, 3, 7, 64] {
        assert_eq!(alone, on(threads), "{threads} threads");
    }
    assert_eq!(exact.trace_all(DVec3::ZERO, &[], 12), vec![]);
}

/// The same shape under an operator, for which the reference must march. Planes and rooms are unchanged.
fn as_field(shape: &Shape) -> Shape {
    match shape.node {
        Node::Cuboid(_) | Node::Sphere(_) | Node::Cylinder(_) => Shape::union([shape.clone()]),
        _ => shape.clone(),
    }
}

/// Protects marched references. A shape is hit at the same points in closed form and by marching, at any position in
/// the scene. Therefore no march ends before its hit, and none passes through a nearer surface.
#[test]
fn marched_shapes_are_met_as_those_in_closed_form() {
    const FLIGHTS: u32 = 3;
    let closed = furnished();
    let mut marched = closed.clone();
    for surface in &mut marched.surfaces {
        surface.shape = as_field(&surface.shape);
    }
    let mut reversed = marched.clone();
    reversed.surfaces.reverse();
    let last = closed.surfaces.len() as u32 + 1;
    let in_reverse = |object: u32| if object == 0 { 0 } else { last - object };
    let [truth, marched, reversed] = [&closed, &marched, &reversed].map(exact);
    for direction in Random(29).directions(4000) {
        let path = |of: &ExactScene| of.trace_path(start(&closed), direction.as_dvec3(), FLIGHTS);
        let expected = path(&truth);
        for (found, name) in [
            (path(&marched), &(|object| object) as &dyn Fn(u32) -> u32),
            (path(&reversed), &in_reverse),
        ] {
            assert_eq!(expected.len(), found.len(), "{direction}");
            for (a, b) in expected.iter().zip(&found) {
                assert_eq!(a.object, name(b.object), "{direction}");
                // A march is accurate to about 1e-11 m. A reflection by a curved surface multiplies the error by about
                // a hundred.
                assert!(
                    a.point.distance(b.point) < 1e-6,
                    "{direction}: {a:?}, {b:?}"
                );
            }
        }
    }
}

/// Protects the normals of marched references, which determine the reflected directions. The normals of an ellipsoid,
/// whose value has a kink exactly at its surface, are compared with the normals from its equation.
#[test]
fn normals_of_marched_shapes_are_those_of_their_equation() {
    let radii = DVec3::new(10.0, 6.0, 4.0);
    let node = Node::Ellipsoid(Ellipsoid {
        radii: radii.as_vec3(),
    });
    let gallery = Shape::from(node).complement();
    let scene = scene(
        vec![Surface::new(gallery)],
        Vec3::new(1.0, 2.0, -1.0),
        listener_outside(),
    );
    let exact = exact(&scene);
    for direction in Random(31).directions(500) {
        let hit = exact.closest_hit(start(&scene), direction.as_dvec3());
        let hit = hit.expect("a closed room");
        let inwards = -(hit.point / (radii * radii)).normalize();
        let off = hit.normal.distance(inwards);
        assert!(off < 1e-8, "{off:e} at {}", hit.point);
    }
}

/// A hit that is known because the line was constructed from it. Returns the scene, the start and direction of the
/// line, and the expected hit.
fn plant(random: &mut Random) -> (Scene, DVec3, DVec3, Hit) {
    let size = [random.scale(), random.scale(), random.scale()].map(|size| size as f32);
    let radius = size[0];
    let size = Vec3::from_array(size);
    let half = size.as_dvec3() * 0.5;
    let position = (random.direction() * random.scale()).as_vec3();
    let around = random.direction();
    let ring = around.with_y(0.0).normalize();
    let radius_wide = f64::from(radius);
    let face = [DVec3::X, DVec3::Y, DVec3::Z][(random.unit() * 3.0) as usize];
    let on_face: DVec3 = std::array::from_fn(|_| 0.9 * random.signed()).into();
    let on_face = half * (on_face * (DVec3::ONE - face) + face);
    let (shape, point, normal) = match (random.unit() * 5.0) as usize {
        0 => (
            Node::Plane(Plane),
            around.with_y(0.0) * radius_wide,
            DVec3::Y,
        ),
        1 => (Node::Cuboid(Cuboid { size }), on_face, face),
        2 => (Node::Room(Room { size }), on_face, -face),
        3 => (
            Node::Sphere(Sphere { radius }),
            around * radius_wide,
            around,
        ),
        _ => (
            Node::Cylinder(Cylinder { radius }),
            (ring + DVec3::Y) * radius_wide,
            ring,
        ),
    };
    let mut away = random.direction();
    if away.dot(normal) < 0.0 {
        away = -away;
    }
    let away = (away + normal * 0.05).normalize();
    let t = match shape {
        // The start must be inside the room.
        Node::Room(_) => half.min_element() * 0.05 * random.unit(),
        _ => random.scale(),
    };
    let origin = point + away * t;
    let hit = Hit {
        t,
        object: 1,
        point: point + position.as_dvec3(),
        normal,
    };
    let surface = Surface::new(shape).at(position);
    let scene = scene(vec![surface], Vec3::ZERO, listener_outside());
    (scene, origin + position.as_dvec3(), -away, hit)
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 20_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Protects nearest hits over seven decades of size, position and distance.
    #[test]
    fn planted_hits_are_found(seed: u64) {
        let (scene, origin, direction, planted) = plant(&mut Random(seed));
        let hit = exact(&scene).closest_hit(origin, direction).expect("a hit");
        prop_assert_eq!(hit.object, planted.object);
        // The line itself is known only up to the rounding of its start.
        let size = match scene.surfaces[0].shape.node {
            Node::Cuboid(Cuboid { size }) | Node::Room(Room { size }) => f64::from(size.max_element()),
            Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => radius.into(),
            _ => 0.0,
        };
        let scale = size + planted.t + planted.point.length() + origin.length();
        let rounding = 1e-13 * scale;
        let steepness = -direction.dot(planted.normal);
        prop_assert!((hit.t - planted.t).abs() < rounding / steepness, "{hit:?} {planted:?}");
        prop_assert!(hit.point.distance(planted.point) < rounding / steepness);
        prop_assert!((hit.normal.length() - 1.0).abs() < 1e-14);
        let bend = match scene.surfaces[0].shape.node {
            Node::Sphere(Sphere { radius }) | Node::Cylinder(Cylinder { radius }) => 1.0 / f64::from(radius),
            _ => 0.0,
        };
        let turned = hit.normal.distance(planted.normal);
        prop_assert!(turned < 1e-14 + bend * rounding / steepness, "{hit:?} {planted:?}");
    }
}
