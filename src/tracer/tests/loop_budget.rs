//! Tests that the number of iterations in a pass does not change a bit of the result. Drivers silently leave loops
//! after a maximum number of turns (Mesa's llvmpipe after 65,536 turns of all loops of a shader together), so every
//! kind of loop has to be counted.

use crate::scene::shape::{Room, Sphere, Torus};
use crate::scene::{Node, Shape};
use crate::test_common::tracer;
use crate::tracer::{Budget, Profile, Wave};
use crate::{Listener, Scene, Settings, Source, Surface};
use glam::Vec3;

fn room(surfaces: impl IntoIterator<Item = Surface>) -> Scene {
    let size = Vec3::splat(20.0);
    let walls = Surface::new(Node::Room(Room { size }));
    Scene::new(
        "room",
        std::iter::once(walls).chain(surfaces).collect(),
        Source::at(Vec3::new(-9.5, 0.0, 0.0)),
        Listener::at(Vec3::splat(9.5), 0.05),
    )
}

fn scattered(shape: &(impl Into<Shape> + Clone)) -> Scene {
    let mut random = crate::test_common::Random(3);
    let mut number = || 9.0 * random.signed() as f32;
    let mut place = || Vec3::new(number(), number(), number());
    room((0..40).map(|_| Surface::new(shape.clone()).at(place())))
}

fn scenes() -> Vec<(&'static str, Scene)> {
    let ball = Shape::from(Node::Sphere(Sphere { radius: 0.2 }));
    let torus = Shape::from(Node::Torus(Torus {
        ring: 0.5,
        tube: 0.1,
    }));
    let lattice =
        |of: &Shape, period: f32, count: u32| of.clone().repeat(Vec3::splat(period), [count; 3]);
    let nested = lattice(&lattice(&ball, 0.5, 3), 3.0, 5);
    // Copies that extend beyond their cells, so that several copies are evaluated each time.
    let crossing = lattice(&torus.translate(Vec3::X * 0.6), 1.5, 5);
    let endless = |of: &Shape, period: f32| lattice(of, period, 0);
    let field = |field: Shape| room([Surface::new(field)]);
    vec![
        (
            "balls in cells",
            scattered(&Node::Sphere(Sphere { radius: 0.3 })),
        ),
        (
            "tori in cells",
            scattered(&Node::Torus(Torus {
                ring: 0.4,
                tube: 0.1,
            })),
        ),
        ("a limited repeat", field(lattice(&ball, 1.5, 11))),
        ("nested repeats", field(nested)),
        ("crossing copies", field(crossing)),
        ("an endless repeat", field(endless(&ball, 1.5))),
        (
            "a limited repeat in an endless one",
            field(endless(&lattice(&ball, 0.5, 3), 3.0)),
        ),
    ]
}

fn bits(waves: &[Wave]) -> Vec<[u32; 9]> {
    let of = |wave: &Wave| {
        let [x, y, z] = wave.position.to_array().map(f32::to_bits);
        let [u, v, w] = wave.direction.to_array().map(f32::to_bits);
        let status = wave.status.to_bits();
        [
            x,
            y,
            z,
            u,
            v,
            w,
            status,
            wave.zero_length_passes,
            wave.step_limit_reached,
        ]
    };
    waves.iter().map(of).collect()
}

/// Protects what `Settings::iterations_per_pass` documents: every number gives the same result.
#[test]
fn passes_of_any_length_give_the_same_bits() {
    let mut tracer = tracer();
    for (what, scene) in scenes() {
        for (profile, iterations) in [
            (Profile::Hybrid, 4000),
            (Profile::March, 600),
            (Profile::Thesis, 60),
        ] {
            let mut waves = |iterations_per_pass| {
                let settings = Settings::new(profile)
                    .with_waves(32)
                    .with_iterations(iterations)
                    .with_iterations_per_pass(iterations_per_pass);
                bits(&tracer.frame_with_waves(&scene, &settings).unwrap().1)
            };
            let by_sixteen = waves(16);
            assert_eq!(
                waves(Settings::MAX_ITERATIONS),
                by_sixteen,
                "{what}, {profile}"
            );
            assert_eq!(waves(1), by_sixteen, "{what}, {profile}");
        }
    }
}

/// Protects the count of turns from omitting a loop: each of these scenes allows fewer iterations in a pass than the
/// empty room.
#[test]
fn every_loop_shortens_the_passes() {
    for profile in Profile::ALL {
        let settings = Settings::new(profile).with_iterations_per_pass(Settings::MAX_ITERATIONS);
        let alone = Budget::of(&room([]), &settings).iterations_per_pass;
        for (what, scene) in scenes() {
            // Of repeated copies that stay within their cells, only one is evaluated, without a loop.
            let loops = profile == Profile::Hybrid || !what.contains("repeat");
            let budget = Budget::of(&scene, &settings).iterations_per_pass;
            assert!(!loops || budget < alone, "{what}, {profile}: {budget}");
        }
    }
}
