//! The files under `glsl/` that the text of fields calls, each once, callees first.

use super::Assets;
use crate::scene::glsl::named::no_comment;
use crate::scene::glsl::{Source, source};
use crate::scene::{Field, Node, UserField};
use std::borrow::Cow;
use std::fmt::Write;

/// What the fields' values need, and their gradients if these are asked for.
pub(in crate::scene::glsl) fn field_files<'a>(
    fields: impl IntoIterator<Item = &'a Field>,
    gradients: bool,
    assets: &Assets,
) -> Vec<Source> {
    let mut files = Files::default();
    for field in fields {
        for node in field.nodes() {
            files.shape(&node.node, gradients);
            files.operator(node, gradients);
        }
    }
    for (index, user) in assets.users.iter().enumerate() {
        files.user(user, index, gradients);
    }
    files.0
}

#[derive(Default)]
struct Files(Vec<Source>);

impl Files {
    fn take(&mut self, sources: impl IntoIterator<Item = Source>) {
        for source in sources {
            if !self.0.contains(&source) {
                self.0.push(source);
            }
        }
    }

    fn shape(&mut self, node: &Node, gradients: bool) {
        let Some(files) = shape_files(node) else {
            return;
        };
        self.take(files.values);
        if gradients {
            self.take(files.gradients);
        }
    }

    fn operator(&mut self, field: &Field, gradients: bool) {
        let (values, duals) = operator_files(field);
        self.take(values);
        if gradients {
            self.take(duals);
        }
    }

    /// The user's own text, and what calls it.
    fn user(&mut self, user: &UserField, index: usize, gradients: bool) {
        self.take([source!("distance/box.glsl")]);
        if gradients {
            self.take([source!("gradient/box.glsl")]);
        }
        self.0.extend(user_text(user, index));
        let use_of = format!("use of {}, field {index}", shown_name(user));
        let functions = user_functions(index, gradients);
        self.0.push((Cow::Owned(use_of), Cow::Owned(functions)));
    }
}

/// A user's text between what renames its names and what takes that back: its `field` is
/// `user<index>_field` then. The text itself is the second of the three.
pub(in crate::scene::glsl) fn user_text(user: &UserField, index: usize) -> [Source; 3] {
    let mut before = String::new();
    let mut after = String::new();
    for name in user.names() {
        let _ = writeln!(before, "#define {name} user{index}_{name}");
        let _ = writeln!(after, "#undef {name}");
    }
    let shown = shown_name(user);
    let source = |name: String, text: String| (Cow::Owned(name), Cow::Owned(text));
    [
        source(format!("names of {shown}, field {index}"), before),
        source(shown.clone(), user.shader_text()),
        source(format!("end of {shown}, field {index}"), after),
    ]
}

/// The file's name as it may stand in a comment.
fn shown_name(user: &UserField) -> String {
    user.file.display().to_string().replace(no_comment, "?")
}

