//! Writes the derivative of functions, once for each set of arguments that depend on the point.

use super::syntax::{Declaration, Program};
use super::types::{Base, Type};
use super::{Along, Obstacle, obstacle};
use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

/// Maximum number of written expressions, including repetitions. The largest known fields need only a small part of it.
const MOST_STEPS: usize = 1 << 18;

/// Maximum length of the derivative's text in bytes, half the maximum length of a field's text. A driver takes about 20
/// µs and 1 KB per token.
const LONGEST: usize = 1 << 17;

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable<'a> {
    /// The declaration of the function with this index.
    Local(usize),
    Global(&'a str),
}

/// Maximum number of nested expressions, statements and calls together, which limits the recursion of the writer.
const DEEPEST: usize = 160;

/// The derivative of a function for certain arguments that depend on the point.
#[derive(Clone, Debug)]
pub struct Instance {
    pub name: String,
    /// Whether each parameter has derivatives.
    pub varies: Vec<bool>,
    pub returns_vary: bool,
    /// The type of the result, as text.
    pub returns: String,
    /// Whether the function uses a global that depends on the point.
    pub touches_global: bool,
}

/// The state of the writer within a function.
#[derive(Debug, Default)]
pub struct Frame<'a> {
    /// The variables in scope, innermost last.
    pub scopes: Vec<HashMap<&'a str, (usize, Type)>>,
    /// Number of variables declared so far. Every pass declares the variables in the same order.
    pub declared: usize,
    pub varying: HashSet<usize>,
    /// Whether another variable has become dependent on the point in this pass.
    pub has_changed: bool,
    pub text: String,
    pub returns: Option<Type>,
    pub returns_vary: bool,
    pub touches_global: bool,
}

/// Writes the derivative of a program.
pub struct Writer<'a> {
    pub program: &'a Program<'a>,
    pub index: usize,
    pub prefix: String,
    along: Along,
    pub lanes: &'static [&'static str],
    pub frame: Frame<'a>,
    pub structures: String,
    pub helpers: String,
    pub instances_text: String,
    /// The keys of the functions that have been written.
    pub known: HashSet<String>,
    instances: HashMap<(usize, Vec<bool>), Instance>,
    active: Vec<usize>,
    varying_globals: HashSet<&'a str>,
    /// Whether another global has become dependent on the point. Everything is then written again.
    has_changed: bool,
    pub makes_floats_of_bits: bool,
    steps: usize,
    depth: usize,
}

