//! Paths at curved surfaces, compared with closed forms: a ball, a cylinder, foci.

use super::{
    SPECULAR, area, assert_specular, by_way_of, directions, found, roots, scene, traced_area,
    vertex,
};
use crate::response::exact_paths::{Candidates, EarlyPaths, Ends};
use crate::scene::shape::{CappedCylinder, Cylinder, Ellipsoid, Paraboloid, Plane, Sphere};
use crate::{Scene, Shape, Surface};
use glam::{DVec2, DVec3, Quat, Vec3};
use std::f64::consts::PI;

fn ball(radius: f32) -> Surface {
    Surface::new(Sphere { radius })
}

fn hollow(radius: f32) -> Surface {
    Surface::new(Shape::from(Sphere { radius }).complement())
}

/// Lengths of stationary paths at a circle with this radius, in the plane of both ends and the centre, found by a
/// search over the whole circle (Alhazen's problem).
fn alhazen(source: DVec3, listener: DVec3, radius: f64) -> Vec<f64> {
    let x = source.normalize();
    let y = (listener - x * listener.dot(x)).normalize();
    let point = |angle: f64| (x * angle.cos() + y * angle.sin()) * radius;
    let slope = |angle: f64| {
        let along = y * angle.cos() - x * angle.sin();
        let p = point(angle);
        along.dot((p - source).normalize() + (p - listener).normalize())
    };
    let length = |angle: f64| point(angle).distance(source) + point(angle).distance(listener);
    let mut all: Vec<f64> = roots(100_000, slope).into_iter().map(length).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Protects paths at a convex mirror (Alhazen's problem): length and spreading agree with a search.
#[test]
fn a_ball_mirrors_as_a_search_says() {
    let ends = [
        (Vec3::new(5.0, 1.0, 0.0), Vec3::new(2.0, -4.0, 1.0)),
        (Vec3::new(0.0, 3.0, 0.5), Vec3::new(-30.0, 9.0, 3.0)),
    ];
    for (source, listener) in ends {
        let scene = scene(vec![ball(1.5)], source, listener);
        let found = found(&scene, 20_000, 1, 3.0);
        let [path] = by_way_of(&found, &[1])[..] else {
            panic!("{:?}", found.paths);
        };
        let shortest = alhazen(source.as_dvec3(), listener.as_dvec3(), 1.5)[0];
        assert!((path.length_m - shortest).abs() < 1e-9);
        assert_specular(&scene, path, SPECULAR);
        let error = area(path) / traced_area(&scene, path, 1e-5) - 1.0;
        assert!(error.abs() < 1e-5, "{error}");
    }
}

/// Protects concave mirrors, where one sequence has up to four paths: all solutions of Alhazen's problem are found.
#[test]
fn a_hollow_ball_has_all_of_alhazens_paths() {
    let source = Vec3::new(2.0, 0.2, 0.0);
    let mut most = 0;
    for listener in [
        Vec3::new(-1.5, 0.5, 0.1),
        Vec3::new(-0.7, -0.2, 0.1),
        Vec3::new(2.0, 1.0, -1.0),
    ] {
        let scene = scene(vec![hollow(3.0)], source, listener);
        let found = found(&scene, 20_000, 1, 0.5);
        let echoes = by_way_of(&found, &[1]);
        let expected = alhazen(source.as_dvec3(), listener.as_dvec3(), 3.0);
        assert_eq!(echoes.len(), expected.len(), "{echoes:?}");
        most = most.max(echoes.len());
        for (path, length) in echoes.into_iter().zip(expected) {
            assert!((path.length_m - length).abs() < 1e-9);
            assert_specular(&scene, path, SPECULAR);
            let error = area(path) / traced_area(&scene, path, 1e-3) - 1.0;
            // Normals of marched fields are accurate to 1e-9, and differences have errors of the order of the angle
            // squared.
            assert!(error.abs() < 1e-4, "{error} at {path:?}");
        }
    }
    assert_eq!(most, 4);
}

/// Protects the focal gain of a concave mirror on its axis, which is compared with the mirror equation: from
/// distance p to distance q (metres) the front has the area (p + q − 2 p q/R)².
#[test]
fn a_hollow_ball_gathers_as_the_mirrors_equation_says() {
    let radius = 4.0f64;
    for (source, listener) in [(-1.0f32, 1.0f32), (-1.0, 2.5), (0.5, 3.5)] {
        let scene = scene(vec![hollow(4.0)], Vec3::X * source, Vec3::X * listener);
        let found = found(&scene, 50_000, 1, 0.5);
        let (p, q) = (radius + f64::from(source), radius + f64::from(listener));
        let expected = (p + q - 2.0 * p * q / radius).powi(2);
        let echoes = by_way_of(&found, &[1]);
        let at_vertex = |path: &&&super::SpecularPath| path.points[0].x < -3.9;
        let path = echoes.iter().find(at_vertex).expect("a path at the vertex");
        assert!((area(path) / expected - 1.0).abs() < 1e-9, "{path:?}");
    }
}

/// Protects the scale of spreading: the energy mirrored by a ball, integrated over a distant sphere, is the energy that
/// the ball intercepts, (1 − √(1 − R²/d²))/2 of the source's power. The density is constant around the axis. Along the
/// axis Simpson's rule over 2000 parts integrates it, accurate to 1e-5 for a density that has a kink at the shadow's
/// border.
#[test]
fn a_ball_mirrors_the_energy_that_it_intercepts() {
    let (radius, away, far) = (1.0f64, 3.0f64, 100.0f64);
    let source = Vec3::X * 3.0;
    let scene = scene(vec![ball(1.0)], source, Vec3::X * 50.0);
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let mirrored = |angle: f64| {
        let listener = DVec3::new(angle.cos(), angle.sin(), 0.0) * far;
        let ends = Ends {
            listener,
            ..Ends::of(scene.only_pair().unwrap())
        };
        // The normal halves the angle between the directions to both ends.
        let normal = (listener.normalize() + DVec3::X + DVec3::Y * 1e-9).normalize();
        let mut candidates = Candidates::new(1);
        candidates.add(0, &[vertex(1, normal * radius, normal)]);
        let found = early.find(&ends, &candidates);
        let flux = |path: &&super::SpecularPath| {
            path.spreading * path.arrival_direction.dot(listener.normalize())
        };
        by_way_of(&found, &[1]).iter().map(flux).sum::<f64>() * 2.0 * PI * far * far * angle.sin()
    };
    let parts = 2000;
    let step = PI / f64::from(parts);
    let weight = |i: i32| match i {
        0 => 1.0,
        i if i == parts => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=parts)
        .map(|i| weight(i) * mirrored(f64::from(i) * step))
        .sum();
    let whole = sum * step / 3.0;
    let intercepted = 0.5 * (1.0 - (1.0 - (radius / away).powi(2)).sqrt());
    assert!(
        (whole / intercepted - 1.0).abs() < 1e-3,
        "{whole} of {intercepted}"
    );
}

/// Protects results from depending on the number of threads.
#[test]
fn any_number_of_threads_finds_the_same() {
    let scene = scene(
        vec![hollow(3.0), ball(0.5)],
        Vec3::X * 1.5,
        Vec3::new(-1.0, 1.0, 0.0),
    );
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let candidates = early.candidates(&ends, &directions(4096), 3, 0.6);
            let found = early.find(&ends, &candidates);
            (found.paths, found.outcomes)
        })
    };
    let one = run(1);
    assert!(one.0.len() > 10);
    assert_eq!(one, run(3));
}

