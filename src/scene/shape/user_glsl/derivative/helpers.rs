//! Writes the structures with derivatives, and the functions that implement the rules of operators.

use super::functions::Writer;
use super::rules::Rule;
use super::types::{Base, Type};
use super::values::Value;
use super::{Obstacle, obstacle};
use std::fmt::Write as _;

/// For each argument of a rule: the name of the parameter, and the names of its value and its derivative in the rule.
const LETTERS: [(&str, &str, &str); 3] = [("a", "A", "dA"), ("b", "B", "dB"), ("c", "C", "dC")];

impl<'a> Writer<'a> {
    /// The name of the structure that contains a value and its derivatives. For an array, this is the structure of an
    /// element.
    pub fn dual(&mut self, of: &Type) -> String {
        let element = Type {
            length: None,
            ..of.clone()
        };
        let (name, members) = match element.base {
            Base::Struct(index) => (format!("{}S{index}", self.prefix), self.members(index)),
            _ => {
                let plain = element.name();
                let lanes = self
                    .lanes
                    .iter()
                    .map(|lane| format!("    {plain} {lane};\n"));
                let members = format!("    {plain} v;\n") + &lanes.collect::<String>();
                (format!("{}{plain}", self.prefix), members)
            }
        };
        if self.known.insert(name.clone()) {
            let _ = write!(self.structures, "struct {name} {{\n{members}}};\n\n");
        }
        name
    }

    fn members(&mut self, index: usize) -> String {
        let program = self.program;
        let mut all = String::new();
        for (member, of) in &program.structures[index].members {
            let varies = self.can_vary(of);
            let name = self.name_of(of, varies);
            let (member, brackets) = (self.named(member), self.brackets(of));
            let _ = writeln!(all, "    {name} {member}{brackets};");
        }
        all
    }

    /// Adds a helper function, once for each key.
    pub fn add_helper(&mut self, key: &str, text: &str) -> Result<(), Obstacle> {
        if self.known.insert(key.to_owned()) {
            self.helpers.push_str(text);
            self.helpers.push('\n');
        }
        self.check_length()
    }

