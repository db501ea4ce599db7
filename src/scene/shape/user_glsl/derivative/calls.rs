//! Writes the derivative of calls of GLSL functions, constructors, and functions of the text.

use super::functions::Writer;
use super::rules;
use super::syntax::{Expression, Parameter};
use super::types::{Base, Type};
use super::values::Value;
use super::{Obstacle, obstacle};
use std::fmt::Write as _;

impl<'a> Writer<'a> {
    /// Writes a call of a function.
    pub fn call(
        &mut self,
        name: &'a str,
        given: &'a [Expression<'a>],
    ) -> Result<Value<'a>, Obstacle> {
        let given = self.values(given)?;
        match self.overload(name, &given)? {
            Some(function) => self.own_call(function, &given),
            None => self.call_of_glsl(name, given),
        }
    }

    fn values(&mut self, of: &'a [Expression<'a>]) -> Result<Vec<Value<'a>>, Obstacle> {
        of.iter().map(|one| self.value(one)).collect()
    }

    /// The index of the text's function that a call refers to; `None` for a GLSL function.
    fn overload(&self, name: &str, given: &[Value<'a>]) -> Result<Option<usize>, Obstacle> {
        let program = self.program;
        let fits = |accepts: fn(&Type, &Type) -> bool| -> Vec<usize> {
            let all = program.functions.iter().enumerate();
            let fitting = all.filter(|(_, function)| {
                let pairs = function.parameters.iter().zip(given);
                function.name == name
                    && function.parameters.len() == given.len()
                    && pairs.clone().all(|(p, v)| accepts(&p.of_type, &v.of_type))
            });
            fitting.map(|(index, _)| index).collect()
        };
        if !program.functions.iter().any(|f| f.name == name) {
            return Ok(None);
        }
        for accepts in [Type::is_same, Type::takes] {
            match fits(accepts)[..] {
                [one] => return Ok(Some(one)),
                [] => (),
                _ => return obstacle("a call that fits two functions"),
            }
        }
        obstacle("a call that fits no function")
    }

    fn call_of_glsl(
        &mut self,
        name: &'a str,
        given: Vec<Value<'a>>,
    ) -> Result<Value<'a>, Obstacle> {
        if !super::super::words::is_function(name) {
            return obstacle("a function without a definition");
        }
        if name == "modf" {
            return self.modf(&given);
        }
        let types: Vec<Type> = given.iter().map(|value| value.of_type.clone()).collect();
        let varies: Vec<bool> = given.iter().map(|value| value.varies).collect();
        let Some(of) = rules::type_of_call(name, &types) else {
            return obstacle("a call of a function of GLSL with other arguments");
        };
        let rule = match varies.contains(&true) {
            true => rules::of_call(name, &types, &varies)?,
            false => None,
        };
        if let Some(rule) = rule {
            return self.apply(name, &rule, &given);
        }
        let bits = ["floatBitsToInt", "floatBitsToUint"];
        if bits.contains(&name) && varies.contains(&true) && self.makes_floats_of_bits {
            return obstacle("floats are made of the bits of floats that depend on the point");
        }
        let texts: Result<Vec<String>, Obstacle> = given.iter().map(|v| self.native(v)).collect();
        let text = format!("{name}({})", texts?.join(", "));
        Ok(Value::plain(text, of))
    }

    /// Writes `modf(x, whole)`. The whole part is constant between jumps, so it has no derivative.
    fn modf(&mut self, given: &[Value<'a>]) -> Result<Value<'a>, Obstacle> {
        let [value, whole] = given else {
            return obstacle("a call of a function of GLSL with other arguments");
        };
        if whole.varies || whole.place.is_none() {
            return obstacle("modf with a whole part that depends on the point");
        }
        let (of, own) = (value.of_type.clone(), self.native(value)?);
        let call = format!("modf({own}, {})", whole.text);
        if !value.varies {
            return Ok(Value::plain(call, of));
        }
        let (dual, plain) = (self.dual(&of), of.name());
        let function = format!("{}modf", self.prefix);
        let rates: Vec<String> = self.lanes.iter().map(|lane| format!("a.{lane}")).collect();
        self.add_helper(
            &format!("{function} {dual}"),
            &format!(
                "{dual} {function}({dual} a, out {plain} whole) {{\n    \
                 return {dual}(modf(a.v, whole), {});\n}}\n",
                rates.join(", ")
            ),
        )?;
        let text = format!("{function}({}, {})", value.text, whole.text);
        Ok(Value::varying(text, of))
    }

    /// Writes a constructor of any type.
    pub fn constructor(
        &mut self,
        of: &Type,
        given: &'a [Expression<'a>],
    ) -> Result<Value<'a>, Obstacle> {
        let given = self.values(given)?;
        let varies = given.iter().any(|value| value.varies);
        if of.is_array() {
            let Some(element) = of.element() else {
                return obstacle("an array of nothing");
            };
            let types = vec![element; given.len()];
            let of_all = varies.then_some(&types[..]);
            let texts = self.members_as(&given, of_all)?;
            let name = self.name_of(of, varies);
            let text = format!("{name}{}({texts})", self.brackets(of));
            return Ok(Value {
                varies,
                ..Value::plain(text, of.clone())
            });
        }
        if let Base::Struct(index) = of.base {
            let members = &self.program.structures[index].members;
            if members.len() != given.len() {
                return obstacle("a structure with other members");
            }
            let types: Vec<Type> = members.iter().map(|(_, of)| of.clone()).collect();
            let texts = self.members_as(&given, varies.then_some(&types[..]))?;
            let text = format!("{}({texts})", self.name_of(of, varies));
            return Ok(Value {
                varies,
                ..Value::plain(text, of.clone())
            });
        }
        if of.base == Base::Float {
            return self.constructed(of, &given);
        }
        let texts: Result<Vec<String>, Obstacle> = given.iter().map(|v| self.native(v)).collect();
        let text = format!("{}({})", of.name(), texts?.join(", "));
        Ok(Value::plain(text, of.clone()))
    }

    /// Writes the values of members. If `types` is given, members whose type can depend on the point get derivatives.
    fn members_as(
        &mut self,
        given: &[Value<'a>],
        types: Option<&[Type]>,
    ) -> Result<String, Obstacle> {
        let mut texts = Vec::new();
        for (place, value) in given.iter().enumerate() {
            texts.push(match types.map(|types| &types[place]) {
                Some(of) if self.can_vary(of) => self.lifted(value, of)?,
                _ => self.native(value)?,
            });
        }
        Ok(texts.join(", "))
    }

    /// Writes a call of a function of the text.
    fn own_call(&mut self, index: usize, given: &[Value<'a>]) -> Result<Value<'a>, Obstacle> {
        let program = self.program;
        let function = &program.functions[index];
        let asked = function.parameters.iter().zip(given);
        let asked =
            asked.map(|(parameter, value)| value.varies && self.can_vary(&parameter.of_type));
        let asked: Vec<bool> = asked.collect();
        let instance = self.instance(index, &asked)?;
        self.frame.touches_global |= instance.touches_global;
        let mut texts = Vec::new();
        let mut split = vec![false; given.len()];
        for (place, (parameter, value)) in function.parameters.iter().zip(given).enumerate() {
            let varies = instance.varies[place];
            if parameter.is_out {
                let Some(to) = &value.place else {
                    return obstacle("an `out` argument that is not a variable");
                };
                if varies && !value.varies {
                    self.make_vary(to.variable)?;
                }
                split[place] = varies && !to.components.is_empty();
                texts.push(match split[place] {
                    true => {
                        let parts = self.parts(&to.root);
                        let parts = parts.iter().map(|part| format!("{part}{}", to.components));
                        parts.collect::<Vec<_>>().join(", ")
                    }
                    false => format!("{}{}", to.root, to.components),
                });
            } else if varies {
                texts.push(self.lifted(value, &parameter.of_type)?);
            } else {
                texts.push(self.native(value)?);
            }
        }
        let name = match split.contains(&true) {
            true => self.split_call(&instance.name, &function.parameters, &instance, &split)?,
            false => instance.name.clone(),
        };
        Ok(Value {
            varies: instance.returns_vary,
            ..Value::plain(
                format!("{name}({})", texts.join(", ")),
                function.returns.clone(),
            )
        })
    }

    /// Writes a wrapper of a function for arguments that are components of a variable. GLSL has no structure of such
    /// components, so the wrapper takes the components of the value and of each derivative as separate parameters.
    fn split_call(
        &mut self,
        of: &str,
        parameters: &[Parameter<'a>],
        instance: &super::functions::Instance,
        split: &[bool],
    ) -> Result<String, Obstacle> {
        let numbers: Vec<String> = (0..split.len())
            .filter(|place| split[*place])
            .map(|place| place.to_string())
            .collect();
        let function = format!("{of}_with{}", numbers.join("_"));
        let (mut declared, mut before, mut given, mut after) =
            (Vec::new(), String::new(), Vec::new(), String::new());
        for (place, parameter) in parameters.iter().enumerate() {
            let t = &parameter.of_type;
            let name = format!("a{place}");
            given.push(name.clone());
            if !split[place] {
                declared.push(self.declared(parameter, &name, instance.varies[place]));
                continue;
            }
            let (plain, dual) = (t.name(), self.dual(t));
            let lanes = std::iter::once("v").chain(self.lanes.iter().copied());
            let lanes: Vec<(String, &str)> =
                lanes.map(|lane| (format!("{name}{lane}"), lane)).collect();
            let parts: Vec<&str> = lanes.iter().map(|(part, _)| part.as_str()).collect();
            let _ = writeln!(before, "    {dual} {name} = {dual}({});", parts.join(", "));
            for (part, lane) in &lanes {
                declared.push(format!("inout {plain} {part}"));
                let _ = writeln!(after, "    {part} = {name}.{lane};");
            }
        }
        let returns = instance.returns.clone();
        let call = format!("{of}({})", given.join(", "));
        let body = match returns.as_str() {
            "void" => format!("{before}    {call};\n{after}"),
            _ => format!("{before}    {returns} result = {call};\n{after}    return result;\n"),
        };
        if self.known.insert(function.clone()) {
            let declared = declared.join(", ");
            let _ = writeln!(
                self.instances_text,
                "{returns} {function}({declared}) {{\n{body}}}\n"
            );
        }
        self.check_length()?;
        Ok(function)
    }

    /// Writes a parameter of a function declaration.
    pub fn declared(&mut self, parameter: &Parameter<'a>, name: &str, varies: bool) -> String {
        let how = match (parameter.is_in, parameter.is_out) {
            (true, true) => "inout ",
            (false, _) => "out ",
            _ => "",
        };
        let of = self.name_of(&parameter.of_type, varies);
        format!("{how}{of} {name}{}", self.brackets(&parameter.of_type))
    }
}
