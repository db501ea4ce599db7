//! Processes directives and expands macros, within limits.

use super::tokens::{Kind, Token, condition};
use super::{Refusal, words};
use std::collections::{HashMap, HashSet};

/// Maximum number of expansion steps for each permitted token of the result; sufficient for eight levels of macros.
const STEPS_A_TOKEN: usize = 8;

/// Maximum number of characters of an `#error` message that are reported.
const LONGEST_ERROR: usize = 200;

/// Maximum nesting depth of macro calls.
const DEEPEST_CALL: u32 = 64;

/// Maximum nesting depth of conditions.
const DEEPEST_CONDITION: usize = 64;

/// Value of `__VERSION__`: the lower of the two language versions in which a field is compiled, GLSL ES 3.00 and GLSL
/// 3.30.
const VERSION: &str = "300";

/// Returns the text without directives and macros, with at most `most_tokens` tokens.
pub fn preprocess<'a>(tokens: &[Token<'a>], most_tokens: usize) -> Result<Vec<Token<'a>>, Refusal> {
    let mut state = Preprocessor {
        expander: Expander::new(most_tokens),
        conditions: Vec::new(),
    };
    let mut out = Vec::new();
    let mut rest = tokens;
    while let Some(first) = rest.first() {
        let is_directive = |token: &Token| token.is_first && token.is("#");
        if is_directive(first) {
            let length = 1 + rest[1..].iter().take_while(|t| !t.is_first).count();
            state.directive(first.line, &rest[1..length])?;
            rest = &rest[length..];
            continue;
        }
        let length = rest.iter().take_while(|t| !is_directive(t)).count();
        if state.is_on() {
            state.expander.expand(&rest[..length], &mut out, 0)?;
        }
        rest = &rest[length..];
    }
    match state.conditions.last() {
        Some(open) => Err((Some(open.line), "this #if has no #endif".to_owned())),
        None => Ok(out),
    }
}

/// An `#if` whose `#endif` has not been read yet.
struct Condition {
    line: u32,
    /// Whether the lines around the `#if` are active.
    outer: bool,
    /// Whether the current lines are active.
    is_on: bool,
    /// Whether any branch has been active.
    was_on: bool,
    has_else: bool,
}

struct Preprocessor<'a> {
    expander: Expander<'a>,
    conditions: Vec<Condition>,
}

impl<'a> Preprocessor<'a> {
    fn is_on(&self) -> bool {
        self.conditions.last().is_none_or(|c| c.is_on)
    }

