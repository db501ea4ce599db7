//! Skeletons of functions: files under `glsl/template/` with placeholders that a scene fills.
//!
//! A placeholder is a name between two `@`, a character that GLSL does not use. A placeholder alone on its line is
//! replaced by whole lines, or by none.

use super::link::Source;

/// The text of a skeleton with its placeholders replaced: each name by its text, in which further placeholders are
/// not replaced.
///
/// A name without a text is a mistake of the caller: it stays in the text, and no driver compiles it.
pub(crate) fn fill(skeleton: &Source, texts: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(skeleton.text.len());
    let mut pieces = skeleton.text.split('@').peekable();
    out.extend(pieces.next());
    while let (Some(name), Some(after)) = (pieces.next(), pieces.next()) {
        let text = texts.iter().find(|(known, _)| *known == name);
        let Some((_, text)) = text else {
            out.extend(["@", name, "@", after]);
            continue;
        };
        let is_alone = (out.is_empty() || out.ends_with('\n')) && after.starts_with('\n');
        out.push_str(text);
        out.push_str(if is_alone { &after[1..] } else { after });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the placeholders of skeletons, within a line and alone on one, and texts that contain
    /// `@`.
    #[test]
    fn places_are_filled_once() {
        let filled = |skeleton: &'static str| {
            let texts = [
                ("a", "1"),
                ("lines", "  x;\n  y;\n"),
                ("none", ""),
                ("sign", "@a@"),
            ];
            fill(&Source::new("test", skeleton), &texts)
        };
        assert_eq!(filled("f(@a@, @a@);\n"), "f(1, 1);\n");
        assert_eq!(filled("{\n@lines@\n}\n"), "{\n  x;\n  y;\n}\n");
        assert_eq!(filled("{\n@none@\n}\n"), "{\n}\n");
        assert_eq!(filled("@lines@\nend"), "  x;\n  y;\nend");
        assert_eq!(filled("@sign@"), "@a@");
        assert_eq!(filled("@unknown@ @a@"), "@unknown@ 1");
    }
}