/// The shortest path at a cylinder about y, found by a search. Seen along y it is a path at a circle. The stationary
/// angle does not depend on heights, because the length of a straight line on the unrolled strip is √(flat² + rise²).
fn searched(source: DVec3, listener: DVec3, radius: f64) -> f64 {
    let flat = |p: DVec3| DVec2::new(p.x, p.z);
    let (a, b) = (flat(source), flat(listener));
    let slope = |angle: f64| {
        let p = DVec2::from_angle(angle) * radius;
        p.perp().dot((p - a).normalize() + (p - b).normalize())
    };
    let length = |angle: f64| {
        let p = DVec2::from_angle(angle) * radius;
        (p.distance(a) + p.distance(b)).hypot(source.y - listener.y)
    };
    let lengths = roots(100_000, slope).into_iter().map(length);
    lengths.fold(f64::INFINITY, f64::min)
}

/// Protects paths at a cylinder and their spreading: the paths are compared with a search over the surface, the
/// spreading with traced rays.
#[test]
fn a_cylinder_mirrors_as_a_search_says() {
    let pillar = Surface::new(Cylinder { radius: 0.8 });
    for height in [0.0, 2.0, -7.0] {
        let (source, listener) = (Vec3::new(3.0, 0.0, 1.0), Vec3::new(-1.0, height, 4.0));
        let scene = scene(vec![pillar.clone()], source, listener);
        let found = found(&scene, 40_000, 1, 2.0);
        let [path] = by_way_of(&found, &[1])[..] else {
            panic!("{:?}", found.paths);
        };
        let expected = searched(source.as_dvec3(), listener.as_dvec3(), f64::from(0.8f32));
        assert!((path.length_m - expected).abs() < 1e-9);
        assert_specular(&scene, path, SPECULAR);
        let error = area(path) / traced_area(&scene, path, 1e-5) - 1.0;
        assert!(error.abs() < 1e-5, "{error}");
    }
}

