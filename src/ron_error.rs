//! Errors in RON texts, in the terms of scene files and study files.
//!
//! RON's own errors mention structs, enums and identifiers. An author of a scene or a study knows fields, names, lists
//! and numbers.

use crate::text::{there_is_no, which_there_are};
use ron::error::{Error, Position, SpannedError};

/// Fields that are lengths in metres: the message for a missing field states the unit.
const METRES: [&str; 3] = ["radius", "size", "radii"];

/// A kind of file in RON.
#[derive(Clone, Copy)]
pub struct FileKind {
    /// The first word of its text: `Scene`.
    pub outermost: &'static str,
    /// The name of such a file in messages: `scene`.
    pub what: &'static str,
}

pub const SCENE: FileKind = FileKind {
    outermost: "Scene",
    what: "scene",
};

pub const STUDY: FileKind = FileKind {
    outermost: "Study",
    what: "study",
};

/// The message for `error` in `text`, the content of a file of this kind.
pub fn sentence(text: &str, error: &SpannedError, kind: FileKind) -> String {
    if text.trim().is_empty() {
        return format!("the file is empty: {}", begins(kind));
    }
    if is_foreign_comment(text, error) {
        return "a comment begins with //, not with #".to_owned();
    }
    match &error.code {
        Error::Eof => ends(kind),
        Error::TrailingCharacters => format!(
            "{}(…) ends before this: is a parenthesis closed too early?",
            kind.outermost
        ),
        Error::ExpectedDifferentStructName { expected, found } => {
            let told = other_name(kind, expected, found);
            match *expected != kind.outermost && is_unclosed(text) {
                true => format!("{told}{MAYBE_UNCLOSED}"),
                false => told,
            }
        }
        Error::ExpectedNamedStructLike(name) if *name == kind.outermost => begins(kind),
        code => of_name(code)
            .map(|told| match code {
                Error::NoSuchStructField { .. } if is_unclosed(text) => {
                    format!("{told}{MAYBE_UNCLOSED}")
                }
                _ => told,
            })
            .or_else(|| of_end(text, error, kind))
            .or_else(|| of_wrong_bracket(text, error))
            .or_else(|| of_many_values(text, error))
            .or_else(|| of_form(code, Around::of(text, error.span.start)))
            .or_else(|| of_sign(code))
            .unwrap_or_else(|| code.to_string()),
    }
}

/// The position of the quote that causes an error because it is not closed in its line, and the message. A text with
/// an unclosed quote goes on to the quote of another text, often some lines below.
pub fn unclosed_quote(text: &str, error: &SpannedError) -> Option<(Position, String)> {
    let opened = marks(text).quote_over_lines?;
    if offset(text, error.span.end)? < opened {
        return None;
    }
    let above = &text[..opened];
    let begin = above.rfind('\n').map_or(0, |at| at + 1);
    let place = Position {
        line: 1 + above.matches('\n').count(),
        col: 1 + above[begin..].chars().count(),
    };
    let told = "the quote that starts here is not closed in this line".to_owned();
    Some((place, told))
}

/// The addition to a message where a closing bracket may be missing.
const MAYBE_UNCLOSED: &str = "; or is a closing bracket missing before it?";

fn begins(kind: FileKind) -> String {
    format!("a {} file begins with {}(…)", kind.what, kind.outermost)
}

fn ends(kind: FileKind) -> String {
    format!("the file ends before {}(…) is closed", kind.outermost)
}

/// The message for an error at the end of a text: the text is truncated.
fn of_end(text: &str, error: &SpannedError, kind: FileKind) -> Option<String> {
    let is_of_value = matches!(error.code, Error::Message(_));
    let at = offset(text, error.span.end)?;
    (!is_of_value && text[at..].trim().is_empty()).then(|| ends(kind))
}

/// The message for an unexpected struct name.
fn other_name(kind: FileKind, expected: &str, found: &str) -> String {
    match (expected == kind.outermost, found) {
        (true, "Scene") => {
            "this is a scene; a study names it: Study(scenes: [Scene(of: \"FILE.ron\")])".to_owned()
        }
        (true, "Study") => "this is a study: echomarch study FILE.ron runs it".to_owned(),
        (true, _) => format!("{}, not with {found}", begins(kind)),
        (false, _) => format!("expected {expected}(…) here, not {found}"),
    }
}

