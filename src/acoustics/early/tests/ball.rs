//! Balls, from outside and from inside.

use super::{
    SPECULAR, area, assert_specular, by_way_of, directions, found, roots, scene, traced_area,
    vertex,
};
use crate::acoustics::early::{Candidates, EarlyPaths, Ends};
use crate::scene::shape::Sphere;
use crate::{Shape, Surface};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

fn ball(radius: f32) -> Surface {
    Surface::new(Sphere { radius })
}

fn hollow(radius: f32) -> Surface {
    Surface::new(Shape::from(Sphere { radius }).complement())
}

/// Lengths of stationary paths at a circle with the radius, in the plane of both ends and the
/// centre, by a search over the whole circle (Alhazen's problem).
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

/// Protects Alhazen's problem at a convex mirror, compared with a search: length and spreading.
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

/// Protects concave mirrors, where one sequence has up to four paths: all of Alhazen's are found.
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
            // Normals of marched fields are accurate to 1e-9, differences to the square of the
            // angle.
            assert!(error.abs() < 1e-4, "{error} at {path:?}");
        }
    }
    assert_eq!(most, 4);
}

/// Protects the focal gain of a concave mirror on its axis, compared with the mirror equation: from
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

/// Protects the scale of spreading: the energy mirrored by a ball, integrated over a distant
/// sphere, is what it intercepts, (1 − √(1 − R²/d²))/2 of the source's power. Around the axis it is
/// constant; along the axis it is integrated by Simpson's rule over 2000 parts, accurate to 1e-5
/// for a density that has a kink at the shadow's border.
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
            ..Ends::of(&scene)
        };
        // Half way between both ends, seen from the ball.
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
    let ends = Ends::of(&scene);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let candidates = early.candidates(&ends, &directions(4096), 3, 0.6);
            let found = early.find(&ends, &candidates);
            (found.paths, found.outcomes, found.missed)
        })
    };
    let one = run(1);
    assert!(one.0.len() > 10);
    assert_eq!(one, run(3));
}