/// Protects sequences of several curved surfaces and planes, with two turned pillars on a floor, to order 3. Also
/// protects reciprocity: with the ends swapped the paths are the same, including lengths and spreading.
#[test]
fn two_pillars_and_a_floor_mirror_in_turn() {
    let leaning = Quat::from_rotation_z(0.2);
    let surfaces = vec![
        Surface::new(Cylinder { radius: 0.5 }).at(Vec3::X * -2.0),
        Surface::new(Cylinder { radius: 0.7 })
            .at(Vec3::X * 2.0)
            .turned(leaning),
        Surface::new(Plane).at(Vec3::Y * -1.5),
    ];
    let mut way = scene(
        surfaces,
        Vec3::new(0.0, 0.0, 3.0),
        Vec3::new(0.3, 0.4, -2.0),
    );
    let there = found(&way, 60_000, 3, 2.0);
    let sequences = [
        &[1, 2][..],
        &[2, 1],
        &[3, 1],
        &[3, 2],
        &[3, 1, 2],
        &[2, 3, 1],
        &[3, 2, 1],
    ];
    for sequence in sequences.into_iter().chain([&[2, 1, 2][..], &[1, 2, 1]]) {
        assert_eq!(by_way_of(&there, sequence).len(), 1, "{sequence:?}");
    }
    for path in &there.paths {
        assert_specular(&way, path, SPECULAR);
        let error = area(path) / traced_area(&way, path, 1e-7) - 1.0;
        assert!(error.abs() < 1e-5, "{error} at {path:?}");
    }
    std::mem::swap(&mut way.sources[0].position, &mut way.listeners[0].position);
    let back = found(&way, 60_000, 3, 2.0);
    assert_eq!(there.paths.len(), back.paths.len());
    for (path, other) in there.paths.iter().zip(&back.paths) {
        let reversed: Vec<u32> = other.surfaces.iter().rev().copied().collect();
        assert_eq!(path.surfaces, reversed);
        assert!((path.length_m - other.length_m).abs() < 1e-9);
        assert!((path.spreading / other.spreading - 1.0).abs() < 1e-9);
    }
}

/// Protects finite cylinders: side and flat ends mirror, each within its edges.
#[test]
fn a_drum_has_a_side_and_two_ends() {
    let drum = Surface::new(CappedCylinder {
        radius: 1.0,
        height: 2.0,
    });
    let beside = (Vec3::new(3.0, 0.5, 1.0), Vec3::new(3.0, -0.5, -1.0));
    let above = (Vec3::new(0.5, 3.0, 0.0), Vec3::new(-0.5, 3.0, 0.0));
    let over_the_edge = (Vec3::new(0.9, 3.0, 0.0), Vec3::new(1.4, 3.0, 0.0));
    for ((source, listener), count) in [(beside, 1), (above, 1), (over_the_edge, 0)] {
        let scene = scene(vec![drum.clone()], source, listener);
        let found = found(&scene, 20_000, 1, 1.0);
        let echoes = by_way_of(&found, &[1]);
        assert_eq!(echoes.len(), count, "{source}");
        for path in echoes {
            let error = area(path) / traced_area(&scene, path, 1e-5) - 1.0;
            assert!(error.abs() < 1e-5, "{error} at {path:?}");
        }
    }
}

