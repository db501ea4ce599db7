//! Writes the derivative of statements and declarations.

use super::functions::{Variable, Writer};
use super::syntax::{Declaration, Expression, Statement};
use super::types::Type;
use super::values::Value;
use super::{Obstacle, obstacle};
use std::collections::HashMap;
use std::fmt::Write as _;

impl<'a> Writer<'a> {
    /// Writes statements in a new scope.
    pub fn block(&mut self, statements: &'a [Statement<'a>]) -> Result<(), Obstacle> {
        self.frame.scopes.push(HashMap::new());
        for statement in statements {
            self.deeper(|writer| writer.statement(statement))?;
        }
        self.frame.scopes.pop();
        Ok(())
    }

    fn line(&mut self, text: &str) {
        let _ = writeln!(self.frame.text, "    {text}");
    }

    fn statement(&mut self, statement: &'a Statement<'a>) -> Result<(), Obstacle> {
        self.step()?;
        match statement {
            Statement::Block(inside) => {
                self.line("{");
                self.block(inside)?;
                self.line("}");
            }
            Statement::Declaration(declaration) => {
                for text in self.declaration(declaration, false)? {
                    self.line(&format!("{text};"));
                }
            }
            Statement::Expression(expression) => {
                let value = self.value(expression)?;
                self.line(&format!("{};", value.text));
            }
            Statement::If(condition, one, other) => {
                let condition = self.condition(condition)?;
                self.line(&format!("if ({condition}) {{"));
                self.block(one)?;
                if !other.is_empty() {
                    self.line("} else {");
                    self.block(other)?;
                }
                self.line("}");
            }
            Statement::For {
                first,
                condition,
                step,
                body,
            } => {
                self.frame.scopes.push(HashMap::new());
                let first = self.first(first)?;
                let condition = match condition {
                    Some(condition) => self.condition(condition)?,
                    None => String::new(),
                };
                let step = match step {
                    Some(step) => self.value(step)?.text,
                    None => String::new(),
                };
                self.line(&format!("for ({first}; {condition}; {step}) {{"));
                self.block(body)?;
                self.line("}");
                self.frame.scopes.pop();
            }
            Statement::While(condition, body) => {
                let condition = self.condition(condition)?;
                self.line(&format!("while ({condition}) {{"));
                self.block(body)?;
                self.line("}");
            }
            Statement::DoWhile(body, condition) => {
                self.line("do {");
                self.block(body)?;
                let condition = self.condition(condition)?;
                self.line(&format!("}} while ({condition});"));
            }
            Statement::Switch(of, body) => {
                let of = self.condition(of)?;
                self.line(&format!("switch ({of}) {{"));
                self.block(body)?;
                self.line("}");
            }
            Statement::Case(Some(value)) => {
                let value = self.value(value)?;
                self.line(&format!("case {}:", value.text));
            }
            Statement::Case(None) => self.line("default:"),
            Statement::Return(value) => self.returned(value.as_ref())?,
            Statement::Jump(jump) => self.line(&format!("{jump};")),
        }
        Ok(())
    }

    /// Writes a condition, which needs no derivatives.
    fn condition(&mut self, of: &'a Expression<'a>) -> Result<String, Obstacle> {
        let value = self.value(of)?;
        self.native(&value)
    }

    fn returned(&mut self, value: Option<&'a Expression<'a>>) -> Result<(), Obstacle> {
        let Some(value) = value else {
            self.line("return;");
            return Ok(());
        };
        let value = self.value(value)?;
        if value.varies && !self.frame.returns_vary {
            self.frame.returns_vary = true;
            self.frame.has_changed = true;
        }
        let of = self.frame.returns.clone();
        let text = match of.filter(|_| self.frame.returns_vary) {
            Some(of) => self.lifted(&value, &of)?,
            None => value.text,
        };
        self.line(&format!("return {text};"));
        Ok(())
    }

    /// Writes the first part of a loop's head, a single statement.
    fn first(&mut self, first: &'a [Statement<'a>]) -> Result<String, Obstacle> {
        let mut texts = Vec::new();
        for statement in first {
            match statement {
                Statement::Declaration(declaration) => {
                    texts.extend(self.declaration(declaration, true)?);
                }
                Statement::Expression(expression) => texts.push(self.value(expression)?.text),
                _ => return obstacle("a loop that begins with a statement"),
            }
        }
        Ok(texts.join("; "))
    }

    /// Writes a declaration. If `is_single`, the result is a single statement, in which all variables have derivatives
    /// if any of them depends on the point. Otherwise each variable becomes a separate statement.
    fn declaration(
        &mut self,
        declaration: &'a Declaration<'a>,
        is_single: bool,
    ) -> Result<Vec<String>, Obstacle> {
        let mut all: Vec<(usize, Type, String, Option<Value<'a>>)> = Vec::new();
        for variable in &declaration.variables {
            let initial = match &variable.initial {
                Some(initial) => Some(self.value(initial)?),
                None => None,
            };
            let of = variable.of_type.clone();
            let index = self.declare(variable.name, of.clone());
            if initial.as_ref().is_some_and(|value| value.varies) && self.can_vary(&of) {
                self.make_vary(Variable::Local(index))?;
            }
            all.push((index, of, self.named(variable.name), initial));
        }
        let any = all.iter().any(|one| self.frame.varying.contains(&one.0));
        if is_single && any {
            for (index, ..) in &all {
                self.make_vary(Variable::Local(*index))?;
            }
        }
        let mut texts: Vec<String> = Vec::new();
        for (index, of, name, initial) in all {
            let varies = self.frame.varying.contains(&index);
            let initial = match initial {
                None => String::new(),
                Some(value) if varies => format!(" = {}", self.lifted(&value, &of)?),
                Some(value) => format!(" = {}", self.native(&value)?),
            };
            let constant = if declaration.is_const && !varies {
                "const "
            } else {
                ""
            };
            let brackets = self.brackets(&of);
            let own = format!("{name}{brackets}{initial}");
            match texts.last_mut().filter(|_| is_single) {
                Some(before) => {
                    let _ = write!(before, ", {own}");
                }
                None => texts.push(format!("{constant}{} {own}", self.name_of(&of, varies))),
            }
        }
        Ok(texts)
    }
}
