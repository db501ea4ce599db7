//! A scene as shader text and uniform values.
//!
//! Only the shapes and operators that occur in the scene are in the text, one evaluation a
//! surface, unrolled. What the shader reads relative to the listener is a uniform, for it
//! changes with every step of the listener: where surfaces and the listener are, and, for
//! they lie in the same vectors and are sealed against each other, the sizes of basic
//! shapes. The numbers of fields are literals, but for those that a driver moves. So the
//! text depends on the [`Structure`] alone, and moving things never compiles a shader
//! again. Three texts can be had, by what a wave needs to know:
//!
//! - [`distance_sources`]: the signed distance to everything (the thesis' march, pictures);
//! - [`ahead_sources`]: the distance to what can be met ahead, and its gradient;
//! - [`closed_form_sources`]: where a line meets each surface, without a march.

mod ahead;
mod closed_form;
mod data;
mod distance;
mod field;
mod fields_ahead;
mod land;
mod placement;
mod source;
mod user;

pub use ahead::{ahead_sources, marches_all_fields};
pub use closed_form::{closed_form_sources, marches_some_fields};
pub use data::{DATA_WIDTH, scene_data};
pub use distance::distance_sources;
pub use placement::{Placed, Placement, uniform_count};
pub(crate) use source::source;
pub use source::{Source, join};
pub(crate) use user::{USER_FILE, user_sources};

use super::{Field, Scene, Shape, Surface};
use placement::value_count;
use std::fmt::Write;

/// What the shader text of a scene depends on: each surface's shape, and whether it
/// has a rotation. Two scenes of one structure share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Structure {
    surfaces: Vec<SurfaceStructure>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct SurfaceStructure {
    name: &'static str,
    has_rotation: bool,
    field: Option<field::Signature>,
}

/// The text's structure; see [`Structure`].
pub fn structure(scene: &Scene) -> Structure {
    let describe = |surface: &Surface| SurfaceStructure {
        name: surface.shape.name(),
        has_rotation: surface.has_rotation(),
        field: surface.shape.field().map(|f| field::signature(surface, f)),
    };
    Structure {
        surfaces: scene.surfaces.iter().map(describe).collect(),
    }
}

/// One surface as the generated text names it.
struct Named<'a> {
    surface: &'a Surface,
    /// Its number, from 1.
    number: usize,
    /// What a comment calls it.
    label: String,
    /// Index of its first value in `uSurfaces`.
    first: usize,
}

/// What must not stand in a comment: GLSL's character set is ASCII, and a backslash would
/// carry the comment on to the next line.
fn no_comment(character: char) -> bool {
    character == '\\' || !(character.is_ascii_graphic() || character == ' ')
}

/// What the text of a scene is written from.
struct Text<'a> {
    scene: &'a Scene,
    named: Vec<Named<'a>>,
    assets: field::Assets,
}

impl<'a> Text<'a> {
    fn new(scene: &'a Scene) -> Text<'a> {
        let mut assets = field::Assets::default();
        for field in scene.surfaces.iter().filter_map(|s| s.shape.field()) {
            assets.add(field);
        }
        Text {
            scene,
            named: named(scene),
            assets,
        }
    }

    fn fields(&self) -> impl Iterator<Item = &'a Field> {
        self.scene.surfaces.iter().filter_map(|s| s.shape.field())
    }

    /// Writes something for each field: its number, what moves, the vector of its first
    /// moving number, the scene's assets.
    fn of_fields(
        &self,
        wanted: impl Fn(&Named) -> bool,
        write: fn(&Field, usize, &[bool], usize, &field::Assets) -> String,
    ) -> String {
        let mut text = String::new();
        for named in self.named.iter().filter(|n| wanted(n)) {
            let Some(field) = named.surface.shape.field() else {
                continue;
            };
            let moving = named.surface.moving_nodes(field);
            let first = named.first + 1 + usize::from(named.surface.has_rotation());
            let _ = writeln!(text, "// {}", named.label);
            text += &write(field, named.number, &moving, first, &self.assets);
        }
        text
    }
}

/// All surfaces in order, with their places in `uSurfaces`.
fn named(scene: &Scene) -> Vec<Named<'_>> {
    let mut first = 0;
    let mut all = Vec::new();
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let label = surface.label(index).replace(no_comment, " ");
        all.push(Named {
            surface,
            number: index + 1,
            label,
            first,
        });
        first += value_count(surface);
    }
    all
}

