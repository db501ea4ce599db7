//! Reads and checks users' GLSL before it is passed to a driver.
//!
//! The compiler in a driver trusts its input. Macros that double the text, a hundred thousand terms or deeply nested
//! brackets crash the compiler, and the program with it. This module therefore splits the text into tokens and
//! preprocesses it within limits, and rejects forbidden content by name. The driver receives the preprocessed text,
//! without directives, macros and continued lines. Lines, blanks and comments (except those next to directives) keep
//! their positions. The checked text is identical to the compiled text.
//!
//! Other problems, such as sums that overflow the stack of a compiler and infinite loops, are found only by compiling
//! and running the text: see [`crate::tracer::FieldTrial`].
//!
//! The command `echomarch cost` analyses whole shaders with the same preprocessor, without limits.

pub(super) mod derivative;
mod loops;
mod preprocess;
#[cfg(test)]
mod tests;
mod tokens;
mod words;

use std::collections::HashSet;
use tokens::{Kind, Token};
use words::{Renamed, is_function, is_known, is_language, is_selection, is_type, refusal};

/// Maximum size of a text in bytes. The largest published fields (whole scenes and small neural networks) have about
/// 30,000 bytes.
const LARGEST_TEXT: usize = 1 << 18;

/// Maximum number of tokens of a text after macro expansion: four times the number in the largest published fields.
/// Drivers take about 20 µs and 1 KB per token.
const MOST_TOKENS: usize = 1 << 15;

/// An error in a text: the line (from 1), if there is one, and the message.
pub(super) type Refusal = (Option<u32>, String);

/// A parsed text.
#[derive(Debug)]
pub(super) struct Text {
    /// The text for use within a shader, line by line, in ASCII.
    pub code: String,
    /// All names in the text that GLSL does not define, in order of appearance.
    pub names: Vec<String>,
    /// Whether the text contains loops.
    pub has_loops: bool,
    /// Whether the text contains a `vec3 fieldGradient(vec3 p)`.
    pub states_gradient: bool,
}

/// Parses a text, and rejects it if it is not a field or has forbidden content.
///
/// `#version` lines and `precision` statements are removed, because the whole shader has its own.
pub(super) fn read(text: &str) -> Result<Text, Refusal> {
    if text.len() > LARGEST_TEXT {
        let size = text.len();
        let why = format!("it has {size} bytes: a field must have at most {LARGEST_TEXT}");
        return Err((None, why));
    }
    let clean = tokens::clean(text);
    let (tokens, end) = tokens::tokens(&clean)?;
    let tokens = preprocess::preprocess(&tokens, MOST_TOKENS)?;
    let tokens = leave_out_precisions(&tokens);
    let declared = check(&tokens)?;
    loops::check(&tokens)?;
    let renamed = Renamed::new(&tokens, &declared.globals);
    Ok(Text {
        states_gradient: declared.states_gradient,
        code: written(&tokens, &renamed, end),
        names: names(&tokens, &renamed),
        has_loops: tokens
            .iter()
            .any(|token| matches!(token.text, "for" | "while" | "do")),
    })
}

/// The lines of code that the compiler sees in the text of a whole shader: without comments, directives and lines that
/// conditions exclude, and with expanded macros.
///
/// # Errors
/// The error in a text that no compiler accepts.
pub fn code_lines(text: &str) -> Result<Vec<String>, String> {
    let is_kept = |line: &&str| !line.starts_with("#line");
    let kept: Vec<&str> = text.lines().filter(is_kept).collect();
    let clean = tokens::clean(&kept.join("\n"));
    let told = |(_, why): Refusal| why;
    let (tokens, _) = tokens::tokens(&clean).map_err(told)?;
    let tokens = preprocess::preprocess(&tokens, usize::MAX).map_err(told)?;
    let lines = tokens.chunk_by(|one, next| one.line == next.line);
    let written = |line: &[Token]| -> String {
        let words: Vec<&str> = line.iter().map(|token| token.text).collect();
        words.join(" ")
    };
    Ok(lines.map(written).collect())
}

