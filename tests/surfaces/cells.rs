//! Many surfaces in cells: no profile misses a surface, for any content of the cells and any start of a wave.

use crate::common::tracer;
use echomarch::scene::shape::{Capsule, Cuboid, Cylinder, Ellipsoid, Plane, Sphere, Torus};
use echomarch::scene::{Node, Shape};
use echomarch::tracer::ThesisOptions;
use echomarch::{Listener, Scene, Settings, Source, Surface, Tracer};
use glam::{Quat, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Returns the number of the object that sphere tracing on the CPU hits from `origin` along `direction`, or -1 for no
/// hit. All surfaces are evaluated, without cells. `None` for a line that grazes a surface.
fn truth(scene: &Scene, origin: Vec3, direction: Vec3) -> Option<f32> {
    /// Distance that counts as a hit, in metres. It is only a few rounding errors, because a line may pass a surface at
    /// less than a tenth of a millimetre. `CLOSE` is the distance below which a line counts as grazing.
    const TOUCH: f32 = 2e-5;
    const CLOSE: f32 = 5e-3;
    const FAR: f32 = 600.0;
    let pair = scene.only_pair().unwrap();
    let mut t = 0.0;
    let mut receding = None;
    for _ in 0..20_000 {
        let nearest = pair.distance(origin + t * direction);
        if nearest.distance < TOUCH {
            // A line that hits must enter the solid. Otherwise it passes the surface within `TOUCH`.
            let beyond = pair.distance(origin + (t + CLOSE) * direction);
            return (beyond.distance < 0.0).then_some(nearest.object as f32);
        }
        if nearest.distance < CLOSE {
            receding = Some(receding.map_or(nearest.distance, |d: f32| d.min(nearest.distance)));
        } else if receding.is_some() {
            return None;
        }
        t += nearest.distance;
        if t > FAR {
            return Some(-1.0);
        }
    }
    None
}

fn scene(surfaces: Vec<Surface>, source: Vec3) -> Scene {
    Scene::new(
        "cells",
        surfaces,
        Source::at(source),
        Listener::at(Vec3::new(0.0, 60.0, 90.0), 1.0),
    )
}

fn profiles() -> Vec<(&'static str, Settings)> {
    let near = ThesisOptions::default().with_min_distance(1e-3);
    let near = Settings::new(near).with_max_distance(700.0);
    vec![
        ("hybrid", Settings::hybrid()),
        ("march", Settings::march()),
        ("thesis", near),
    ]
}

/// Traces one flight of each wave, and compares the hit surface with `truth`.
fn compare(tracer: &mut Tracer, what: &str, scene: &Scene) {
    for (profile, settings) in profiles() {
        let settings = settings.with_waves(1024).with_iterations(1);
        let (frame, waves) = tracer.frame_with_waves(scene, &settings).unwrap();
        assert_eq!(frame.counts.step_limit_reached, 0, "{what}, {profile}");
        let mut hits = 0;
        for wave in &waves {
            let Some(object) = truth(scene, scene.sources[0].position, wave.start_direction) else {
                continue;
            };
            hits += u32::from(object > 0.0);
            // The thesis' algorithm counts a line within its minimum distance as a hit.
            if profile == "thesis" && object < 0.0 {
                continue;
            }
            let direction = wave.start_direction;
            assert_eq!(wave.status, object, "{what}, {profile}, along {direction}");
        }
        assert!(hits > 3, "{what}: only {hits} waves hit anything");
    }
}

/// Returns surfaces of one shape on a lattice of 6 by 6, 4 m apart.
fn lattice(height: f32, shape: &(impl Into<Shape> + Clone)) -> Vec<Surface> {
    let place =
        |index: usize| Vec3::new((index % 6) as f32 * 4.0, height, (index / 6) as f32 * 4.0);
    let surface = |index| Surface::new(shape.clone()).at(place(index));
    (0..36).map(surface).collect()
}

/// Returns forty surfaces of one shape at random positions in a cube of 30 m.
fn scattered(shape: &(impl Into<Shape> + Clone)) -> Vec<Surface> {
    let mut random = crate::common::Random(7);
    let mut number = || 30.0 * random.unit() as f32;
    let mut place = || Vec3::new(number(), number(), number());
    (0..40)
        .map(|_| Surface::new(shape.clone()).at(place()))
        .collect()
}

/// Protects basic shapes and fields in cells from being missed, for waves from inside and outside the grid.
#[test]
fn scattered_shapes_are_all_met() {
    let mut tracer = tracer();
    let shapes = [
        Node::Sphere(Sphere { radius: 0.6 }),
        Node::Cuboid(Cuboid {
            size: Vec3::new(0.5, 1.5, 1.0),
        }),
        Node::Torus(Torus {
            ring: 0.7,
            tube: 0.3,
        }),
        Node::Capsule(Capsule {
            radius: 0.4,
            height: 1.0,
        }),
    ];
    for shape in &shapes {
        for source in [Vec3::new(14.0, 15.5, 15.0), Vec3::new(-8.0, 15.0, 15.0)] {
            let what = format!("{} from {source}", shape.name());
            compare(&mut tracer, &what, &scene(scattered(shape), source));
        }
    }
}

/// Protects columns of cells: infinite pillars, and shapes that are infinite on one side only.
#[test]
fn pillars_are_all_met() {
    let mut tracer = tracer();
    let pillar = Node::Cylinder(Cylinder { radius: 0.5 });
    for source in [Vec3::new(2.0, 1.0, 2.0), Vec3::new(-9.0, 1.0, 2.0)] {
        let what = format!("pillars from {source}");
        compare(&mut tracer, &what, &scene(lattice(0.0, &pillar), source));
    }
    let cut = Shape::intersection([
        Node::Cylinder(Cylinder { radius: 0.5 }).into(),
        Node::Plane(Plane).into(),
    ]);
    let cut = lattice(-8.0, &cut);
    compare(
        &mut tracer,
        "cut pillars",
        &scene(cut, Vec3::new(2.0, -12.0, 2.0)),
    );
    let lying: Vec<Surface> = lattice(6.0, &pillar)
        .into_iter()
        .map(|mut surface| {
            let Vec3 { x, z, .. } = surface.position;
            surface.position = Vec3::new(0.0, x, z);
            surface.turned(Quat::from_rotation_z(FRAC_PI_2))
        })
        .collect();
    compare(
        &mut tracer,
        "lying pillars",
        &scene(lying, Vec3::new(3.0, 10.0, 10.0)),
    );
}

/// Protects lists of cells that are kept between frames. After surfaces have moved, including far away and back, a
/// tracer gives the same results as a new tracer.
#[test]
fn moved_surfaces_are_met_where_they_are() {
    let mut kept = tracer();
    let mut scene = scene(
        scattered(&Node::Sphere(Sphere { radius: 0.6 })),
        Vec3::splat(15.0),
    );
    for step in 0..12 {
        let index = (step * 7) % scene.surfaces.len();
        scene.surfaces[index].position += match step {
            4 => Vec3::X * 400.0,
            5 => Vec3::Y * -3.0,
            _ => Vec3::new(1.5, -0.7, 0.4),
        };
        for settings in [Settings::hybrid(), Settings::march(), Settings::thesis()] {
            let settings = settings.with_waves(2048).with_iterations(4);
            let (_, seen) = kept.frame_with_waves(&scene, &settings).unwrap();
            let (_, fresh) = tracer().frame_with_waves(&scene, &settings).unwrap();
            let differ = seen
                .iter()
                .zip(&fresh)
                .filter(|(a, b)| a.status != b.status);
            // A list for a different grid has a different order, so a tie may be resolved differently.
            assert!(differ.count() <= 2, "step {step}, {}", settings.profile());
        }
    }
}

/// Returns a scene whose surfaces are unrolled in the shader text, and the same scene with each surface twice. The
/// second scene has enough surfaces to lie in cells, and the distances are the same everywhere.
fn alone_and_twice(surfaces: &[Surface]) -> [Scene; 2] {
    let source = Vec3::new(-3.0, 0.1, 0.2);
    let mut alone = scene(surfaces.to_vec(), source);
    alone.listeners = vec![Listener::at(Vec3::new(0.0, 3.0, 0.0), 0.5)];
    let mut twice = alone.clone();
    twice.surfaces.extend_from_slice(surfaces);
    [alone, twice]
}

/// Sets of 15 small surfaces. Each set is much smaller than the minimum distance of the thesis' algorithm.
fn small_sets() -> Vec<(&'static str, Vec<Surface>)> {
    let mut random = crate::common::Random(11);
    let mut set = |shape: Node, turned: bool| -> Vec<Surface> {
        let mut number = || 0.4 * random.signed() as f32;
        let mut place = || Vec3::new(number(), number(), number());
        let mut surface = |_| {
            let surface = Surface::new(shape.clone()).at(place());
            match turned {
                true => surface.turned(Quat::from_rotation_y(place().x)),
                false => surface,
            }
        };
        (0..15).map(&mut surface).collect()
    };
    let ellipsoid = Node::Ellipsoid(Ellipsoid {
        radii: Vec3::new(0.05, 0.02, 0.03),
    });
    let size = Vec3::new(0.05, 0.1, 0.02);
    vec![
        ("balls", set(Node::Sphere(Sphere { radius: 0.03 }), false)),
        ("boxes", set(Node::Cuboid(Cuboid { size }), true)),
        ("ellipsoids", set(ellipsoid, false)),
        (
            "pillars",
            set(Node::Cylinder(Cylinder { radius: 0.03 }), false),
        ),
    ]
}

/// Protects the thesis' profile in cells: its waves are bit-identical to those of the unrolled shader text, for any
/// start. No bounding box replaces the surfaces.
#[test]
fn the_thesis_sees_the_same_with_cells_and_without() {
    let mut tracer = tracer();
    for (what, surfaces) in small_sets() {
        let [alone, twice] = alone_and_twice(&surfaces);
        for (min_distance, iterations) in [(0.1, 1), (0.1, 3), (0.5, 3), (1e-3, 1)] {
            let options = ThesisOptions::default().with_min_distance(min_distance);
            let settings = Settings::new(options)
                .with_waves(20_000)
                .with_iterations(iterations);
            let (_, expected) = tracer.frame_with_waves(&alone, &settings).unwrap();
            let (_, found) = tracer.frame_with_waves(&twice, &settings).unwrap();
            let differ = expected.iter().zip(&found).find(|(a, b)| a != b);
            assert_eq!(differ, None, "{what}, {min_distance} m");
            let is_met = |n: &u32| found.iter().any(|wave| wave.status == *n as f32);
            let met = (1..=15).filter(is_met).count();
            let enough = iterations > 1 || met >= 3;
            assert!(enough, "{what}, {min_distance} m: only {met} are hit");
        }
    }
}
