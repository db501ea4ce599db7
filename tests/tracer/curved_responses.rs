//! Compares responses at curved mirrors with closed forms and with brute force, from the scene to the levels.

use echomarch::glam::{DVec3, Vec3};
use echomarch::response::{HeardPath, Response, ResponseSettings};
use echomarch::scene::Material;
use echomarch::scene::shape::{Cuboid, Cylinder, Ellipsoid, Room, Sphere};
use echomarch::{Listener, Scene, Settings, Shape, Source, Surface};
use std::f64::consts::PI;

use crate::common::tracer;

/// Maximum error of a level, in decibels.
const DECIBELS: f64 = 0.05;

fn response(scene: &Scene, waves: u32) -> Response {
    let settings = ResponseSettings::default()
        .with_trace(Settings::default().with_waves(waves))
        .with_seconds(0.25);
    Response::trace(&mut tracer(), scene, &settings).unwrap()
}

fn path<'a>(response: &'a Response, surfaces: &[u32], length_m: f64) -> &'a HeardPath {
    let is_it = |path: &&HeardPath| {
        path.path.surfaces == surfaces && (path.path.length_m - length_m).abs() < 1e-4
    };
    let found = response.paths.iter().find(is_it);
    found.unwrap_or_else(|| panic!("{surfaces:?}, {length_m} m: {:?}", response.paths))
}

#[track_caller]
fn assert_level(energy: f64, expected: f64) {
    let off_db = 10.0 * (energy / expected).log10();
    assert!(off_db.abs() < DECIBELS, "{off_db} dB");
}

/// Protects the gain of the parabolic mirrors. The rim of each dish is as high above its vertex as its focus, so the
/// dish catches half of all waves. All of these waves pass through the listener's centre at the other focus. A chord of
/// two radii in the sphere's volume is a density of 3 / (2π r²) there.
#[test]
fn parabolic_mirrors_gather_one_half_of_all_waves() {
    let scene = Scene::builtin("parabolic-mirrors").unwrap();
    let response = response(&scene, 1 << 18);
    // The path along the axis: 2 m back to the vertex, 30 m to the other vertex, 2 m to the focus.
    let focus = path(&response, &[2, 3], 34.0);
    assert!(focus.path.is_focus);
    let radius = f64::from(scene.listeners[0].radius);
    let caught = 0.5 * 3.0 / (2.0 * PI * radius * radius);
    for (band, energy) in focus.energy.iter().enumerate() {
        let absorption = Material::builtin("concrete").unwrap().absorption[band];
        assert_level(*energy, caught * (1.0 - absorption).powi(2));
    }
}

/// Protects the gain of a hollow ball. On its axis, a wave front that starts d metres in front of the wall has the
/// radius d + e − 2 d e / R at e metres after the reflection.
#[test]
fn a_hollow_ball_gathers_as_its_curvature_says() {
    let radius = 5.0;
    let ball = Shape::from(Sphere { radius: 5.0 }).complement();
    let mut scene = Scene::new(
        "ball",
        vec![Surface::new(ball).with_material("half")],
        Source::at(Vec3::X * 1.0),
        Listener::at(Vec3::X * 3.0, 0.2),
    );
    scene
        .materials
        .insert("half".to_owned(), Material::absorbing(0.5));
    let response = response(&scene, 1 << 16);
    for (before, behind) in [(4.0, 2.0), (6.0, 8.0)] {
        let front: f64 = before + behind - 2.0 * before * behind / radius;
        let found = path(&response, &[1], before + behind);
        assert_level(found.energy[4], 0.5 / (4.0 * PI * front.powi(2)));
    }
}

/// The first hit of a line on the cylinder of this radius about y, and the reflected direction.
fn mirrored(from: DVec3, towards: DVec3, radius: f64) -> (DVec3, DVec3) {
    let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z);
    let (o, d) = (flat(from), flat(towards));
    let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - radius * radius);
    let t = (-b - (b * b - a * c).sqrt()) / a;
    let point = from + towards * t;
    let normal = flat(point).normalize();
    (point, towards - 2.0 * towards.dot(normal) * normal)
}