/// Writes tokens on their original lines, with the original space before each token and after the last token.
fn written(tokens: &[Token], renamed: &Renamed, end: &str) -> String {
    let mut code = String::new();
    let mut line = 1;
    for (place, token) in tokens.iter().enumerate() {
        let breaks = newlines(token.space);
        // Line breaks that replace removed lines.
        while line + breaks < token.line {
            code.push('\n');
            line += 1;
        }
        code.push_str(token.space);
        code.push_str(renamed.text(place));
        line += breaks;
    }
    code.push_str(end);
    if !code.ends_with('\n') {
        code.push('\n');
    }
    code
}

fn newlines(space: &str) -> u32 {
    space.bytes().filter(|byte| *byte == b'\n').count() as u32
}

/// Maximum nesting of brackets.
const DEEPEST: usize = 128;

/// Maximum number of elements of an array. Each wave has its own copy of an array: 2^14 vectors are 256 KiB. The arrays
/// of all waves that are evaluated in parallel fit into the cache of a processor core.
const LONGEST_ARRAY: u64 = 1 << 14;

/// Removes `precision highp float;` and similar statements, because the whole shader has its own.
fn leave_out_precisions<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let is_precision = |at: &[Token]| {
        matches!(at, [word, how, of, end] if word.is("precision")
            && how.is_word() && of.is_word() && end.is(";"))
    };
    let mut left: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut after_one = false;
    for token in tokens {
        let mut token = *token;
        // The tokens on both sides must not merge.
        if std::mem::take(&mut after_one) && token.space.is_empty() {
            token.space = " ";
        }
        left.push(token);
        let before = left.len().saturating_sub(4);
        if is_precision(&left[before..]) {
            left.truncate(before);
            after_one = true;
        }
    }
    left
}

/// The declarations in a text.
struct Declared {
    /// Whether the text defines its gradient.
    states_gradient: bool,
    /// Positions of the words outside brackets and initial values. These are the names of globals, functions and
    /// structures, and the names of types.
    globals: Vec<usize>,
}

/// Rejects a text that is not a field or contains something that is not allowed in a field.
fn check(tokens: &[Token]) -> Result<Declared, Refusal> {
    let mut open: Vec<&Token> = Vec::new();
    let mut globals = Vec::new();
    let mut is_initial_value = false;
    let mut is_found = false;
    let mut states_gradient = false;
    for (index, token) in tokens.iter().enumerate() {
        let told = |why: String| Err((Some(token.line), why));
        let is_parameter = open.last().is_some_and(|bracket| bracket.is("("));
        match token.text {
            "(" | "[" | "{" => open.push(token),
            ")" | "]" | "}" => {
                let fits = open.pop().is_some_and(|o| closes(o.text, token.text));
                if !fits {
                    return told(format!(
                        "there is no opening bracket for this '{}'",
                        token.text
                    ));
                }
            }
            "#" | "##" => return told(format!("'{}' must begin its line", token.text)),
            "in" | "out" | "inout" if !is_parameter => {
                return told(format!(
                    "'{}' is not allowed here: the only input of a field is its point",
                    token.text
                ));
            }
            word if token.is_word() => {
                if let Some(why) = refusal(word) {
                    return told(why);
                }
            }
            _ => (),
        }
        if open.len() > DEEPEST {
            return told(format!("brackets are nested more than {DEEPEST} deep"));
        }
        if let Some(length) = array_length(&tokens[index..]).filter(|l| *l > LONGEST_ARRAY) {
            return told(format!(
                "an array of {length} elements is too large for a shader: at most {LONGEST_ARRAY}"
            ));
        }
        if is_named_as_language(tokens, index) {
            return told(format!(
                "'{}' is a word of GLSL, not a name: choose another one",
                token.text
            ));
        }
        if is_function(token.text) {
            let is_global = open.is_empty() && !is_initial_value;
            if is_global || is_prototype(tokens, index) {
                return told(format!(
                    "'{}' is a function of GLSL and cannot be declared again: choose another name",
                    token.text
                ));
            }
        }
        if open.is_empty() {
            match token.text {
                "=" => is_initial_value = true,
                "," | ";" | "}" => is_initial_value = false,
                _ if token.is_word() && !is_initial_value => globals.push(index),
                _ => (),
            }
            is_found |= is_of_a_point(&tokens[index..], ["float", "field"]);
            if token.is("fieldGradient") {
                let from_type = &tokens[index.saturating_sub(1)..];
                if !is_of_a_point(from_type, ["vec3", "fieldGradient"]) {
                    return told("a stated gradient is `vec3 fieldGradient(vec3 p)`".to_owned());
                }
                states_gradient = true;
            }
        }
    }
    if let Some(bracket) = open.last() {
        let (mark, line) = (bracket.text, bracket.line);
        return Err((
            None,
            format!("after its end: the '{mark}' in line {line} is not closed"),
        ));
    }
    if is_found {
        return Ok(Declared {
            states_gradient,
            globals,
        });
    }
    let why = "there is no `float field(vec3 p)` in it, which every field must define".to_owned();
    Err((None, why))
}

