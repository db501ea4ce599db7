//! Cylinders.

use super::{SPECULAR, area, assert_specular, by_way_of, found, roots, scene, traced_area};
use crate::Surface;
use crate::scene::shape::{CappedCylinder, Cylinder, Plane};
use glam::{DVec2, DVec3, Quat, Vec3};

/// The shortest path at a cylinder about y, by a search: seen along y it is a path at a circle,
/// whose stationary angle does not depend on heights, because the length of a straight line on the
/// unrolled strip is √(flat² + rise²).
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

/// Protects paths at a cylinder, compared with a search over its surface, and their spreading,
/// compared with traced rays.
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

/// Protects sequences of several curved surfaces and planes: two turned pillars on a floor, to
/// order 3, and reciprocity: with the ends swapped the paths are the same, including lengths and
/// spreading.
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
    std::mem::swap(&mut way.source.position, &mut way.listener.position);
    let back = found(&way, 60_000, 3, 2.0);
    assert_eq!(there.paths.len(), back.paths.len());
    for (path, other) in there.paths.iter().zip(&back.paths) {
        let reversed: Vec<u32> = other.surfaces.iter().rev().copied().collect();
        assert_eq!(path.surfaces, reversed);
        assert!((path.length_m - other.length_m).abs() < 1e-9);
        assert!((path.spreading / other.spreading - 1.0).abs() < 1e-9);
    }
}

/// Protects finite cylinders: side and flat ends, each within its edges.
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
