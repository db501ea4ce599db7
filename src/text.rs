//! Prepares untrusted text for display: on a terminal, in a CSV cell, in a page.

use std::borrow::Cow;

/// Maximum number of characters of a name in a scene or in answers.
pub const LONGEST_NAME: usize = 200;

/// The known word that is most similar to a mistyped word, if the number of different characters is at most a third of
/// the known word's length. Case is ignored, and spaces and underscores count as hyphens.
pub fn nearest<'a>(
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

/// The message for an unknown name: all known names, and the name most similar to `typed`. `what` is the kind of name,
/// such as `profile`.
pub fn there_is_no(what: &str, typed: &str, known: &[&str]) -> String {
    which_there_are(&format!("there is no {what} {typed:?}"), typed, known)
}

/// Appends to the message the most similar known name, else the known names that have a word in common with the typed
/// one, such as `wood-floor` for `wood`, else all known names.
pub fn nearest_or_all(refused: &str, typed: &str, known: &[&str]) -> String {
    let similar = match nearest(typed, known.iter().copied()) {
        Some(nearest) => vec![nearest],
        None => with_common_word(typed, known),
    };
    match similar.is_empty() {
        true => format!("{refused}; there are {}", known.join(", ")),
        false => format!("{refused}; did you mean {}?", similar.join(" or ")),
    }
}

/// The known names of which a word contains a word of the typed name, or the other way round.
fn with_common_word<'a>(typed: &str, known: &[&'a str]) -> Vec<&'a str> {
    const LEAST_LETTERS: usize = 4;
    let words = |name: &str| -> Vec<String> {
        let name = name.to_lowercase();
        let words = name.split(|c: char| !c.is_alphanumeric());
        let words = words.filter(|word| word.chars().count() >= LEAST_LETTERS);
        words.map(str::to_owned).collect()
    };
    let typed = words(typed);
    let is_common = |word: &String| {
        let mut typed = typed.iter();
        typed.any(|other| word.contains(other.as_str()) || other.contains(word.as_str()))
    };
    let known = known.iter().copied();
    known
        .filter(|name| words(name).iter().any(is_common))
        .collect()
}

/// Appends all known names, and the known name that is most similar to the typed name, to a message.
pub fn which_there_are(refused: &str, typed: &str, known: &[&str]) -> String {
    let with_all = format!("{refused}; there are: {}", known.join(", "));
    with_nearest(with_all, typed, known.iter().copied())
}

/// Appends the names of a scene's parts, and the name that is most similar to the typed name, to a message.
pub fn which_it_has(refused: &str, typed: &str, names: &[String]) -> String {
    if names.is_empty() {
        return format!("{refused}; it has none");
    }
    let with_all = format!("{refused}; it has: {}", names.join(", "));
    with_nearest(with_all, typed, names.iter().map(String::as_str))
}

fn with_nearest<'a>(message: String, typed: &str, known: impl Iterator<Item = &'a str>) -> String {
    match nearest(typed, known) {
        Some(nearest) => format!("{message}; did you mean {nearest}?"),
        None => message,
    }
}

/// The text in one line, for a terminal. Invisible characters (escape codes and other controls, ends of lines, changes
/// of direction, zero-width spaces) are escaped as in Rust.
pub fn in_a_line(text: &str) -> Cow<'_, str> {
    spelled_out(text, |_| false)
}

/// Checks a name; the error is a sentence without its subject.
pub fn check_name(name: &str) -> Result<(), String> {
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

pub fn spelled_out(text: &str, stays: fn(char) -> bool) -> Cow<'_, str> {
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
pub fn is_hidden(c: char) -> bool {
    if c.is_ascii() {
        return c.is_ascii_control();
    }
    // Characters that Rust escapes in a string's `Debug` count as hidden, except spaces that have a width. Combining
    // marks are visible; Rust escapes them only when they stand alone.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects users who know a material by a part of its name: all names with this word are suggested, otherwise all
    /// names.
    #[test]
    fn names_with_a_common_word_are_suggested() {
        let known = ["brick", "mineral-wool", "wood-floor", "wood-panel"];
        let told = |typed| nearest_or_all("no", typed, &known);
        assert_eq!(told("wood"), "no; did you mean wood-floor or wood-panel?");
        assert_eq!(
            told("Wooden wall"),
            "no; did you mean wood-floor or wood-panel?"
        );
        assert_eq!(told("wool"), "no; did you mean mineral-wool?");
        assert_eq!(told("glass_wool"), "no; did you mean mineral-wool?");
        assert_eq!(told("bric"), "no; did you mean brick?");
        let all = "no; there are brick, mineral-wool, wood-floor, wood-panel";
        assert_eq!((told("oak"), told("")), (all.to_owned(), all.to_owned()));
    }

    /// Protects terminals: a text cannot move the cursor, begin a line or change the writing direction.
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
