//! Writes the derivative of expressions.

use super::functions::{Variable, Writer};
use super::rules;
use super::syntax::{Expression, ExpressionKind as Kind};
use super::types::{Base, Type};
use super::values::{Place, Value};
use super::{Obstacle, obstacle};

/// Maximum length of an index in bytes. The text of an index is repeated for each derivative.
const LONGEST_INDEX: usize = 256;

impl<'a> Writer<'a> {
    /// Writes an expression.
    pub fn value(&mut self, of: &'a Expression<'a>) -> Result<Value<'a>, Obstacle> {
        self.step()?;
        self.deeper(|writer| writer.value_of_kind(&of.kind))
    }

    fn value_of_kind(&mut self, kind: &'a Kind<'a>) -> Result<Value<'a>, Obstacle> {
        match kind {
            Kind::Literal(text) => Ok(Value::plain((*text).to_owned(), type_of_literal(text))),
            Kind::Name(name) => self.variable(name),
            Kind::Prefix(operator @ ("++" | "--"), of) => self.stepped(operator, of, true),
            Kind::Postfix(operator, of) => self.stepped(operator, of, false),
            Kind::Prefix(operator, of) => self.prefixed(operator, of),
            Kind::Binary(",", left, right) => {
                let left = self.value(left)?;
                let right = self.value(right)?;
                let text = format!("({}, {})", left.text, right.text);
                Ok(Value {
                    text,
                    place: None,
                    ..right
                })
            }
            Kind::Binary(operator, left, right) => {
                let left = self.value(left)?;
                let right = self.value(right)?;
                self.operated(operator, &left, &right)
            }
            Kind::Assignment(operator, to, from) => self.assigned(operator, to, from),
            Kind::Choice([condition, one, other]) => self.chosen(condition, one, other),
            Kind::Index(of, index) => self.indexed(of, index),
            Kind::Member(of, name) => self.member(of, name),
            Kind::Call(name, given) => self.call(name, given),
            Kind::Constructor(of, given) => self.constructor(of, given),
            Kind::Length(of) => {
                let of = self.value(of)?;
                let length = Type::scalar(Base::Int);
                Ok(Value::plain(format!("{}.length()", of.text), length))
            }
        }
    }

    fn variable(&mut self, name: &'a str) -> Result<Value<'a>, Obstacle> {
        let Some((variable, of)) = self.find(name) else {
            return obstacle("a name without a declaration");
        };
        let varies = self.does_vary(variable);
        let root = match (variable, varies) {
            (Variable::Global(_), true) => {
                self.frame.touches_global = true;
                self.name_of_global(name)
            }
            _ => self.named(name),
        };
        let place = Place {
            variable,
            root,
            components: String::new(),
        };
        Ok(self.at_place(place, of, varies))
    }

    fn prefixed(&mut self, operator: &str, of: &'a Expression<'a>) -> Result<Value<'a>, Obstacle> {
        let value = self.value(of)?;
        if !value.varies || matches!(operator, "!" | "~") {
            // The blank separates two consecutive signs.
            let text = format!("({operator} {})", self.native(&value)?);
            return Ok(Value::plain(text, value.of_type));
        }
        if !value.of_type.is_float() {
            return obstacle("a sign of a structure");
        }
        match operator {
            "-" => self.apply("negate", &rules::of_negation(&value.of_type), &[value]),
            _ => Ok(Value {
                place: None,
                ..value
            }),
        }
    }

    /// Writes a binary operator.
    pub fn operated(
        &mut self,
        operator: &str,
        left: &Value<'a>,
        right: &Value<'a>,
    ) -> Result<Value<'a>, Obstacle> {
        let is_logical = matches!(
            operator,
            "||" | "&&" | "^^" | "==" | "!=" | "<" | ">" | "<=" | ">="
        );
        if is_logical || !(left.varies || right.varies) {
            let text = format!(
                "({} {operator} {})",
                self.native(left)?,
                self.native(right)?
            );
            let known = rules::type_of_operation(operator, &left.of_type, &right.of_type);
            let of = match is_logical {
                true => Type::scalar(Base::Bool),
                false => known.ok_or(Obstacle("an operator on other types"))?,
            };
            return Ok(Value::plain(text, of));
        }
        let rule = rules::of_operation(operator, &left.of_type, &right.of_type)?;
        let name = match operator {
            "+" => "add",
            "-" => "subtract",
            "*" => "times",
            _ => "over",
        };
        self.apply(name, &rule, &[left.clone(), right.clone()])
    }

    fn chosen(
        &mut self,
        condition: &'a Expression<'a>,
        one: &'a Expression<'a>,
        other: &'a Expression<'a>,
    ) -> Result<Value<'a>, Obstacle> {
        let condition = self.value(condition)?;
        let condition = self.native(&condition)?;
        let (one, other) = (self.value(one)?, self.value(other)?);
        let of = match one.of_type.takes(&other.of_type) {
            true => one.of_type.clone(),
            false => other.of_type.clone(),
        };
        let varies = one.varies || other.varies;
        let (one, other) = match varies {
            true => (self.lifted(&one, &of)?, self.lifted(&other, &of)?),
            false => (one.text, other.text),
        };
        let text = format!("({condition} ? {one} : {other})");
        Ok(Value {
            varies,
            ..Value::plain(text, of)
        })
    }

    fn indexed(
        &mut self,
        of: &'a Expression<'a>,
        index: &'a Expression<'a>,
    ) -> Result<Value<'a>, Obstacle> {
        let (value, at) = (self.value(of)?, self.value(index)?);
        let at = Value::plain(self.native(&at)?, at.of_type);
        let Some(element) = value.of_type.element() else {
            return obstacle("an index of a single value");
        };
        if value.varies && !(is_pure(index) && at.text.len() < LONGEST_INDEX) {
            return obstacle("an index with effects");
        }
        let text = format!("[{}]", at.text);
        self.part(&value, &text, Some(&at), element)
    }

    /// Writes a part of a value: an element, or components.
    fn part(
        &mut self,
        value: &Value<'a>,
        selection: &str,
        index: Option<&Value<'a>>,
        of: Type,
    ) -> Result<Value<'a>, Obstacle> {
        let is_whole = value.of_type.is_array() || value.of_type.is_struct();
        if let Some(place) = &value.place {
            let mut place = place.clone();
            match is_whole {
                true => place.root += selection,
                false => place.components += selection,
            }
            return Ok(self.at_place(place, of, value.varies));
        }
        if is_whole || !value.varies {
            return Ok(Value {
                text: format!("{}{selection}", value.text),
                of_type: of,
                ..value.clone()
            });
        }
        match index {
            Some(index) => self.selected(value, ("at", "[i]"), Some(index), &of),
            None => {
                let name = format!("get_{}", &selection[1..]);
                self.selected(value, (name.as_str(), selection), None, &of)
            }
        }
    }

    fn member(&mut self, of: &'a Expression<'a>, name: &'a str) -> Result<Value<'a>, Obstacle> {
        let value = self.value(of)?;
        let selection = format!(".{}", self.named(name));
        if value.of_type.is_array() {
            return obstacle("a member of an array");
        }
        if let Base::Struct(index) = value.of_type.base {
            let program = self.program;
            let mut members = program.structures[index].members.iter();
            let Some((_, of)) = members.find(|(known, _)| *known == name) else {
                return obstacle("an unknown member");
            };
            let varies = value.varies && self.can_vary(of);
            let part = self.part(&value, &selection, None, of.clone())?;
            return Ok(Value { varies, ..part });
        }
        if value.of_type.is_matrix() || name.len() > 4 {
            return obstacle("an unknown member");
        }
        let of = Type::vector(value.of_type.base, name.len());
        self.part(&value, &selection, None, of)
    }

    fn assigned(
        &mut self,
        operator: &'a str,
        to: &'a Expression<'a>,
        from: &'a Expression<'a>,
    ) -> Result<Value<'a>, Obstacle> {
        let target = self.value(to)?;
        let from = self.value(from)?;
        let compound = operator.strip_suffix('=').filter(|own| !own.is_empty());
        if let Some(own) = compound {
            if !(target.varies || from.varies) {
                let text = format!("({} {operator} {})", target.text, from.text);
                return Ok(Value::plain(text, target.of_type));
            }
            if !is_pure(to) {
                return obstacle("an index with effects");
            }
            let result = self.operated(own, &target, &from)?;
            return self.put(&target, &result);
        }
        self.put(&target, &from)
    }

    /// Writes an assignment of a value to a place.
    fn put(&mut self, target: &Value<'a>, from: &Value<'a>) -> Result<Value<'a>, Obstacle> {
        let Some(place) = &target.place else {
            return obstacle("an assignment to something other than a variable");
        };
        let of = &target.of_type;
        if from.varies && !target.varies && self.can_vary(of) {
            self.make_vary(place.variable)?;
            // The text of this pass is discarded, so this text need not be valid.
            return Ok(Value::varying(from.text.clone(), of.clone()));
        }
        if !target.varies {
            let text = format!("({} = {})", target.text, self.native(from)?);
            return Ok(Value::plain(text, of.clone()));
        }
        let new = self.lifted(from, of)?;
        if place.components.is_empty() {
            let text = format!("({} = {new})", place.root);
            return Ok(Value::varying(text, of.clone()));
        }
        let setter = self.setter(of)?;
        let parts = self.parts(&place.root);
        let parts: Vec<String> = parts
            .iter()
            .map(|part| format!("{part}{}", place.components))
            .collect();
        let text = format!("{setter}({}, {new})", parts.join(", "));
        Ok(Value::varying(text, of.clone()))
    }

    /// Writes `++` and `--`, before or after an operand.
    fn stepped(
        &mut self,
        operator: &'a str,
        of: &'a Expression<'a>,
        is_before: bool,
    ) -> Result<Value<'a>, Obstacle> {
        let value = self.value(of)?;
        if !value.varies {
            let text = match is_before {
                true => format!("({operator}{})", value.text),
                false => format!("({}{operator})", value.text),
            };
            return Ok(Value::plain(text, value.of_type));
        }
        if !is_pure(of) {
            return obstacle("an index with effects");
        }
        let one = Value::plain("1.0".to_owned(), Type::scalar(Base::Float));
        let result = self.operated(&operator[..1], &value, &one)?;
        let put = self.put(&value, &result)?;
        match is_before {
            true => Ok(put),
            // Computes the value before the step from the value after it.
            false => {
                let back = if operator == "++" { "-" } else { "+" };
                self.operated(back, &put, &one)
            }
        }
    }
}

