//! Splits a text into tokens, and evaluates the expressions of `#if`.

use super::Refusal;

/// Maximum length of a name or a number in characters. GLSL ES 3.00 limits names to 1024 characters, and the program
/// adds a prefix of at most 16 characters when it renames them.
const LONGEST_WORD: usize = 1024 - 16;

/// Symbols of two or three characters, the longer ones first.
const MARKS: [&str; 24] = [
    "<<=", ">>=", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "^^", "+=", "-=",
    "*=", "/=", "%=", "&=", "|=", "^=", "##", "//", "/*",
];

/// Symbols of one character; `#` begins a directive.
const SINGLE: &[u8] = b"(){}[].,;:?+-*/%<>=!&|^~#";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A name or a reserved word.
    Word,
    Number,
    Mark,
}

/// One token of a text.
#[derive(Clone, Copy, Debug)]
pub struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    /// Blanks, line breaks and comments before the token.
    pub space: &'a str,
    /// Line of the token, counted from 1. For a token from a macro, this is the line of the macro call.
    pub line: u32,
    /// Whether the token is the first in its line.
    pub is_first: bool,
}

impl Token<'_> {
    pub fn is(&self, text: &str) -> bool {
        self.text == text
    }

    pub fn is_word(&self) -> bool {
        self.kind == Kind::Word
    }
}

/// Converts the text to ASCII, as GLSL requires, with `\n` at the end of lines. Continued lines are joined, and the
/// removed line breaks are added after the joined line, so that later lines keep their numbers.
///
/// Other characters, which occur in comments, are replaced by question marks.
pub fn clean(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut out = String::with_capacity(text.len());
    let mut owed = 0;
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '\r' => {
                characters.next_if_eq(&'\n');
                end_line(&mut out, &mut owed);
            }
            '\n' => end_line(&mut out, &mut owed),
            '\\' if characters.peek().is_some_and(|c| matches!(c, '\r' | '\n')) => {
                if characters.next() == Some('\r') {
                    characters.next_if_eq(&'\n');
                }
                owed += 1;
            }
            c if !c.is_ascii() => out.push('?'),
            c if c.is_ascii_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

fn end_line(out: &mut String, owed: &mut usize) {
    out.extend(std::iter::repeat_n('\n', 1 + std::mem::take(owed)));
}

/// The tokens of a text that [`clean`] has converted, and the space after the last token.
pub fn tokens(text: &str) -> Result<(Vec<Token<'_>>, &str), Refusal> {
    let mut all = Vec::new();
    let (mut at, mut line) = (0, 1);
    loop {
        let begin = at;
        let mut is_first = begin == 0;
        (at, is_first) = space_end(text, at, is_first, line)?;
        let space = &text[begin..at];
        if at == text.len() {
            return Ok((all, space));
        }
        line += super::newlines(space);
        let (kind, length) = token(&text[at..]).map_err(|why| (Some(line), why))?;
        all.push(Token {
            kind,
            text: &text[at..at + length],
            space,
            line,
            is_first,
        });
        at += length;
    }
}

/// The end of the blanks and comments that begin at `at`, and whether they contain the beginning of a line.
fn space_end(
    text: &str,
    mut at: usize,
    mut is_first: bool,
    line: u32,
) -> Result<(usize, bool), Refusal> {
    let begin = at;
    loop {
        let rest = &text[at..];
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if let Some(inside) = rest.strip_prefix("/*") {
            let Some(length) = inside.find("*/") else {
                let line = line + super::newlines(&text[begin..at]);
                return Err((Some(line), "this /* has no */".to_owned()));
            };
            at += 2 + length + 2;
        } else if rest.starts_with([' ', '\n']) {
            is_first |= rest.starts_with('\n');
            at += 1;
        } else {
            return Ok((at, is_first));
        }
    }
}

/// Kind and length in bytes of the first token of a text.
fn token(text: &str) -> Result<(Kind, usize), String> {
    let bytes = text.as_bytes();
    let first = bytes[0];
    let second = bytes.get(1).copied().unwrap_or_default();
    let (kind, length) = if first.is_ascii_alphabetic() || first == b'_' {
        (Kind::Word, word_length(bytes))
    } else if first.is_ascii_digit() || (first == b'.' && second.is_ascii_digit()) {
        (Kind::Number, number_length(bytes))
    } else if let Some(mark) = MARKS.iter().find(|mark| text.starts_with(**mark)) {
        (Kind::Mark, mark.len())
    } else if SINGLE.contains(&first) {
        (Kind::Mark, 1)
    } else {
        return Err(format!("there is no '{}' in GLSL", char::from(first)));
    };
    if length > LONGEST_WORD {
        let why = format!(
            "'{}…' has {length} characters: a name or a number must have at most {LONGEST_WORD}",
            &text[..16]
        );
        return Err(why);
    }
    Ok((kind, length))
}

fn word_length(bytes: &[u8]) -> usize {
    let is_of_it = |byte: &&u8| byte.is_ascii_alphanumeric() || **byte == b'_';
    bytes.iter().take_while(is_of_it).count()
}

/// Length of a number as defined by the preprocessor, which includes the sign of an exponent.
fn number_length(bytes: &[u8]) -> usize {
    let is_hex = bytes.len() > 1 && bytes[0] == b'0' && bytes[1].eq_ignore_ascii_case(&b'x');
    let mut length = 1;
    while let Some(byte) = bytes.get(length) {
        let is_sign = matches!(byte, b'+' | b'-');
        let after_e = bytes[length - 1].eq_ignore_ascii_case(&b'e') && !is_hex;
        let is_of_it = byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.');
        if !(is_of_it || is_sign && after_e) {
            break;
        }
        length += 1;
    }
    length
}

/// Maximum nesting depth of brackets and signs in the expression of an `#if`.
const DEEPEST: u32 = 64;

/// Binary operators by precedence, from the lowest to the highest.
const LEVELS: [&[&str]; 10] = [
    &["||"],
    &["&&"],
    &["|"],
    &["^"],
    &["&"],
    &["==", "!="],
    &["<", ">", "<=", ">="],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/", "%"],
];

/// The value of an `#if` expression in which all macros have been expanded. Remaining names have the value 0.
pub fn condition(tokens: &[Token]) -> Result<i64, String> {
    let mut parser = Parser { tokens, depth: 0 };
    let value = parser.binary(0)?;
    match parser.tokens.first() {
        None => Ok(value),
        Some(token) => Err(format!("unexpected '{}'", token.text)),
    }
}

struct Parser<'a, 'b> {
    tokens: &'b [Token<'a>],
    depth: u32,
}

