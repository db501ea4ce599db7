//! Pieces of shader text, and a linker that gives each program only the functions that it calls.
//!
//! A file under `glsl/` is a list of definitions of functions, constants and uniforms. Each definition, with the
//! comment before it, is a [`Part`]. [`link`] includes some sources as a whole, and puts the parts that a source uses
//! before it, callees first. Such an order always exists, because GLSL has no recursion. [`join`] makes one text of the
//! sources, and states the file and line of each source for the driver's messages.
//!
//! If some lines of a function depend on the scene, the function is written as a *skeleton*, a file under
//! `glsl/template/` with placeholders. A placeholder is a name between two `@`, a character that GLSL does not use.
//! [`fill`] replaces placeholders by texts. A placeholder that is alone on its line is replaced by whole lines, or by
//! none.

use crate::scene::shape::every_part;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::sync::LazyLock;

/// A piece of shader text, with its file and the number of its first line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file's path from the repository's root, or a description of the piece.
    pub name: Cow<'static, str>,
    /// Number of the first line of the piece in that file, from 1.
    pub line: usize,
    /// The text itself.
    pub text: Cow<'static, str>,
}

impl Source {
    /// A piece that does not come from a file.
    pub fn new(name: impl Into<Cow<'static, str>>, text: impl Into<Cow<'static, str>>) -> Source {
        Source {
            name: name.into(),
            line: 1,
            text: text.into(),
        }
    }
}

/// A [`Source`] with the text of a file under `glsl/`. `scripts/mutate.sh` builds the tests with
/// `--cfg glsl_at_run_time`, so that it can change the files without rebuilding.
macro_rules! source {
    ($file:expr) => {{
        #[cfg(not(glsl_at_run_time))]
        let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/", $file));
        #[cfg(glsl_at_run_time)]
        let text = $crate::shader::read_at_run_time($file);
        $crate::shader::Source::new(concat!("glsl/", $file), text)
    }};
}
pub(crate) use source;