impl Named<'_> {
    /// A world point in the surface's own axes.
    fn point(&self, p: &str) -> String {
        self.vector(&format!("{p} - uSurfaces[{}].xyz", self.first))
    }

    /// A world direction in the surface's own axes.
    fn vector(&self, v: &str) -> String {
        match self.rotation() {
            Some(index) => format!("turn(uSurfaces[{index}], {v})"),
            None => v.to_owned(),
        }
    }

    /// A direction of the surface's own axes in the world's.
    fn outward(&self, v: &str) -> String {
        match self.rotation() {
            Some(index) => format!("turn(uSurfaces[{index}] * vec4(-1, -1, -1, 1), {v})"),
            None => v.to_owned(),
        }
    }

    /// The value of a field at a world point.
    fn field_value(&self, p: &str) -> String {
        format!("field{}({})", self.number, self.point(p))
    }

    /// The size that the shape's functions take last, with a comma before it.
    fn size(&self) -> String {
        match self.surface.shape {
            Shape::Plane | Shape::Field(_) => String::new(),
            Shape::Box { .. } | Shape::Room { .. } => {
                format!(", uSurfaces[{}].xyz", self.first + 1)
            }
            Shape::Sphere { .. } | Shape::Cylinder { .. } => {
                format!(", uSurfaces[{}].w", self.first)
            }
        }
    }

    /// What rounding may do to the distance to it, in metres.
    fn slack(&self) -> String {
        let first = self.first;
        match self.surface.shape {
            Shape::Plane | Shape::Field(_) => format!("uSurfaces[{first}].w"),
            Shape::Box { .. } | Shape::Room { .. } => format!("uSurfaces[{}].w", first + 1),
            Shape::Sphere { .. } | Shape::Cylinder { .. } => {
                format!("roundSlack(uSurfaces[{first}])")
            }
        }
    }

    fn rotation(&self) -> Option<usize> {
        let place = match self.surface.shape {
            Shape::Field(_) => 1,
            _ => value_count(self.surface) - 1,
        };
        self.surface.has_rotation().then_some(self.first + place)
    }

    fn shape(&self) -> &'static str {
        self.surface.shape.name()
    }
}

/// The file of each basic shape that occurs, once.
fn shape_files(scene: &Scene, file_of: fn(&Shape) -> Option<Source>) -> Vec<Source> {
    let mut files: Vec<Source> = Vec::new();
    for surface in &scene.surfaces {
        add_once(&mut files, file_of(&surface.shape));
    }
    files
}

/// Adds the sources that are not yet there.
fn add_once(files: &mut Vec<Source>, more: impl IntoIterator<Item = Source>) {
    for source in more {
        if !files.contains(&source) {
            files.push(source);
        }
    }
}

/// The rotation's function, where a surface has one.
fn turn_file(scene: &Scene) -> Option<Source> {
    let turns = scene.surfaces.iter().any(Surface::has_rotation);
    turns.then_some(source!("distance/turn.glsl"))
}

/// The declaration of `uSurfaces`.
fn uniforms_text(scene: &Scene) -> String {
    format!("uniform vec4 uSurfaces[{}];\n\n", uniform_count(scene))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    const TEXTS: [fn(&Scene) -> Vec<Source>; 4] = [
        distance_sources,
        |scene| ahead_sources(scene, false),
        |scene| ahead_sources(scene, true),
        closed_form_sources,
    ];

    /// Protects specialisation: a scene's shader names no shape that is not in it.
    #[test]
    fn only_the_shapes_of_the_scene_are_in_its_text() {
        let corner = Scene::builtin("corner").unwrap();
        for text in TEXTS {
            let text = join(&text(&corner));
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
        moved.surfaces[1].shape = Shape::Box {
            size: Vec3::splat(3.0),
        };
        assert_eq!(structure(&scene), structure(&moved));
        for text in TEXTS {
            assert_eq!(join(&text(&scene)), join(&text(&moved)));
        }
        let values = |scene| Placement::world().apply(scene).uniform_values();
        assert_ne!(values(&scene), values(&moved));
    }
}
