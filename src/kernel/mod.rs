//! What the GPU is told: from a scene and settings to shader text, data and key.
//!
//! | it takes | it gives | where |
//! | --- | --- | --- |
//! | the structure of a scene: shapes, operators, what moves | the text of a distance, of a march or of closed forms | `text` |
//! | and the algorithm | the text of a whole pass, and the key of its program | `passes`, `structure` |
//! | the numbers of a scene, and its listener | uniforms, relative to the listener, with covered faces extended | `rebasing`, `values`, `extend` |
//! | height images, and many surfaces | the data that shaders read by index, with cells and their lists | `data`, `cells`, `layout` |
//! | | turns of the loops in the text | `loops` |
//!
//! It knows no OpenGL: [`crate::trace`] compiles the texts and sends the numbers.
//!
//! What the shader reads relative to the listener is a uniform, for it changes with every step
//! of the listener: where surfaces and the listener are, and, for they lie in the same vectors
//! and are extended into each other, the sizes of basic shapes. The numbers of fields are
//! literals, but for those that a driver moves. So the text depends on the [`Structure`] alone,
//! and moving things never compiles a shader again.
//!
//! Of many surfaces only their kinds are in the text (`layout`): they lie in cells, whose
//! lists, like the surfaces' values, are in the scene's data.

mod assets;
mod cells;
mod check;
mod data;
mod extend;
mod layout;
mod loops;
mod passes;
mod rebasing;
mod record;
mod signature;
mod structure;
mod text;
mod values;

pub(crate) use cells::{Lists, SceneCells};
pub(crate) use check::check;
pub(crate) use data::CellData;
pub use data::{DATA_WIDTH, scene_data};
pub(crate) use layout::Layout;
pub(crate) use loops::{Loops, loops};
#[cfg(feature = "experiment")]
pub(crate) use passes::is_marched;
pub(crate) use passes::{
    AlgorithmText, Key, MarchText, initialise_text, march_text, pan_text, sum_contributions_text,
    sum_text,
};
pub use passes::{Directions, marches_fields};
pub use rebasing::{OriginRebasing, RebasedScene};
pub use structure::{Structure, structure};
#[cfg(glsl_at_run_time)]
pub(crate) use text::read_at_run_time;
#[cfg(feature = "picture")]
pub(crate) use text::source;
pub use text::{Part, Source, closed_form_parts, directed_parts, distance_parts, join, link};
pub(crate) use text::{USER_FILE, user_sources};
pub use values::uniform_count;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Cuboid;
    use crate::scene::{Node, Scene};
    use glam::{Quat, Vec3};

    type Parts = fn(&Scene) -> Vec<Part>;

    /// What a pass calls, and where from.
    const CALLS: [(&str, Parts); 4] = [
        ("distanceFunction()", distance_parts),
        ("directedDistance() directedGradient() project()", |scene| {
            directed_parts(scene, false)
        }),
        ("directedDistance() surfaceDistance() project()", |scene| {
            directed_parts(scene, true)
        }),
        ("closestHit() project()", closed_form_parts),
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

    /// Protects the promise that moving things never compiles a shader again.
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
        assert_eq!(structure(&scene), structure(&moved));
        assert_eq!(texts(&scene), texts(&moved));
        let values = |scene| OriginRebasing::world().apply(scene).uniform_values();
        assert_ne!(values(&scene), values(&moved));
    }
}
