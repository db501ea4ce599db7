//! A scene as shader text and uniform values.
//!
//! Only the shapes and operators that occur in the scene are in the text: one evaluation a
//! surface, unrolled, or for many surfaces one a kind. What the shader reads relative to the listener is a uniform, for it
//! changes with every step of the listener: where surfaces and the listener are, and, for
//! they lie in the same vectors and are sealed against each other, the sizes of basic
//! shapes. The numbers of fields are literals, but for those that a driver moves. So the
//! text depends on the [`Structure`] alone, and moving things never compiles a shader
//! again. Three texts can be had, by what a wave needs to know:
//!
//! - [`distance_parts`]: the signed distance to everything (the thesis' march, pictures);
//! - [`ahead_parts`]: the distance to what can be met ahead, and its gradient;
//! - [`closed_form_parts`]: where a line meets each surface, without a march.
//!
//! Of many surfaces only their kinds are in the text (`scene::layout`): they lie in cells,
//! whose lists, like the surfaces' values, are in the scene's data (`data.rs`).

mod ahead;
mod cells;
mod closed_form;
mod data;
mod distance;
mod field;
mod fields_ahead;
mod land;
mod library;
mod link;
mod loops;
mod named;
mod placement;
mod source;
mod user;

pub use ahead::ahead_parts;
pub use closed_form::closed_form_parts;
pub use data::{CellData, DATA_WIDTH, scene_data};
pub use distance::distance_parts;
pub use link::{Part, link};
pub use loops::{Loops, loops};
pub use placement::{Placed, Placement, uniform_count};
#[cfg(glsl_at_run_time)]
pub(crate) use source::read_at_run_time;
pub(crate) use source::source;
pub use source::{Source, join};
pub(crate) use user::{USER_FILE, user_sources};

use super::layout::Layout;
use super::{Scene, Shape, Surface};
use library::library;
use named::Named;
use std::borrow::Cow;

/// What the shader text of a scene depends on: each surface's shape, whether it has a
/// rotation, and of a field what does not move; of surfaces in cells only which kinds there
/// are. Two scenes of one structure share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Structure {
    /// Unrolled surfaces by their index.
    loose: Vec<(usize, SurfaceStructure)>,
    kinds: Vec<SurfaceStructure>,
    /// Where the heights of the images lie, in the order of the text.
    images: Vec<usize>,
}

/// What the text of one surface, or of one kind, depends on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in crate::scene) struct SurfaceStructure {
    name: &'static str,
    has_rotation: bool,
    /// Whether a wave that leaves it passes it over: a driven number may change that.
    convex: bool,
    field: Option<field::Signature>,
}

impl SurfaceStructure {
    fn unrolled(surface: &Surface) -> SurfaceStructure {
        let moving = |field: &Shape| surface.moving_nodes(field);
        SurfaceStructure::new(surface, moving)
    }

    /// Of a surface whose numbers are all data.
    pub fn as_data(surface: &Surface) -> SurfaceStructure {
        SurfaceStructure::new(surface, |field| vec![true; field.nodes().len()])
    }

    fn new(surface: &Surface, moving: impl Fn(&Shape) -> Vec<bool>) -> SurfaceStructure {
        let field = surface.shape.field();
        SurfaceStructure {
            name: surface.shape.name(),
            has_rotation: surface.has_rotation(),
            convex: surface.shape.is_convex(),
            field: field.map(|field| field::signature(field, &moving(field))),
        }
    }
}

/// The text's structure; see [`Structure`].
pub fn structure(scene: &Scene) -> Structure {
    let layout = Layout::of(scene);
    let unrolled = |&index: &usize| (index, SurfaceStructure::unrolled(&scene.surfaces[index]));
    let as_data = |&index: &usize| SurfaceStructure::as_data(&scene.surfaces[index]);
    Structure {
        loose: layout.loose.iter().map(unrolled).collect(),
        kinds: layout.kinds.iter().map(as_data).collect(),
        images: field::Assets::of(scene).places(&layout, scene),
    }
}

/// Whether a march must take fields: all of them, or those alone that have no closed form.
pub fn marches_fields(scene: &Scene, all: bool) -> bool {
    let mut fields = scene.surfaces.iter().filter_map(|s| s.shape.field());
    fields.any(|field| all || !field::has_closed_form(field))
}

/// Whether every profile has to march to a surface: a field without a closed form.
pub fn is_marched(surface: &Surface) -> bool {
    let field = surface.shape.field();
    field.is_some_and(|field| !field::has_closed_form(field))
}

/// Whether surfaces of the scene lie in cells.
pub fn has_cells(scene: &Scene) -> bool {
    Layout::of(scene).has_cells()
}

/// What the text of a scene is written from.
struct Text<'a> {
    /// Unrolled surfaces.
    loose: Vec<Named<'a>>,
    /// Kinds of the surfaces in cells.
    kinds: Vec<Named<'a>>,
    assets: field::Assets,
}

impl<'a> Text<'a> {
    fn new(scene: &'a Scene) -> Text<'a> {
        let layout = Layout::of(scene);
        let mut first = 0;
        let mut loose = Vec::new();
        for &index in &layout.loose {
            let named = Named::surface(scene, index, first);
            first += named.value_count();
            loose.push(named);
        }
        let kinds = layout.kinds.iter().enumerate();
        Text {
            loose,
            kinds: kinds
                .map(|(kind, &index)| Named::kind(scene, index, kind))
                .collect(),
            assets: field::Assets::of(scene),
        }
    }

    /// Every surface and kind that the text has lines for.
    fn all(&self) -> impl Iterator<Item = &Named<'a>> {
        self.loose.iter().chain(&self.kinds)
    }

    /// What every text may call: the library, the users' fields, the values of the surfaces.
    fn parts(&self) -> Vec<Part> {
        let mut parts = library();
        parts.extend(field::user_parts(&self.assets));
        self.add(&mut parts, "the values of the surfaces", self.uniforms());
        parts
    }

    /// Adds functions written for the scene.
    fn add(&self, parts: &mut Vec<Part>, name: &'static str, text: impl Into<Cow<'static, str>>) {
        parts.extend(link::parts(Source::new(name, text)));
    }

    /// Adds a function of each field that is wanted.
    fn add_fields(
        &self,
        parts: &mut Vec<Part>,
        wanted: impl Fn(&Named) -> bool,
        write: field::Write,
    ) {
        let wanted = self.all().filter(|named| wanted(named));
        let text: String = wanted
            .map(|named| named.field_functions(write, &self.assets))
            .collect();
        self.add(parts, "the surfaces", text);
    }

    /// The declaration of `uSurfaces`.
    fn uniforms(&self) -> String {
        let count: usize = self.loose.iter().map(|named| named.value_count()).sum();
        match count {
            0 => String::new(),
            count => format!("uniform vec4 uSurfaces[{count}];\n\n"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Node;
    use crate::scene::shape::Cuboid;
    use glam::{Quat, Vec3};

    type Parts = fn(&Scene) -> Vec<Part>;

    /// What a pass calls, and where from.
    const CALLS: [(&str, Parts); 4] = [
        ("distanceFunction()", distance_parts),
        ("distanceAhead() gradientAhead() land()", |scene| {
            ahead_parts(scene, false)
        }),
        ("distanceAhead() surfaceDistance() land()", |scene| {
            ahead_parts(scene, true)
        }),
        ("nearestHit() land()", closed_form_parts),
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
        let values = |scene| Placement::world().apply(scene).uniform_values();
        assert_ne!(values(&scene), values(&moved));
    }
}