fn user_functions(index: usize, gradients: bool) -> String {
    let mut text = format!(
        "// The user's field {index}, cut off at its box, and never evaluated beyond.\n\
         float sdUser{index}(vec3 p, vec3 halfSize, float inverseLipschitz) {{\n    \
         float inside = user{index}_field(clamp(p, -halfSize, halfSize)) * inverseLipschitz;\n    \
         return max(inside, sdBox(p, halfSize));\n}}\n"
    );
    if gradients {
        let _ = write!(
            text,
            "\n// Its gradient by differences over a step that follows from the place, whatever the box.\n\
             vec3 differencesOfUser{index}(vec3 p, float h, vec3 halfSize, float inverseLipschitz) {{\n    \
             vec2 e = vec2(h, 0.0);\n    \
             return vec3(\n        \
             sdUser{index}(p + e.xyy, halfSize, inverseLipschitz) - sdUser{index}(p - e.xyy, halfSize, inverseLipschitz),\n        \
             sdUser{index}(p + e.yxy, halfSize, inverseLipschitz) - sdUser{index}(p - e.yxy, halfSize, inverseLipschitz),\n        \
             sdUser{index}(p + e.yyx, halfSize, inverseLipschitz) - sdUser{index}(p - e.yyx, halfSize, inverseLipschitz)) / (2.0 * h);\n}}\n\n\
             // The power of 2 next to the largest coordinate: what the text's own rounding goes by.\n\
             float scaleOfUser{index}(vec3 p, vec3 halfSize) {{\n    \
             return exp2(floor(0.5 + log2(max(largest(p), 9.765625e-4 * largest(halfSize)))));\n}}\n\n\
             // For a march: right next to edges, and to some 1e-4.\n\
             vec4 gdUser{index}(vec3 p, vec3 halfSize, float inverseLipschitz) {{\n    \
             float value = sdUser{index}(p, halfSize, inverseLipschitz);\n    \
             float outside = sdBox(p, halfSize);\n    \
             if (outside >= value) {{\n        \
             return vec4(gradientBox(p, halfSize), outside);\n    }}\n    \
             float h = 9.765625e-4 * scaleOfUser{index}(p, halfSize);\n    \
             return vec4(differencesOfUser{index}(p, h, halfSize, inverseLipschitz), value);\n}}\n\n\
             // For a normal: differences of sixth order over wide steps, whose rounding is some\n\
             // 1e-6, where the surface is smooth so far that near ones tell the same.\n\
             vec4 gnUser{index}(vec3 p, vec3 halfSize, float inverseLipschitz) {{\n    \
             vec4 near = gdUser{index}(p, halfSize, inverseLipschitz);\n    \
             float h = 0.0625 * scaleOfUser{index}(p, halfSize);\n    \
             // Nothing is known beyond the box.\n    \
             h = max(min(h, -sdBox(p, halfSize) / 3.0), 0.03125 * h);\n    \
             vec3 wide = 1.5 * differencesOfUser{index}(p, h, halfSize, inverseLipschitz)\n        \
             - 0.6 * differencesOfUser{index}(p, 2.0 * h, halfSize, inverseLipschitz)\n        \
             + 0.1 * differencesOfUser{index}(p, 3.0 * h, halfSize, inverseLipschitz);\n    \
             return length(wide - near.xyz) < 4.8828125e-4 ? vec4(wide, near.w) : near;\n}}\n"
        );
    }
    text
}

struct ShapeFiles {
    values: Vec<Source>,
    gradients: Vec<Source>,
}

fn shape_files(node: &Node) -> Option<ShapeFiles> {
    let (values, gradients) = match node {
        Node::Plane => (
            vec![source!("distance/plane.glsl")],
            vec![source!("dual/plane.glsl")],
        ),
        Node::HalfSpace { .. } => (
            vec![source!("distance/half_space.glsl")],
            vec![source!("dual/half_space.glsl")],
        ),
        Node::Box { .. } => (
            vec![source!("distance/box.glsl")],
            vec![source!("gradient/box.glsl"), source!("dual/box.glsl")],
        ),
        Node::Room { .. } => (
            vec![source!("distance/room.glsl")],
            vec![source!("dual/room.glsl")],
        ),
        Node::RoundedBox { .. } => (
            vec![
                source!("distance/box.glsl"),
                source!("distance/rounded_box.glsl"),
            ],
            vec![
                source!("gradient/box.glsl"),
                source!("dual/rounded_box.glsl"),
            ],
        ),
        Node::Sphere { .. } => (
            vec![source!("distance/sphere.glsl")],
            vec![source!("dual/sphere.glsl")],
        ),
        Node::Cylinder { .. } => (
            vec![source!("distance/cylinder.glsl")],
            vec![source!("dual/cylinder.glsl")],
        ),
        Node::CappedCylinder { .. } => (
            vec![
                source!("distance/corner.glsl"),
                source!("distance/capped_cylinder.glsl"),
            ],
            vec![
                source!("dual/corner.glsl"),
                source!("dual/capped_cylinder.glsl"),
            ],
        ),
        Node::Capsule { .. } => (
            vec![source!("distance/capsule.glsl")],
            vec![source!("dual/capsule.glsl")],
        ),
        Node::Torus { .. } => (
            vec![source!("distance/torus.glsl")],
            vec![source!("dual/torus.glsl")],
        ),
        Node::Cone { .. } => (
            vec![
                source!("distance/segment.glsl"),
                source!("distance/cone.glsl"),
            ],
            vec![source!("dual/cone.glsl")],
        ),
        Node::Prism { .. } => (
            vec![
                source!("distance/corner.glsl"),
                source!("distance/segment.glsl"),
                source!("distance/prism.glsl"),
            ],
            vec![source!("dual/corner.glsl"), source!("dual/prism.glsl")],
        ),
        Node::HeightField { .. } => (
            vec![
                source!("scene_data.glsl"),
                source!("distance/box.glsl"),
                source!("distance/height_field.glsl"),
            ],
            vec![
                source!("gradient/box.glsl"),
                source!("dual/height_field.glsl"),
            ],
        ),
        _ => return quadric_files(node),
    };
    Some(ShapeFiles { values, gradients })
}

