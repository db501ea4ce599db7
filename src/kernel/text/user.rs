//! A user's field by itself: to be compiled, and sampled, before it is part of a scene.

use super::field::user_text;
use super::shader_source::Source;
use super::shader_source::source;
use crate::scene::UserField;

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