    fn directive(&mut self, line: u32, tokens: &[Token<'a>]) -> Result<(), Refusal> {
        let Some((name, rest)) = tokens.split_first() else {
            return Ok(());
        };
        let told = |why: String| (Some(line), why);
        match name.text {
            "if" | "ifdef" | "ifndef" => self.begin(line, name.text, rest),
            "elif" | "else" | "endif" => self.go_on(line, name.text, rest),
            _ if !self.is_on() => Ok(()),
            "define" => self.expander.define(rest).map_err(told),
            "undef" => self.expander.undefine(rest).map_err(told),
            // The whole shader has its own version.
            "version" => Ok(()),
            "error" => {
                let words: Vec<&str> = rest.iter().take(20).map(|token| token.text).collect();
                let mut words = words.join(" ");
                words.truncate(LONGEST_ERROR);
                Err(told(format!("#error {words}")))
            }
            "extension" | "pragma" | "line" | "include" => Err(told(format!(
                "#{} is allowed in whole shaders only, not in a field",
                name.text
            ))),
            other => Err(told(format!("there is no directive #{other}"))),
        }
    }

    fn begin(&mut self, line: u32, name: &str, rest: &[Token<'a>]) -> Result<(), Refusal> {
        if self.conditions.len() == DEEPEST_CONDITION {
            let why = format!("#if is nested more than {DEEPEST_CONDITION} deep");
            return Err((Some(line), why));
        }
        let outer = self.is_on();
        let is_defined = |rest: &[Token]| {
            let name = rest.first().map_or("", |token| token.text);
            self.expander.is_defined(name)
        };
        let is_on = match name {
            _ if !outer => false,
            "if" => self.holds(line, rest)?,
            "ifdef" => is_defined(rest),
            _ => !is_defined(rest),
        };
        self.conditions.push(Condition {
            line,
            outer,
            is_on,
            was_on: is_on,
            has_else: false,
        });
        Ok(())
    }

    fn go_on(&mut self, line: u32, name: &str, rest: &[Token<'a>]) -> Result<(), Refusal> {
        let Some(mut open) = self.conditions.pop() else {
            return Err((Some(line), format!("this #{name} has no #if")));
        };
        if name == "endif" {
            return Ok(());
        }
        if open.has_else {
            return Err((Some(line), format!("this #{name} comes after an #else")));
        }
        let may_be_on = open.outer && !open.was_on;
        open.is_on = match name {
            "elif" => may_be_on && self.holds(line, rest)?,
            _ => may_be_on,
        };
        open.has_else = name == "else";
        open.was_on |= open.is_on;
        self.conditions.push(open);
        Ok(())
    }

    /// Whether the expression of an `#if` or `#elif` is true.
    fn holds(&mut self, line: u32, tokens: &[Token<'a>]) -> Result<bool, Refusal> {
        let mut known = Vec::with_capacity(tokens.len());
        let mut rest = tokens;
        while let Some((first, after)) = rest.split_first() {
            if !first.is("defined") {
                known.push(*first);
                rest = after;
                continue;
            }
            let (name, length) = match after {
                [open, name, close, ..] if open.is("(") && close.is(")") => (name, 3),
                [name, ..] if name.is_word() => (name, 1),
                _ => return Err((Some(line), "'defined' needs a name".to_owned())),
            };
            let is_defined = self.expander.is_defined(name.text);
            known.push(number(*first, if is_defined { "1" } else { "0" }));
            rest = &after[length..];
        }
        let mut expanded = Vec::new();
        self.expander.expand(&known, &mut expanded, 0)?;
        condition(&expanded)
            .map(|value| value != 0)
            .map_err(|why| (Some(line), format!("#if: {why}")))
    }
}

fn number<'a>(at: Token<'a>, text: &'a str) -> Token<'a> {
    Token {
        kind: Kind::Number,
        text,
        ..at
    }
}

#[derive(Clone, PartialEq)]
struct Macro<'a> {
    /// `None` for a macro without parameters.
    parameters: Option<Vec<&'a str>>,
    body: Vec<&'a str>,
    kinds: Vec<Kind>,
}

/// An item that has not been processed yet.
enum Item<'a> {
    Token(Token<'a>),
    /// The end of the tokens of a macro. The macro is not expanded again before this end.
    End(&'a str),
}

struct Expander<'a> {
    macros: HashMap<&'a str, Macro<'a>>,
    /// Macros that are currently being expanded, and are therefore not expanded again.
    hidden: HashSet<&'a str>,
    steps: usize,
    most_tokens: usize,
}

impl<'a> Expander<'a> {
    fn new(most_tokens: usize) -> Expander<'a> {
        Expander {
            macros: HashMap::new(),
            hidden: HashSet::new(),
            steps: 0,
            most_tokens,
        }
    }

    fn is_defined(&self, name: &str) -> bool {
        name == "__VERSION__" || self.macros.contains_key(name)
    }

    fn define(&mut self, tokens: &[Token<'a>]) -> Result<(), String> {
        let Some((name, mut rest)) = tokens.split_first().filter(|(n, _)| n.is_word()) else {
            return Err("this #define has no name".to_owned());
        };
        if let Some(why) = words::macro_refusal(name.text) {
            return Err(why);
        }
        let is_function = |next: &Token| next.is("(") && next.space.is_empty();
        let mut parameters = None;
        if rest.first().is_some_and(is_function) {
            let Some(end) = rest.iter().position(|token| token.is(")")) else {
                return Err(format!("the macro '{}' has no ')'", name.text));
            };
            parameters = Some(parameter_names(name.text, &rest[1..end])?);
            rest = &rest[end + 1..];
        }
        if let Some(odd) = rest.iter().find(|t| t.is("#") || t.is("##")) {
            return Err(format!("'{}' in macros is not in GLSL", odd.text));
        }
        let new = Macro {
            parameters,
            body: rest.iter().map(|token| token.text).collect(),
            kinds: rest.iter().map(|token| token.kind).collect(),
        };
        match self.macros.insert(name.text, new.clone()) {
            Some(old) if old != new => Err(format!("'{}' is already a macro", name.text)),
            _ => Ok(()),
        }
    }

    fn undefine(&mut self, tokens: &[Token<'a>]) -> Result<(), String> {
        let Some(name) = tokens.first().filter(|name| name.is_word()) else {
            return Err("this #undef has no name".to_owned());
        };
        if let Some(why) = words::macro_refusal(name.text) {
            return Err(why);
        }
        self.macros.remove(name.text);
        Ok(())
    }

    fn step(&mut self, count: usize, line: u32) -> Result<(), Refusal> {
        self.steps += count;
        if self.steps <= self.most_tokens.saturating_mul(STEPS_A_TOKEN) {
            return Ok(());
        }
        Err((
            Some(line),
            "its macros expand to too many tokens".to_owned(),
        ))
    }

    /// Expands the macros in some tokens.
    fn expand(
        &mut self,
        tokens: &[Token<'a>],
        out: &mut Vec<Token<'a>>,
        depth: u32,
    ) -> Result<(), Refusal> {
        let mut left: Vec<Item> = tokens.iter().rev().map(|t| Item::Token(*t)).collect();
        // The token after a macro must not merge with the last token of the macro.
        let mut after_macro = false;
        while let Some(item) = left.pop() {
            let mut token = match item {
                Item::End(name) => {
                    self.hidden.remove(name);
                    after_macro = true;
                    continue;
                }
                Item::Token(token) => token,
            };
            self.step(1, token.line)?;
            if std::mem::take(&mut after_macro) && token.space.is_empty() {
                token.space = " ";
            }
            let is_call = token.is_word() && !self.hidden.contains(token.text);
            if is_call && self.call(token, &mut left, depth)? {
                continue;
            }
            if is_call && token.is("__VERSION__") {
                token = number(token, VERSION);
            }
            out.push(token);
            if out.len() > self.most_tokens {
                let most = self.most_tokens;
                let why = format!("it has more than {most} words, numbers and marks");
                return Err((Some(token.line), why));
            }
        }
        Ok(())
    }

    /// Replaces a macro call by the tokens of the macro. Returns false if `name` is not a macro, or is a macro with
    /// parameters that is not followed by arguments.
    fn call(
        &mut self,
        name: Token<'a>,
        left: &mut Vec<Item<'a>>,
        depth: u32,
    ) -> Result<bool, Refusal> {
        let Some(of) = self.macros.get(name.text) else {
            return Ok(false);
        };
        let Some(parameters) = of.parameters.clone() else {
            let body = body_of(of, name);
            self.step(body.len(), name.line)?;
            self.put(name, body, left);
            return Ok(true);
        };
        let next = left.iter().rev().find_map(|item| match item {
            Item::Token(token) => Some(token),
            Item::End(_) => None,
        });
        if !next.is_some_and(|token| token.is("(")) {
            return Ok(false);
        }
        let told = |why: &str| (Some(name.line), format!("the macro '{}' {why}", name.text));
        let body = body_of(of, name);
        let mut given = self.arguments(name, left)?;
        // An empty call has one empty argument or no argument.
        if parameters.is_empty() && given.len() == 1 && given[0].is_empty() {
            given.clear();
        }
        if given.len() != parameters.len() {
            let count = parameters.len();
            return Err(told(&format!(
                "takes {count} arguments, not {}",
                given.len()
            )));
        }
        if depth == DEEPEST_CALL {
            return Err(told("has calls that are nested too deeply"));
        }
        let mut expanded = HashMap::new();
        for (parameter, tokens) in parameters.iter().zip(given) {
            let mut of_it = Vec::new();
            self.expand(&tokens, &mut of_it, depth + 1)?;
            expanded.insert(*parameter, of_it);
        }
        let mut whole = Vec::with_capacity(body.len());
        for token in body {
            match expanded.get(token.text).filter(|_| token.is_word()) {
                Some(argument) => {
                    self.step(argument.len(), name.line)?;
                    whole.extend(argument.iter().map(|t| made(*t, name)));
                }
                None => whole.push(token),
            }
        }
        self.step(whole.len(), name.line)?;
        self.put(name, whole, left);
        Ok(true)
    }

    /// Removes the arguments of a call from the remaining items, beginning with its `(`.
    fn arguments(
        &mut self,
        name: Token<'a>,
        left: &mut Vec<Item<'a>>,
    ) -> Result<Vec<Vec<Token<'a>>>, Refusal> {
        let mut given = vec![Vec::new()];
        let mut depth = 0;
        while let Some(item) = left.pop() {
            let token = match item {
                Item::End(name) => {
                    self.hidden.remove(name);
                    continue;
                }
                Item::Token(token) => token,
            };
            self.step(1, name.line)?;
            match token.text {
                "(" => depth += 1,
                ")" => depth -= 1,
                _ => (),
            }
            let last = given.len() - 1;
            match token.text {
                "(" if depth == 1 => (),
                ")" if depth == 0 => return Ok(given),
                "," if depth == 1 => given.push(Vec::new()),
                _ => given[last].push(token),
            }
        }
        let why = format!("the macro '{}' has no ')' after its '('", name.text);
        Err((Some(name.line), why))
    }

    fn put(&mut self, name: Token<'a>, body: Vec<Token<'a>>, left: &mut Vec<Item<'a>>) {
        self.hidden.insert(name.text);
        left.push(Item::End(name.text));
        let count = body.len();
        for (index, mut token) in body.into_iter().rev().enumerate() {
            if index + 1 == count && !name.space.is_empty() {
                token.space = name.space;
            }
            left.push(Item::Token(token));
        }
    }
}

fn parameter_names<'a>(name: &str, tokens: &[Token<'a>]) -> Result<Vec<&'a str>, String> {
    if tokens.is_empty() {
        return Ok(Vec::new());
    }
    let mut names = Vec::new();
    let mut known = HashSet::new();
    for one in tokens.split(|token| token.is(",")) {
        match one {
            [parameter] if parameter.is_word() && known.insert(parameter.text) => {
                names.push(parameter.text);
            }
            _ => {
                return Err(format!(
                    "the macro '{name}' needs one name for each parameter"
                ));
            }
        }
    }
    Ok(names)
}

fn body_of<'a>(of: &Macro<'a>, name: Token<'a>) -> Vec<Token<'a>> {
    let tokens = of.body.iter().zip(&of.kinds);
    tokens
        .map(|(text, kind)| {
            made(
                Token {
                    kind: *kind,
                    text,
                    ..name
                },
                name,
            )
        })
        .collect()
}

/// A token from a macro, at the position of the macro's name.
fn made<'a>(token: Token<'a>, name: Token<'a>) -> Token<'a> {
    Token {
        space: " ",
        line: name.line,
        is_first: false,
        ..token
    }
}
