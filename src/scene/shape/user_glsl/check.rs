//! Rejects forbidden content in a field's text.

use super::Refusal;
use super::global_selections::Renamed;
use super::tokens::{Kind, Token};
use super::words::{is_function, is_known, is_language, is_selection, is_type, refusal};
use std::collections::HashSet;

/// Maximum nesting of brackets.
const DEEPEST: usize = 128;

/// Maximum number of elements of an array. Each wave that is evaluated at once has its own array:
/// 2^14 vectors are 256 KiB, which fit into the cache of a processor's core for all of them.
const LONGEST_ARRAY: u64 = 1 << 14;

/// Removes `precision highp float;` and similar statements: a shader has its own.
pub fn leave_out_precisions<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let is_precision = |at: &[Token]| {
        matches!(at, [word, how, of, end] if word.is("precision")
            && how.is_word() && of.is_word() && end.is(";"))
    };
    let mut left: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut after_one = false;
    for token in tokens {
        let mut token = *token;
        // The tokens on either side must not merge.
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

/// The declarations of a text.
pub struct Declared {
    /// Whether it states its gradient.
    pub states_gradient: bool,
    /// Positions of the words outside of brackets and initial values: the names of globals,
    /// functions and structures, and the types.
    pub globals: Vec<usize>,
}

/// Rejects a text that is not a field, or does something that a field cannot do.
pub fn check(tokens: &[Token]) -> Result<Declared, Refusal> {
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
                    return told(format!("this '{}' closes nothing", token.text));
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
            return told(format!(
                "there are more than {DEEPEST} brackets in each other"
            ));
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
            format!("after its end: the '{mark}' of line {line} is still open"),
        ));
    }
    if is_found {
        return Ok(Declared {
            states_gradient,
            globals,
        });
    }
    let why = "there is no `float field(vec3 p)` in it, which every field needs".to_owned();
    Err((None, why))
}

/// Whether the word at a position is one of the language where a name is declared: after a type or
/// after `struct`.
fn is_named_as_language(tokens: &[Token], place: usize) -> bool {
    let before = place.checked_sub(1).map(|before| tokens[before].text);
    is_language(tokens[place].text) && before.is_some_and(|word| is_type(word) || word == "struct")
}

/// Whether the word at a position is a function's name in a declaration: a type precedes it.
fn is_prototype(tokens: &[Token], place: usize) -> bool {
    let is_of_statement = |word: &Token| matches!(word.text, "return" | "else" | "do" | "case");
    let before = place.checked_sub(1).map(|before| &tokens[before]);
    let is_after_type = before.is_some_and(|word| word.is_word() && !is_of_statement(word));
    is_after_type && tokens.get(place + 1).is_some_and(|next| next.is("("))
}

/// Names in the text that GLSL does not define, as they are written, in order of appearance.
/// Component selections (`.xyz`) do not count: no global has such a name.
pub fn names(tokens: &[Token], renamed: &Renamed) -> Vec<String> {
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

/// The number of `[number]`, with which the tokens begin.
fn array_length(tokens: &[Token]) -> Option<u64> {
    match tokens {
        [open, number, close, ..]
            if open.is("[") && number.kind == Kind::Number && close.is("]") =>
        {
            let digits = number.text.trim_end_matches(['u', 'U']);
            let is_number = digits.bytes().all(|byte| byte.is_ascii_digit());
            // A number with too many digits is too large as well.
            is_number.then(|| digits.parse().unwrap_or(u64::MAX))
        }
        _ => None,
    }
}

/// Whether tokens begin with the given type and name of a function, and `(vec3`.
fn is_of_a_point(tokens: &[Token], [of_type, name]: [&str; 2]) -> bool {
    let mut inside = tokens.iter().map(|token| token.text);
    let opens = [of_type, name, "("]
        .into_iter()
        .all(|word| inside.next() == Some(word));
    let kind = inside.find(|word| !matches!(*word, "const" | "in" | "highp" | "mediump" | "lowp"));
    opens && kind == Some("vec3")
}