/// The text of a file in the folder that the environment variable `ECHOMARCH_GLSL` names.
#[cfg(glsl_at_run_time)]
pub(crate) fn read_at_run_time(file: &str) -> String {
    let folder = std::env::var_os("ECHOMARCH_GLSL").expect("ECHOMARCH_GLSL names the folder");
    let path = std::path::Path::new(&folder).join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Maximum empty lines that replace a `#line` directive between two sources of one file.
const MOST_EMPTY_LINES: usize = 2;

/// Joins sources into one text. Driver messages identify each file by a number, counted from 1 in the order in which
/// the files first occur.
pub fn join(sources: &[Source]) -> String {
    let mut files: Vec<&str> = Vec::new();
    let mut text = String::new();
    // The file of the previous source, and the number of the line after its end.
    let mut before = ("", 0);
    for Source {
        name,
        line,
        text: part,
    } in sources
    {
        let known = files.iter().position(|file| file == name);
        let number = 1 + known.unwrap_or_else(|| {
            files.push(name);
            files.len() - 1
        });
        let gap = line
            .checked_sub(before.1)
            .filter(|gap| *gap <= MOST_EMPTY_LINES);
        // Writing to a String cannot fail.
        let _ = match gap {
            Some(gap) if before.0 == name => write!(text, "{:\n<gap$}", ""),
            _ if before.0 == name => write!(text, "\n#line {line} {number}\n"),
            _ => write!(text, "\n// {number}: {name}\n#line {line} {number}\n"),
        };
        let _ = writeln!(text, "{}", part.trim_end_matches('\n'));
        before = (name, line + part.trim_end_matches('\n').lines().count());
    }
    text
}

/// The text of a skeleton with its placeholders replaced by the given texts. Placeholders within these texts are not
/// replaced.
///
/// A placeholder without a text stays in the result, and no driver compiles it. This is an error of the caller.
pub fn fill(skeleton: &Source, texts: &[(&str, &str)]) -> String {
    let mut out = String::with_capacity(skeleton.text.len());
    let mut pieces = skeleton.text.split('@').peekable();
    out.extend(pieces.next());
    while let (Some(name), Some(after)) = (pieces.next(), pieces.next()) {
        let text = texts.iter().find(|(known, _)| *known == name);
        let Some((_, text)) = text else {
            out.extend(["@", name, "@", after]);
            continue;
        };
        let is_alone = (out.is_empty() || out.ends_with('\n')) && after.starts_with('\n');
        out.push_str(text);
        out.push_str(if is_alone { &after[1..] } else { after });
    }
    out
}

/// The name of the file with this number in a joined text.
pub fn file_name(text: &str, number: u32) -> Option<&str> {
    let start = format!("// {number}: ");
    text.lines().find_map(|line| line.strip_prefix(&start))
}

/// A definition, which is linked only if another text uses its name.
#[derive(Clone, Debug)]
pub struct Part {
    pub(super) sources: Vec<Source>,
    pub(super) defines: Vec<String>,
    pub(super) uses: Vec<String>,
}

/// Types with which the definition of a function or a variable begins.
const TYPES: [&str; 11] = [
    "float", "int", "uint", "bool", "void", "vec2", "vec3", "vec4", "uvec3", "mat3", "ivec2",
];

/// Splits a source into its definitions, each with the comment before it. Text between `#if` and its `#endif` stays
/// together.
pub fn parts(source: Source) -> Vec<Part> {
    let mut all = Vec::new();
    let mut lines: Vec<&str> = Vec::new();
    let mut defines = Vec::new();
    let (mut braces, mut conditions) = (0, 0);
    for (number, line) in (source.line..).zip(source.text.lines()) {
        let code = code(line).trim_end();
        let is_outside = braces == 0 && conditions == 0;
        if code.is_empty() && line.is_empty() && is_outside && defines.is_empty() {
            // A comment without a definition after it is dropped.
            lines.clear();
            continue;
        }
        lines.push(line);
        if braces == 0 {
            defines.extend(defined(code));
        }
        braces += code.matches('{').count();
        braces -= code.matches('}').count().min(braces);
        conditions += usize::from(code.starts_with("#if"));
        conditions -= usize::from(code.starts_with("#endif")).min(conditions);
        let is_complete = code.starts_with('#') || code.ends_with([';', '}']);
        if braces > 0 || conditions > 0 || !is_complete || defines.is_empty() {
            continue;
        }
        let text = lines.join("\n") + "\n";
        all.push(Part {
            // The part's own name is left out, so that functions of the same name keep the order of the file.
            uses: words(&text)
                .filter(|word| !defines.iter().any(|name| name == word))
                .map(str::to_owned)
                .collect(),
            defines: std::mem::take(&mut defines),
            sources: vec![Source {
                name: source.name.clone(),
                line: number + 1 - lines.len(),
                text: Cow::Owned(text),
            }],
        });
        lines.clear();
    }
    all
}

/// A line without its comment.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or_default()
}

/// Returns the roots in their order. The parts that a root uses come before the root.
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
    /// Adds the definitions of a name. Before each of them come the definitions that it uses.
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

/// The name that a line defines, or `None` if no definition begins on the line.
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
        // An output: `layout(location = 0) out vec4 name;`.
        "layout(location" => rest.nth(4)?,
        kind if TYPES.contains(&kind) => rest.next()?,
        // A function that returns a structure.
        kind if kind.starts_with(|c: char| c.is_ascii_alphabetic()) => {
            rest.next().filter(|name| name.contains('('))?
        }
        _ => return None,
    };
    words(name).next().map(str::to_owned)
}

/// The names in a text, without its comments. The name of a function includes the opening bracket, to distinguish it
/// from a variable of the same name.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(code).flat_map(|line| {
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

macro_rules! files {
    ($folder:literal: $($file:ident)*) => {
        vec![$(source!(concat!($folder, "/", stringify!($file), ".glsl"))),*]
    };
}

