//! A light reading of users' GLSL: what it defines, and what cannot stand in a shader.

/// The text as it may stand within a shader, line for line.
///
/// A `#version` line belongs at a shader's beginning, and a `precision` line would change
/// that of all that follows: both are blanked. GLSL is ASCII; other characters, which people
/// write in comments, become question marks.
pub(super) fn within_a_shader(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut out = String::new();
    for line in text.lines() {
        let start = line.trim_start();
        let directive = start.strip_prefix('#').map(str::trim_start);
        let of_the_whole = directive.is_some_and(|d| d.starts_with("version"))
            || (start.starts_with("precision ") && start.trim_end().ends_with(';'));
        if !of_the_whole {
            out.extend(line.chars().map(|c| if c.is_ascii() { c } else { '?' }));
        }
        out.push('\n');
    }
    out
}

/// What is wrong with a text, and in which line (from 1) if it is in one.
pub(super) fn check(text: &str) -> Result<(), (Option<u32>, String)> {
    let code = without_comments(text);
    let mut depth = 0;
    for (index, line) in code.lines().enumerate() {
        let first = tokens(line).into_iter().next().unwrap_or_default();
        if depth == 0 && matches!(first.as_str(), "uniform" | "in" | "out" | "varying") {
            let why = format!(
                "there is nothing that would set this '{first}': a field has its point alone"
            );
            return Err((Some(index as u32 + 1), why));
        }
        let count = |brackets: [char; 2]| line.matches(brackets).count() as i32;
        depth += count(['{', '(']) - count(['}', ')']);
    }
    let tokens = tokens(&code);
    let is_field = |at: usize| {
        let mut inside = tokens[at..].iter().map(String::as_str);
        let opens = inside.next() == Some("float")
            && inside.next() == Some("field")
            && inside.next() == Some("(");
        let kind =
            inside.find(|word| !matches!(*word, "const" | "in" | "highp" | "mediump" | "lowp"));
        opens && kind == Some("vec3")
    };
    if (0..tokens.len()).any(is_field) {
        return Ok(());
    }
    let why = "there is no `float field(vec3 p)` in it, which is what a field is".to_owned();
    Err((None, why))
}

/// Whether a text loops.
pub(super) fn has_loops(text: &str) -> bool {
    let words = tokens(&without_comments(text));
    words
        .iter()
        .any(|word| matches!(word.as_str(), "for" | "while" | "do"))
}

/// Whether a piece of text is one GLSL identifier.
fn is_identifier(word: &str) -> bool {
    let mut characters = word.chars();
    let starts = characters
        .next()
        .is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    starts && characters.all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Names of functions, structures, constants and macros at the outermost level.
///
/// A light reading, not a parser: comments are passed over; outside of braces and
/// parentheses, a word that follows a word and is followed by `(`, `=`, `;`, `[`, `,` or
/// `{` is a definition.
pub(super) fn global_names(text: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut keep = |name: &str| {
        if is_identifier(name) && !names.iter().any(|n| n == name) {
            names.push(name.to_owned());
        }
    };
    let mut code = String::new();
    for line in without_comments(text).lines() {
        let Some(directive) = line.trim_start().strip_prefix('#') else {
            code.push_str(line);
            code.push('\n');
            continue;
        };
        if let Some(macro_name) = directive.trim_start().strip_prefix("define") {
            let word: String = macro_name
                .trim_start()
                .chars()
                .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                .collect();
            keep(&word);
        }
    }
    let mut depth = 0i32;
    let mut before = String::new();
    let tokens = tokens(&code);
    for (index, token) in tokens.iter().enumerate() {
        match token.as_str() {
            "{" | "(" => depth += 1,
            "}" | ")" => depth -= 1,
            word if depth == 0 && is_identifier(word) => {
                let next = tokens.get(index + 1).map_or("", String::as_str);
                let after_type = is_identifier(&before) && before != "return";
                if after_type && matches!(next, "(" | "=" | ";" | "[" | "," | "{") {
                    keep(word);
                }
            }
            _ => (),
        }
        before.clone_from(token);
    }
    names
}

fn tokens(code: &str) -> Vec<String> {
    let mut all = Vec::new();
    let mut word = String::new();
    for character in code.chars() {
        if character.is_ascii_alphanumeric() || character == '_' || character == '.' {
            word.push(character);
            continue;
        }
        if !word.is_empty() {
            all.push(std::mem::take(&mut word));
        }
        if !character.is_whitespace() {
            all.push(character.to_string());
        }
    }
    all.push(word);
    all
}

/// The text without comments, line breaks kept.
fn without_comments(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("//").into_iter().chain(rest.find("/*")).min() {
        out.push_str(&rest[..start]);
        let is_line = rest[start..].starts_with("//");
        let end = if is_line { "\n" } else { "*/" };
        let body = &rest[start + 2..];
        let length = body.find(end).map_or(body.len(), |at| at);
        out.extend(body[..length].chars().filter(|c| *c == '\n'));
        rest = &body[length..];
        if !is_line {
            rest = rest.strip_prefix("*/").unwrap_or("");
        }
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the renaming: all that a text defines is found, and nothing else.
    #[test]
    fn the_names_that_a_text_defines_are_found() {
        let text = "// float not(vec3 p)\n#define PI 3.14\nconst float A = 1.0, B[2];\n\
            struct Ray { vec3 o; };\nmat2 rot(float a) { float c = cos(a); return mat2(c); }\n\
            /* vec3\n no(); */ float field(vec3 p) { return length(p) - A; }\n";
        assert_eq!(global_names(text), ["PI", "A", "Ray", "rot", "field"]);
    }

    /// Protects line numbers, and shaders from what is not theirs.
    #[test]
    fn a_text_is_made_fit_for_a_shader_line_by_line() {
        let text = "\u{feff}#version 450\n  precision highp float;\n// caf\u{e9}\nfloat x;";
        assert_eq!(within_a_shader(text), "\n\n// caf?\nfloat x;\n");
    }

    /// Protects the sentence for a text that is no field.
    #[test]
    fn what_is_no_field_is_told() {
        assert_eq!(
            check("float field(const in vec3 p) { return p.x; }"),
            Ok(())
        );
        assert_eq!(check("float\nfield ( vec3 p ) { return p.x; }"), Ok(()));
        for none in [
            "",
            "float f(vec3 p) { return 1.0; }",
            "// float field(vec3 p)",
            "float field(vec2 p);",
        ] {
            let (line, why) = check(none).unwrap_err();
            assert!(
                line.is_none() && why.contains("float field(vec3 p)"),
                "{none}"
            );
        }
        let (line, why) = check("\nuniform float iTime;\n").unwrap_err();
        assert!(line == Some(2) && why.contains("'uniform'"), "{why}");
    }
}
