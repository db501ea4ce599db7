//! A shader's text as its compiler gets it: the part of a preprocessor that is needed to say
//! what is in it.

use std::collections::HashMap;

/// The lines that are code, with names replaced as the text defines them. Conditions that are
/// not understood count as true, with everything in them.
pub(super) fn reduced(text: &str) -> Vec<String> {
    let mut defines: HashMap<String, String> = HashMap::new();
    // For each open condition: whether its lines are in.
    let mut open: Vec<bool> = Vec::new();
    let mut lines = Vec::new();
    for line in without_comments(text).lines() {
        let is_in = open.iter().all(|&is_in| is_in);
        match line.trim_start().strip_prefix('#') {
            Some(directive) => direct(directive, is_in, &mut open, &mut defines),
            None if is_in && !line.trim().is_empty() => lines.push(replaced(line, &defines)),
            None => (),
        }
    }
    lines
}

fn direct(
    directive: &str,
    is_in: bool,
    open: &mut Vec<bool>,
    defines: &mut HashMap<String, String>,
) {
    let directive = directive.trim();
    let (what, rest) = directive
        .split_once(char::is_whitespace)
        .unwrap_or((directive, ""));
    let rest = rest.trim();
    match what {
        "if" => open.push(holds(rest, defines)),
        "ifdef" => open.push(defines.contains_key(rest)),
        "ifndef" => open.push(!defines.contains_key(rest)),
        "else" => {
            if let Some(last) = open.last_mut() {
                *last = !*last;
            }
        }
        "endif" => {
            open.pop();
        }
        "define" if is_in => {
            let (name, value) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            defines.insert(name.to_owned(), value.trim().to_owned());
        }
        "undef" if is_in => {
            defines.remove(rest);
        }
        _ => (),
    }
}

/// A condition that is a number, a name, or either of them denied.
fn holds(condition: &str, defines: &HashMap<String, String>) -> bool {
    if let Some(denied) = condition.strip_prefix('!') {
        return !holds(denied.trim(), defines);
    }
    let value = defines.get(condition).map_or(condition, String::as_str);
    value != "0"
}

/// The line with the names replaced that stand for other names.
fn replaced(line: &str, defines: &HashMap<String, String>) -> String {
    let mut out = String::with_capacity(line.len());
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let part_of_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let is_word = part_of_word(first);
        let end = rest
            .find(|c| part_of_word(c) != is_word)
            .unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        let value = defines.get(piece).filter(|value| !value.is_empty());
        out.push_str(value.map_or(piece, String::as_str));
        rest = after;
    }
    out
}

/// The names and numbers of a line.
pub(super) fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
}

fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    loop {
        let line_comment = rest.find("//");
        let block = rest.find("/*");
        let (start, end) = match (line_comment, block) {
            (None, None) => return out + rest,
            (Some(line), other) if other.is_none_or(|block| line < block) => {
                (line, rest[line..].find('\n').map(|n| line + n))
            }
            (_, Some(block)) => (block, rest[block + 2..].find("*/").map(|n| block + n + 4)),
            (Some(line), None) => (line, None),
        };
        out.push_str(&rest[..start]);
        let Some(end) = end else {
            return out;
        };
        rest = &rest[end..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the counts: comments and what is switched off are no code, names are renamed.
    #[test]
    fn a_text_is_reduced_to_its_code() {
        let text = "// 1: a\n#line 1 1\n#define ON 1\n#define OFF 0\n#define field user0_field\n\
                    float field(vec3 p) { /* one\ntwo */ return p.x; } // end\n#undef field\n\
                    #if OFF\nfloat off;\n#else\nfloat field;\n#endif\n#if !ON\nfloat off;\n#endif\n\
                    #ifdef ON\nfloat on;\n#endif";
        let expected = ["float user0_field(vec3 p) { ", "float field;", "float on;"];
        let lines: Vec<String> = reduced(text)
            .into_iter()
            .map(|line| line.replace(" return p.x; } ", ""))
            .filter(|line| !line.trim().is_empty())
            .collect();
        assert_eq!(lines, expected);
    }
}
