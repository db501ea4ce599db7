//! Tests of the shader texts of scenes, and comparisons of the shaders with the CPU.

mod distance_functions;
mod driver_functions;
mod field_shaders;
mod lines;

use super::origin_rebasing::OriginRebasing;
use super::text::{
    ListenerText, Part, Text, closed_form_parts, directed_parts, distance_parts, is_marched, link,
};
use super::{Lists, Source, Structure, join};
use crate::scene::shape::Cuboid;
use crate::scene::{Node, Scene};
use glam::{Quat, Vec3, Vec4};

type Parts = fn(&Text) -> Vec<Part>;

/// For each pass, the functions that it calls, the lists of cells that it reads, and the parts that it links.
const CALLS: [(&str, Lists, Parts); 3] = [
    (
        "distanceFunction()",
        Lists::NearestCandidates,
        distance_parts,
    ),
    (
        "directedDistance() directedGradient() reflectWave()",
        Lists::Overlapping,
        |text| directed_parts(text, ListenerText::Solid),
    ),
    ("closestHit() reflectWave()", Lists::Lines, |text| {
        closed_form_parts(text, ListenerText::Solid)
    }),
];

/// The parts of the shader text of a scene.
fn parts_of(scene: &Scene, lists: Lists, parts: Parts) -> Vec<Part> {
    parts(&Text::new(scene, &Structure::of(scene, lists)))
}

/// Whether `hybrid` marches to a surface of a scene.
fn has_marched_fields(scene: &Scene) -> bool {
    scene.surfaces.iter().any(is_marched)
}

/// The values of `uSurfaces` in world coordinates.
fn world_values(scene: &Scene, lists: Lists) -> Vec<Vec4> {
    let rebased = OriginRebasing::world().apply(scene);
    rebased.uniform_values(&Structure::of(scene, lists).layout)
}

/// Every text of a scene, each with the functions that a pass calls.
fn texts(scene: &Scene) -> Vec<String> {
    let linked = |(calls, lists, parts): (&'static str, Lists, Parts)| {
        let parts = parts_of(scene, lists, parts);
        join(&link(vec![Source::new("a pass", calls)], parts))
    };
    CALLS.map(linked).to_vec()
}

/// Protects specialisation: the shader of a scene contains no shape that the scene lacks.
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

/// Protects programs: moving objects never recompiles a shader.
#[test]
fn moving_and_resizing_leaves_the_text_alone() {
    let scene = Scene::builtin("open-pillars").unwrap();
    let mut moved = scene.clone();
    moved.sources[0].position.x += 1.0;
    moved.listeners[0].radius *= 2.0;
    for surface in &mut moved.surfaces {
        surface.position.z -= 1.0;
    }
    moved.surfaces[1].rotation = Quat::from_rotation_x(0.3);
    let size = Vec3::splat(3.0);
    moved.surfaces[1].shape = Node::Cuboid(Cuboid { size }).into();
    assert_eq!(
        Structure::of(&scene, Lists::Lines).key,
        Structure::of(&moved, Lists::Lines).key
    );
    assert_eq!(texts(&scene), texts(&moved));
    let values = |scene| world_values(scene, Lists::Lines);
    assert_ne!(values(&scene), values(&moved));
}
