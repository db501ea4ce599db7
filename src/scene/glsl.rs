//! A scene as shader text and uniform values.
//!
//! Only the shapes that occur in the scene are in the text, one evaluation a
//! surface, unrolled. Every number (positions, sizes, rotations, the listener) is
//! a uniform, so the text depends on the [`Structure`] alone: moving things never
//! compiles a shader again.

use super::{Scene, Shape, Surface};
use glam::{Quat, Vec3, Vec4};
use std::borrow::Cow;
use std::fmt::Write;

/// One piece of shader text: the file it stands in, and the text itself.
pub type Source = (&'static str, Cow<'static, str>);

/// A [`Source`] out of a file under `glsl/`.
macro_rules! source {
    ($file:literal) => {
        (
            concat!("glsl/", $file),
            std::borrow::Cow::Borrowed(include_str!(concat!("../../glsl/", $file))),
        )
    };
}
pub(crate) use source;

/// What the shader text of a scene depends on: each surface's shape, and whether it
/// has a rotation. Two scenes of one structure share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Structure {
    surfaces: Vec<(&'static str, bool)>,
}

/// The distance functions of `scene` as GLSL: `surfaceDistance(p, object)` over the
/// surfaces and `distanceFunction(p, object)` over surfaces and listener.
pub fn distance_sources(scene: &Scene) -> Vec<Source> {
    let mut sources = shape_files(scene);
    sources.push(source!("distance/listener.glsl"));
    sources.push(("the scene", Cow::Owned(scene_text(scene))));
    sources
}

/// The text's structure; see [`Structure`].
pub fn structure(scene: &Scene) -> Structure {
    let describe = |surface: &Surface| (surface.shape.name(), surface.has_rotation());
    Structure {
        surfaces: scene.surfaces.iter().map(describe).collect(),
    }
}

/// The values of `uSurfaces`: for each surface its position (and radius), then its
/// half size if it has one, then the inverse of its rotation if it has one.
pub fn uniform_values(scene: &Scene) -> Vec<Vec4> {
    scene.surfaces.iter().flat_map(surface_values).collect()
}

/// Joins sources to one text, each numbered by `#line` as the driver's messages
/// will name it: the n-th source is file n, counted from 1.
pub fn join(sources: &[Source]) -> String {
    let mut text = String::new();
    for (index, (name, part)) in sources.iter().enumerate() {
        let number = index + 1;
        // Writing to a String cannot fail.
        let _ = write!(text, "// {number}: {name}\n#line 1 {number}\n{part}\n");
    }
    text
}

fn shape_files(scene: &Scene) -> Vec<Source> {
    let mut files: Vec<Source> = Vec::new();
    for surface in &scene.surfaces {
        let file = shape_file(&surface.shape);
        if !files.contains(&file) {
            files.push(file);
        }
    }
    if scene.surfaces.iter().any(Surface::has_rotation) {
        files.push(source!("distance/turn.glsl"));
    }
    files
}

fn shape_file(shape: &Shape) -> Source {
    match shape {
        Shape::Plane => source!("distance/plane.glsl"),
        Shape::Box { .. } => source!("distance/box.glsl"),
        Shape::Room { .. } => source!("distance/room.glsl"),
        Shape::Sphere { .. } => source!("distance/sphere.glsl"),
        Shape::Cylinder { .. } => source!("distance/cylinder.glsl"),
    }
}

fn scene_text(scene: &Scene) -> String {
    let mut text = String::new();
    let length = uniform_values(scene).len();
    let _ = writeln!(text, "uniform vec4 uSurfaces[{length}];\n");
    text.push_str("// Signed distance to the nearest surface, and its number from 1.\n");
    text.push_str("float surfaceDistance(vec3 p, out float object) {\n");
    let mut next = 0;
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let call = surface_call(surface, next);
        let label = surface.label(index).replace(['\n', '\r', '\\'], " ");
        let number = index + 1;
        if index == 0 {
            let _ = writeln!(
                text,
                "    // {label}\n    float nearest = {call};\n    object = 1.0;"
            );
            if scene.surfaces.len() > 1 {
                text.push_str("    float candidate;\n");
            }
        } else {
            let _ = writeln!(text, "    // {label}\n    candidate = {call};");
            let _ = writeln!(
                text,
                "    if (candidate < nearest) {{ nearest = candidate; object = {number}.0; }}"
            );
        }
        next += surface_values(surface).len();
    }
    text.push_str("    return nearest;\n}\n\n");
    text.push_str(DISTANCE_FUNCTION);
    text
}

/// The thesis' `distanceFunction`: the listener is an object too, number 0.
const DISTANCE_FUNCTION: &str = "\
// Signed distance to the nearest surface or to the listener, whose number is 0.
float distanceFunction(vec3 p, out float object) {
    float nearest = surfaceDistance(p, object);
    float listener = listenerDistance(p);
    if (listener <= nearest) { nearest = listener; object = 0.0; }
    return nearest;
}
";

fn surface_call(surface: &Surface, first: usize) -> String {
    let mut p = format!("p - uSurfaces[{first}].xyz");
    if surface.has_rotation() {
        let last = first + surface_values(surface).len() - 1;
        p = format!("turn(uSurfaces[{last}], {p})");
    }
    let second = first + 1;
    match surface.shape {
        Shape::Plane => format!("sdPlane({p})"),
        Shape::Box { .. } => format!("sdBox({p}, uSurfaces[{second}].xyz)"),
        Shape::Room { .. } => format!("sdRoom({p}, uSurfaces[{second}].xyz)"),
        Shape::Sphere { .. } => format!("sdSphere({p}, uSurfaces[{first}].w)"),
        Shape::Cylinder { .. } => format!("sdCylinder({p}, uSurfaces[{first}].w)"),
    }
}

fn surface_values(surface: &Surface) -> Vec<Vec4> {
    let place = |w: f32| surface.position.extend(w);
    let half = |size: Vec3| (size * 0.5).extend(0.0);
    let mut values = match surface.shape {
        Shape::Plane => vec![place(0.0)],
        Shape::Box { size } | Shape::Room { size } => vec![place(0.0), half(size)],
        Shape::Sphere { radius } | Shape::Cylinder { radius } => vec![place(radius)],
    };
    if surface.has_rotation() {
        values.push(inverse(surface.rotation));
    }
    values
}

fn inverse(rotation: Quat) -> Vec4 {
    Vec4::from(rotation.conjugate())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(scene: &Scene) -> String {
        join(&distance_sources(scene))
    }

    /// Protects specialisation: a scene's shader names no shape that is not in it.
    #[test]
    fn only_the_shapes_of_the_scene_are_in_its_text() {
        let text = text(&Scene::builtin("corner").unwrap());
        for present in ["sdRoom", "sdBox"] {
            assert!(text.contains(present), "{present}");
        }
        for absent in ["sdPlane", "sdSphere", "sdCylinder", " turn("] {
            assert!(!text.contains(absent), "{absent}");
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
        assert_eq!(text(&scene), text(&moved));
        assert_ne!(uniform_values(&scene), uniform_values(&moved));
    }
}
