//! Evaluates the expressions of `#if`.

use super::tokens::{Kind, Token};

/// Maximum nesting of brackets and signs.
const DEEPEST: u32 = 64;

/// Binary operators by level, from the weakest to the strongest.
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

/// The value of an expression without macros; names count as 0.
pub fn value(tokens: &[Token]) -> Result<i64, String> {
    let mut parser = Parser { tokens, depth: 0 };
    let value = parser.binary(0)?;
    match parser.tokens.first() {
        None => Ok(value),
        Some(token) => Err(format!("'{}' is one too many", token.text)),
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
            text => return Err(format!("'{text}' cannot stand there")),
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

/// A whole number in GLSL notation: decimal, octal or hexadecimal.
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