    /// A key that contains the name and the parameter types of a function, by which its overloads differ.
    fn key(&mut self, name: &str, given: &[Value<'a>]) -> String {
        let types = given.iter().map(|v| self.name_of(&v.of_type, v.varies));
        format!("{name} {}", types.collect::<Vec<_>>().join(" "))
    }

    /// Writes a call of the function that implements a rule.
    pub fn apply(
        &mut self,
        name: &str,
        rule: &Rule,
        given: &[Value<'a>],
    ) -> Result<Value<'a>, Obstacle> {
        let function = format!("{}{name}", self.prefix);
        let texts: Vec<&str> = given.iter().map(|value| value.text.as_str()).collect();
        let call = format!("{function}({})", texts.join(", "));
        let key = self.key(&function, given);
        if !self.known.contains(&key) {
            let text = self.ruled(&function, rule, given)?;
            self.add_helper(&key, &text)?;
        }
        Ok(Value::varying(call, rule.returns.clone()))
    }

    /// The text of a function that implements a rule.
    fn ruled(
        &mut self,
        function: &str,
        rule: &Rule,
        given: &[Value<'a>],
    ) -> Result<String, Obstacle> {
        if given.len() > LETTERS.len() {
            return obstacle("a function of GLSL has too many arguments");
        }
        let t = rule.returns.name();
        let result = self.dual(&rule.returns);
        let (mut parameters, mut values) = (Vec::new(), String::new());
        let mut rates = Vec::new();
        for (value, (parameter, letter, rate)) in given.iter().zip(LETTERS) {
            let of = &value.of_type;
            parameters.push(format!("{} {parameter}", self.name_of(of, value.varies)));
            let float = match of.base {
                Base::Bool => of.clone(),
                _ => of.of(Base::Float),
            };
            let is_wider = rule.promotes && !float.is_same(&rule.returns);
            let needed = if is_wider { t.clone() } else { float.name() };
            let own = if value.varies {
                format!("{parameter}.v")
            } else {
                parameter.to_owned()
            };
            let own = match is_wider || !float.is_same(of) {
                true => format!("{needed}({own})"),
                false => own,
            };
            let _ = write!(values, " {needed} {letter} = {own};");
            if value.varies {
                rates.push((rate, (parameter, is_wider)));
            }
        }
        let is_bool = |value: &Value| value.of_type.base == Base::Bool;
        let all_vary = given.iter().all(|value| value.varies || is_bool(value));
        let along = |lane: &str| {
            let own = |&(parameter, is_wider): &(&str, bool)| match is_wider {
                true => format!("{t}({parameter}.{lane})"),
                false => format!("{parameter}.{lane}"),
            };
            let known: Vec<(&str, String)> =
                rates.iter().map(|(rate, of)| (*rate, own(of))).collect();
            if let Some(sum) = rule.sum.filter(|_| all_vary) {
                return substituted(sum, &t, &known);
            }
            let terms = LETTERS.iter().zip(&rule.terms);
            let terms = terms.filter(|((.., rate), _)| known.iter().any(|(own, _)| own == rate));
            let terms: Vec<String> = terms
                .map(|(_, term)| substituted(term, &t, &known))
                .collect();
            terms.join(" + ")
        };
        let lanes: Vec<String> = self.lanes.iter().map(|lane| along(lane)).collect();
        let (before, after) = (
            substituted(&rule.before, &t, &[]),
            substituted(&rule.after, &t, &[]),
        );
        Ok(format!(
            "{result} {function}({}) {{\n   {values} {before}\n    {t} V = {}; {after}\n    \
             return {result}(V, {});\n}}\n",
            parameters.join(", "),
            substituted(&rule.value, &t, &[]),
            lanes.join(", "),
        ))
    }

    /// Writes a call of a type's constructor.
    pub fn constructed(&mut self, of: &Type, given: &[Value<'a>]) -> Result<Value<'a>, Obstacle> {
        let t = of.name();
        let texts: Vec<&str> = given.iter().map(|value| value.text.as_str()).collect();
        if !given.iter().any(|value| value.varies) {
            return Ok(Value::plain(
                format!("{t}({})", texts.join(", ")),
                of.clone(),
            ));
        }
        if let [one] = given
            && one.of_type.is_same(of)
        {
            return Ok(Value::varying(one.text.clone(), of.clone()));
        }
        let is_smaller = |value: &Value| {
            let from = &value.of_type;
            from.is_matrix() && (from.columns < of.columns || from.rows < of.rows)
        };
        if of.is_matrix() && given.iter().any(is_smaller) {
            // GLSL fills the rest of the matrix from an identity matrix. The same fill would be wrong for the
            // derivatives.
            return obstacle("a matrix of a smaller one");
        }
        let function = format!("{}make_{t}", self.prefix);
        let call = format!("{function}({})", texts.join(", "));
        let key = self.key(&function, given);
        if !self.known.contains(&key) {
            let result = self.dual(of);
            let mut parameters = Vec::new();
            for (place, value) in given.iter().enumerate() {
                if value.of_type.is_array() || value.of_type.is_struct() {
                    return obstacle("a constructor of a structure or an array");
                }
                let name = self.name_of(&value.of_type, value.varies);
                parameters.push(format!("{name} a{place}"));
            }
            let made = |lane: &str| {
                let parts =
                    given
                        .iter()
                        .enumerate()
                        .map(|(place, value)| match (value.varies, lane) {
                            (true, lane) => format!("a{place}.{lane}"),
                            (false, "v") => format!("a{place}"),
                            (false, _) => format!("{}(0)", value.of_type.name()),
                        });
                format!("{t}({})", parts.collect::<Vec<_>>().join(", "))
            };
            let lanes = std::iter::once("v").chain(self.lanes.iter().copied());
            let lanes: Vec<String> = lanes.map(made).collect();
            let text = format!(
                "{result} {function}({}) {{\n    return {result}({});\n}}\n",
                parameters.join(", "),
                lanes.join(", ")
            );
            self.add_helper(&key, &text)?;
        }
        Ok(Value::varying(call, of.clone()))
    }

    /// Writes the selection of components or of an element from a value that is not a variable.
    pub fn selected(
        &mut self,
        value: &Value<'a>,
        (name, selection): (&str, &str),
        index: Option<&Value<'a>>,
        of: &Type,
    ) -> Result<Value<'a>, Obstacle> {
        let function = format!("{}{name}", self.prefix);
        let (from, to) = (self.dual(&value.of_type), self.dual(of));
        let parts: Vec<String> = self.parts("a");
        let parts: Vec<String> = parts.iter().map(|p| format!("{p}{selection}")).collect();
        let (parameter, argument) = match index {
            Some(index) => (
                format!(", {} i", index.of_type.name()),
                format!(", {}", index.text),
            ),
            None => (String::new(), String::new()),
        };
        self.add_helper(
            &format!("{function} {from}{parameter}"),
            &format!(
                "{to} {function}({from} a{parameter}) {{\n    return {to}({});\n}}\n",
                parts.join(", ")
            ),
        )?;
        let text = format!("{function}({}{argument})", value.text);
        Ok(Value::varying(text, of.clone()))
    }

    /// The name of the helper function that assigns to components.
    pub fn setter(&mut self, of: &Type) -> Result<String, Obstacle> {
        let (plain, dual) = (of.name(), self.dual(of));
        let function = format!("{}set", self.prefix);
        let mut parameters = format!("out {plain} v");
        let mut body = "    v = a.v;\n".to_owned();
        for lane in self.lanes {
            let _ = write!(parameters, ", out {plain} {lane}");
            let _ = writeln!(body, "    {lane} = a.{lane};");
        }
        self.add_helper(
            &format!("{function} {dual}"),
            &format!("{dual} {function}({parameters}, {dual} a) {{\n{body}    return a;\n}}\n"),
        )?;
        Ok(function)
    }
}

/// Replaces the names in the text of a rule by the type of the result and the derivatives of the arguments.
fn substituted(text: &str, t: &str, rates: &[(&str, String)]) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(is_name) {
        out.push_str(&rest[..start]);
        rest = &rest[start..];
        let length = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        let word = &rest[..length];
        let rate = rates.iter().find(|(name, _)| *name == word);
        out.push_str(match (word, rate) {
            ("T", _) => t,
            (_, Some((_, own))) => own,
            _ => word,
        });
        rest = &rest[length..];
    }
    out.push_str(rest);
    out
}
