//! Where things stand in the text of a scene, strings and comments left out: for changes that
//! keep all else as it was written.

use std::ops::Range;

/// `Value("name", number)` in a text.
pub struct Said {
    /// The name, read.
    pub name: String,
    /// Where the number stands.
    pub number: Range<usize>,
}

/// Everywhere that a text has a named value.
pub fn named_values(text: &str) -> Vec<Said> {
    const WORD: &str = "Value";
    let mut all = Vec::new();
    for (index, symbol) in symbols(text, 0..text.len()) {
        if symbol != '(' || !text[..index].trim_end().ends_with(WORD) {
            continue;
        }
        let Some(within) = inside(text, index) else {
            continue;
        };
        let Some((comma, _)) = symbols(text, within.clone()).find(|(_, symbol)| *symbol == ',')
        else {
            continue;
        };
        let end = symbols(text, comma + 1..within.end).find(|(_, symbol)| *symbol == ',');
        let number = comma + 1..end.map_or(within.end, |(end, _)| end);
        // The name as the file's grammar reads it, comments and escapes included.
        let name = ron::from_str::<(String, f32)>(&format!("({})", &text[within.clone()]));
        if let Ok((name, _)) = name {
            all.push(Said { name, number });
        }
    }
    all
}

/// Where a field stands.
pub struct Field {
    /// Its value.
    pub value: Range<usize>,
    /// All of it, the comma behind it included.
    pub whole: Range<usize>,
}

/// What is between the first bracket from `start` on and its partner.
pub fn inside(text: &str, start: usize) -> Option<Range<usize>> {
    let mut depth = 0usize;
    let mut open = None;
    for (index, symbol) in symbols(text, start..text.len()) {
        match symbol {
            '(' | '[' | '{' => {
                open.get_or_insert(index + 1);
                depth += 1;
            }
            ')' | ']' | '}' => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(open?..index);
                }
            }
            _ => {}
        }
    }
    None
}

/// The field `name` of the structure whose fields stand in `within`.
pub fn field(text: &str, within: Range<usize>, name: &str) -> Option<Field> {
    let mut depth = 0;
    let mut found: Option<Range<usize>> = None;
    let mut word = within.start..within.start;
    for (index, symbol) in symbols(text, within.clone()) {
        match symbol {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ':' if depth == 0 && found.is_none() && &text[word.clone()] == name => {
                found = Some(word.start..index + 1);
            }
            ',' if depth == 0 => {
                if let Some(key) = found {
                    return Some(trimmed(text, key, index, index + 1));
                }
            }
            _ => {}
        }
        // The last word is the key that a colon follows.
        if symbol.is_alphanumeric() || symbol == '_' {
            let end = index + symbol.len_utf8();
            word = if word.end == index {
                word.start..end
            } else {
                index..end
            };
        }
    }
    found.map(|key| trimmed(text, key, within.end, within.end))
}

fn trimmed(text: &str, key: Range<usize>, end: usize, whole_end: usize) -> Field {
    let value = &text[key.end..end];
    let start = end - value.trim_start().len();
    Field {
        value: start..start + value.trim().len(),
        whole: key.start..whole_end,
    }
}

/// The characters that mean something: neither in a string nor in a comment.
fn symbols(text: &str, within: Range<usize>) -> impl Iterator<Item = (usize, char)> + '_ {
    let mut at = within.start;
    std::iter::from_fn(move || {
        while at < within.end {
            let rest = &text[at..within.end];
            let skipped = if rest.starts_with("//") {
                rest.find('\n').unwrap_or(rest.len())
            } else if rest.starts_with("/*") {
                rest.find("*/").map_or(rest.len(), |end| end + 2)
            } else if rest.starts_with('"') {
                string_length(rest)
            } else {
                let symbol = rest.chars().next()?;
                let index = at;
                at += symbol.len_utf8();
                return Some((index, symbol));
            };
            at += skipped;
        }
        None
    })
}

/// Bytes of the string at the beginning, quotes included.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (index, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return index + 1,
            _ => {}
        }
    }
    text.len()
}