impl<'a> Writer<'a> {
    pub fn new(
        program: &'a Program<'a>,
        (along, index): (Along, usize),
        makes_floats_of_bits: bool,
    ) -> Writer<'a> {
        Writer {
            program,
            index,
            prefix: along.prefix(index),
            along,
            lanes: along.lanes(),
            frame: Frame::default(),
            structures: String::new(),
            helpers: String::new(),
            instances_text: String::new(),
            known: HashSet::new(),
            instances: HashMap::new(),
            active: Vec::new(),
            varying_globals: HashSet::new(),
            has_changed: false,
            makes_floats_of_bits,
            steps: 0,
            depth: 0,
        }
    }

    /// Counts one unit of work.
    pub fn step(&mut self) -> Result<(), Obstacle> {
        self.steps += 1;
        match self.steps <= MOST_STEPS {
            true => Ok(()),
            false => obstacle("it takes too many steps"),
        }
    }

    pub fn check_length(&self) -> Result<(), Obstacle> {
        let parts = [&self.structures, &self.helpers, &self.instances_text];
        match parts.iter().map(|part| part.len()).sum::<usize>() <= LONGEST {
            true => Ok(()),
            false => obstacle("its derivative is too long"),
        }
    }

    /// Performs `work` one nesting level deeper.
    pub fn deeper<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<T, Obstacle>,
    ) -> Result<T, Obstacle> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return obstacle("it is nested too deeply");
        }
        let done = work(self)?;
        self.depth -= 1;
        Ok(done)
    }

    /// Writes the whole text of the derivative.
    pub fn whole(mut self) -> Result<String, Obstacle> {
        let is_field = |f: &super::syntax::Function| {
            let point = Type::vector(Base::Float, 3);
            f.name == "field" && matches!(&f.parameters[..], [p] if p.of_type == point && !p.is_out)
        };
        let Some(field) = self.program.functions.iter().position(is_field) else {
            return obstacle("it has no field");
        };
        if self.program.functions[field].returns != Type::scalar(Base::Float) {
            return obstacle("it has no field");
        }
        loop {
            self.has_changed = false;
            let instance = self.instance(field, &[true])?;
            if !self.has_changed {
                return self.joined(&instance);
            }
            self.structures.clear();
            self.helpers.clear();
            self.instances_text.clear();
            self.known.clear();
            self.instances.clear();
        }
    }

    fn joined(mut self, field: &Instance) -> Result<String, Obstacle> {
        let globals = self.globals()?;
        let dual = self.dual(&Type::vector(Base::Float, 3));
        self.dual(&Type::scalar(Base::Float));
        let scalar = self.name_of(&Type::scalar(Base::Float), field.returns_vary);
        let name = &field.name;
        let (prefix, own) = (&self.prefix, ["", ".v"][usize::from(field.returns_vary)]);
        let entry = match self.along {
            Along::Axes => {
                let gradient = match field.returns_vary {
                    true => "vec3(value.x, value.y, value.z)",
                    false => "vec3(0.0)",
                };
                format!(
                    "float {prefix}field(vec3 p, out vec3 gradient) {{\n    {scalar} value = \
                     {name}({dual}(p, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)));\n    \
                     gradient = {gradient};\n    return value{own};\n}}\n"
                )
            }
            Along::Line => {
                let slope = if field.returns_vary { "value.s" } else { "0.0" };
                format!(
                    "float {prefix}field(vec3 p, vec3 direction, out float slope) {{\n    \
                     {scalar} value = {name}({dual}(p, direction));\n    slope = {slope};\n    \
                     return value{own};\n}}\n"
                )
            }
        };
        self.check_length()?;
        let Writer {
            structures,
            helpers,
            instances_text,
            ..
        } = self;
        Ok(format!(
            "{structures}{helpers}{globals}{instances_text}{entry}"
        ))
    }

    /// Writes the globals that depend on the point.
    fn globals(&mut self) -> Result<String, Obstacle> {
        let mut text = String::new();
        let program = self.program;
        for variable in program.globals.iter().flat_map(|d| &d.variables) {
            if !self.varying_globals.contains(variable.name) {
                continue;
            }
            let of = &variable.of_type;
            let (dual, brackets) = (self.dual(of), self.brackets(of));
            let name = self.name_of_global(variable.name);
            match &variable.initial {
                None => {
                    let _ = writeln!(text, "{dual} {name}{brackets};\n");
                }
                Some(initial) => {
                    let value = self.value(initial)?;
                    let value = self.lifted(&value, of)?;
                    let _ = writeln!(text, "{dual} {name}{brackets} = {value};\n");
                }
            }
        }
        Ok(text)
    }

    pub fn name_of_global(&self, name: &str) -> String {
        format!("{}g_{name}", self.prefix)
    }

    /// The variable with this name, and its type.
    pub fn find(&self, name: &'a str) -> Option<(Variable<'a>, Type)> {
        let mut scopes = self.frame.scopes.iter().rev();
        if let Some((index, of)) = scopes.find_map(|scope| scope.get(name)) {
            return Some((Variable::Local(*index), of.clone()));
        }
        let mut globals = self.program.globals.iter().flat_map(|d| &d.variables);
        let global = globals.find(|variable| variable.name == name)?;
        Some((Variable::Global(name), global.of_type.clone()))
    }

    pub fn does_vary(&self, variable: Variable) -> bool {
        match variable {
            Variable::Local(index) => self.frame.varying.contains(&index),
            Variable::Global(name) => self.varying_globals.contains(name),
        }
    }

    /// Makes a variable depend on the point, from here on and in all later passes.
    pub fn make_vary(&mut self, variable: Variable<'a>) -> Result<(), Obstacle> {
        match variable {
            Variable::Local(index) => {
                self.frame.has_changed |= self.frame.varying.insert(index);
            }
            Variable::Global(name) => {
                let mut all = self.program.globals.iter();
                let is_const = |d: &Declaration| {
                    d.is_const && d.variables.iter().any(|variable| variable.name == name)
                };
                if all.any(is_const) {
                    return obstacle("a constant depends on the point");
                }
                self.has_changed |= self.varying_globals.insert(name);
            }
        }
        Ok(())
    }

    /// Declares a variable in the innermost scope.
    pub fn declare(&mut self, name: &'a str, of: Type) -> usize {
        let index = self.frame.declared;
        self.frame.declared += 1;
        if let Some(scope) = self.frame.scopes.last_mut() {
            scope.insert(name, (index, of));
        }
        index
    }

    /// The derivative of a function for certain arguments that depend on the point (`asked`). It is written at the
    /// first call.
    pub fn instance(&mut self, function: usize, asked: &[bool]) -> Result<Instance, Obstacle> {
        let program = self.program;
        let own = &program.functions[function];
        let original = Instance {
            name: self.named(own.name),
            varies: asked.to_vec(),
            returns_vary: false,
            returns: self.type_name(&own.returns),
            touches_global: false,
        };
        // If neither an argument nor a global depends on the point, nothing in the function does.
        if !asked.contains(&true) && self.varying_globals.is_empty() {
            return Ok(original);
        }
        let key = (function, asked.to_vec());
        if let Some(known) = self.instances.get(&key) {
            return Ok(known.clone());
        }
        if self.active.contains(&function) {
            return obstacle("a function calls itself");
        }
        self.active.push(function);
        let outer = std::mem::take(&mut self.frame);
        let written = self.deeper(|writer| writer.turns(function, asked));
        let frame = std::mem::replace(&mut self.frame, outer);
        self.active.pop();
        let parameters = written?;
        let varies: Vec<bool> = (0..own.parameters.len())
            .map(|place| frame.varying.contains(&place))
            .collect();
        let is_original = !varies.contains(&true) && !frame.returns_vary && !frame.touches_global;
        let instance = match is_original {
            true => original,
            false => {
                let number = self.instances.len();
                let returns = match frame.returns_vary {
                    true => self.dual(&own.returns),
                    false => self.type_name(&own.returns),
                };
                let returns = returns + &self.brackets(&own.returns);
                let name = format!("{}{number}{}", self.prefix, own.name);
                let _ = writeln!(
                    self.instances_text,
                    "{returns} {name}({parameters}) {{\n{}}}\n",
                    frame.text
                );
                self.check_length()?;
                Instance {
                    name,
                    varies,
                    returns_vary: frame.returns_vary,
                    returns,
                    touches_global: frame.touches_global,
                }
            }
        };
        self.instances.insert(key, instance.clone());
        Ok(instance)
    }

    /// Writes a function in repeated passes, until no more variables become dependent on the point. Returns the text of
    /// the parameters.
    fn turns(&mut self, function: usize, asked: &[bool]) -> Result<String, Obstacle> {
        let program = self.program;
        let own = &program.functions[function];
        self.frame.varying = (0..asked.len()).filter(|place| asked[*place]).collect();
        loop {
            let frame = &mut self.frame;
            frame.scopes = vec![HashMap::new()];
            frame.declared = 0;
            frame.has_changed = false;
            frame.text.clear();
            frame.returns = Some(own.returns.clone());
            let mut parameters = Vec::new();
            for parameter in &own.parameters {
                let place = self.declare(parameter.name, parameter.of_type.clone());
                let varies = self.frame.varying.contains(&place);
                let name = match parameter.name.is_empty() {
                    true => String::new(),
                    false => self.named(parameter.name),
                };
                parameters.push(self.declared(parameter, &name, varies));
            }
            let body = own.body.as_ref().map_err(|why| *why)?;
            self.block(body)?;
            if !self.frame.has_changed {
                return Ok(parameters.join(", "));
            }
        }
    }
}
