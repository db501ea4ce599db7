//! Renames globals that look like a selection of components: `float s(float x)`.
//!
//! Names are renamed by macros, which would rename the `.s` of a vector too. So such a global gets
//! another name in the text itself: two fields with an `s` do not clash then.

use super::tokens::Token;
use super::words::is_selection;
use std::collections::{HashMap, HashSet};

/// The words of a text as they are written out: most are unchanged.
pub struct Renamed<'a> {
    /// The new names of tokens that have one, by position.
    of: HashMap<usize, String>,
    tokens: &'a [Token<'a>],
}

impl<'a> Renamed<'a> {
    /// The names of a text whose globals are at these positions.
    pub fn new(tokens: &'a [Token<'a>], globals: &[usize]) -> Renamed<'a> {
        let selections = globals.iter().map(|place| tokens[*place].text);
        let wanted: HashSet<&str> = selections.filter(|word| is_selection(word)).collect();
        let mut of = HashMap::new();
        if !wanted.is_empty() {
            let names = new_names(tokens, wanted);
            let mut members = Members::default();
            for (place, token) in tokens.iter().enumerate() {
                let is_member = members.is_declared_by(token);
                let is_selected = place > 0 && tokens[place - 1].is(".");
                if let Some(name) = names.get(token.text).filter(|_| !is_member && !is_selected) {
                    of.insert(place, name.clone());
                }
            }
        }
        Renamed { of, tokens }
    }

    /// The token at this position as it is written out.
    pub fn text(&self, place: usize) -> &str {
        self.of
            .get(&place)
            .map_or(self.tokens[place].text, String::as_str)
    }
}

/// Finds a new name for each: one with a number, which the text does not contain and which does not
/// select components.
fn new_names<'a>(tokens: &[Token<'a>], wanted: HashSet<&'a str>) -> HashMap<&'a str, String> {
    let known: HashSet<&str> = tokens.iter().map(|token| token.text).collect();
    let new = |word: &'a str| {
        let mut numbered = (0..=tokens.len()).map(|number| format!("{word}{number}"));
        let free = numbered.find(|name| !known.contains(name.as_str()));
        free.map(|name| (word, name))
    };
    wanted.into_iter().filter_map(new).collect()
}

/// Finds the declarations of structure members.
#[derive(Default)]
struct Members {
    /// Whether a `struct` was read and its `{` was not.
    begins: bool,
    is_inside: bool,
    /// Whether the next word is a member's type.
    is_type: bool,
    brackets: usize,
}

impl Members {
    /// Whether the next token declares the name of a member.
    fn is_declared_by(&mut self, token: &Token) -> bool {
        match token.text {
            "struct" => self.begins = true,
            "{" if self.begins => (self.begins, self.is_inside, self.is_type) = (false, true, true),
            "}" => self.is_inside = false,
            "[" => self.brackets += 1,
            "]" => self.brackets = self.brackets.saturating_sub(1),
            ";" => (self.begins, self.is_type) = (false, true),
            "const" | "highp" | "mediump" | "lowp" => (),
            _ if self.is_inside && self.brackets == 0 && token.is_word() => {
                return !std::mem::take(&mut self.is_type);
            }
            _ => (),
        }
        false
    }
}