macro_rules! files_of_parts {
    (
        shapes: { $($(#[$attr:meta])* $_s:literal $shape:ident::$_st:ident,)* }
        operators: { $($_o:literal $operator:ident::$_ot:ident,)* }
        written_out: { $($_w:tt)* }
        made: { $($_mn:literal $made:ident::$_mt:ident,)* }
    ) => {
        [
            [$($(#[$attr])* source!(concat!("shape/", stringify!($shape), ".glsl"))),*].to_vec(),
            files!("shape": $($made)*),
            files!("operator": $($operator)*),
        ]
        .concat()
    };
}

/// All functions of the files, which are split into parts only once.
static LIBRARY: LazyLock<Vec<Part>> = LazyLock::new(|| {
    let shared = files!(
        "common": ahead air_boxes ball beyond_turning bound chord corner cosine_sine exit_distance hash least_component listener march_fields mirror_direction
        no_hit on_line onto_field quadric_form reflect_at_face rotate_by_quaternion rounding safe_inverse
        scene_data segment turns_of
    );
    let cells = files!("cells": directed distance fields grid grid_traversal records);
    let all: Vec<Source> = [shared, cells, every_part!(files_of_parts)].concat();
    all.into_iter().flat_map(parts).collect()
});

/// All functions of the library, which are linked where they are called.
pub(in crate::shader) fn library() -> Vec<Part> {
    LIBRARY.clone()
}

/// Whether the library has a function of this name. The generated text for a shape depends on the functions in the
/// shape's file.
pub(super) fn has_function(name: &str) -> bool {
    static DEFINED: LazyLock<HashSet<&str>> = LazyLock::new(|| {
        let defined = LIBRARY.iter().flat_map(|part| &part.defines);
        defined.map(String::as_str).collect()
    });
    DEFINED.contains(format!("{name}(").as_str())
}

/// Whether a character is not allowed in a comment. GLSL's character set is ASCII, and a backslash would continue the
/// comment on the next line.
pub(super) fn no_comment(character: char) -> bool {
    character == '\\' || !(character.is_ascii_graphic() || character == ' ')
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

    /// Protects the order and the selection of parts: callees come first, functions that are not called are left out,
    /// and a name in a comment does not count as a call.
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

    /// Protects the line numbers in driver messages, and the splitting into definitions. The definitions are adjacent,
    /// contain an empty line, or are between `#if` and `#endif`.
    #[test]
    fn each_part_knows_its_line() {
        let text = "// A file.\n\nuniform float uSize;\nconst float A = 1.0;  // {\n\n// f.\nfloat f() {\n    return \
                    uSize;\n\n}\n#if X\nint b;\n\nint c;\n#endif\nlayout(location = 1) out vec4 outD;\n";
        let lines: Vec<usize> = parts(Source::new("file", text))
            .iter()
            .map(|part| part.sources[0].line)
            .collect();
        assert_eq!(lines, [3, 4, 6, 11, 16]);
    }

    /// Protects structures, functions that return structures, and variables: each is linked if its name is used.
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

    /// Protects from linking functions that are not called: a variable may have the name of a function.
    #[test]
    fn a_variable_is_no_call() {
        let library = "float bend(float x) { return x; }\n\nconst float SIZE = 2.0;\n";
        let text = linked("void main() { float bend = SIZE; }\n", library);
        assert!(text.contains("const float SIZE") && !text.contains("float bend(float x)"));
    }

    /// Protects overloads: a call links all functions of that name.
    #[test]
    fn functions_of_one_name_come_together() {
        let text = linked(
            "void main() { f(1.0); }\n",
            "float f(float x) { return x; }\nvec4 f(vec4 x) { return vec4(f(x.x)); }\n",
        );
        assert!(text.find("float f(") < text.find("vec4 f("));
        assert!(text.contains("vec4 f("));
    }

    /// Protects the placeholders of skeletons, within a line and alone on a line, and texts that contain `@`.
    #[test]
    fn places_are_filled_once() {
        let filled = |skeleton: &'static str| {
            let texts = [
                ("a", "1"),
                ("lines", "  x;\n  y;\n"),
                ("none", ""),
                ("sign", "@a@"),
            ];
            fill(&Source::new("test", skeleton), &texts)
        };
        assert_eq!(filled("f(@a@, @a@);\n"), "f(1, 1);\n");
        assert_eq!(filled("{\n@lines@\n}\n"), "{\n  x;\n  y;\n}\n");
        assert_eq!(filled("{\n@none@\n}\n"), "{\n}\n");
        assert_eq!(filled("@lines@\nend"), "  x;\n  y;\nend");
        assert_eq!(filled("@sign@"), "@a@");
        assert_eq!(filled("@unknown@ @a@"), "@unknown@ 1");
    }
}
