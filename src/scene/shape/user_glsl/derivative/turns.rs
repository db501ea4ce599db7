//! The turns of the loops in a text: an upper bound, for loops that count with a constant step to a constant end. A loop
//! that may end earlier, by `break` or `return`, counts as at most [`ENDED_TURNS`].

use super::syntax::{
    Declaration, Expression, ExpressionKind as Kind, Function, Program, Statement, Variable,
};
use super::types::Base;
use std::collections::HashMap;

/// Maximum nesting of calls that is followed, which limits the recursion. A text in which functions call each other in a
/// circle does not compile.
const DEEPEST_CALL: usize = 32;

/// The count of a loop that ends earlier if a condition holds, if it counts to more. Loops that search or iterate state a
/// large end as a guard, and take few turns.
const ENDED_TURNS: u64 = 60;

/// The greatest count of turns. A driver that limits loops allows fewer.
const MOST_TURNS: u64 = 1 << 20;

/// The most turns of a loop that counts floats. The rounding errors of more sums may amount to a turn.
const MOST_FLOAT_TURNS: f64 = 4096.0;

/// The most turns that all loops in one call of `field` and one of `fieldGradient`, if there is one, take together, nested
/// ones included; `None` if a loop is not counted by constants.
pub fn turns(program: &Program) -> Option<u64> {
    let mut count = Count {
        program,
        depth: 0,
        known: HashMap::new(),
    };
    sum([count.of_call("field"), count.of_call("fieldGradient")])
}

struct Count<'a, 'b> {
    program: &'b Program<'a>,
    depth: usize,
    /// The turns in one call of each function that has been counted.
    known: HashMap<&'b str, u64>,
}

impl<'a, 'b> Count<'a, 'b> {
    /// The turns in one call; those of the overload with the most. Functions of GLSL have none.
    fn of_call(&mut self, name: &'b str) -> Option<u64> {
        if let Some(known) = self.known.get(name) {
            return Some(*known);
        }
        if self.depth == DEEPEST_CALL {
            return None;
        }
        self.depth += 1;
        let program = self.program;
        let mut most = 0;
        for function in program.functions.iter().filter(|f| f.name == name) {
            most = most.max(self.of_body(function)?);
        }
        self.depth -= 1;
        self.known.insert(name, most);
        Some(most)
    }

    fn of_body(&mut self, function: &'b Function<'a>) -> Option<u64> {
        self.of_statements(function.body.as_ref().ok()?)
    }

