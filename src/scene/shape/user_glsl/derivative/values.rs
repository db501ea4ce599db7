//! Values of expressions: their text, and their place if they are variables.

use super::functions::{Variable, Writer};
use super::types::{Base, Type};
use super::{Obstacle, obstacle};

/// A variable, or a part of it.
#[derive(Clone, Debug)]
pub struct Place<'a> {
    pub variable: Variable<'a>,
    /// The text of the variable, with members of structures and indices of arrays.
    pub root: String,
    /// The text of the indices of columns and the selections of components.
    pub components: String,
}

/// The value of an expression.
#[derive(Clone, Debug)]
pub struct Value<'a> {
    pub text: String,
    pub of_type: Type,
    /// Whether the value depends on the point. If so, its text is a structure with derivatives.
    pub varies: bool,
    pub place: Option<Place<'a>>,
}

impl<'a> Value<'a> {
    pub fn plain(text: String, of_type: Type) -> Value<'a> {
        Value {
            text,
            of_type,
            varies: false,
            place: None,
        }
    }

    pub fn varying(text: String, of_type: Type) -> Value<'a> {
        Value {
            varies: true,
            ..Value::plain(text, of_type)
        }
    }
}

impl<'a> Writer<'a> {
    /// The value of a variable or a part of it.
    pub fn at_place(&mut self, place: Place<'a>, of_type: Type, varies: bool) -> Value<'a> {
        let Place {
            root, components, ..
        } = &place;
        let text = if varies && !components.is_empty() {
            let name = self.dual(&of_type);
            let parts = self.parts(root);
            let parts: Vec<String> = parts.iter().map(|p| format!("{p}{components}")).collect();
            format!("{name}({})", parts.join(", "))
        } else {
            format!("{root}{components}")
        };
        Value {
            text,
            of_type,
            varies,
            place: Some(place),
        }
    }

    /// The texts of the value and the derivatives of the structure `root`.
    pub fn parts(&self, root: &str) -> Vec<String> {
        let lanes = self.lanes.iter().map(|lane| format!("{root}.{lane}"));
        std::iter::once(format!("{root}.v")).chain(lanes).collect()
    }

    /// The text of a value without its derivatives.
    pub fn native(&self, value: &Value<'a>) -> Result<String, Obstacle> {
        if !value.varies {
            return Ok(value.text.clone());
        }
        if !value.of_type.is_float() {
            return obstacle(
                "a structure or an array that depends on the point is used as a whole",
            );
        }
        Ok(match &value.place {
            Some(Place {
                root, components, ..
            }) => format!("{root}.v{components}"),
            None => format!("({}).v", value.text),
        })
    }

    /// The text of a value as a structure of this type. If the value does not depend on the point, the derivatives are
    /// 0.
    pub fn lifted(&mut self, value: &Value<'a>, to: &Type) -> Result<String, Obstacle> {
        if value.varies {
            return Ok(value.text.clone());
        }
        if to.is_array() {
            return self.lifted_array(value, to);
        }
        let name = self.dual(to);
        if to.base != Base::Float {
            return self.lifted_structure(value, to);
        }
        let of = to.name();
        let own = match value.of_type.base {
            Base::Float => value.text.clone(),
            _ => format!("{of}({})", value.text),
        };
        let zeros = format!(", {of}(0.0)").repeat(self.lanes.len());
        Ok(format!("{name}({own}{zeros})"))
    }

    /// Converts an array element by element. The helper function needs a length that is known outside of functions.
    fn lifted_array(&mut self, value: &Value<'a>, to: &Type) -> Result<String, Obstacle> {
        let is_known = |of: &&Type| {
            let length = of.length.as_deref().unwrap_or_default();
            let mut globals = self.program.globals.iter().flat_map(|d| &d.variables);
            length.starts_with(|c: char| c.is_ascii_digit()) || globals.any(|g| g.name == length)
        };
        let (Some(sized), Some(element)) = (
            [to, &value.of_type].into_iter().find(is_known),
            to.element(),
        ) else {
            return obstacle("an array that depends on the point is assigned as a whole");
        };
        let brackets = self.brackets(sized);
        let (own, dual) = (self.type_name(&element), self.dual(&element));
        let at = Value::plain("a[i]".to_owned(), element.clone());
        let lifted = self.lifted(&at, &element)?;
        // The length is part of the function's name. Overloads by the length would clash if two names have the same
        // number.
        let length = brackets.trim_matches(['[', ']']);
        let function = format!("{}lift_{length}", self.prefix);
        self.add_helper(
            &format!("{function} {own}"),
            &format!(
                "{dual}{brackets} {function}({own} a{brackets}) {{\n    {dual} all{brackets};\n    \
                 for (int i = 0; i < all.length(); ++i) {{\n        all[i] = {lifted};\n    }}\n    \
                 return all;\n}}\n"
            ),
        )?;
        Ok(format!("{function}({})", value.text))
    }

    fn lifted_structure(&mut self, value: &Value<'a>, to: &Type) -> Result<String, Obstacle> {
        let Base::Struct(index) = to.base else {
            return obstacle("a whole number depends on the point");
        };
        let name = self.dual(to);
        let own = self.structure_name(index);
        let function = format!("{}lift{index}", self.prefix);
        let program = self.program;
        let mut members = Vec::new();
        for (member, of) in &program.structures[index].members {
            let value = Value::plain(format!("a.{}", self.named(member)), of.clone());
            members.push(match self.can_vary(of) {
                true => self.lifted(&value, of)?,
                false => value.text,
            });
        }
        let members = members.join(", ");
        self.add_helper(
            &function,
            &format!("{name} {function}({own} a) {{\n    return {name}({members});\n}}\n"),
        )?;
        Ok(format!("{function}({})", value.text))
    }

    /// The name in the shader for a name in the text.
    pub fn named(&self, name: &str) -> String {
        use super::super::words::{is_known, is_selection};
        if is_known(name) || is_selection(name) {
            return name.to_owned();
        }
        match name.starts_with('_') {
            true => format!("users{}{name}", self.index),
            false => format!("user{}_{name}", self.index),
        }
    }

    pub fn structure_name(&self, index: usize) -> String {
        self.named(self.program.structures[index].name)
    }

    /// The name in the shader for a type, without the length of an array.
    pub fn type_name(&self, of: &Type) -> String {
        match of.base {
            Base::Struct(index) => self.structure_name(index),
            _ => of.name(),
        }
    }

    /// The name in the shader for a type, or for its structure with derivatives.
    pub fn name_of(&mut self, of: &Type, varies: bool) -> String {
        match varies {
            true => self.dual(of),
            false => self.type_name(of),
        }
    }

    /// The brackets of an array type, as text.
    pub fn brackets(&self, of: &Type) -> String {
        let length = |length: &String| match length.starts_with(|c: char| c.is_ascii_digit()) {
            true => format!("[{length}]"),
            false if length.is_empty() => "[]".to_owned(),
            false => format!("[{}]", self.named(length)),
        };
        of.length.as_ref().map_or(String::new(), length)
    }

    /// Whether values of this type can depend on the point.
    pub fn can_vary(&self, of: &Type) -> bool {
        match of.base {
            Base::Float => true,
            Base::Struct(index) => {
                let members = &self.program.structures[index].members;
                members.iter().any(|(_, member)| self.can_vary(member))
            }
            _ => false,
        }
    }
}
