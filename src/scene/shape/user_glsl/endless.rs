//! Finds loops whose text shows that they never end.
//!
//! Software renderers end a loop after 65,536 iterations, and a compiler removes a loop whose
//! result is not used, so a trial run alone does not find them.

use super::Refusal;
use super::tokens::Token;

/// Rejects `while (true)` and similar loops without a `break` or a `return`. Loops whose condition
/// is computed at run time are left to the trial run.
pub fn check(tokens: &[Token]) -> Result<(), Refusal> {
    let endless = (0..tokens.len()).find(|&at| is_endless(tokens, at));
    match endless {
        None => Ok(()),
        Some(at) => Err((
            Some(tokens[at].line),
            "this loop never ends: its condition is always true, and there is neither a `break` \
             nor a `return` in it"
                .to_owned(),
        )),
    }
}

/// Whether an infinite loop begins, or is closed by its `while`, at this token.
fn is_endless(tokens: &[Token], at: usize) -> bool {
    let is_for = tokens[at].is("for");
    if !is_for && !tokens[at].is("while") {
        return false;
    }
    // A loop needs a condition in brackets; the driver reports its absence.
    if !tokens.get(at + 1).is_some_and(|next| next.is("(")) {
        return false;
    }
    let Some(close) = closing(tokens, at + 1) else {
        return false;
    };
    let said = &tokens[at + 2..close];
    let is_always = if is_for { condition(said) } else { said };
    if !is_true(is_always, is_for) {
        return false;
    }
    let body = match tokens.get(close + 1) {
        Some(next) if next.is(";") && !is_for => done_before(tokens, at),
        _ => statement(tokens, close + 1),
    };
    !body.iter().any(|t| t.is("break") || t.is("return"))
}

/// The part of a `for` between its two semicolons.
fn condition<'a, 'b>(said: &'a [Token<'b>]) -> &'a [Token<'b>] {
    said.split(|token| token.is(";")).nth(1).unwrap_or(said)
}

/// Whether a condition is `true`; that of a `for` may be empty.
fn is_true(condition: &[Token], is_for: bool) -> bool {
    let mut words = condition.iter().filter(|t| !t.is("(") && !t.is(")"));
    match words.next() {
        None => is_for,
        Some(word) => word.is("true") && words.next().is_none(),
    }
}

/// The bracket that closes the one at `open`.
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

/// The block, or the tokens up to a semicolon, that begins at `at`.
fn statement<'a, 'b>(tokens: &'a [Token<'b>], at: usize) -> &'a [Token<'b>] {
    let rest = tokens.get(at..).unwrap_or_default();
    if rest.first().is_some_and(|token| token.is("{")) {
        let end = closing(tokens, at).unwrap_or(tokens.len());
        return &tokens[at..end];
    }
    // The extent of a nested statement with a block is unknown, as in `while (true) if (…) {…}`.
    let end = rest.iter().position(|t| t.is(";") || t.is("}"));
    match end {
        Some(end) if !rest[..end].iter().any(|t| t.is("{")) => &rest[..end],
        _ => tokens,
    }
}

/// The block of `do {…} while`, whose `while` is at `at`; empty for a plain `while`.
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

#[cfg(test)]
mod tests {
    use super::super::read;

    fn field(body: &str) -> String {
        format!("float field(vec3 p) {{\n float a = 0.0; int i = 0;\n{body}\n return p.x; }}")
    }

    /// An infinite loop is rejected: a renderer would end it at an arbitrary iteration, without an
    /// error.
    #[test]
    fn a_loop_without_an_end_is_refused_with_its_line() {
        for body in [
            "while (true) { a += 1.0; }",
            "while ((true)) a += 1.0;",
            "while (true);",
            "for (;;) { a += 1.0; if (a > 3.0) { a = 0.0; } }",
            "for (int k = 0; ; k++) a += 1.0;",
            "for (; true; ) { }",
            "do { a += 1.0; } while (true);",
        ] {
            let (line, why) = read(&field(body)).expect_err(body);
            assert_eq!(line, Some(3), "{body}");
            assert!(why.contains("never ends"), "{body}: {why}");
        }
    }

    /// Protects loops that end by other means than their condition.
    #[test]
    fn a_loop_that_can_be_left_is_taken() {
        for body in [
            "while (true) { if (i++ > 5) break; }",
            "while (true) { if (i++ > 5) { return 1.0; } }",
            "while (true) if (i++ > 5) { break; }",
            "for (;;) { if (i++ > 5) break; }",
            "for (int k = 0; k < 4; k++) { a += 1.0; }",
            "do { a += 1.0; } while (a < 3.0);",
            "do { if (i++ > 5) break; } while (true);",
            "do { if (i++ > 5) { break; } } while (true);",
            "{ a = 1.0; } while (a < 3.0) a += 1.0;",
            "bool t = true; while (i < 3) { i++; }",
            // Invalid GLSL, which the driver reports.
            "while; for a; do {} while 1; while",
        ] {
            assert!(
                read(&field(body)).is_ok(),
                "{body}: {:?}",
                read(&field(body))
            );
        }
    }
}