/// The message for an unknown, missing or repeated name.
fn of_name(code: &Error) -> Option<String> {
    let within = |outer: &Option<String>| {
        outer
            .as_ref()
            .map_or(String::new(), |of| format!(" in `{of}`"))
    };
    Some(match code {
        Error::NoSuchStructField {
            expected,
            found,
            outer,
        } => field_unknown(found, &within(outer), expected),
        Error::NoSuchEnumVariant {
            expected,
            found,
            outer,
        } => there_is_no(outer.as_deref().unwrap_or("name"), found, expected),
        Error::MissingStructField { field, outer } => {
            let unit = if METRES.contains(field) {
                " (in metres)"
            } else {
                ""
            };
            format!("`{field}`{unit} is missing{}", within(outer))
        }
        Error::DuplicateStructField { field, outer } => {
            format!("`{field}` is given twice{}", within(outer))
        }
        _ => return None,
    })
}

/// Whether more brackets are opened than closed, outside of comments and quoted texts.
fn is_unclosed(text: &str) -> bool {
    let step = |(_, bracket)| if closing(bracket).is_some() { 1 } else { -1 };
    brackets(text).into_iter().map(step).sum::<i64>() > 0
}

/// The bracket that closes an opening bracket; `None` for another character.
fn closing(open: char) -> Option<char> {
    Some(match open {
        '(' => ')',
        '[' => ']',
        '{' => '}',
        _ => return None,
    })
}

/// The innermost bracket that is open at the end of the text, with its byte offset.
fn innermost_open(text: &str) -> Option<(usize, char)> {
    let mut open = Vec::new();
    for (at, bracket) in brackets(text) {
        match closing(bracket) {
            Some(_) => open.push((at, bracket)),
            None => drop(open.pop()),
        }
    }
    open.pop()
}

/// Whether the error is at the sign `#`, with which comments of other languages begin.
fn is_foreign_comment(text: &str, error: &SpannedError) -> bool {
    let at = offset(text, error.span.start);
    let is_sign = at.is_some_and(|at| text[at..].trim_start().starts_with('#'));
    let begins = text.trim_start().starts_with('#') && !text.trim_start().starts_with("#!");
    begins || is_sign && !matches!(error.code, Error::Message(_))
}

/// The message for an error at a bracket that does not close the innermost open one, or that opens where a field is
/// expected.
fn of_wrong_bracket(text: &str, error: &SpannedError) -> Option<String> {
    if matches!(error.code, Error::Message(_)) {
        return None;
    }
    let at = offset(text, error.span.start)?;
    let found = text[at..].trim_start().chars().next()?;
    let is_of_field = matches!(error.code, Error::ExpectedIdentifier);
    if is_of_field && closing(found).is_some() && text[..at].trim_end().ends_with(',') {
        return Some(format!("expected the name of a field here{MAYBE_UNCLOSED}"));
    }
    if !matches!(found, ')' | ']' | '}') {
        return None;
    }
    let (opened, open) = innermost_open(&text[..at])?;
    let wanted = closing(open).filter(|wanted| *wanted != found)?;
    let line = 1 + text[..opened].matches('\n').count();
    Some(format!(
        "expected {wanted} before this {found}: the {open} in line {line} is not closed"
    ))
}

/// The message for more values in parentheses than are expected.
fn of_many_values(text: &str, error: &SpannedError) -> Option<String> {
    if !matches!(error.code, Error::ExpectedStructLikeEnd) {
        return None;
    }
    let at = offset(text, error.span.start)?;
    let before = text[..at].trim_end();
    let (opened, _) = innermost_open(before).filter(|(_, open)| *open == '(')?;
    let is_value = before.ends_with(',') && text[..opened].trim_end().ends_with(':');
    let wanted = before[opened..].matches(',').count();
    // Values in parentheses or after a comment have commas of their own.
    let is_plain = !before[opened + 1..].contains(['(', '[', '{', '/', '"']);
    (is_value && is_plain).then(|| {
        format!(
            "expected {wanted} values here, not more{}",
            named_values(wanted)
        )
    })
}

/// The names of the values of a point or a size.
fn named_values(count: usize) -> &'static str {
    if count == 3 { ": (x, y, z)" } else { "" }
}