fn quadric_files(node: &Node) -> Option<ShapeFiles> {
    let (value, gradient) = match node {
        Node::Ellipsoid { .. } => (
            source!("distance/ellipsoid.glsl"),
            source!("dual/ellipsoid.glsl"),
        ),
        Node::Paraboloid { .. } => (
            source!("distance/paraboloid.glsl"),
            source!("dual/paraboloid.glsl"),
        ),
        Node::Hyperboloid { .. } => (
            source!("distance/hyperboloid.glsl"),
            source!("dual/hyperboloid.glsl"),
        ),
        Node::Quadric { .. } => (
            source!("distance/quadric.glsl"),
            source!("dual/quadric.glsl"),
        ),
        _ => return None,
    };
    Some(ShapeFiles {
        values: vec![source!("distance/quadric_distance.glsl"), value],
        gradients: vec![source!("dual/quadric_distance.glsl"), gradient],
    })
}

/// For values, and for gradients beside these.
fn operator_files(field: &Field) -> (Vec<Source>, Vec<Source>) {
    let several = field.of.len() > 1;
    match &field.node {
        Node::Union if several => (
            vec![source!("operator/union.glsl")],
            vec![source!("dual/op_union.glsl")],
        ),
        Node::Intersection if several => (
            vec![source!("operator/intersection.glsl")],
            vec![source!("dual/op_intersection.glsl")],
        ),
        Node::Difference => (
            vec![source!("operator/difference.glsl")],
            vec![source!("dual/op_difference.glsl")],
        ),
        Node::SmoothUnion { .. } if several => (
            vec![source!("operator/smooth_union.glsl")],
            vec![source!("dual/op_smooth_union.glsl")],
        ),
        Node::Morph { .. } => (
            vec![source!("operator/morph.glsl")],
            vec![source!("dual/op_morph.glsl")],
        ),
        Node::Shell { .. } => (
            vec![source!("operator/shell.glsl")],
            vec![source!("dual/op_shell.glsl")],
        ),
        Node::Offset { .. } => (
            vec![source!("operator/offset.glsl")],
            vec![source!("dual/op_offset.glsl")],
        ),
        Node::Repeat { .. } => {
            let copies = field.copies().unwrap_or([crate::scene::Copies::Own; 3]);
            let mut files = vec![source!("operator/repeat.glsl")];
            let mut duals = Vec::new();
            if copies.iter().any(|c| c.count() > 1) {
                files.push(source!("operator/union.glsl"));
                duals.push(source!("dual/op_union.glsl"));
            }
            if field.cap().is_some() {
                files.push(source!("operator/repeat_cap.glsl"));
                duals.push(source!("dual/op_repeat_cap.glsl"));
            }
            (files, duals)
        }
        Node::Twist { .. } => (
            vec![
                source!("operator/turning.glsl"),
                source!("operator/twist.glsl"),
            ],
            vec![source!("dual/op_twist.glsl")],
        ),
        Node::Bend { .. } => (
            vec![
                source!("operator/turning.glsl"),
                source!("operator/bend.glsl"),
            ],
            vec![source!("dual/op_bend.glsl")],
        ),
        _ => (Vec::new(), Vec::new()),
    }
}
