//! Paths among many surfaces, in both directions.

use super::{found, scene};
use crate::acoustics::early::{Candidates, EarlyPaths, Ends, SpecularPath, Vertex};
use crate::scene::shape::{Cuboid, Cylinder, Plane, Room, Sphere, Torus};
use crate::{Scene, Surface};
use glam::{EulerRot, Quat, Vec3};
use std::f64::consts::PI;

/// Every kind of surface, some of them turned, in a turned room.
fn furnished() -> Scene {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.4, 0.3, -0.2);
    let size = Vec3::new(14.0, 8.0, 18.0);
    let crate_size = Vec3::new(2.0, 1.5, 1.0);
    let surfaces = vec![
        Surface::new(Room { size }).turned(turn),
        Surface::new(Plane).at(Vec3::Y * -3.0),
        Surface::new(Cuboid { size: crate_size })
            .at(Vec3::new(-3.0, -1.0, 2.0))
            .turned(turn),
        Surface::new(Sphere { radius: 1.2 }).at(Vec3::new(3.0, 0.5, -3.0)),
        Surface::new(Cylinder { radius: 0.6 }).at(Vec3::new(-2.0, 0.0, -4.0)),
        Surface::new(Torus {
            ring: 1.0,
            tube: 0.3,
        })
        .at(Vec3::new(1.0, 1.0, 4.0))
        .turned(turn),
    ];
    scene(
        surfaces,
        Vec3::new(0.3, 0.2, 0.1),
        Vec3::new(-1.0, 0.9, -1.4),
    )
}

/// A path's reflections in the other direction.
fn reversed(path: &SpecularPath, ends: &Ends) -> Vec<Vertex> {
    let mut all = vec![ends.source];
    all.extend(&path.points);
    all.push(ends.listener);
    let vertex = |i: usize| {
        let (to, from) = (all[i] - all[i - 1], all[i + 1] - all[i]);
        Vertex {
            point: all[i],
            normal: (from.normalize() - to.normalize()).normalize(),
            surface: path.surfaces[i - 1],
        }
    };
    (1..all.len() - 1).rev().map(vertex).collect()
}

/// Protects reciprocity among all kinds of surfaces: every path is also one from the listener to
/// the source, with the same length and spreading. From the other side, other surfaces hide and
/// other points come first.
#[test]
fn every_path_goes_back() {
    let there = furnished();
    let found = found(&there, 40_000, 3, 1.0);
    assert!(found.paths.len() > 100, "{}", found.paths.len());
    let early = EarlyPaths::new(&there).expect("a valid scene");
    let ends = Ends::of(&there);
    let back = Ends {
        source: ends.listener,
        listener: ends.source,
        ..ends
    };
    for path in &found.paths {
        let mut candidates = Candidates::new(1);
        candidates.add(0, &reversed(path, &ends));
        let again = early.find(&back, &candidates);
        let Ok(index) = again.outcomes[0] else {
            panic!("{:?} for {path:?}", again.outcomes)
        };
        let other = &again.paths[index];
        assert!((path.length_m - other.length_m).abs() < 1e-9);
        assert!((path.departure + other.arrival_direction).length() < 1e-8);
        // The front at a torus' marched neighbour has the error of its normals.
        let error = (path.spreading / other.spreading - 1.0).abs();
        assert!(error < 1e-7, "{error} at {path:?}");
    }
}

/// Protects the estimate of what the waves miss, compared with twenty times as many: the energy of
/// the additional paths that these find.
#[test]
fn what_more_waves_find_was_estimated() {
    let scene = furnished();
    let few = found(&scene, 20_000, 2, 0.5);
    let many = found(&scene, 400_000, 2, 0.5);
    let is_new = |path: &&SpecularPath| {
        let is_same = |other: &SpecularPath| {
            other.surfaces == path.surfaces && (other.length_m - path.length_m).abs() < 1e-6
        };
        !few.paths.iter().any(is_same)
    };
    let all: f64 = many.paths.iter().map(|path| path.spreading).sum();
    let new: Vec<&SpecularPath> = many.paths.iter().filter(is_new).collect();
    let share = new.iter().map(|path| path.spreading).sum::<f64>() / all;
    let missed = few.missed;
    let estimated = missed.energy_share().expect("waves that found paths");
    assert!(
        new.len() as f64 > missed.paths(),
        "{} {missed:?}",
        new.len()
    );
    // Good's variance is about (f1 + 2 f2)/n²; three deviations.
    let once_and_twice = (missed.found_once + 2 * missed.found_twice) as f64;
    let deviation = once_and_twice.sqrt() / missed.waves as f64;
    assert!(
        (share - estimated).abs() < 3.0 * deviation,
        "{share} {missed:?}"
    );
}

/// Protects spreading, compared with counts of waves: of N waves, N reach² / (4 A) come within
/// `reach` of the listener by a path, plus or minus the root of that.
#[test]
fn as_many_waves_arrive_as_the_spreading_says() {
    let (waves, reach) = (400_000, 0.3);
    let found = found(&furnished(), waves, 2, reach);
    let (mut all, mut came) = (0.0, 0.0);
    for path in &found.paths {
        let expected = waves as f64 * reach * reach * PI * path.spreading;
        let count = f64::from(path.found_by);
        assert!(
            (count - expected).abs() < 4.0 * expected.sqrt() + 3.0,
            "{expected} {path:?}"
        );
        all += expected;
        came += count;
    }
    assert!((came - all).abs() < 3.0 * all.sqrt(), "{came} of {all}");
}