/// The brackets of a text outside of comments and quoted texts, with their byte offsets.
fn brackets(text: &str) -> Vec<(usize, char)> {
    marks(text).brackets
}

/// The marks of a text outside of comments, with their byte offsets.
#[derive(Default)]
struct Marks {
    /// The brackets outside of quoted texts.
    brackets: Vec<(usize, char)>,
    /// The first quote whose text has a line break. Raw texts (`r"…"`) may have one.
    quote_over_lines: Option<usize>,
}

fn marks(text: &str) -> Marks {
    let mut found = Marks::default();
    let mut is_quoted = false;
    let mut quote = 0;
    let mut chars = text.char_indices().peekable();
    while let Some((at, next)) = chars.next() {
        let behind = chars.peek().map(|(_, behind)| *behind);
        match next {
            '\\' if is_quoted => drop(chars.next()),
            '"' => {
                is_quoted = !is_quoted;
                quote = at;
            }
            '\n' if is_quoted && !text[..quote].ends_with(['r', '#']) => {
                found.quote_over_lines.get_or_insert(quote);
            }
            _ if is_quoted => {}
            '/' if behind == Some('/') => drop(chars.find(|(_, c)| *c == '\n')),
            '/' if behind == Some('*') => {
                let mut before = ' ';
                for (_, next) in chars.by_ref() {
                    if (before, next) == ('*', '/') {
                        break;
                    }
                    before = next;
                }
            }
            '(' | '[' | '{' | ')' | ']' | '}' => found.brackets.push((at, next)),
            _ => {}
        }
    }
    found
}

/// Reports an unknown field of a part, and lists the known fields.
fn field_unknown(found: &str, within: &str, known: &[&str]) -> String {
    which_there_are(
        &format!("there is no field `{found}`{within}"),
        found,
        known,
    )
}

/// The text around an error.
#[derive(Clone, Copy, Default)]
struct Around<'a> {
    /// The field whose value is wrong, if the error is at the beginning of the value.
    field: Option<&'a str>,
    /// The name of the part, if the error is at the beginning of its fields.
    opened: Option<&'a str>,
    /// The word, number or text at the error.
    found: &'a str,
}

impl<'a> Around<'a> {
    fn of(text: &'a str, place: Position) -> Around<'a> {
        let Some(at) = offset(text, place) else {
            return Around::default();
        };
        let (before, behind) = text.split_at(at);
        let is_of_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+');
        let word_before = |sign: char| {
            let named = before.trim_end().strip_suffix(sign)?;
            let begin = named.char_indices().rfind(|(_, c)| !is_of_word(*c));
            let word = &named[begin.map_or(0, |(at, c)| at + c.len_utf8())..];
            (!word.is_empty()).then_some(word)
        };
        let behind = behind.trim_start();
        let end = behind.find(|c: char| !is_of_word(c));
        Around {
            field: word_before(':'),
            opened: word_before('('),
            found: &behind[..end.unwrap_or(behind.len())],
        }
    }

    /// States the required form of the field, or of the text at the error.
    fn must_be(self, what: &str, example: &str) -> String {
        match self.field {
            Some(field) => format!("{field} must be {what}: {field}: {example}"),
            None => format!("expected {what} here: {example}"),
        }
    }
}

/// The message for a value of the wrong form.
fn of_form(code: &Error, around: Around) -> Option<String> {
    Some(match code {
        Error::ExpectedArray => {
            let example = match around.found {
                "" => "[…]".to_owned(),
                found if found.starts_with(char::is_alphabetic) => format!("[{found}(…)]"),
                found => format!("[{found}]"),
            };
            around.must_be("a list in brackets", &example)
        }
        Error::ExpectedStructLike => around.must_be(
            "in parentheses",
            "(…), for example three numbers: (x, y, z)",
        ),
        Error::ExpectedNamedStructLike(name) => format!("expected {name}(…) here"),
        Error::ExpectedMap => around.must_be("names and values in braces", "{\"name\": …}"),
        Error::ExpectedString => match around.found {
            "" => around.must_be("a text in quotes", "\"…\""),
            found => around.must_be("a text in quotes", &format!("\"{found}\"")),
        },
        Error::InvalidIdentifier(_) | Error::SuggestRawIdentifier(_)
            if around
                .found
                .starts_with(|c: char| c.is_ascii_digit() || c == '-') =>
        {
            around.must_be("a list of numbers", &format!("List([{}])", around.found))
        }
        Error::InvalidIdentifier(_)
        | Error::SuggestRawIdentifier(_)
        | Error::ExpectedIdentifier => match around.opened {
            Some(part) => format!("expected a field with its name here: {part}(field: value)"),
            None => "expected a name here".to_owned(),
        },
        Error::ExpectedDifferentLength { expected, found } => {
            let wanted: String = expected.chars().filter(char::is_ascii_digit).collect();
            let wanted: usize = wanted.parse().ok()?;
            let names = named_values(wanted);
            format!("expected {wanted} values here, not {found}{names}")
        }
        _ => return None,
    })
}

/// The message for an error in a number or punctuation.
fn of_sign(code: &Error) -> Option<String> {
    let told = match code {
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. } => {
            "expected a whole number here, such as 65536 or 65_536"
        }
        Error::IntegerOutOfBounds => "this whole number is too large, or below 0",
        Error::ExpectedFloat => "expected a number here",
        Error::ExpectedBoolean => "expected true or false here",
        Error::ExpectedComma => "expected a comma or a closing bracket here",
        Error::ExpectedArrayEnd => "expected a comma or a closing ] here",
        Error::ExpectedMapColon => "expected a colon here",
        Error::ExpectedMapEnd => "expected a comma or a closing } here",
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => "expected a closing ) here",
        Error::ExpectedStringEnd => "a text has no closing quote",
        Error::UnclosedBlockComment => "a comment /* has no */",
        _ => return None,
    };
    Some(told.to_owned())
}

