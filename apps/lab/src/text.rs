//! Makes untrusted text safe to show on a terminal, in a CSV cell or in a page.

pub use echomarch::internals::text::{check_name, in_a_line};

use echomarch::internals::text::{is_hidden, spelled_out};
use std::borrow::Cow;

/// Maximum number of lines in a message.
const MOST_LINES: usize = 10;

/// Maximum number of characters in a message.
const MOST_CHARACTERS: usize = 1000;

/// Like [`in_a_line`], but keeps line ends and tabs.
pub fn in_lines(text: &str) -> Cow<'_, str> {
    spelled_out(text, |c| c == '\n' || c == '\t')
}

/// Like [`in_lines`], but shortened to 10 lines and 1,000 characters. Lines after the first are indented, so that they
/// are recognisable as parts of the message.
pub fn message(text: &str) -> String {
    let text = in_lines(text.trim_end());
    let lines: Vec<&str> = text.lines().collect();
    cut_characters(&cut_lines(&lines).join("\n  "))
}

/// Whether [`message`] leaves every character of the text unchanged.
pub fn is_showable(text: &str) -> bool {
    text.len() <= MOST_CHARACTERS && matches!(in_lines(text), Cow::Borrowed(_))
}

/// Keeps the first and the last lines, because the cause is usually at the start or at the end.
fn cut_lines(lines: &[&str]) -> Vec<String> {
    const LAST: usize = 2;
    let whole = |lines: &[&str]| -> Vec<String> { lines.iter().map(|&l| l.to_owned()).collect() };
    if lines.len() <= MOST_LINES {
        return whole(lines);
    }
    let first = MOST_LINES - 1 - LAST;
    let left_out = lines.len() - first - LAST;
    let mut kept = whole(&lines[..first]);
    kept.push(format!("… ({left_out} lines left out)"));
    kept.extend(whole(&lines[lines.len() - LAST..]));
    kept
}

/// Keeps the first and the last characters.
fn cut_characters(text: &str) -> String {
    const LAST: usize = 300;
    /// Number of characters reserved for the note in place of the removed part.
    const BETWEEN: usize = 50;
    let count = text.chars().count();
    if count <= MOST_CHARACTERS {
        return text.to_owned();
    }
    let first = MOST_CHARACTERS - LAST - BETWEEN;
    let left_out = count - first - LAST;
    let begin: String = text.chars().take(first).collect();
    let end: String = text.chars().skip(count - LAST).collect();
    format!("{begin} … ({left_out} characters left out) … {end}")
}

/// JSON for a terminal. Invisible characters are written as JSON escapes (`\u…`).
pub fn json(text: &str) -> Cow<'_, str> {
    if !text.chars().any(|c| c != '\n' && is_hidden(c)) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c != '\n' && is_hidden(c) {
            push_json(&mut shown, c);
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// A JSON record in one line, for a program that reads standard error. The record is escaped like [`json`] and at most
/// as long as a message. A longer record is replaced by its length.
pub fn json_record(text: &str) -> Cow<'_, str> {
    let shown = json(text);
    match shown.chars().count() {
        count if count > MOST_CHARACTERS => {
            format!("{{\"left_out\":\"{count} characters\"}}").into()
        }
        _ => shown,
    }
}

/// JSON for a `script` element, in which characters with a meaning in HTML are escaped. A JSON reader gets the same
/// value.
pub fn json_in_html(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' | '>' | '&' => push_json(&mut shown, c),
            c if is_hidden(c) => push_json(&mut shown, c),
            c => shown.push(c),
        }
    }
    shown
}

fn push_json(json: &mut String, c: char) {
    use std::fmt::Write;
    for unit in c.encode_utf16(&mut [0; 2]) {
        // Writing to a string never fails.
        let _ = write!(json, "\\u{unit:04x}");
    }
}

/// Text for a CSV cell, in one line. An apostrophe precedes text that a spreadsheet would interpret as a formula.
pub fn csv_cell(text: &str) -> String {
    let text = in_a_line(text);
    match text.trim_start().chars().next() {
        Some('=' | '+' | '-' | '@' | '＝' | '＋' | '－' | '＠') => format!("'{text}"),
        _ => text.into_owned(),
    }
}

/// Text for Markdown, also in a table cell, that cannot create a tag, a link or a column.
pub fn markdown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in in_a_line(text).chars() {
        match c {
            '<' => shown.push_str("&lt;"),
            '&' => shown.push_str("&amp;"),
            '|' | '[' | ']' | '`' | '*' | '\\' => shown.extend(['\\', c]),
            c => shown.push(c),
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects terminals: of the characters that move the cursor, only line ends and tabs remain.
    #[test]
    fn lines_stay() {
        assert_eq!(in_lines("a\n\tb\u{1b}"), "a\n\tb\\u{1b}");
    }

    /// Protects readers from messages that fill the screen.
    #[test]
    fn messages_are_cut() {
        let long = message(&format!("begin {} end", "x".repeat(1_000_000)));
        assert!(long.chars().count() <= MOST_CHARACTERS, "{long}");
        assert!(long.starts_with("begin x") && long.ends_with("x end"));
        let lines = message(&"line\n".repeat(1000));
        assert_eq!(lines.lines().count(), MOST_LINES);
        assert!(lines.contains("991 lines left out"), "{lines}");
        assert_eq!(message("one\n"), "one");
        assert_eq!(message("one\ntwo"), "one\n  two");
    }

    /// Protects pages: a text cannot end the script element or begin another one, and a JSON reader restores the same
    /// text.
    #[test]
    fn json_within_a_page_is_the_same_json() {
        let text = "<!--<script>\u{2028}&\u{202e}𝄞 é";
        let json = serde_json::to_string(text).unwrap();
        let inner = json_in_html(&json);
        assert!(!inner.contains(['<', '>', '&', '\u{2028}', '\u{202e}']));
        assert_eq!(serde_json::from_str::<String>(&inner).unwrap(), text);
        let shown = super::json(&json);
        assert!(shown.contains("<!--") && !shown.contains(['\u{2028}', '\u{202e}']));
        assert_eq!(serde_json::from_str::<String>(&shown).unwrap(), text);
    }

    /// Protects programs that read the window's records: each record is JSON in one line, does not move the cursor, and
    /// is at most as long as a message.
    #[test]
    fn records_are_short_json() {
        let record = |name: &str| serde_json::json!({ "scene": name }).to_string();
        let name = "a\u{1b}[31m\u{202e}b";
        let shown = json_record(&record(name)).into_owned();
        assert!(!shown.contains(['\u{1b}', '\u{202e}', '\n']));
        let read: serde_json::Value = serde_json::from_str(&shown).unwrap();
        assert_eq!(read["scene"], name);
        for name in ["x".repeat(MOST_CHARACTERS), "\u{202e}".repeat(200)] {
            let cut = json_record(&record(&name)).into_owned();
            let read: serde_json::Value = serde_json::from_str(&cut).unwrap();
            assert!(cut.len() < 100 && read["left_out"].is_string(), "{cut}");
        }
    }

    /// Protects spreadsheets from interpreting a scene's name as a formula.
    #[test]
    fn cells_are_no_formulas() {
        for formula in ["=1+1", "+1", "-1", "@x", " =1", "\u{3000}=x", "＝1"] {
            assert!(csv_cell(formula).starts_with('\''), "{formula}");
        }
        assert_eq!(csv_cell("corner"), "corner");
        assert_eq!(csv_cell("\t=1"), "\\t=1");
    }
}
