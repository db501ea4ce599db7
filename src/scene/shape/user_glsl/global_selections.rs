//! Global names that look like a selection of components: `float s(float x)`.
//!
//! Names are renamed by macros, which would rename the `.s` of a vector too. So the text itself
//! gets another name for such a global: two fields with an `s` do not clash then.

use super::tokens::Token;
use super::words::is_selection;
use std::collections::{HashMap, HashSet};

/// The words of a text as they are written: most as they are.
pub struct Renamed<'a> {
    /// Of each token the new name, if it has one.
    of: HashMap<usize, String>,
    tokens: &'a [Token<'a>],
}

impl<'a> Renamed<'a> {
    /// The names of a text, whose globals stand at these places.
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

    /// The token of this place as it is written.
    pub fn text(&self, place: usize) -> &str {
        self.of
            .get(&place)
            .map_or(self.tokens[place].text, String::as_str)
    }
}

/// For each name one that the text does not have, and that selects nothing: with a number.
fn new_names<'a>(tokens: &[Token<'a>], wanted: HashSet<&'a str>) -> HashMap<&'a str, String> {
    let known: HashSet<&str> = tokens.iter().map(|token| token.text).collect();
    let new = |word: &'a str| {
        let mut numbered = (0..=tokens.len()).map(|number| format!("{word}{number}"));
        let free = numbered.find(|name| !known.contains(name.as_str()));
        free.map(|name| (word, name))
    };
    wanted.into_iter().filter_map(new).collect()
}

/// The declarations of members of structures.
#[derive(Default)]
struct Members {
    /// A `struct` whose `{` is still to come.
    begins: bool,
    is_inside: bool,
    /// Whether the next word is a member's type.
    is_type: bool,
    brackets: usize,
}

impl Members {
    /// Whether a token, the next one, is the name of a member where it is declared.
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
