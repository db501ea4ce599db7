//! Pieces of shader text and where they come from.

use std::borrow::Cow;
use std::fmt::Write;

/// One piece of shader text: the file it stands in, and the text itself.
pub type Source = (Cow<'static, str>, Cow<'static, str>);

/// A [`Source`] out of a file under `glsl/`.
macro_rules! source {
    ($file:literal) => {
        (
            std::borrow::Cow::Borrowed(concat!("glsl/", $file)),
            std::borrow::Cow::Borrowed(include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/glsl/",
                $file
            ))),
        )
    };
}
pub(crate) use source;

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

/// The sources without what nothing calls: whole files of distances (of a field with a closed
/// form the gradient is needed, and not always the value), and single functions of the bounds
/// along lines.
pub(super) fn without_uncalled(sources: Vec<Source>) -> Vec<Source> {
    without_uncalled_bounds(without_uncalled_files(sources))
}

fn without_uncalled_files(mut sources: Vec<Source>) -> Vec<Source> {
    loop {
        let uncalled = sources.iter().position(|(name, text)| {
            let others = || sources.iter().filter(|(other, _)| other != name);
            // What declares a uniform is needed for that.
            name.starts_with("glsl/distance/")
                && !text.contains("uniform ")
                && functions(text).all(|f| others().all(|(_, text)| !calls(text, f)))
        });
        match uncalled {
            Some(index) => sources.remove(index),
            None => return sources,
        };
    }
}

/// Leaves out the functions of `glsl/along/` that nothing after them calls; there each stands in
/// a paragraph of its own, after those that it calls.
pub(super) fn without_uncalled_bounds(sources: Vec<Source>) -> Vec<Source> {
    let mut after = String::new();
    let mut kept = Vec::new();
    for (name, text) in sources.into_iter().rev() {
        if !name.starts_with("glsl/along/") {
            after.push_str(&text);
            kept.push((name, text));
            continue;
        }
        let mut paragraphs = Vec::new();
        for paragraph in text.trim_end().rsplit("\n\n") {
            let mut defined = functions(paragraph).peekable();
            if defined.peek().is_none() || defined.any(|f| calls(&after, f)) {
                after.push_str(paragraph);
                paragraphs.push(paragraph);
            }
        }
        paragraphs.reverse();
        let text = paragraphs.join("\n\n") + "\n";
        if functions(&text).next().is_some() {
            kept.push((name, Cow::Owned(text)));
        }
    }
    kept.reverse();
    kept
}

/// Names of the functions that a file defines: at the start of a line, a type and a name.
fn functions(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| {
        let head = line.split_once('(')?.0;
        let (kind, name) = head.split_once(' ')?;
        let is_type = ["float", "vec2", "vec3", "vec4", "bool", "void"].contains(&kind);
        (is_type && !name.contains(' ')).then_some(name)
    })
}

fn calls(text: &str, function: &str) -> bool {
    text.match_indices(function).any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let is_word = before.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_');
        !is_word && text[at + function.len()..].starts_with('(')
    })
}
