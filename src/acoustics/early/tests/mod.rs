//! Compares early paths with closed forms, brute force, and bundles of traced rays.

mod ball;
mod cylinder;
mod foci;
mod obstacles;
mod plane_sequences;
mod reciprocity;
mod room;
mod shapes;

use super::{EarlyPaths, Ends, Found, SpecularPath, Vertex};
use crate::reference::ExactScene;
use crate::{Listener, Scene, Source, Surface};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

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

/// Directions on a spiral over the unit sphere (Vogel 1979), even to a few per cent.
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

/// The paths found by `waves` waves that come within `reach` metres of the listener.
pub fn found(scene: &Scene, waves: usize, order: u32, reach: f64) -> Found {
    let early = EarlyPaths::new(scene).expect("a valid scene");
    let ends = Ends::of(scene);
    let candidates = early.candidates(&ends, &directions(waves), order, reach);
    early.find(&ends, &candidates)
}

/// The paths over these surfaces.
pub fn by_way_of<'a>(found: &'a Found, surfaces: &[u32]) -> Vec<&'a SpecularPath> {
    let paths = found.paths.iter();
    paths.filter(|path| path.surfaces == surfaces).collect()
}

/// The area of the front per solid angle that corresponds to the path's spreading.
pub fn area(path: &SpecularPath) -> f64 {
    1.0 / (4.0 * PI * path.spreading)
}

/// The same from eight rays around the path's departure, by differences of fourth order, without
/// using curvatures. The rays are `angle` radians off, and twice that.
pub fn traced_area(scene: &Scene, path: &SpecularPath, angle: f64) -> f64 {
    let exact = ExactScene::new(scene).expect("a valid scene");
    let ends = Ends::of(scene);
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

/// Roots of a function of an angle over a full turn, between `steps` samples, by bisection.
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

/// Asserts that every reflection is specular, to `most` radians.
pub fn assert_specular(scene: &Scene, path: &SpecularPath, most: f64) {
    let ends = Ends::of(scene);
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