/// Byte offset of a position in a text.
pub fn offset(text: &str, place: Position) -> Option<usize> {
    let mut lines = text.split_inclusive('\n');
    let above = lines.by_ref().take(place.line.checked_sub(1)?);
    let start: usize = above.map(str::len).sum();
    let line = lines.next()?;
    let at = line.char_indices().nth(place.col.checked_sub(1)?);
    Some(start + at.map_or(line.len(), |(at, _)| at))
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;

    fn told(text: &str) -> String {
        Scene::from_ron(text, "f").unwrap_err().to_string()
    }

    /// Protects messages on files that are wrong as a whole: empty, truncated, or of another kind.
    #[test]
    fn a_file_that_is_no_scene_is_told_what_it_is() {
        for (text, sentence) in [
            ("", "the file is empty: a scene file begins with Scene(…)"),
            (" \n", "the file is empty"),
            (
                "scene()",
                "a scene file begins with Scene(…), not with scene",
            ),
            ("3", "a scene file begins with Scene(…)"),
            ("Study(scenes: [])", "this is a study: echomarch study"),
            (
                "Scene(surfaces: [",
                "the file ends before Scene(…) is closed",
            ),
        ] {
            assert!(told(text).contains(sentence), "{text}: {}", told(text));
        }
        let early = "Scene(surfaces: [], source: Source(), listener: Listener(radius: 1)), x";
        assert!(told(early).contains("closed too early?"), "{}", told(early));
    }

    /// Protects messages on values of the wrong form from Rust terms.
    #[test]
    fn values_of_the_wrong_form_are_told_how_they_are_written() {
        for (field, sentence) in [
            (
                "source: Source(position: [0, -1, 0])",
                "position must be in parentheses",
            ),
            (
                "source: Source(position: \"0,0,0\")",
                "position must be in parentheses",
            ),
            (
                "source: Source(position: (0, 0))",
                "expected 3 values here, not 2: (x, y, z)",
            ),
            (
                "source: Source(position: (0, 0, 0, 0))",
                "expected 3 values here, not more: (x, y, z)",
            ),
            (
                "sources: Source()",
                "sources must be a list in brackets: sources: [Source(…)]",
            ),
            (
                "source: Source((0, -1, 0))",
                "expected a field with its name here: Source(field: value)",
            ),
            ("name: 12", "name must be a text in quotes: name: \"12\""),
            (
                "listener: Listener()",
                "`radius` (in metres) is missing in `Listener`",
            ),
            (
                "surfcaes: []",
                "there is no field `surfcaes` in `Scene`; there are: name, ",
            ),
            (
                "name: \"a\", name: \"b\"",
                "`name` is given twice in `Scene`",
            ),
        ] {
            let said = told(&format!("Scene(surfaces: [],\n {field})"));
            assert!(said.starts_with("f:2:"), "{said}");
            assert!(said.contains(sentence), "{field}: {said}");
        }
    }

    /// Protects authors who forget a bracket before another one closes, or begin a comment with `#`.
    #[test]
    fn wrong_brackets_and_foreign_comments_are_named() {
        let unclosed = "f:2:2: expected ) before this ]: the ( in line 1 is not closed";
        let comment = "a comment begins with //, not with #";
        let maybe = "or is a closing bracket missing before it?";
        for (text, sentence) in [
            ("Scene(surfaces: [Surface(shape: Plane,\n ])", unclosed),
            ("Scene(surfaces: [Surface(shape: Plane\n ])", unclosed),
            (
                "Scene(surfaces: [Surface(shape: Plane /* ) */\n ])",
                unclosed,
            ),
            (
                "Scene(surfaces: [Surface(shape: Box(size: (1, 2, 3),\n ])",
                unclosed,
            ),
            (
                "Scene(surfaces: [Surface(shape: Rooms(of: [(from: (0, 0, 0), (from: (0, 0, 0))]))])",
                maybe,
            ),
            (
                "Scene(surfaces: [Surface(shape: Plane), source: Source())",
                maybe,
            ),
            ("# hall\nScene()", comment),
            ("Scene(# hall\n surfaces: [])", comment),
            (
                "Scene(surfaces: [Surface(shape: Plane), # wall\n])",
                comment,
            ),
            (
                "Scene(surfaces: [Surface( # wall\n shape: Plane)])",
                comment,
            ),
            ("Scene(surfaces: [Surface(shape: Plane # wall\n)])", comment),
            ("Scene(name: \"a\" # hall\n)", comment),
        ] {
            assert!(told(text).contains(sentence), "{text}: {}", told(text));
        }
    }

    /// Protects authors who forget a closing quote: the message names the place of this quote, not what follows from it.
    #[test]
    fn an_unclosed_quote_is_named_with_its_place() {
        let told_at = |place: &str| format!("f:{place}: the quote that starts here is not closed");
        for (text, place) in [
            (
                "Scene(surfaces: [\n Surface(material: \"brick),\n Surface(material: \"wood\")])",
                "2:20",
            ),
            ("Scene(\n name: \"hall,\n surfaces: [])", "2:8"),
            ("Scene(\n name: \"hall,\n air: \"x\")", "2:8"),
            ("Scene(/* ä \" */ name: \"\\\"hall,\n)", "1:23"),
            (
                "Scene(surfaces: [Surface(shape: Union([Plane]), material: \"brick),\n Surface(material: \"wood\")])",
                "1:59",
            ),
        ] {
            let said = told(text);
            assert!(said.starts_with(&told_at(place)), "{text}: {said}");
        }
        for other in [
            "Scene(name: hall\",\n surfaces: [])",
            "Scene(x: 1, name: \"hall,\n)",
            "Scene(/* \" \n */ x: 1)",
            "Scene(name: r\"a\nb\", x: 1)",
        ] {
            assert!(
                !told(other).contains("not closed"),
                "{other}: {}",
                told(other)
            );
        }
    }

    /// Protects authors who forget a bracket: the fields of the next part count as those of the part before, and the
    /// message says why. Brackets in comments and in quoted texts do not count.
    #[test]
    fn a_missing_bracket_is_suspected() {
        let hint = "or is a closing bracket missing before it?";
        for (text, has_hint) in [
            (
                "Scene(surfaces: [Surface(shape: Room(size: (8, 3, 5), material: \"m\")])",
                true,
            ),
            (
                "Scene(surfaces: [Surface(shape: Plane, source: Source(position: (0, 0, 0))])",
                true,
            ),
            (
                "Scene(surfaces: [Surface(shape: Plane, colour: 1)]) // (",
                false,
            ),
            ("Scene(name: \"(\", colour: 1)", false),
            ("Scene(/* ( [ */ colour: 1)", false),
        ] {
            let said = told(text);
            assert!(said.contains("there is no field"), "{said}");
            assert_eq!(said.contains(hint), has_hint, "{said}");
        }
    }
}