    fn of_statements(&mut self, all: &'b [Statement<'a>]) -> Option<u64> {
        sum(all.iter().map(|statement| self.of_statement(statement)))
    }

    fn of_statement(&mut self, statement: &'b Statement<'a>) -> Option<u64> {
        match statement {
            Statement::Block(all) => self.of_statements(all),
            Statement::Declaration(declared) => {
                let initial = declared.variables.iter().filter_map(|v| v.initial.as_ref());
                sum(initial.map(|value| self.of_expression(value)))
            }
            Statement::Expression(value)
            | Statement::Case(Some(value))
            | Statement::Return(Some(value)) => self.of_expression(value),
            // A driver may execute both branches, each for some of the waves in a register.
            Statement::If(condition, one, other) => sum([
                self.of_expression(condition),
                self.of_statements(one),
                self.of_statements(other),
            ]),
            Statement::Switch(value, body) => {
                sum([self.of_expression(value), self.of_statements(body)])
            }
            Statement::For {
                first,
                condition: Some(condition),
                step: Some(step),
                body,
            } => {
                let count = match may_end(body, true) {
                    true => self.count(first, condition, step, body)?.min(ENDED_TURNS),
                    false => self.count(first, condition, step, body)?,
                };
                let each = sum([
                    self.of_expression(condition),
                    self.of_expression(step),
                    self.of_statements(body),
                ])?;
                let whole = count.saturating_mul(1 + each);
                sum([
                    self.of_statements(first),
                    self.of_expression(condition),
                    Some(whole),
                ])
            }
            Statement::For { .. } | Statement::While(..) | Statement::DoWhile(..) => None,
            Statement::Case(None) | Statement::Return(None) | Statement::Jump(_) => Some(0),
        }
    }

    fn of_expression(&mut self, expression: &'b Expression<'a>) -> Option<u64> {
        let own = match &expression.kind {
            Kind::Call(name, _) => self.of_call(name),
            _ => Some(0),
        };
        sum(std::iter::once(own).chain(
            parts(expression)
                .into_iter()
                .map(|part| self.of_expression(part)),
        ))
    }

    /// The turns of a loop that counts a variable of its own, which its body leaves unchanged, up or down to an end.
    fn count(
        &self,
        first: &[Statement<'a>],
        condition: &Expression<'a>,
        step: &Expression<'a>,
        body: &[Statement<'a>],
    ) -> Option<u64> {
        let [Statement::Declaration(Declaration { variables, .. })] = first else {
            return None;
        };
        let [counter] = &variables[..] else {
            return None;
        };
        let is_changed = body.iter().any(|s| self.may_change(s, counter.name))
            || self.changes(condition, counter.name);
        if !counter.of_type.is_scalar() || is_changed {
            return None;
        }
        let start = self.number(counter.initial.as_ref()?)?;
        let step = self.step(step, counter.name)?;
        let (end, includes_end) = self.end(condition, counter.name, step)?;
        let steps = (end - start) / step;
        let is_float = counter.of_type.base == Base::Float;
        let is_unsigned = counter.of_type.base == Base::Uint;
        // Numbers that wrap, and floats that stop growing, never reach the end.
        let wraps = is_unsigned && (step < 0.0 || start < 0.0 || end < 0.0);
        let largest = (start.abs().max(end.abs()) / step).abs();
        if wraps || (is_float && (steps > MOST_FLOAT_TURNS || largest > MOST_FLOAT_TURNS)) {
            return None;
        }
        // A sum of floats may end a turn later.
        let rounded = u64::from(is_float);
        let whole = if includes_end {
            steps.floor() + 1.0
        } else {
            steps.ceil()
        };
        Some((whole.clamp(0.0, MOST_TURNS as f64) as u64 + rounded).min(MOST_TURNS))
    }

    /// The end of a loop, and whether it has a turn at this end. Of two conditions that must both hold, one is enough.
    fn end(&self, condition: &Expression<'a>, counter: &str, step: f64) -> Option<(f64, bool)> {
        let Kind::Binary(operator, left, right) = &condition.kind else {
            return None;
        };
        let (operator, limit) = match *operator {
            "&&" => {
                let one = self.end(left, counter, step);
                return one.or_else(|| self.end(right, counter, step));
            }
            operator if is_name(left, counter) => (operator, right),
            "<" if is_name(right, counter) => (">", left),
            "<=" if is_name(right, counter) => (">=", left),
            ">" if is_name(right, counter) => ("<", left),
            ">=" if is_name(right, counter) => ("<=", left),
            _ => return None,
        };
        let end = self.number(limit)?;
        match operator {
            "<" if step > 0.0 => Some((end, false)),
            "<=" if step > 0.0 => Some((end, true)),
            ">" if step < 0.0 => Some((end, false)),
            ">=" if step < 0.0 => Some((end, true)),
            _ => None,
        }
    }

    /// The step of a loop.
    fn step(&self, step: &Expression<'a>, counter: &str) -> Option<f64> {
        let (operator, of, by) = match &step.kind {
            Kind::Prefix(operator, of) | Kind::Postfix(operator, of) => (*operator, of, 1.0),
            Kind::Assignment(operator, of, by) => (*operator, of, self.number(by)?),
            _ => return None,
        };
        match operator {
            _ if !is_name(of, counter) => None,
            "++" | "+=" => Some(by),
            "--" | "-=" => Some(-by),
            _ => None,
        }
    }

    /// A number that is constant: a literal, or a constant of the text with a literal.
    fn number(&self, expression: &Expression<'a>) -> Option<f64> {
        match &expression.kind {
            Kind::Literal(text) if is_octal(text) => None,
            Kind::Literal(text) => text.trim_end_matches(['u', 'U', 'f', 'F']).parse().ok(),
            Kind::Prefix("-", of) => Some(-self.number(of)?),
            Kind::Name(name) if self.is_local(name) => None,
            Kind::Name(name) => {
                let constants = self.program.globals.iter().filter(|d| d.is_const);
                let mut all = constants.flat_map(|d| &d.variables);
                let found = all.find(|v: &&Variable| v.name == *name)?;
                match &found.initial.as_ref()?.kind {
                    Kind::Literal(_) => self.number(found.initial.as_ref()?),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Whether a function has a parameter or a variable with this name, which may hide a constant of the text.
    fn is_local(&self, name: &str) -> bool {
        self.program.functions.iter().any(|function| {
            let is_parameter = function.parameters.iter().any(|p| p.name == name);
            let body = function.body.as_deref().unwrap_or(&[]);
            is_parameter || body.iter().any(|s| self.may_change(s, name))
        })
    }

    /// Whether a statement may change the variable with this name, or declares another one with it.
    fn may_change(&self, statement: &Statement, name: &str) -> bool {
        let within = |all: &[Statement]| all.iter().any(|s| self.may_change(s, name));
        let by = |value: &Expression| self.changes(value, name);
        match statement {
            Statement::Block(all) => within(all),
            Statement::Declaration(declared) => declared
                .variables
                .iter()
                .any(|v| v.name == name || v.initial.as_ref().is_some_and(by)),
            Statement::Expression(value)
            | Statement::Case(Some(value))
            | Statement::Return(Some(value)) => by(value),
            Statement::If(condition, one, other) => by(condition) || within(one) || within(other),
            Statement::For {
                first,
                condition,
                step,
                body,
            } => {
                within(first)
                    || condition.as_ref().is_some_and(by)
                    || step.as_ref().is_some_and(by)
                    || within(body)
            }
            Statement::While(condition, body)
            | Statement::DoWhile(body, condition)
            | Statement::Switch(condition, body) => by(condition) || within(body),
            Statement::Case(None) | Statement::Return(None) | Statement::Jump(_) => false,
        }
    }

    /// Whether an expression assigns to the variable, or passes it to a function that does.
    fn changes(&self, expression: &Expression, name: &str) -> bool {
        let own = match &expression.kind {
            Kind::Prefix("++" | "--", of) | Kind::Postfix(_, of) | Kind::Assignment(_, of, _) => {
                is_name(of, name)
            }
            Kind::Call(function, all) => {
                self.assigns(function) && all.iter().any(|argument| is_name(argument, name))
            }
            _ => false,
        };
        own || parts(expression)
            .into_iter()
            .any(|part| self.changes(part, name))
    }

    /// Whether a function assigns to an argument.
    fn assigns(&self, name: &str) -> bool {
        let mut all = self.program.functions.iter().filter(|f| f.name == name);
        let own = |function: &Function| function.parameters.iter().any(|p| p.is_out);
        matches!(name, "modf" | "frexp") || all.any(own)
    }
}

/// The sum of bounds that are all known, at most [`MOST_TURNS`].
fn sum(all: impl IntoIterator<Item = Option<u64>>) -> Option<u64> {
    let mut whole: u64 = 0;
    for one in all {
        whole = whole.saturating_add(one?);
    }
    Some(whole.min(MOST_TURNS))
}

/// Whether an integer is written in octal digits.
fn is_octal(text: &str) -> bool {
    let digits = text.trim_end_matches(['u', 'U']);
    digits.len() > 1 && digits.starts_with('0') && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Whether statements may return from their function or, if `by_break` holds, end the loop around them.
fn may_end(all: &[Statement], by_break: bool) -> bool {
    all.iter().any(|statement| match statement {
        Statement::Jump(jump) => by_break && *jump == "break",
        Statement::Return(_) => true,
        Statement::Block(all) => may_end(all, by_break),
        Statement::If(_, one, other) => may_end(one, by_break) || may_end(other, by_break),
        // A `break` in these ends only them.
        Statement::For { body, .. }
        | Statement::While(_, body)
        | Statement::DoWhile(body, _)
        | Statement::Switch(_, body) => may_end(body, false),
        Statement::Declaration(_) | Statement::Expression(_) | Statement::Case(_) => false,
    })
}

fn is_name(expression: &Expression, name: &str) -> bool {
    matches!(&expression.kind, Kind::Name(found) if *found == name)
}

/// The expressions of which an expression consists.
fn parts<'a, 'b>(expression: &'b Expression<'a>) -> Vec<&'b Expression<'a>> {
    match &expression.kind {
        Kind::Literal(_) | Kind::Name(_) => Vec::new(),
        Kind::Prefix(_, of) | Kind::Postfix(_, of) | Kind::Member(of, _) | Kind::Length(of) => {
            vec![of]
        }
        Kind::Binary(_, a, b) | Kind::Assignment(_, a, b) | Kind::Index(a, b) => vec![a, b],
        Kind::Choice([a, b, c]) => vec![a, b, c],
        Kind::Call(_, all) | Kind::Constructor(_, all) => all.iter().collect(),
    }
}