fn type_of_literal(text: &str) -> Type {
    let is_hex = text.starts_with("0x") || text.starts_with("0X");
    Type::scalar(if matches!(text, "true" | "false") {
        Base::Bool
    } else if text.ends_with(['u', 'U']) {
        Base::Uint
    } else if !is_hex && text.contains(['.', 'e', 'E', 'f', 'F']) {
        Base::Float
    } else {
        Base::Int
    })
}

/// Whether an expression has no side effects, so that its text can be repeated.
fn is_pure(of: &Expression) -> bool {
    match &of.kind {
        Kind::Literal(_) | Kind::Name(_) => true,
        Kind::Prefix(operator, of) => !matches!(*operator, "++" | "--") && is_pure(of),
        Kind::Binary(_, left, right) => is_pure(left) && is_pure(right),
        Kind::Index(of, index) => is_pure(of) && is_pure(index),
        Kind::Member(of, _) | Kind::Length(of) => is_pure(of),
        Kind::Constructor(_, given) => given.iter().all(is_pure),
        Kind::Choice(all) => all.iter().all(|one| is_pure(one)),
        Kind::Call(name, given) => {
            super::super::words::is_function(name) && *name != "modf" && given.iter().all(is_pure)
        }
        Kind::Postfix(..) | Kind::Assignment(..) => false,
    }
}
