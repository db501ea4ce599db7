//! Prepares untrusted text for display: on a terminal, in a CSV cell, within a page.

use std::borrow::Cow;

/// Maximum characters of a name in a scene or in answers.
pub(crate) const LONGEST_NAME: usize = 200;

/// Maximum lines of a message.
#[cfg(feature = "cli")]
const MOST_LINES: usize = 10;

/// Maximum characters of a message.
#[cfg(feature = "cli")]
const MOST_CHARACTERS: usize = 1000;

/// The known word most similar to a mistyped one, if any: apart from case, spaces and underscores,
/// at most a third of it may be mistyped.
pub(crate) fn nearest<'a>(
    typed: &str,
    known: impl IntoIterator<Item = impl Into<&'a str>>,
) -> Option<&'a str> {
    let plain = |word: &str| word.to_lowercase().replace([' ', '_'], "-");
    let typed = plain(typed);
    let known = known.into_iter().map(Into::into);
    let measured = known.map(|word| (strsim::damerau_levenshtein(&typed, &plain(word)), word));
    let (wrong, nearest) = measured.min()?;
    (3 * wrong <= nearest.len()).then_some(nearest)
}

/// States that `typed` does not exist, the known names, and the most similar one; `what` is its kind, such as
/// `profile`.
pub(crate) fn there_is_no(what: &str, typed: &str, known: &[&str]) -> String {
    which_there_are(&format!("there is no {what} {typed:?}"), typed, known)
}

/// Appends the known name most similar to what was typed, or else all known names, to a message.
pub(crate) fn nearest_or_all(refused: &str, typed: &str, known: &[&str]) -> String {
    match nearest(typed, known.iter().copied()) {
        Some(nearest) => format!("{refused}; did you mean {nearest}?"),
        None => format!("{refused}; there are {}", known.join(", ")),
    }
}

/// Appends all known names, and the one most similar to what was typed, to a message.
pub(crate) fn which_there_are(refused: &str, typed: &str, known: &[&str]) -> String {
    let told = format!("{refused}; there are: {}", known.join(", "));
    match nearest(typed, known.iter().copied()) {
        Some(nearest) => format!("{told}; did you mean {nearest}?"),
        None => told,
    }
}

/// The text in one line, for a terminal: invisible characters (escape codes and other controls,
/// ends of lines, changes of direction, zero-width spaces) are escaped as in Rust.
pub(crate) fn in_a_line(text: &str) -> Cow<'_, str> {
    spelled_out(text, |_| false)
}

/// As [`in_a_line`], but keeps ends of lines and tabs.
#[cfg(feature = "cli")]
pub(crate) fn in_lines(text: &str) -> Cow<'_, str> {
    spelled_out(text, |c| c == '\n' || c == '\t')
}

/// As [`in_lines`], cut to a readable length: 10 lines, 1,000 characters. Later lines are indented,
/// so that none looks like a separate message.
#[cfg(feature = "cli")]
pub(crate) fn message(text: &str) -> String {
    let text = in_lines(text.trim_end());
    let lines: Vec<&str> = text.lines().collect();
    cut_characters(&cut_lines(&lines).join("\n  "))
}

/// Whether [`message`] would show all of the text's characters unchanged.
#[cfg(feature = "cli")]
pub(crate) fn is_showable(text: &str) -> bool {
    text.len() <= MOST_CHARACTERS && matches!(in_lines(text), Cow::Borrowed(_))
}

/// Keeps the first and the last lines: the error is at the start or at the end.
#[cfg(feature = "cli")]
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
#[cfg(feature = "cli")]
fn cut_characters(text: &str) -> String {
    const LAST: usize = 300;
    /// Room for the text in between.
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

/// JSON for a terminal: invisible characters are written as `\u…` escapes of JSON.
#[cfg(feature = "cli")]
pub(crate) fn json(text: &str) -> Cow<'_, str> {
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

/// A record of JSON in one line, for a program that reads standard error: as [`json`], and at most
/// as long as a message. For a longer one only the length is reported.
#[cfg(all(feature = "cli", feature = "demo"))]
pub(crate) fn json_record(text: &str) -> Cow<'_, str> {
    let shown = json(text);
    match shown.chars().count() {
        count if count > MOST_CHARACTERS => {
            format!("{{\"left_out\":\"{count} characters\"}}").into()
        }
        _ => shown,
    }
}