/// Protects the beam of a paraboloid: its front keeps the area r² that it has at the mirror, r metres from the focus,
/// at every distance of the listener.
#[test]
fn a_source_in_the_focus_of_a_dish_gives_a_beam() {
    // Turned: it opens along +x.
    let dish = Shape::from(Paraboloid { focal_length: 2.0 }).complement();
    let dish = Surface::new(dish).turned(Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2));
    for away in [5.0, 20.0, 80.0] {
        let beside = 1.5;
        let scene = scene(
            vec![dish.clone()],
            Vec3::X * 2.0,
            Vec3::new(away, beside, 0.0),
        );
        let found = found(&scene, 20_000, 1, 0.5);
        let [path] = by_way_of(&found, &[1])[..] else {
            panic!("{:?}", found.paths);
        };
        let to_mirror = path.points[0].distance(DVec3::X * 2.0);
        let depth = f64::from(beside).powi(2) / 8.0;
        assert!((to_mirror - (2.0 + depth)).abs() < 1e-6);
        assert!(
            (area(path) / to_mirror.powi(2) - 1.0).abs() < 1e-5,
            "{path:?}"
        );
        assert!((path.length_m - (f64::from(away) + 2.0)).abs() < 1e-6);
    }
}

/// Protects perfect foci: all paths in the gallery have the same length, so they count as one path with finite energy.
#[test]
fn focus_to_focus_is_one_focus() {
    let gallery = Shape::from(Ellipsoid {
        radii: Vec3::new(10.0, 6.0, 6.0),
    })
    .complement();
    let scene = scene(vec![Surface::new(gallery)], Vec3::X * -8.0, Vec3::X * 8.0);
    let found = found(&scene, 4096, 1, 0.3);
    let [direct, path] = &found.paths[..] else {
        panic!("{:?}", found.paths);
    };
    assert!(!direct.is_focus && path.is_focus);
    assert!((path.length_m - 20.0).abs() < 1e-9);
    // All waves arrive, each with a chord of two radii.
    assert_eq!(path.found_by, 4096);
    let most = 3.0 / (2.0 * PI * 0.3f64.powi(2));
    assert!(
        (path.spreading / most - 1.0).abs() < 1e-6,
        "{}",
        path.spreading / most
    );
}

/// Protects the built-in dishes: all paths from focus to focus have the same length, with one
/// reflection at each dish.
#[test]
fn two_dishes_have_a_focus() {
    let scene = Scene::builtin("parabolic-mirrors").expect("built in");
    let found = found(&scene, 20_000, 2, 0.5);
    let foci: Vec<_> = found.paths.iter().filter(|path| path.is_focus).collect();
    let [path] = foci[..] else { panic!("{foci:?}") };
    assert_eq!(path.surfaces, [2, 3]);
    // The distances from a mirror's points to the focus equal their distances to the directrix.
    assert!(
        (path.length_m - (30.0 + 4.0)).abs() < 1e-6,
        "{}",
        path.length_m
    );
    assert!(path.spreading.is_finite() && path.found_by > 100);
}

/// Protects a listener at the source from an infinite direct sound.
#[test]
fn a_listener_in_the_source_hears_finitely() {
    let ground = Surface::new(crate::scene::shape::Plane).at(Vec3::Y * -1.0);
    let scene = scene(vec![ground], Vec3::ZERO, Vec3::ZERO);
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let candidates = early.candidates(&ends, &[Vec3::NEG_Y], 1, 0.3);
    let found = early.find(&ends, &candidates);
    assert_eq!(found.paths.len(), 2);
    let direct = &found.paths[0];
    assert!(direct.is_focus && direct.spreading.is_finite());
    assert_eq!((direct.length_m, direct.departure), (0.0, DVec3::ZERO));
    let echo = &found.paths[1];
    assert!((echo.length_m, echo.departure) == (2.0, DVec3::NEG_Y));
}
