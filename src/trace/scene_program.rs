//! Programs that contain a scene: an error in a user's text is that of the user's file.

use super::TraceError;
use crate::error::Error;
use crate::gpu::{Context, GpuError, Program, log_errors};
use crate::kernel;
use crate::scene::{Scene, UserField};
use std::sync::Arc;

/// Compiles a program around the surfaces of a scene.
///
/// # Errors
/// [`TraceError::FieldDoesNotCompile`] where it does not compile and has a user's text in it,
/// which compiled alone; else what the driver reports.
pub fn compile(
    context: &Context,
    scene: &Scene,
    label: &str,
    text: &str,
) -> Result<Program, Error> {
    match Program::fragment(context, label, text) {
        Err(GpuError::Compile { stage, label, log }) => match of_field(scene, text, &log) {
            Some(error) => Err(error.into()),
            None => Err(GpuError::Compile { stage, label, log }.into()),
        },
        Err(GpuError::Link { label, log }) => match of_field(scene, text, &log) {
            Some(error) => Err(error.into()),
            None => Err(GpuError::Link { label, log }.into()),
        },
        other => Ok(other?),
    }
}

/// The first error of a log as one of a user's field, if the scene has one that is not the
/// program's own.
fn of_field(scene: &Scene, text: &str, log: &str) -> Option<TraceError> {
    let fields: Vec<&Arc<UserField>> = scene.user_fields().filter(|f| !f.is_own()).collect();
    let errors = log_errors(log);
    let refused = |field: &UserField, line, message| TraceError::FieldDoesNotCompile {
        file: field.file.display().to_string(),
        line,
        message,
    };
    for error in &errors {
        let name = kernel::file_name(text, error.file);
        let is_in = |field: &&&Arc<UserField>| name == Some(kernel::shown_name(field).as_str());
        if let Some(field) = fields.iter().find(is_in) {
            let message = without_prefixes(&error.message);
            return Some(refused(field, Some(error.line), message));
        }
    }
    let message = match errors.first() {
        Some(error) => without_prefixes(&error.message),
        None => first_line(log),
    };
    let field = fields.first()?;
    let why = format!("compiles alone, and not in the scene's shader: {message}");
    Some(refused(field, None, why))
}

/// The first line of a log that says something.
pub(super) fn first_line(log: &str) -> String {
    let line = log.lines().find(|line| !line.trim().is_empty());
    without_prefixes(line.unwrap_or("the driver does not say why").trim())
}

/// A driver's message with the names that the user's text has: without what renames them.
pub(super) fn without_prefixes(message: &str) -> String {
    let mut plain = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(start) = rest.find("user") {
        let (before, from) = rest.split_at(start);
        plain.push_str(before);
        let is_word = before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
        match prefix_length(from).filter(|_| !is_word) {
            Some(length) => {
                let name = &from[length..];
                let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let end = name.find(|c| !is_of_name(c)).unwrap_or(name.len());
                plain.push_str(&name[..end]);
                rest = &name[end..];
            }
            None => {
                plain.push_str("user");
                rest = &from["user".len()..];
            }
        }
    }
    plain + rest
}

/// Bytes of the `user<number>_` that a text begins with; of `users<number>_`, which stands before
/// names that begin with `_`, without the underscore, which is the name's own.
fn prefix_length(text: &str) -> Option<usize> {
    let after = text.strip_prefix("user")?;
    let number = after.strip_prefix('s').unwrap_or(after);
    let name = number.trim_start_matches(|c: char| c.is_ascii_digit());
    if name.len() == number.len() || !name.starts_with('_') {
        return None;
    }
    let of_name = if number.len() == after.len() { 1 } else { 0 };
    Some(text.len() - name.len() + of_name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Surface;
    use crate::scene::shape::User;
    use glam::Vec3;

    fn scene_with(text: &str) -> Scene {
        let field = UserField::new("my.glsl", text.to_owned(), Vec3::ONE, 1.0);
        let shape = User {
            field: Arc::new(field),
        };
        let mut scene = Scene::load("corner").unwrap();
        scene.surfaces.push(Surface::new(shape));
        scene
    }

    /// Protects people from a driver's log: what it says of a text in the whole shader is one
    /// sentence with their file, their line and their names.
    #[test]
    fn an_error_in_the_whole_shader_is_that_of_the_field() {
        let text = "float _a;\nfloat field(vec3 p) { return p.x + _a; }\n";
        let scene = scene_with(text);
        let shader = super::super::shader_text(
            &scene,
            &crate::Settings::default(),
            crate::trace::Pass::March,
        );
        let number = (1..999).find(|n| kernel::file_name(&shader, *n) == Some("my.glsl"));
        let number = number.unwrap();
        for (log, expected) in [
            (
                format!(
                    "1:5(2): warning: odd\n{number}:2(9): error: `user0_field' and `users0_a' differ\nmore"
                ),
                "my.glsl:2: 'field' and '_a' differ",
            ),
            (
                format!("ERROR: {number}:1: 'user0_b' : redefinition\n"),
                "my.glsl:1: 'b' : redefinition",
            ),
            (
                "1:7(3): error: no function with name 'min'\nmore\n".to_owned(),
                "my.glsl: compiles alone, and not in the scene's shader: no function with name 'min'",
            ),
            (
                "\nout of registers\nmore\n".to_owned(),
                "my.glsl: compiles alone, and not in the scene's shader: out of registers",
            ),
        ] {
            let error = of_field(&scene, &shader, &log).unwrap();
            assert_eq!(error.to_string(), expected);
        }
        let own = Scene::load("menger").unwrap();
        assert!(of_field(&own, &shader, "1:1(1): error: bad").is_none());
    }

    /// Protects the names in messages: only what the program has put before them is taken off.
    #[test]
    fn only_prefixes_are_taken_off() {
        for (message, expected) in [
            ("'user0_a', user12_b users3_c", "'a', b _c"),
            (
                "user_a users user0 my_user0_a",
                "user_a users user0 my_user0_a",
            ),
            ("user0_user0_a", "user0_a"),
        ] {
            assert_eq!(without_prefixes(message), expected);
        }
    }
}
