//! Rejects what a field's text must not contain.

use super::Refusal;
use super::global_selections::Renamed;
use super::tokens::{Kind, Token};
use super::words::{is_function, is_known, is_language, is_selection, is_type, refusal};
use std::collections::HashSet;

/// Brackets within brackets, at most.
const DEEPEST: usize = 128;

/// Elements of an array at most. Each wave that is evaluated at once has its own: 2^14
/// vectors are 256 KiB, which is what a processor's core keeps at hand for all of them.
const LONGEST_ARRAY: u64 = 1 << 14;

/// Takes out `precision highp float;` and its like: a shader has its own.
pub fn leave_out_precisions<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let is_precision = |at: &[Token]| {
        matches!(at, [word, how, of, end] if word.is("precision")
            && how.is_word() && of.is_word() && end.is(";"))
    };
    let mut left: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut after_one = false;
    for token in tokens {
        let mut token = *token;
        // What stood on either side shall not become one.
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

/// What a text declares.
pub struct Declared {
    /// Whether it states its gradient.
    pub states_gradient: bool,
    /// Places of the words outside of brackets and of initial values: the names of globals, of
    /// functions and of structures, and the types.
    pub globals: Vec<usize>,
}

/// Rejects a text that is no field, or does what a field cannot do.
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
                "an array of {length} is more than a shader holds: {LONGEST_ARRAY} elements at the most"
            ));
        }
        if is_named_as_language(tokens, index) {
            return told(format!(
                "'{}' is a word of GLSL and no name: choose another one",
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
    let why = "there is no `float field(vec3 p)` in it, which is what a field is".to_owned();
    Err((None, why))
}

/// Whether the word at a place is one of the language, and stands where a name is declared: behind
/// a type or behind `struct`.
fn is_named_as_language(tokens: &[Token], place: usize) -> bool {
    let before = place.checked_sub(1).map(|before| tokens[before].text);
    is_language(tokens[place].text) && before.is_some_and(|word| is_type(word) || word == "struct")
}

/// Whether the word at a place is a function's name in a declaration: a type stands before it.
fn is_prototype(tokens: &[Token], place: usize) -> bool {
    let is_of_statement = |word: &Token| matches!(word.text, "return" | "else" | "do" | "case");
    let before = place.checked_sub(1).map(|before| &tokens[before]);
    let is_after_type = before.is_some_and(|word| word.is_word() && !is_of_statement(word));
    is_after_type && tokens.get(place + 1).is_some_and(|next| next.is("("))
}

/// Names in the text that GLSL does not know, as they are written, in the order in which they
/// come. What selects components (`.xyz`) is none: no global is called so.
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
            // One of more digits than a number can have is too much as well.
            is_number.then(|| digits.parse().unwrap_or(u64::MAX))
        }
        _ => None,
    }
}

/// Whether tokens begin with a function's type and name, and `(vec3`.
fn is_of_a_point(tokens: &[Token], [of_type, name]: [&str; 2]) -> bool {
    let mut inside = tokens.iter().map(|token| token.text);
    let opens = [of_type, name, "("]
        .into_iter()
        .all(|word| inside.next() == Some(word));
    let kind = inside.find(|word| !matches!(*word, "const" | "in" | "highp" | "mediump" | "lowp"));
    opens && kind == Some("vec3")
}
