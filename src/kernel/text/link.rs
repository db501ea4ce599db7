//! A linker for shader text: a program gets the functions that it calls, and no others.
//!
//! A file under `glsl/` is paragraphs, parted by empty lines; each defines a function, constants
//! or uniforms. [`link`] takes some sources whole and puts before each what it names, callees
//! first. GLSL has no recursion, so that there always is such an order.

use super::shader_source::Source;
use std::borrow::Cow;
use std::collections::HashMap;

/// A piece that is taken as a whole, and only if something names what it defines.
#[derive(Clone, Debug)]
pub struct Part {
    pub(super) sources: Vec<Source>,
    pub(super) defines: Vec<String>,
    pub(super) uses: Vec<String>,
}

/// Words that begin the definition of a function.
const TYPES: [&str; 11] = [
    "float", "int", "uint", "bool", "void", "vec2", "vec3", "vec4", "uvec3", "mat3", "ivec2",
];

/// The paragraphs of a source; those of comments alone are left out.
pub fn parts(source: Source) -> Vec<Part> {
    let mut all = Vec::new();
    let mut line = source.line;
    for paragraph in source.text.split("\n\n") {
        let first = line;
        line += paragraph.matches('\n').count() + 2;
        let blank = paragraph.len() - paragraph.trim_start_matches('\n').len();
        let text = paragraph.trim_matches('\n');
        let defines: Vec<String> = text.lines().filter_map(defined).collect();
        if defines.is_empty() {
            continue;
        }
        all.push(Part {
            uses: words(text).map(str::to_owned).collect(),
            defines,
            sources: vec![Source {
                name: source.name.clone(),
                line: first + blank,
                text: Cow::Owned(format!("{text}\n")),
            }],
        });
    }
    all
}

/// The roots in their order, each after the parts that it calls for.
pub fn link(roots: Vec<Source>, parts: Vec<Part>) -> Vec<Source> {
    let mut defined_in: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, part) in parts.iter().enumerate() {
        for name in &part.defines {
            defined_in.entry(name).or_default().push(index);
        }
    }
    let mut linker = Linker {
        parts: &parts,
        defined_in,
        taken: vec![false; parts.len()],
        sources: Vec::new(),
    };
    for root in roots {
        words(&root.text).for_each(|word| linker.take(word));
        linker.sources.push(root);
    }
    linker.sources
}

struct Linker<'a> {
    parts: &'a [Part],
    defined_in: HashMap<&'a str, Vec<usize>>,
    taken: Vec<bool>,
    sources: Vec<Source>,
}

impl Linker<'_> {
    /// Takes what defines a name, after what that names itself.
    fn take(&mut self, name: &str) {
        let parts = self.parts;
        for index in self.defined_in.get(name).cloned().unwrap_or_default() {
            if std::mem::replace(&mut self.taken[index], true) {
                continue;
            }
            parts[index].uses.iter().for_each(|word| self.take(word));
            self.sources.extend(parts[index].sources.iter().cloned());
        }
    }
}

/// What a line that begins a definition defines.
fn defined(line: &str) -> Option<String> {
    let mut rest = line.split_whitespace();
    let first = rest.next()?;
    if line.starts_with(' ') {
        return None;
    }
    let name = match first {
        "#define" => rest.next()?,
        "const" => rest.nth(1)?,
        "uniform" => match rest.next()? {
            "highp" => rest.nth(1)?,
            _ => rest.next()?,
        },
        "struct" => rest.next()?,
        kind if TYPES.contains(&kind) => rest.next()?,
        // A function that gives a structure.
        kind if kind.starts_with(|c: char| c.is_ascii_alphabetic()) => {
            rest.next().filter(|name| name.contains('('))?
        }
        _ => return None,
    };
    words(name).next().map(str::to_owned)
}

/// The names in a text, its comments left out; that of a function with its bracket, so that a
/// variable of the same name is another word.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    code.flat_map(|line| {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let mut rest = line;
        std::iter::from_fn(move || {
            let start = rest.find(is_name)?;
            let from = &rest[start..];
            let length = from.find(|c| !is_name(c)).unwrap_or(from.len());
            let with_bracket = length + usize::from(from[length..].starts_with('('));
            rest = &from[with_bracket..];
            Some(&from[..with_bracket])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linked(root: &str, library: &'static str) -> String {
        let sources = link(
            vec![Source::new("root", root.to_owned())],
            parts(Source::new("library", library)),
        );
        sources.iter().map(|source| &*source.text).collect()
    }

    /// Protects the order and the choice: callees come first, what nothing calls is left out,
    /// a name in a comment calls nothing.
    #[test]
    fn what_is_called_comes_first_and_nothing_else() {
        let library = "// A file.\n\nfloat outer(float x) {\n    return inner(x) + SIZE;\n}\n\n\
                       float unused() { return 0.0; }\n\n// Not unused().\n\
                       float inner(float x) { return x; }\n\nconst float SIZE = 2.0;\n";
        let text = linked("void main() { outer(1.0); }  // unused()\n", library);
        let place = |part: &str| text.find(part);
        assert!(place("float inner(") < place("float outer("));
        assert!(place("const float SIZE") < place("float outer("));
        assert!(place("float outer(") < place("void main("));
        assert_eq!(place("float unused("), None);
    }

    /// Protects the lines that a driver's messages name.
    #[test]
    fn each_part_knows_its_line() {
        let text =
            "// A file.\n\nuniform float uSize;\n\n\n// f.\nfloat f() {\n    return uSize;\n}\n";
        let lines: Vec<usize> = parts(Source::new("file", text))
            .iter()
            .map(|part| part.sources[0].line)
            .collect();
        assert_eq!(lines, [3, 6]);
    }

    /// Protects structures, the functions that give one, and variables: each comes where it is
    /// named.
    #[test]
    fn structures_and_what_gives_them_come_too() {
        let library = "struct Way {\n    float end;\n};\n\nint turns;\n\n\
                       Way way(float end) {\n    ++turns;\n    return Way(end);\n}\n\n\
                       struct Other { int x; };\n";
        let text = linked("void main() { way(1.0); }\n", library);
        let place = |part: &str| text.find(part);
        assert!(place("struct Way") < place("Way way("));
        assert!(place("int turns;") < place("Way way("));
        assert!(place("Way way(") < place("void main("));
        assert_eq!(place("struct Other"), None);
    }

    /// Protects what is not called: a variable may have a function's name.
    #[test]
    fn a_variable_is_no_call() {
        let library = "float bend(float x) { return x; }\n\nconst float SIZE = 2.0;\n";
        let text = linked("void main() { float bend = SIZE; }\n", library);
        assert!(text.contains("const float SIZE") && !text.contains("float bend(float x)"));
    }

    /// Protects overloads: a name brings all functions of that name.
    #[test]
    fn functions_of_one_name_come_together() {
        let text = linked(
            "void main() { f(1.0); }\n",
            "float f(float x) { return x; }\n\nvec4 f(vec4 x) { return x; }\n",
        );
        assert!(text.contains("float f(") && text.contains("vec4 f("));
    }
}
