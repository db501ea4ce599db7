//! Users' fields as parts of a shader's text.

use crate::kernel::assets::Assets;
use crate::kernel::text::link::parts;
use crate::kernel::text::surface_names::no_comment;
use crate::kernel::text::{Part, Source, source};
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