/// Protects the level of an echo from a pillar, by comparison with a bundle of rays around it, and its delay, by
/// comparison with a search over the pillar.
#[test]
fn a_pillar_answers_as_a_bundle_of_rays_does() {
    const RADIUS: f64 = 0.75;
    const SPREAD: f64 = 1e-6;
    let (source, listener) = (DVec3::new(3.0, 0.25, 1.0), DVec3::new(-1.0, -1.5, 4.0));
    let scene = Scene::new(
        "pillar",
        vec![Surface::new(Cylinder { radius: 0.75 })],
        Source::at(source.as_vec3()),
        Listener::at(listener.as_vec3(), 0.3),
    );
    // Seen from above, the echo's path is the shortest path that touches the circle. Its height changes linearly along
    // the path.
    let flat = |angle: f64| {
        let at = DVec3::new(angle.cos(), 0.0, angle.sin()) * RADIUS;
        let from = |end: DVec3| at.distance(DVec3::new(end.x, 0.0, end.z));
        (from(source) + from(listener)).hypot(source.y - listener.y)
    };
    let shortest = (0..2_000_000).map(|i| flat(f64::from(i) * PI / 1e6));
    let length_m = shortest.fold(f64::INFINITY, f64::min);
    let response = response(&scene, 1 << 18);
    let echo = path(&response, &[1], length_m);
    assert!((echo.path.length_m - length_m).abs() < 1e-9);
    let departure = echo.path.departure;
    let (aside, up) = departure.any_orthonormal_pair();
    let end = |turn: DVec3| {
        let (point, direction) = mirrored(source, (departure + turn).normalize(), RADIUS);
        let normal = echo.path.arrival_direction;
        point + direction * ((listener - point).dot(normal) / direction.dot(normal))
    };
    let moved = |turn: DVec3| (end(turn * SPREAD) - end(-turn * SPREAD)) / (2.0 * SPREAD);
    let area = moved(aside).cross(moved(up)).length();
    assert_level(echo.energy[0], 1.0 / (4.0 * PI * area));
}

/// Protects the stated errors of figures if the energies of exact paths, which end at the listener's centre, differ
/// from the energies that the listener's sphere catches. Such paths occur in a hollow ellipsoid, and behind a pier that
/// hides a part of the sphere. Figures with exact paths of any order agree within their errors.
#[test]
fn figures_of_different_orders_agree_within_their_errors() {
    let mut tracer = tracer();
    let radii = Vec3::new(5.0, 3.0, 4.0);
    let hollow = vec![Surface::new(Shape::from(Ellipsoid { radii }).complement())];
    let room = Surface::new(Room {
        size: Vec3::new(20.0, 8.0, 15.0),
    });
    let pier = Surface::new(Cuboid {
        size: Vec3::new(2.0, 8.0, 1.5),
    });
    let (source, listener) = (Vec3::new(-1.5, -1.2, 0.3), Vec3::new(2.0, -0.3, 1.5));
    let (before, behind) = (Vec3::new(-3.0, -1.0, 0.65), Vec3::new(3.0, -1.2, 0.85));
    for (mut surfaces, source, listener) in [
        (hollow, source, listener),
        (vec![room, pier], before, behind),
    ] {
        for surface in &mut surfaces {
            surface.material = Some("plaster".to_owned());
        }
        let listener = Listener::at(listener, 0.3);
        let mut scene = Scene::new("orders", surfaces, Source::at(source), listener);
        scene.materials = [("plaster".to_owned(), Material::absorbing(0.3))].into();
        let waves = Settings::default().with_waves(1 << 17);
        let of_orders = [0, 6].map(|order| {
            let settings = ResponseSettings::default()
                .with_trace(waves.clone())
                .with_order(order);
            let figures = Response::trace(&mut tracer, &scene, &settings)
                .unwrap()
                .figures;
            let (told, errors) = (figures.bands[4], figures.errors[4]);
            [
                (told.g_db.unwrap(), errors.g_db.unwrap()),
                (told.c80_db.unwrap(), errors.c80_db.unwrap()),
            ]
        });
        println!("{of_orders:.3?}");
        for (of_waves, of_paths) in of_orders[0].iter().zip(of_orders[1]) {
            let off = (of_waves.0 - of_paths.0).abs();
            assert!(off < 2.5 * of_waves.1.hypot(of_paths.1), "{of_orders:?}");
            // The limits are the differences at the first measurement, plus some noise.
            assert!(of_waves.1 < 0.5 && of_paths.1 < 1.2, "{of_orders:?}");
        }
    }
}
