//! A recursive-descent parser: expressions, and functions shared with the parser of statements and declarations.

use super::super::tokens::{Kind, Token};
use super::syntax::{Expression, ExpressionKind, Structure};
use super::types::{Base, Type};
use super::{Obstacle, obstacle};

/// Maximum nesting of expressions and of statements, which limits the recursion of the parser and the writer.
pub const DEEPEST: usize = 96;

/// Binary operators by precedence, from the lowest to the highest.
const LEVELS: [&[&str]; 11] = [
    &["||"],
    &["^^"],
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

const ASSIGNMENTS: [&str; 11] = [
    "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=",
];

pub struct Parser<'a, 'b> {
    pub tokens: &'b [Token<'a>],
    pub structures: Vec<Structure<'a>>,
    pub depth: usize,
}

impl<'a> Parser<'a, '_> {
    pub fn peek(&self) -> &'a str {
        self.after(0)
    }

    /// The text of the token `count` positions ahead; empty after the end.
    pub fn after(&self, count: usize) -> &'a str {
        self.tokens.get(count).map_or("", |token| token.text)
    }

    pub fn next(&mut self) -> Result<Token<'a>, Obstacle> {
        let Some((first, rest)) = self.tokens.split_first() else {
            return obstacle("the text ends too early");
        };
        self.tokens = rest;
        Ok(*first)
    }

    /// Consumes the next token if its text is `text`; returns whether it was consumed.
    pub fn take(&mut self, text: &str) -> bool {
        let is_it = self.peek() == text && !self.tokens.is_empty();
        if is_it {
            self.tokens = &self.tokens[1..];
        }
        is_it
    }

    pub fn expect(&mut self, text: &'static str) -> Result<(), Obstacle> {
        match self.take(text) {
            true => Ok(()),
            false => obstacle("a mark is missing"),
        }
    }

    pub fn word(&mut self) -> Result<&'a str, Obstacle> {
        let token = self.next()?;
        match token.is_word() {
            true => Ok(token.text),
            false => obstacle("a name is missing"),
        }
    }

    /// The type with this name, defined by GLSL or by the text.
    pub fn type_named(&self, word: &str) -> Option<Type> {
        let index = || self.structures.iter().rposition(|s| s.name == word);
        Type::named(word).or_else(|| Some(Type::scalar(Base::Struct(index()?))))
    }

    /// Parses a type, with its precision and brackets if there are any.
    pub fn type_written(&mut self) -> Result<Type, Obstacle> {
        while matches!(self.peek(), "highp" | "mediump" | "lowp") {
            self.next()?;
        }
        let word = self.word()?;
        let Some(known) = self.type_named(word) else {
            return obstacle("an unknown type");
        };
        self.brackets(known)
    }

    /// Parses the brackets of an array type after `of`, if there are any.
    pub fn brackets(&mut self, of: Type) -> Result<Type, Obstacle> {
        if !self.take("[") {
            return Ok(of);
        }
        if of.is_array() {
            return obstacle("an array of arrays");
        }
        let mut length = String::new();
        while self.peek() != "]" {
            let token = self.next()?;
            // Only a number or the name of a constant is accepted, because other expressions could have side effects.
            if !length.is_empty() || token.kind == Kind::Mark {
                return obstacle("the length of an array is computed");
            }
            token.text.clone_into(&mut length);
        }
        self.expect("]")?;
        Ok(Type {
            length: Some(length),
            ..of
        })
    }

    /// Parses an expression that may contain the comma operator.
    pub fn expression(&mut self) -> Result<Expression<'a>, Obstacle> {
        let mut first = self.assignment()?;
        while self.take(",") {
            let second = self.assignment()?;
            first = binary(",", first, second)?;
        }
        Ok(first)
    }

    /// Parses an expression without the comma operator.
    pub fn assignment(&mut self) -> Result<Expression<'a>, Obstacle> {
        self.deeper(|parser| {
            let left = parser.binary(0)?;
            let operator = parser.peek();
            if operator == "?" {
                parser.next()?;
                let one = parser.expression()?;
                parser.expect(":")?;
                let other = parser.assignment()?;
                let depth = left.depth.max(one.depth).max(other.depth);
                let all = [left, one, other].map(Box::new);
                return made(ExpressionKind::Choice(all), depth);
            }
            if !ASSIGNMENTS.contains(&operator) {
                return Ok(left);
            }
            parser.next()?;
            let right = parser.assignment()?;
            let depth = left.depth.max(right.depth);
            let kind = ExpressionKind::Assignment(operator, Box::new(left), Box::new(right));
            made(kind, depth)
        })
    }

    /// Parses something one nesting level deeper.
    pub fn deeper<T>(
        &mut self,
        parse: impl FnOnce(&mut Self) -> Result<T, Obstacle>,
    ) -> Result<T, Obstacle> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return obstacle("it is nested too deeply");
        }
        let parsed = parse(self)?;
        self.depth -= 1;
        Ok(parsed)
    }

    /// Parses binary operators of at least this precedence by precedence climbing, with one recursive call for all
    /// levels.
    fn binary(&mut self, least: usize) -> Result<Expression<'a>, Obstacle> {
        let mut left = self.prefix()?;
        loop {
            let operator = self.peek();
            let level = LEVELS.iter().position(|level| level.contains(&operator));
            let Some(level) = level.filter(|level| *level >= least) else {
                return Ok(left);
            };
            self.next()?;
            let right = self.deeper(|parser| parser.binary(level + 1))?;
            left = binary(operator, left, right)?;
        }
    }

    fn prefix(&mut self) -> Result<Expression<'a>, Obstacle> {
        let operator = self.peek();
        if !matches!(operator, "+" | "-" | "!" | "~" | "++" | "--") {
            return self.postfix();
        }
        self.next()?;
        let of = self.deeper(Self::prefix)?;
        let depth = of.depth;
        made(ExpressionKind::Prefix(operator, Box::new(of)), depth)
    }

    fn postfix(&mut self) -> Result<Expression<'a>, Obstacle> {
        let mut of = self.primary()?;
        loop {
            let depth = of.depth;
            let operator = self.peek();
            let kind = match operator {
                "++" | "--" => {
                    self.next()?;
                    ExpressionKind::Postfix(operator, Box::new(of))
                }
                "[" => {
                    self.next()?;
                    let index = self.expression()?;
                    self.expect("]")?;
                    let depth = depth.max(index.depth);
                    of = made(ExpressionKind::Index(Box::new(of), Box::new(index)), depth)?;
                    continue;
                }
                "." => {
                    self.next()?;
                    let name = self.word()?;
                    if self.take("(") {
                        self.expect(")")?;
                        ExpressionKind::Length(Box::new(of))
                    } else {
                        ExpressionKind::Member(Box::new(of), name)
                    }
                }
                _ => return Ok(of),
            };
            of = made(kind, depth)?;
        }
    }

    fn primary(&mut self) -> Result<Expression<'a>, Obstacle> {
        if self.take("(") {
            let inside = self.expression()?;
            self.expect(")")?;
            return Ok(inside);
        }
        let is_type = self.tokens.first().is_some_and(|token| token.is_word())
            && self.type_named(self.peek()).is_some();
        if is_type && matches!(self.after(1), "(" | "[") {
            let of = self.type_written()?;
            let given = self.arguments()?;
            let depth = deepest(&given);
            return made(ExpressionKind::Constructor(of, given), depth);
        }
        let token = self.next()?;
        match token.kind {
            Kind::Number => made(ExpressionKind::Literal(token.text), 0),
            Kind::Word if matches!(token.text, "true" | "false") => {
                made(ExpressionKind::Literal(token.text), 0)
            }
            Kind::Word if self.peek() == "(" => {
                let given = self.arguments()?;
                let depth = deepest(&given);
                made(ExpressionKind::Call(token.text, given), depth)
            }
            Kind::Word => made(ExpressionKind::Name(token.text), 0),
            Kind::Mark => obstacle("a mark that begins no expression"),
        }
    }

    fn arguments(&mut self) -> Result<Vec<Expression<'a>>, Obstacle> {
        self.expect("(")?;
        if self.peek() == "void" {
            self.next()?;
        }
        let mut given = Vec::new();
        if self.take(")") {
            return Ok(given);
        }
        loop {
            given.push(self.assignment()?);
            if !self.take(",") {
                break;
            }
        }
        self.expect(")")?;
        Ok(given)
    }
}

fn deepest(all: &[Expression]) -> usize {
    all.iter().map(|one| one.depth).max().unwrap_or(0)
}

fn binary<'a>(
    operator: &'a str,
    left: Expression<'a>,
    right: Expression<'a>,
) -> Result<Expression<'a>, Obstacle> {
    let depth = left.depth.max(right.depth);
    let kind = ExpressionKind::Binary(operator, Box::new(left), Box::new(right));
    made(kind, depth)
}

fn made(kind: ExpressionKind, below: usize) -> Result<Expression, Obstacle> {
    match below < DEEPEST {
        true => Ok(Expression {
            kind,
            depth: below + 1,
        }),
        // A deeper tree would need a large stack when it is dropped or written.
        false => obstacle("an expression has too many terms"),
    }
}
