//! The texts of scenes, and the shaders against the CPU.

mod distance_functions;
mod driver_functions;
mod field_shaders;
mod free_lines;
mod parallel_lines;

use super::text::{ListenerText, Part, closed_form_parts, directed_parts};
use super::{Lists, OriginRebasing, Source, distance_parts, join, link, structure};
use crate::scene::shape::Cuboid;
use crate::scene::{Node, Scene};
use glam::{Quat, Vec3};

type Parts = fn(&Scene) -> Vec<Part>;

/// The calls of a pass, and the parts of the text that they need.
const CALLS: [(&str, Parts); 4] = [
    ("distanceFunction()", distance_parts),
    (
        "directedDistance() directedGradient() reflectWave()",
        |scene| directed_parts(scene, ListenerText::Solid, false),
    ),
    (
        "directedDistance() surfaceDistance() reflectWave()",
        |scene| directed_parts(scene, ListenerText::Solid, true),
    ),
    ("closestHit() reflectWave()", |scene| {
        closed_form_parts(scene, ListenerText::Solid)
    }),
];

/// Every text of a scene, each with the functions that a pass calls.
fn texts(scene: &Scene) -> Vec<String> {
    let linked = |(calls, parts): (&'static str, Parts)| {
        join(&link(vec![Source::new("a pass", calls)], parts(scene)))
    };
    CALLS.map(linked).to_vec()
}

/// Protects specialisation: a scene's shader names no shape that is not in it.
#[test]
fn only_the_shapes_of_the_scene_are_in_its_text() {
    let corner = Scene::builtin("corner").unwrap();
    for text in texts(&corner) {
        for present in ["Room", "Box"] {
            assert!(text.contains(present), "{present}");
        }
        for absent in ["Plane", "Sphere", "Cylinder", " turn("] {
            assert!(!text.contains(absent), "{absent}");
        }
    }
}

/// Protects the promise that moving things never recompiles a shader.
#[test]
fn moving_and_resizing_leaves_the_text_alone() {
    let scene = Scene::builtin("open-pillars").unwrap();
    let mut moved = scene.clone();
    moved.source.position.x += 1.0;
    moved.listener.radius *= 2.0;
    for surface in &mut moved.surfaces {
        surface.position.z -= 1.0;
    }
    moved.surfaces[1].rotation = Quat::from_rotation_x(0.3);
    let size = Vec3::splat(3.0);
    moved.surfaces[1].shape = Node::Cuboid(Cuboid { size }).into();
    assert_eq!(
        structure(&scene, Lists::Lines),
        structure(&moved, Lists::Lines)
    );
    assert_eq!(texts(&scene), texts(&moved));
    let values = |scene| {
        OriginRebasing::world()
            .apply(scene)
            .uniform_values(Lists::Lines)
    };
    assert_ne!(values(&scene), values(&moved));
}