/// JSON for a `script` element, without characters that have a meaning in HTML. Any JSON reader
/// reads the same.
#[cfg(feature = "experiment")]
pub(crate) fn json_in_html(text: &str) -> String {
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

#[cfg(feature = "experiment")]
fn push_json(json: &mut String, c: char) {
    use std::fmt::Write;
    for unit in c.encode_utf16(&mut [0; 2]) {
        // Writing to a string never fails.
        let _ = write!(json, "\\u{unit:04x}");
    }
}

/// Text for a CSV cell: in one line, with an apostrophe before anything that a spreadsheet would
/// take for a formula.
#[cfg(feature = "experiment")]
pub(crate) fn csv_cell(text: &str) -> String {
    let text = in_a_line(text);
    match text.trim_start().chars().next() {
        Some('=' | '+' | '-' | '@' | '＝' | '＋' | '－' | '＠') => format!("'{text}"),
        _ => text.into_owned(),
    }
}

/// Text for Markdown, including a table's cell: it cannot create a tag, a link or a column.
#[cfg(feature = "experiment")]
pub(crate) fn markdown(text: &str) -> String {
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

/// Rejects an invalid name with a sentence that lacks its subject.
pub(crate) fn check_name(name: &str) -> Result<(), String> {
    let count = name.chars().count();
    if count > LONGEST_NAME {
        return Err(format!(
            "has {count} characters: at most {LONGEST_NAME} are allowed"
        ));
    }
    match name.chars().find(|c| is_hidden(*c)) {
        Some(c) => Err(format!(
            "holds {:?}, which cannot be shown: leave it out",
            c.escape_default().to_string()
        )),
        None => Ok(()),
    }
}

fn spelled_out(text: &str, stays: fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(|c| is_hidden(c) && !stays(c)) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) && !stays(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// Whether a character is invisible, or changes how others are displayed.
fn is_hidden(c: char) -> bool {
    if c.is_ascii() {
        return c.is_ascii_control();
    }
    // Characters that Rust escapes in a string's `Debug` are hidden, except spaces that have a
    // width. Combining marks are visible; Rust escapes them only when they stand alone.
    const WIDE_SPACES: [char; 17] = [
        '\u{a0}', '\u{1680}', '\u{2000}', '\u{2001}', '\u{2002}', '\u{2003}', '\u{2004}',
        '\u{2005}', '\u{2006}', '\u{2007}', '\u{2008}', '\u{2009}', '\u{200a}', '\u{202f}',
        '\u{205f}', '\u{3000}', '\u{ad}',
    ];
    let mut after_a_letter = String::from("a");
    after_a_letter.push(c);
    let is_spelled_out = after_a_letter.escape_debug().count() > 2;
    is_spelled_out && !WIDE_SPACES.contains(&c)
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    /// Protects terminals: a text cannot move the cursor, begin a line or change the writing
    /// direction.
    #[test]
    fn what_is_not_seen_is_spelled_out() {
        let shown =
            in_a_line("a\u{1b}[31mb\nc\u{202e}d\u{200b}e\u{9b}f\u{2028}g\u{7f}\r\t\u{feff}");
        assert_eq!(
            shown,
            r"a\u{1b}[31mb\nc\u{202e}d\u{200b}e\u{9b}f\u{2028}g\u{7f}\r\t\u{feff}"
        );
        for plain in [
            "Sjöberg’s “room” – 3 × 4 …",
            "e\u{301}, 部屋, \u{a0}«x»",
            "\"\\'",
            "",
        ] {
            assert_eq!(in_a_line(plain), plain);
        }
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

    /// Protects pages: a text neither ends the script element nor begins another, and a reader of
    /// JSON gets it back.
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

    /// Protects readers of a window's records: each is JSON in one line, does not move the cursor,
    /// and is at most as long as a message.
    #[cfg(all(feature = "cli", feature = "demo"))]
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

    /// Protects spreadsheets from executing the name of a scene.
    #[test]
    fn cells_are_no_formulas() {
        for formula in ["=1+1", "+1", "-1", "@x", " =1", "\u{3000}=x", "＝1"] {
            assert!(csv_cell(formula).starts_with('\''), "{formula}");
        }
        assert_eq!(csv_cell("corner"), "corner");
        assert_eq!(csv_cell("\t=1"), "\\t=1");
    }

    /// Protects names: any displayable text is allowed, in any script.
    #[test]
    fn names_can_be_shown() {
        assert!(check_name("Sjöbergs 部屋 <=>").is_ok());
        assert!(check_name("a\nb").is_err() && check_name("\u{202e}").is_err());
        assert!(check_name(&"x".repeat(LONGEST_NAME)).is_ok());
        assert!(check_name(&"x".repeat(LONGEST_NAME + 1)).is_err());
    }
}
