//! Foci: those of an ellipsoid and a paraboloid, and a listener at the source.

use super::{area, by_way_of, found, scene};
use crate::acoustics::early::{EarlyPaths, Ends};
use crate::scene::shape::{Ellipsoid, Paraboloid};
use crate::{Scene, Shape, Surface};
use glam::{DVec3, Quat, Vec3};
use std::f64::consts::PI;

/// Protects the beam of a paraboloid: after the mirror its front keeps the area r² that it has
/// there, r metres from the focus, however far the listener is.
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

/// Protects perfect foci: one path for the whole gallery, as all have the same length, with finite
/// energy.
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
    // The lengths from focus to mirror equal the distances to the directrix.
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
    let ends = Ends::of(&scene);
    let candidates = early.candidates(&ends, &[Vec3::NEG_Y], 1, 0.3);
    let found = early.find(&ends, &candidates);
    assert_eq!(found.paths.len(), 2);
    let direct = &found.paths[0];
    assert!(direct.is_focus && direct.spreading.is_finite());
    assert_eq!((direct.length_m, direct.departure), (0.0, DVec3::ZERO));
    let echo = &found.paths[1];
    assert!((echo.length_m, echo.departure) == (2.0, DVec3::NEG_Y));
}
