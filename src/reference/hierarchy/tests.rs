//! Compares the hierarchy with evaluating every surface.

use super::super::ExactScene;
use super::Hierarchy;
use crate::scene::shape::{Cuboid, Cylinder, Plane, Prism, Room, Sphere, Torus};
use crate::scene::{Bounds3, Listener, Node, Scene, Shape, Source, Surface};
use crate::test_common::Random;
use glam::{DVec3, EulerRot, Quat, Vec2, Vec3};
use proptest::prelude::*;

/// Half the side of the cube that contains the surfaces, in metres.
const HALF: f64 = 10.0;

fn place(random: &mut Random) -> Vec3 {
    // Whole decimetres, so that lines along the axes lie in faces, and surfaces share faces.
    Vec3::from_array(std::array::from_fn(|_| {
        (10.0 * HALF * random.signed()).round() as f32 * 0.1
    }))
}

fn surface(random: &mut Random) -> Surface {
    let size = 0.2 * (2.0 + random.signed() as f32);
    let node = match (8.0 * (random.signed() + 1.0)) as u32 {
        0..=5 => Node::Cuboid(Cuboid {
            size: Vec3::new(size, 2.0 * size, 0.5),
        }),
        6..=9 => Node::Sphere(Sphere { radius: size }),
        10 => Node::Cylinder(Cylinder { radius: 0.3 * size }),
        11..=13 => Node::Prism(Prism {
            corners: [Vec2::ZERO, Vec2::X, Vec2::Y],
            depth: size,
        }),
        _ => Node::Torus(Torus {
            ring: size,
            tube: 0.3 * size,
        }),
    };
    let turn = match random.signed() > 0.0 {
        true => Quat::IDENTITY,
        false => {
            let [a, b, c] = std::array::from_fn(|_| 3.0 * random.signed() as f32);
            Quat::from_euler(EulerRot::YXZ, a, b, c)
        }
    };
    Surface::new(Shape::from(node))
        .at(place(random))
        .turned(turn)
}

/// The given number of surfaces in a room, every tenth one twice, moved by `away` from the world's
/// origin.
fn scene(random: &mut Random, count: usize, away: Vec3) -> Scene {
    let size = Vec3::splat(2.5 * HALF as f32);
    let mut surfaces = vec![Surface::new(Node::Room(Room { size }))];
    for index in 0..count {
        let one = surface(random);
        surfaces.extend((index % 10 == 0).then(|| one.clone()));
        surfaces.push(one);
    }
    surfaces.push(Surface::new(Node::Plane(Plane)).at(Vec3::NEG_Y * 9.0));
    for surface in &mut surfaces {
        surface.position += away;
    }
    let (source, listener) = (Source::at(away), Listener::at(away + Vec3::X, 0.3));
    Scene::new("many", surfaces, source, listener)
}

/// The same scene, evaluating every surface.
fn asking_all(exact: &ExactScene) -> ExactScene {
    let mut all = exact.clone();
    all.hierarchies = [false, true].map(|is_marched| {
        let surfaces = (0..).zip(&exact.surfaces);
        let of_kind = surfaces.filter(|(_, surface)| surface.is_marched() == is_marched);
        Hierarchy::new(
            of_kind
                .map(|(index, _)| (index, Bounds3::EVERYWHERE))
                .collect(),
        )
    });
    all
}

fn direction(random: &mut Random, number: usize) -> DVec3 {
    match number % 4 {
        0 => DVec3::AXES[number / 4 % 3] * random.signed().signum(),
        _ => random.direction(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Protects the hits of waves among many surfaces: each flight of a wave, each obstacle and each point in a solid
    /// is, bit for bit, the one found by evaluating every surface; also of surfaces that share a face, and along their
    /// faces.
    #[test]
    fn the_hierarchy_changes_no_hit(seed in any::<u32>(), count in 17..160usize, is_far in any::<bool>()) {
        let mut random = Random(seed.into());
        let away = if is_far { Vec3::new(3000.0, -200.0, 70.0) } else { Vec3::ZERO };
        let exact = ExactScene::new(&scene(&mut random, count, away)).expect("a valid scene");
        let all = asking_all(&exact);
        let mut met = 0;
        for number in 0..150 {
            let start = (place(&mut random) + away).as_dvec3();
            let direction = direction(&mut random, number);
            let flights = |exact: &ExactScene| {
                let mut hits = Vec::new();
                let last = exact.follow(start, direction, 6, |hit| hits.push(*hit));
                (hits, last.map(|last| (last.origin, last.direction, last.is_free)))
            };
            let (found, expected) = (flights(&exact), flights(&all));
            prop_assert_eq!(&found, &expected, "from {} along {}", start, direction);
            met += found.0.len();
            let until = 5.0 * (1.0 + random.signed());
            prop_assert_eq!(
                exact.first_surface(start, direction, None, until),
                all.first_surface(start, direction, None, until)
            );
            let distance = exact.surface_distance(start);
            prop_assert_eq!(exact.is_in_solid(start, 1e-9), distance < -1e-9);
            let reach = 0.4;
            let within = exact.distance_within(start, reach);
            prop_assert_eq!(within < reach, distance < reach);
            prop_assert!(within == distance || within == reach);
        }
        prop_assert!(met > 100);
    }
}

/// Protects the time that many surfaces take: a line evaluates a small part of them.
#[test]
fn a_line_asks_few_of_many() {
    let mut random = Random(5);
    let exact = ExactScene::new(&scene(&mut random, 5000, Vec3::ZERO)).expect("a valid scene");
    let directions = (0..100).map(|_| random.direction()).collect::<Vec<_>>();
    let flights = directions
        .iter()
        .map(|d| exact.next_surface(DVec3::ZERO, *d, None, 1e9).1);
    let asked: u64 = flights.sum();
    assert!(asked < 100 * 500, "{asked}");
}
