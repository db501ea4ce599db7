//! Users' fields as parts of a shader's text, and each by itself: to be compiled, and sampled, before it
//! is part of a scene.

use crate::kernel::structure::Assets;
use crate::kernel::text::link::{Part, Source, parts, source};
use crate::kernel::text::surface_names::no_comment;
use crate::scene::UserField;
use std::fmt::Write;

/// The users' own texts, and the functions that call them.
pub(in crate::kernel) fn user_parts(assets: &Assets) -> Vec<Part> {
    let mut all = Vec::new();
    for (index, user) in assets.users.iter().enumerate() {
        all.push(Part {
            sources: Vec::from(user_text(user, index)),
            defines: ["field", "fieldGradient"]
                .map(|name| format!("user{index}_{name}("))
                .to_vec(),
            // It has nothing but what is its own.
            uses: Vec::new(),
        });
        all.extend(user_functions(user, index).into_iter().flat_map(parts));
    }
    all
}

/// A user's text between what renames its names and what takes that back: its `field` is
/// `user<index>_field` then. The text itself is the second of the three.
pub(in crate::kernel) fn user_text(user: &UserField, index: usize) -> [Source; 3] {
    let mut before = String::new();
    let mut after = String::new();
    for name in user.names() {
        let _ = writeln!(before, "#define {name} {}", name_in_shader(index, &name));
        let _ = writeln!(after, "#undef {name}");
    }
    let shown = shown_name(user);
    [
        Source::new(format!("names of {shown}, field {index}"), before),
        Source::new(shown.clone(), user.shader_text()),
        Source::new(format!("end of {shown}, field {index}"), after),
    ]
}

/// What a name of a user's text is called in the shader. GLSL reserves two underscores in a row.
fn name_in_shader(index: usize, name: &str) -> String {
    match name.starts_with('_') {
        true => format!("users{index}{name}"),
        false => format!("user{index}_{name}"),
    }
}

/// The file's name as it may stand in a comment.
pub(crate) fn shown_name(user: &UserField) -> String {
    user.file.display().to_string().replace(no_comment, "?")
}

/// The functions that call the text of a user's field, in the files called `User0`.
fn user_functions(user: &UserField, index: usize) -> Vec<Source> {
    let gradient = match user.states_gradient() {
        true => source!("user/gradient.glsl"),
        false => source!("user/differences.glsl"),
    };
    let numbered = |source: Source| {
        let text = source.text.replace("User0", &format!("User{index}"));
        let text = text.replace("user0_", &format!("user{index}_"));
        let name = format!("{}, field {index}", source.name);
        Source::new(name, text)
    };
    [source!("user/value.glsl"), gradient]
        .map(numbered)
        .to_vec()
}

/// The number by which a driver's messages name the user's own text in [`user_sources`].
pub(crate) const USER_FILE: u32 = 2;

/// A fragment shader with the field alone: its values, and the gradients that it states, at the
/// points in `uPoints`.
pub(crate) fn user_sources(user: &UserField) -> Vec<Source> {
    let mut sources = Vec::from(user_text(user, 0));
    let stated = match user.states_gradient() {
        true => "user0_fieldGradient(p)",
        false => "vec3(0.0)",
    };
    let function = format!("vec3 statedGradient(vec3 p) {{\n    return {stated};\n}}\n");
    sources.push(Source::new("the stated gradient", function));
    sources.push(source!("user/check.frag"));
    sources
}
