//! The part of the parser for statements and declarations.

use super::super::tokens::Token;
use super::parse::Parser;
use super::syntax::{
    Declaration, Expression, Function, Parameter, Program, Statement, Structure, Variable,
};
use super::types::{Base, Type};
use super::{Obstacle, obstacle};

/// Parses a text without directives to a syntax tree.
pub fn program<'a>(tokens: &[Token<'a>]) -> Result<Program<'a>, Obstacle> {
    let mut parser = Parser {
        tokens,
        structures: Vec::new(),
        depth: 0,
    };
    let mut program = Program::default();
    while !parser.tokens.is_empty() {
        if parser.take(";") {
            continue;
        }
        parser.global(&mut program)?;
    }
    program.structures = parser.structures;
    Ok(program)
}

impl<'a> Parser<'a, '_> {
    fn global(&mut self, program: &mut Program<'a>) -> Result<(), Obstacle> {
        let is_const = self.take("const");
        if self.peek() == "struct" {
            let of = self.structure()?;
            if self.take(";") {
                return Ok(());
            }
            let variables = self.variables(&of)?;
            self.expect(";")?;
            program.globals.push(Declaration {
                is_const,
                variables,
            });
            return Ok(());
        }
        let of = self.type_written()?;
        if self.after(1) == "(" {
            let name = self.word()?;
            let parameters = self.parameters()?;
            // A prototype; the definition follows later.
            if self.take(";") {
                return Ok(());
            }
            let (from, depth) = (self.tokens, self.depth);
            let body = self.block();
            if body.is_err() {
                (self.tokens, self.depth) = (from, depth);
                self.skip_block()?;
            }
            program.functions.push(Function {
                name,
                returns: of,
                parameters,
                body,
            });
            return Ok(());
        }
        let variables = self.variables(&of)?;
        self.expect(";")?;
        program.globals.push(Declaration {
            is_const,
            variables,
        });
        Ok(())
    }

    /// Skips the block that begins at the next token.
    fn skip_block(&mut self) -> Result<(), Obstacle> {
        let mut open = 0usize;
        loop {
            match self.next()?.text {
                "{" => open += 1,
                "}" => open = open.saturating_sub(1),
                _ => (),
            }
            if open == 0 {
                return Ok(());
            }
        }
    }

    fn structure(&mut self) -> Result<Type, Obstacle> {
        self.expect("struct")?;
        let name = match self.peek() {
            "{" => "",
            _ => self.word()?,
        };
        self.expect("{")?;
        let mut members = Vec::new();
        while !self.take("}") {
            let of = self.type_written()?;
            loop {
                let member = self.word()?;
                members.push((member, self.brackets(of.clone())?));
                if !self.take(",") {
                    break;
                }
            }
            self.expect(";")?;
        }
        if self.type_named(name).is_some() && !name.is_empty() {
            return obstacle("two types with the same name");
        }
        self.structures.push(Structure { name, members });
        Ok(Type::scalar(Base::Struct(self.structures.len() - 1)))
    }

    fn parameters(&mut self) -> Result<Vec<Parameter<'a>>, Obstacle> {
        self.expect("(")?;
        let mut all = Vec::new();
        if self.peek() == "void" && self.after(1) == ")" {
            self.next()?;
        }
        while !self.take(")") {
            if !all.is_empty() {
                self.expect(",")?;
            }
            let (mut is_in, mut is_out) = (true, false);
            loop {
                match self.peek() {
                    "out" => (is_in, is_out) = (false, true),
                    "inout" => is_out = true,
                    "in" | "const" => (),
                    _ => break,
                }
                self.next()?;
            }
            let of = self.type_written()?;
            // A parameter without a name is unused.
            let name = match self.peek() {
                "," | ")" => "",
                _ => self.word()?,
            };
            all.push(Parameter {
                name,
                of_type: self.brackets(of)?,
                is_in,
                is_out,
            });
        }
        Ok(all)
    }

    fn variables(&mut self, of: &Type) -> Result<Vec<Variable<'a>>, Obstacle> {
        let mut all = Vec::new();
        loop {
            let name = self.word()?;
            let of_type = self.brackets(of.clone())?;
            let initial = match self.take("=") {
                true => Some(self.assignment()?),
                false => None,
            };
            all.push(Variable {
                name,
                of_type,
                initial,
            });
            if !self.take(",") {
                return Ok(all);
            }
        }
    }

    /// Whether a declaration begins at the next token: a type that is followed by a name or by brackets.
    fn is_declaration(&self) -> bool {
        let first = self.peek();
        let is_type = || self.type_named(first).is_some();
        let is_qualifier = matches!(first, "const" | "struct" | "highp" | "mediump" | "lowp");
        let is_name = |token: &Token| token.is_word();
        is_qualifier
            || is_type() && (self.tokens.get(1).is_some_and(is_name) || self.is_array_declared())
    }

    /// Whether `type[…] name` begins at the next token, and not `type[…](…)`.
    fn is_array_declared(&self) -> bool {
        let close = self.tokens.iter().take(4).position(|t| t.is("]"));
        let next = close.and_then(|close| self.tokens.get(close + 1));
        self.after(1) == "[" && next.is_some_and(Token::is_word)
    }

    fn block(&mut self) -> Result<Vec<Statement<'a>>, Obstacle> {
        self.expect("{")?;
        let mut all = Vec::new();
        while !self.take("}") {
            all.extend(self.statement()?);
        }
        Ok(all)
    }

    /// Parses the statements of a branch or a loop, with or without braces.
    fn body(&mut self) -> Result<Vec<Statement<'a>>, Obstacle> {
        self.deeper(|parser| match parser.peek() {
            "{" => parser.block(),
            _ => Ok(parser.statement()?.into_iter().collect()),
        })
    }

    /// Parses a statement; `None` for an empty statement.
    fn statement(&mut self) -> Result<Option<Statement<'a>>, Obstacle> {
        let statement = match self.peek() {
            ";" => {
                self.next()?;
                return Ok(None);
            }
            "{" => Statement::Block(self.body()?),
            "if" => self.branch()?,
            "for" => self.counted()?,
            "while" => {
                self.next()?;
                Statement::While(self.condition()?, self.body()?)
            }
            "do" => {
                self.next()?;
                let body = self.body()?;
                self.expect("while")?;
                let condition = self.condition()?;
                self.expect(";")?;
                Statement::DoWhile(body, condition)
            }
            "switch" => {
                self.next()?;
                let of = self.condition()?;
                Statement::Switch(of, self.deeper(Self::block)?)
            }
            "case" => {
                self.next()?;
                let value = self.assignment()?;
                self.expect(":")?;
                Statement::Case(Some(value))
            }
            "default" => {
                self.next()?;
                self.expect(":")?;
                Statement::Case(None)
            }
            "return" => {
                self.next()?;
                let value = match self.peek() {
                    ";" => None,
                    _ => Some(self.expression()?),
                };
                self.expect(";")?;
                Statement::Return(value)
            }
            "break" | "continue" => {
                let jump = self.word()?;
                self.expect(";")?;
                Statement::Jump(jump)
            }
            _ => {
                let simple = self.simple()?;
                self.expect(";")?;
                simple
            }
        };
        Ok(Some(statement))
    }

    /// Parses a declaration or an expression, without its semicolon.
    fn simple(&mut self) -> Result<Statement<'a>, Obstacle> {
        if !self.is_declaration() {
            return Ok(Statement::Expression(self.expression()?));
        }
        let is_const = self.take("const");
        if self.peek() == "struct" {
            return obstacle("a structure within a function");
        }
        let of = self.type_written()?;
        let variables = self.variables(&of)?;
        Ok(Statement::Declaration(Declaration {
            is_const,
            variables,
        }))
    }

    fn condition(&mut self) -> Result<Expression<'a>, Obstacle> {
        self.expect("(")?;
        if self.is_declaration() {
            return obstacle("a variable in a condition");
        }
        let condition = self.expression()?;
        self.expect(")")?;
        Ok(condition)
    }

    fn branch(&mut self) -> Result<Statement<'a>, Obstacle> {
        self.expect("if")?;
        let condition = self.condition()?;
        let one = self.body()?;
        let other = match self.take("else") {
            true => self.body()?,
            false => Vec::new(),
        };
        Ok(Statement::If(condition, one, other))
    }

    fn counted(&mut self) -> Result<Statement<'a>, Obstacle> {
        self.expect("for")?;
        self.expect("(")?;
        let mut first = Vec::new();
        if self.peek() != ";" {
            first.push(self.simple()?);
        }
        self.expect(";")?;
        if self.is_declaration() {
            return obstacle("a variable in a condition");
        }
        let condition = match self.peek() {
            ";" => None,
            _ => Some(self.expression()?),
        };
        self.expect(";")?;
        let step = match self.peek() {
            ")" => None,
            _ => Some(self.expression()?),
        };
        self.expect(")")?;
        Ok(Statement::For {
            first,
            condition,
            step,
            body: self.body()?,
        })
    }
}
