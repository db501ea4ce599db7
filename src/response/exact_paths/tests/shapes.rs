//! Paths at all kinds of shapes.

use super::{area, assert_specular, by_way_of, directions, found, scene, traced_area};
use crate::geometry::ExactScene;
use crate::response::exact_paths::{Candidates, EarlyPaths, Ends, Missed, SpecularPath, Vertex};
use crate::scene::HeightImage;
use crate::scene::shape::{
    Capsule, Cone, Cuboid, Cylinder, Ellipsoid, GeneralQuadric, HalfSpace, HeightField,
    Hyperboloid, Paraboloid, Plane, Prism, Room, RoundedBox, Sphere, Torus,
};
use crate::test_common::Random;
use crate::{Scene, Shape, Surface};
use glam::{DVec3, EulerRot, Quat, UVec2, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

fn torus() -> Shape {
    Shape::from(Torus {
        ring: 1.2,
        tube: 0.4,
    })
}

fn cuboid(x: f32, y: f32, z: f32) -> Shape {
    Shape::from(Cuboid {
        size: Vec3::new(x, y, z),
    })
}

fn ball(radius: f32) -> Shape {
    Shape::from(Sphere { radius })
}

fn hills() -> Shape {
    let size = UVec2::new(6, 6);
    let height = |i: u32| 0.5 + 0.3 * ((i % 6) as f32 * 0.9).sin() * ((i / 6) as f32 * 0.7).cos();
    let heights = (0..36).map(height).collect();
    let image = HeightImage::new("hills", size, heights).expect("a grid");
    Shape::from(HeightField {
        image: Arc::new(image),
        size: Vec3::new(4.0, 1.5, 4.0),
    })
}

/// Finite shapes about the origin.
fn shapes() -> Vec<Shape> {
    let corners = [
        Vec2::new(-1.0, -1.0),
        Vec2::new(1.5, -0.5),
        Vec2::new(0.0, 1.2),
    ];
    let size = Vec3::new(2.0, 1.0, 1.5);
    let coefficients = [1.0, 2.0, 0.7, 0.3, -0.2, 0.1, 0.2, 0.1, 0.0, -1.5];
    vec![
        ball(1.3),
        torus(),
        Shape::from(Capsule {
            radius: 0.6,
            height: 1.0,
        }),
        Shape::from(Cone {
            radius: 1.0,
            height: 2.0,
        }),
        Shape::from(Prism {
            corners,
            depth: 1.5,
        }),
        Shape::from(RoundedBox {
            size,
            rounding: 0.3,
        }),
        Shape::from(Ellipsoid {
            radii: Vec3::new(1.5, 1.0, 0.7),
        }),
        Shape::from(GeneralQuadric { coefficients }),
        hills(),
        Shape::intersection([Shape::from(Paraboloid { focal_length: 0.4 }), ball(2.0)]),
        Shape::intersection([
            Shape::from(Hyperboloid {
                waist: 0.7,
                rise: 0.9,
                two_sheets: false,
            }),
            ball(2.0),
        ]),
    ]
}

/// Finite trees about the origin.
fn trees() -> Vec<Shape> {
    vec![
        cuboid(1.0, 1.0, 1.0).offset(0.3),
        Shape::from(Cylinder { radius: 0.5 }).rotate(Vec3::new(0.4, 0.2, 1.0)),
        Shape::union([ball(0.8), cuboid(2.5, 0.5, 0.5)]),
        cuboid(2.0, 2.0, 2.0).minus([ball(1.2)]),
        cuboid(2.0, 2.0, 2.0)
            .minus([ball(1.2).translate(Vec3::Y)])
            .scale(0.8),
        ball(0.5).repeat(Vec3::new(1.5, 0.0, 1.5), [3, 0, 2]),
        torus()
            .translate(Vec3::X * 0.7)
            .mirror([true, false, false]),
        ball(0.7).elongate(Vec3::new(0.6, 0.0, 0.2)),
        Shape::smooth_union(0.8, [ball(0.9).translate(Vec3::X), cuboid(1.5, 1.0, 1.0)]),
        cuboid(1.0, 2.0, 0.7).twist(0.5),
        cuboid(2.0, 1.0, 0.7).bend(0.3),
        ball(1.2).morph(cuboid(1.5, 1.5, 1.5), 0.4),
        torus().offset(0.1),
        Shape::intersection([
            ball(1.5),
            Shape::from(HalfSpace {
                normal: Vec3::new(1.0, 2.0, 0.5),
                offset: 0.4,
            }),
        ])
        .shell(0.1),
    ]
}

/// Number of waves that hit a shape in the test below.
const TRIED: usize = 40;

/// Protects every kind of sheet with its derivatives, moved and turned. Any listener that a reflected wave passes has a
/// path, the path is specular, and its wave front has the area found by traced rays. The listener is 3 m along a
/// reflected wave. The path is solved for from another wave 0.01 rad away, which may miss next to edges, seams and
/// outlines.
#[test]
fn shapes_mirror_as_rays_do() {
    let turn = Quat::from_euler(EulerRot::YXZ, 0.5, -0.8, 0.3);
    for shape in shapes().into_iter().chain(trees()) {
        let name = shape.name();
        let surface = Surface::new(shape)
            .at(Vec3::new(0.2, -0.1, 0.3))
            .turned(turn);
        let mut scene = scene(vec![surface], Vec3::new(3.0, 2.5, 2.0), Vec3::ONE * 9.0);
        let mut random = Random(7);
        let mut met = 0;
        for unit in mirrored(&scene) {
            let Some(path) = path_along(&mut scene, unit, unit + 0.01 * random.direction()) else {
                continue;
            };
            // Points within 1e-8 m of the border of a blend get the sheet on one side of the border. Their normals
            // deviate by the square root of the distance to the border.
            assert_specular(&scene, &path, 1e-4);
            // For a bundle over the seam of two sheets the area depends on the bundle's width.
            let [traced, wider] = [1e-4, 2e-4].map(|angle| traced_area(&scene, &path, angle));
            if (wider / traced - 1.0).abs() > 1e-4 {
                continue;
            }
            met += 1;
            let error = area(&path) / traced - 1.0;
            // Normals of marched fields are accurate to 1e-9, so differences are accurate to 1e-5; 1e-3 corresponds to
            // 0.004 dB.
            assert!(error.abs() < 1e-3, "{name}: {error} at {path:?}");
        }
        assert!(met >= TRIED * 4 / 5, "{name}: {met} paths");
    }
}

/// Directions from the source in which a wave is mirrored once and then flies freely for 3 m.
fn mirrored(scene: &Scene) -> Vec<DVec3> {
    let exact = ExactScene::new(scene).expect("a valid scene");
    let start = scene.sources[0].position.as_dvec3();
    let is_mirrored = |unit: &DVec3| {
        let mut hits = 0;
        let flight = exact.follow(start, *unit, 2, |hit| {
            hits += u32::from(hit.t > 0.0);
        });
        hits == 1 && flight.is_some_and(|flight| flight.is_free)
    };
    let units = directions(6000).into_iter();
    let units = units.map(|direction| direction.as_dvec3().normalize());
    units.filter(is_mirrored).take(TRIED).collect()
}

/// The path that departs along `unit` to a listener on that wave, solved for from a wave that departs along `beside`.
fn path_along(scene: &mut Scene, unit: DVec3, beside: DVec3) -> Option<SpecularPath> {
    let exact = ExactScene::new(&*scene).expect("a valid scene");
    let flight = exact.follow(Ends::of(scene.only_pair().unwrap()).source, unit, 1, |_| ())?;
    scene.listeners[0].position = (flight.origin + 3.0 * flight.direction).as_vec3();
    let early = EarlyPaths::new(&*scene).expect("a valid scene");
    let ends = Ends::of(scene.only_pair().unwrap());
    let candidates = early.candidates(&ends, &[beside.as_vec3()], 1, f64::INFINITY);
    let found = early.find(&ends, &candidates);
    let echoes = by_way_of(&found, &[1]).into_iter();
    // The listener's position is rounded to f32.
    let mut near = echoes.filter(|path| path.departure.distance(unit) < 1e-5);
    near.next().cloned()
}

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

/// A path's reflections in reverse order.
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

/// Protects reciprocity among all kinds of surfaces: every path also leads from the listener to the source, with the
/// same length and spreading. The reversed search meets other obstacles and other points first.
#[test]
fn every_path_goes_back() {
    let there = furnished();
    let found = found(&there, 40_000, 3, 1.0);
    assert!(found.paths.len() > 100, "{}", found.paths.len());
    let early = EarlyPaths::new(&there).expect("a valid scene");
    let ends = Ends::of(there.only_pair().unwrap());
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
        // Next to a marched torus, the spreading has the error of the normals.
        let error = (path.spreading / other.spreading - 1.0).abs();
        assert!(error < 1e-7, "{error} at {path:?}");
    }
}

/// Protects the estimate of missed energy: it agrees with the energy of the additional paths that are found with twenty
/// times as many waves.
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
    let missed = Missed::of(&few.paths);
    let estimated = missed.energy_share().expect("waves that found paths");
    assert!(
        new.len() as f64 > missed.paths(),
        "{} {missed:?}",
        new.len()
    );
    // Good's variance is about (f1 + 2 f2)/n²; the test allows three standard deviations.
    let once_and_twice = (missed.found_once + 2 * missed.found_twice) as f64;
    let deviation = once_and_twice.sqrt() / missed.waves as f64;
    assert!(
        (share - estimated).abs() < 3.0 * deviation,
        "{share} {missed:?}"
    );
}

/// Protects spreading, which is compared with counts of waves: of N waves, N reach² / (4 A) come within `reach` of the
/// listener along a path. The standard deviation is the square root of this number.
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