impl<'a> Parser<'a, '_> {
    fn next(&mut self) -> Result<Token<'a>, String> {
        let Some((first, rest)) = self.tokens.split_first() else {
            return Err("the expression ends too early".to_owned());
        };
        self.tokens = rest;
        Ok(*first)
    }

    fn binary(&mut self, level: usize) -> Result<i64, String> {
        let Some(operators) = LEVELS.get(level) else {
            return self.unary();
        };
        let mut left = self.binary(level + 1)?;
        while let Some(operator) = self.tokens.first().filter(|t| operators.contains(&t.text)) {
            let operator = operator.text;
            self.next()?;
            let right = self.binary(level + 1)?;
            left = applied(left, operator, right)?;
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<i64, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(format!("it has more than {DEEPEST} levels"));
        }
        let token = self.next()?;
        let value = match token.text {
            "-" => self.unary()?.wrapping_neg(),
            "+" => self.unary()?,
            "!" => i64::from(self.unary()? == 0),
            "~" => !self.unary()?,
            "(" => {
                let value = self.binary(0)?;
                if !self.next()?.is(")") {
                    return Err("a ')' is missing".to_owned());
                }
                value
            }
            _ if token.kind == Kind::Word => 0,
            text if token.kind == Kind::Number => {
                whole(text).ok_or_else(|| format!("{text} is not a whole number"))?
            }
            text => return Err(format!("'{text}' is not allowed there")),
        };
        self.depth -= 1;
        Ok(value)
    }
}

fn applied(left: i64, operator: &str, right: i64) -> Result<i64, String> {
    Ok(match operator {
        "||" => i64::from(left != 0 || right != 0),
        "&&" => i64::from(left != 0 && right != 0),
        "|" => left | right,
        "^" => left ^ right,
        "&" => left & right,
        "==" => i64::from(left == right),
        "!=" => i64::from(left != right),
        "<" => i64::from(left < right),
        ">" => i64::from(left > right),
        "<=" => i64::from(left <= right),
        ">=" => i64::from(left >= right),
        "<<" => left.wrapping_shl(right as u32),
        ">>" => left.wrapping_shr(right as u32),
        "+" => left.wrapping_add(right),
        "-" => left.wrapping_sub(right),
        "*" => left.wrapping_mul(right),
        _ if right == 0 => return Err(format!("{left} {operator} 0 has no value")),
        "/" => left.wrapping_div(right),
        _ => left.wrapping_rem(right),
    })
}

/// Parses an integer in GLSL notation: decimal, octal or hexadecimal.
fn whole(text: &str) -> Option<i64> {
    let digits = text.trim_end_matches(['u', 'U']);
    if let Some(hex) = digits.strip_prefix("0x").or(digits.strip_prefix("0X")) {
        return i64::from_str_radix(hex, 16).ok();
    }
    match digits.strip_prefix('0').filter(|octal| !octal.is_empty()) {
        Some(octal) => i64::from_str_radix(octal, 8).ok(),
        None => digits.parse().ok(),
    }
}