/// Whether the word at a position is a reserved word used as a declared name: it follows a type or `struct`.
fn is_named_as_language(tokens: &[Token], place: usize) -> bool {
    let before = place.checked_sub(1).map(|before| tokens[before].text);
    is_language(tokens[place].text) && before.is_some_and(|word| is_type(word) || word == "struct")
}

/// Whether the word at a position is the name in a function declaration: it follows a type.
fn is_prototype(tokens: &[Token], place: usize) -> bool {
    let is_of_statement = |word: &Token| matches!(word.text, "return" | "else" | "do" | "case");
    let before = place.checked_sub(1).map(|before| &tokens[before]);
    let is_after_type = before.is_some_and(|word| word.is_word() && !is_of_statement(word));
    is_after_type && tokens.get(place + 1).is_some_and(|next| next.is("("))
}

/// Names in the text that GLSL does not define, as written and in order of appearance. Component selections (`.xyz`) do
/// not count, because no global has such a name after renaming.
fn names(tokens: &[Token], renamed: &Renamed) -> Vec<String> {
    let mut known = HashSet::new();
    let words = (0..tokens.len()).filter(|place| tokens[*place].is_word());
    words
        .map(|place| renamed.text(place))
        .filter(|word| !is_known(word) && !is_selection(word))
        .filter(|word| known.insert(*word))
        .map(str::to_owned)
        .collect()
}

fn closes(open: &str, close: &str) -> bool {
    matches!((open, close), ("(", ")") | ("[", "]") | ("{", "}"))
}

/// The number in `[number]` at the beginning of the tokens, if the tokens begin with this pattern.
fn array_length(tokens: &[Token]) -> Option<u64> {
    match tokens {
        [open, number, close, ..]
            if open.is("[") && number.kind == Kind::Number && close.is("]") =>
        {
            let digits = number.text.trim_end_matches(['u', 'U']);
            let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
            // A number with too many digits counts as too large.
            is_number.then(|| digits.parse().unwrap_or(u64::MAX))
        }
        _ => None,
    }
}

/// Whether the tokens begin with a function of this type and name whose first parameter is a `vec3`.
fn is_of_a_point(tokens: &[Token], [of_type, name]: [&str; 2]) -> bool {
    let mut inside = tokens.iter().map(|token| token.text);
    let opens = [of_type, name, "("]
        .into_iter()
        .all(|word| inside.next() == Some(word));
    let kind = inside.find(|word| !matches!(*word, "const" | "in" | "highp" | "mediump" | "lowp"));
    opens && kind == Some("vec3")
}
