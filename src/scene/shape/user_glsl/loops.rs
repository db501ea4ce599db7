//! Rejects loops that visibly never end.
//!
//! The trial run cannot find all infinite loops. Software renderers end a loop after 65,536 iterations, and a compiler
//! removes a loop whose result is not used. A graphics card may run it forever.

use super::Refusal;
use super::tokens::Token;
use super::words::{is_known, is_language};

/// Rejects loops without a `break` or a `return` whose condition is always true, or whose variables nothing in the loop
/// changes.
/// Other loops are tested by the trial run.
pub(super) fn check(tokens: &[Token]) -> Result<(), Refusal> {
    let endless = (0..tokens.len()).find_map(|at| Some((at, endlessness(tokens, at)?)));
    match endless {
        None => Ok(()),
        Some((at, why)) => Err((
            Some(tokens[at].line),
            format!(
                "this loop never ends: {why}, and there is neither a `break` nor a `return` in it"
            ),
        )),
    }
}

/// Why the loop that begins at this token, or ends with the `while` at this token, is infinite.
fn endlessness(tokens: &[Token], at: usize) -> Option<&'static str> {
    let is_for = tokens[at].is("for");
    if !is_for && !tokens[at].is("while") {
        return None;
    }
    // A loop needs a condition in brackets. The driver reports a missing condition.
    if !tokens.get(at + 1)?.is("(") {
        return None;
    }
    let close = closing(tokens, at + 1)?;
    let said = &tokens[at + 2..close];
    let parts: Vec<&[Token]> = said.split(|token| token.is(";")).collect();
    let (condition, step) = match parts[..] {
        [_, condition, step] if is_for => (condition, step),
        _ => (said, [].as_slice()),
    };
    let body = match tokens.get(close + 1) {
        Some(next) if next.is(";") && !is_for => done_before(tokens, at),
        _ => statement(tokens, close + 1),
    };
    if body.iter().any(|t| t.is("break") || t.is("return")) {
        return None;
    }
    if is_true(condition, is_for) {
        return Some("its condition is always true");
    }
    // A condition without variables is an idiom, such as `do {…} while (false)`.
    let variables = variables(condition, tokens);
    // The end of a body without a block is not determined.
    let is_block = body.first().is_some_and(|token| token.is("{"));
    let body = if is_block { body } else { tokens };
    let parts = [condition, step, body];
    let may_change = parts.iter().any(|part| may_change(part, &variables));
    (!variables.is_empty() && !may_change).then_some("nothing in it changes its condition")
}

/// The variables in a condition: names that are not declared as constants.
fn variables<'a>(condition: &[Token<'a>], tokens: &[Token]) -> Vec<&'a str> {
    let is_constant = |name: &str| {
        let mut statements = tokens.split(|token| token.is(";"));
        statements
            .any(|words| words.iter().any(|t| t.is("const")) && words.iter().any(|t| t.is(name)))
    };
    let is_variable = |at: &usize| {
        let token = condition[*at];
        let is_called = condition.get(at + 1).is_some_and(|next| next.is("("));
        token.is_word() && !is_language(token.text) && !is_called && !is_constant(token.text)
    };
    let places = (0..condition.len()).filter(is_variable);
    places.map(|at| condition[at].text).collect()
}

/// Whether a part of a loop may change one of these variables: by an assignment, or by a function with `out` parameters or
/// global variables.
fn may_change(part: &[Token], variables: &[&str]) -> bool {
    let is_open = |at: usize| part.get(at).is_some_and(|next| next.is("("));
    part.iter().enumerate().any(|(at, token)| {
        let is_called = token.is_word() && is_open(at + 1);
        let has_effects =
            is_called && (!is_known(token.text) || ["modf", "frexp"].contains(&token.text));
        let is_step = is_open(at + 1) && (token.is("++") || token.is("--"));
        let is_target = token.is(")") || variables.contains(&token.text);
        has_effects || is_step || is_target && is_assigned(part, at)
    })
}

/// Whether the token at `at`, with components and indices behind it, is the target of an assignment.
fn is_assigned(part: &[Token], at: usize) -> bool {
    let is_step = |token: Option<&Token>| token.is_some_and(|t| t.is("++") || t.is("--"));
    let mut end = at + 1;
    while let Some(token) = part.get(end) {
        match token.text {
            "." => end += 2,
            "[" => end = closing(part, end).map_or(part.len(), |close| close + 1),
            _ => break,
        }
    }
    let is_target = part.get(end).is_some_and(|mark| {
        mark.text.ends_with('=') && !["==", "!=", "<=", ">="].contains(&mark.text)
    });
    is_target || is_step(part.get(end)) || at > 0 && is_step(part.get(at - 1))
}

/// Whether a condition is `true`. An empty condition of a `for` also counts as true.
fn is_true(condition: &[Token], is_for: bool) -> bool {
    let mut words = condition.iter().filter(|t| !t.is("(") && !t.is(")"));
    match words.next() {
        None => is_for,
        Some(word) => word.is("true") && words.next().is_none(),
    }
}

/// The position of the bracket that closes the bracket at `open`, if it is closed.
fn closing(tokens: &[Token], open: usize) -> Option<usize> {
    let mut depth = 0usize;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "{" | "[" => depth += 1,
            ")" | "}" | "]" => depth = depth.checked_sub(1)?,
            _ => (),
        }
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// The block that begins at `at`, or the tokens up to the next semicolon.
fn statement<'a, 'b>(tokens: &'a [Token<'b>], at: usize) -> &'a [Token<'b>] {
    let rest = tokens.get(at..).unwrap_or_default();
    if rest.first().is_some_and(|token| token.is("{")) {
        let end = closing(tokens, at).unwrap_or(tokens.len());
        return &tokens[at..end];
    }
    // The end of a nested statement with a block is not determined, as in `while (true) if (…) {…}`.
    let end = rest.iter().position(|t| t.is(";") || t.is("}"));
    match end {
        Some(end) if !rest[..end].iter().any(|t| t.is("{")) => &rest[..end],
        _ => tokens,
    }
}

/// The block of the `do {…} while` whose `while` is at `at`; empty for a `while` without `do`.
fn done_before<'a, 'b>(tokens: &'a [Token<'b>], at: usize) -> &'a [Token<'b>] {
    let mut depth = 0usize;
    for start in (0..at).rev() {
        match tokens[start].text {
            "}" => depth += 1,
            "{" if depth == 1 => {
                let is_do = start > 0 && tokens[start - 1].is("do");
                return if is_do { &tokens[start..at] } else { &[] };
            }
            "{" => depth -= 1,
            _ if depth == 0 => return &[],
            _ => (),
        }
    }
    &[]
}
