//! Skeletons of functions: files under `glsl/template/` with places that a scene fills.
//!
//! A place is a name between two `@`, a sign that GLSL does not have. A place that is alone on its line is filled with
//! whole lines, or with none.

use super::link::Source;

/// The text of a skeleton with its places filled: each name with its text, which is not searched for places again.
///
/// A name without a text, which is a mistake of the caller, stays as it is, and no driver compiles it.
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

    /// Protects the places of skeletons: within a line, and alone on one; texts with the sign of places.
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
