//! Obstacles, and surfaces that are not exact.

use super::{by_way_of, found, scene, vertex};
use crate::acoustics::early::{Candidates, EarlyPaths, Ends, NoPath};
use crate::scene::UserField;
use crate::scene::shape::{Cuboid, Plane, Sphere, User};
use crate::{Shape, Surface};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Protects shadows: a box between both ends blocks the direct sound and leaves the echo, and
/// one that reaches to the ground blocks both.
#[test]
fn an_obstacle_blocks_what_it_crosses() {
    let ground = Surface::new(Plane).at(Vec3::Y * -2.0);
    let screen = |height: f32, y: f32| {
        let size = Vec3::new(0.1, height, 8.0);
        Surface::new(Cuboid { size }).at(Vec3::Y * y)
    };
    let (source, listener) = (Vec3::X * -3.0, Vec3::X * 3.0);
    for (screen, direct, echo) in [
        (screen(1.0, 5.0), 1, 1),
        (screen(1.0, 0.0), 0, 1),
        (screen(4.0, 0.0), 0, 0),
        (screen(1.0, -1.5), 1, 0),
    ] {
        let scene = scene(vec![ground.clone(), screen], source, listener);
        let found = found(&scene, 20_000, 1, f64::INFINITY);
        assert_eq!(by_way_of(&found, &[]).len(), direct);
        assert_eq!(by_way_of(&found, &[1]).len(), echo);
    }
}

/// Protects against paths within solids: a candidate on the far side of a ball has none.
#[test]
fn a_reflection_comes_from_the_air() {
    let ball = Surface::new(Sphere { radius: 1.0 });
    let scene = scene(
        vec![ball],
        Vec3::new(4.0, 1.0, 0.0),
        Vec3::new(4.0, -1.0, 0.0),
    );
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let mut candidates = Candidates::new(2);
    candidates.add(0, &[vertex(1, DVec3::NEG_X, DVec3::NEG_X)]);
    candidates.add(1, &[vertex(1, DVec3::X, DVec3::X)]);
    let found = early.find(&Ends::of(&scene), &candidates);
    assert_eq!(found.outcomes, [Err(NoPath::NotFromTheAir), Ok(1)]);
}

/// Protects against claiming exact paths at surfaces that are known only from samples.
#[test]
fn users_fields_are_not_exact() {
    let text = "float field(vec3 p) { return length(p) - 1.0; }".to_owned();
    let field = UserField::new("ball", text, Vec3::splat(3.0), 1.0);
    let user = Shape::from(User {
        field: Arc::new(field),
    });
    let scene = scene(vec![Surface::new(user)], Vec3::X * 4.0, Vec3::Y * 4.0);
    let early = EarlyPaths::new(&scene).expect("a valid scene");
    let normal = DVec3::new(1.0, 1.0, 0.0).normalize();
    let mut candidates = Candidates::new(1);
    candidates.add(0, &[vertex(1, normal, normal)]);
    let found = early.find(&Ends::of(&scene), &candidates);
    assert_eq!(found.outcomes, [Err(NoPath::NotExact)]);
}

/// Protects the estimate of missed paths: many waves miss little, few miss much, and without waves
/// the estimate is `None`.
#[test]
fn few_waves_say_that_they_miss_much() {
    let size = Vec3::new(20.0, 5.0, 13.0);
    let room = Surface::new(crate::scene::shape::Room { size });
    let scene = scene(
        vec![room],
        Vec3::new(3.0, 1.0, 2.0),
        Vec3::new(-6.0, 0.2, -3.0),
    );
    let share = |waves| found(&scene, waves, 3, 0.3).missed.energy_share();
    let (few, many) = (share(4000), share(400_000));
    assert!(few > Some(0.1) && many < Some(0.01), "{few:?} {many:?}");
    assert_eq!(share(0), None);
    let missed = found(&scene, 400_000, 3, 0.3);
    let lacking = 63.0 - missed.paths.len() as f64;
    assert!(
        (missed.missed.paths() - lacking).abs() < 5.0,
        "{:?}",
        missed.missed
    );
}
