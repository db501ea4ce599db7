//! The contents of a scene's shader, compared with the scene.

use echomarch::scene::shape::{Plane, code_lines};
use echomarch::scene::{Node, Scene, Surface};
use echomarch::tracer::{Pass, Settings, shader_text};
use serde::Serialize;

/// The march shader of a scene after preprocessing: without comments, empty lines and parts excluded by preprocessor
/// conditions.
#[derive(Clone, Debug, Serialize)]
pub struct ShaderReport {
    /// Number of lines.
    pub lines: usize,
    /// Number of functions.
    pub functions: usize,
    /// Number of lines for a scene of one plane, which is the minimum.
    pub least_lines: usize,
    /// Number of functions for a scene of one plane.
    pub least_functions: usize,
    /// Shapes and operators that have functions in the shader. Operators that only move points (`Translate`, `Rotate`
    /// and similar ones) are written inline and have no functions.
    pub features: Vec<Feature>,
    /// Functions that are never called.
    pub unused_functions: Vec<String>,
}

/// A shape or an operator with functions in the shader text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Feature {
    /// The name of the shape or operator in scene files.
    pub name: String,
    /// Whether the scene contains the shape or operator.
    pub in_scene: bool,
    /// The shapes and operators in the scene that call these functions.
    pub called_by: Vec<String>,
}

/// Prefixes in the names of the functions of shapes and operators.
const PREFIXES: [&str; 6] = ["sd", "gd", "hit", "project", "gradient", "op"];

/// Suffixes that may follow the name of the shape or operator.
const SUFFIXES: [&str; 2] = ["Directed", "Cap"];

/// Function names, without their prefix, that belong to no shape or operator.
const HELPERS: [&str; 9] = [
    "Ball", "Chord", "Circle", "Corner", "Group", "Kind", "Listener", "OfKind", "OntoKind",
];

/// Functions whose names do not follow this pattern, with their operators.
const OTHERWISE: [(&str, &str); 4] = [
    ("repeatCopy", "Repeat"),
    ("repeatSide", "Repeat"),
    ("twist", "Twist"),
    ("bend", "Bend"),
];

/// Pairs of a shape and another shape or operator that calls its functions. For example, a rounded box calls the
/// functions of a box.
const CALLERS: [(&str, &str); 6] = [
    ("Box", "RoundedBox"),
    ("Box", "HeightField"),
    ("Box", "Grid"),
    ("Box", "Field"),
    ("Union", "Repeat"),
    ("Room", "Complement"),
];

impl ShaderReport {
    /// Analyses the scene's march shader. No OpenGL context is needed.
    pub fn of(scene: &Scene, settings: &Settings) -> ShaderReport {
        let text = code(&shader_text(scene, settings, Pass::March));
        let mut least = scene.clone();
        least.surfaces = vec![Surface::new(Node::Plane(Plane))];
        let least = code(&shader_text(&least, settings, Pass::March));
        let functions = defined(&text);
        ShaderReport {
            lines: text.len(),
            functions: functions.len(),
            least_lines: least.len(),
            least_functions: defined(&least).len(),
            features: features(scene, &functions),
            unused_functions: unused(&text, &functions),
        }
    }

    /// Names of shapes and operators that are in the shader but not needed by the scene.
    pub fn unneeded(&self) -> Vec<&str> {
        let is_unneeded = |f: &&Feature| !f.in_scene && f.called_by.is_empty();
        let unneeded = self.features.iter().filter(is_unneeded);
        unneeded.map(|feature| feature.name.as_str()).collect()
    }
}

/// The lines of code in a shader; all lines if the text cannot be parsed.
fn code(text: &str) -> Vec<String> {
    code_lines(text).unwrap_or_else(|_| text.lines().map(str::to_owned).collect())
}

/// The identifiers and numbers in a line.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
}

fn features(scene: &Scene, functions: &[String]) -> Vec<Feature> {
    let mut names: Vec<&str> = functions.iter().filter_map(|f| feature(f)).collect();
    names.sort_unstable();
    names.dedup();
    let present = names_in(scene);
    let of = |name: &str| {
        let callers = CALLERS.iter().filter(|(called, _)| *called == name);
        let called_by = callers.map(|(_, by)| *by).filter(|by| present.contains(by));
        Feature {
            name: name.to_owned(),
            in_scene: present.contains(&name),
            called_by: called_by.map(str::to_owned).collect(),
        }
    };
    names.into_iter().map(of).collect()
}

/// Names of the shapes and operators in a scene.
fn names_in(scene: &Scene) -> Vec<&'static str> {
    let mut names = Vec::new();
    for surface in &scene.surfaces {
        names.extend(surface.shape.nodes().iter().map(|f| f.node.name()));
    }
    names
}

/// The shape or operator that a function belongs to.
fn feature(function: &str) -> Option<&str> {
    if let Some((_, name)) = OTHERWISE.iter().find(|(known, _)| *known == function) {
        return Some(name);
    }
    let rest = PREFIXES.iter().find_map(|prefix| {
        let rest = function.strip_prefix(prefix)?;
        rest.starts_with(|c: char| c.is_ascii_uppercase())
            .then_some(rest)
    })?;
    let name = SUFFIXES
        .iter()
        .find_map(|suffix| rest.strip_suffix(suffix))
        .unwrap_or(rest);
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit());
    match name {
        "User" => Some("Field"),
        "" => None,
        name => (!HELPERS.contains(&name)).then_some(name),
    }
}

/// Names of the functions that a shader defines, one for each definition.
fn defined(lines: &[String]) -> Vec<String> {
    let mut functions = Vec::new();
    let mut depth = 0_i64;
    for line in lines {
        if depth == 0
            && let Some(name) = heading(line)
        {
            functions.push(name.to_owned());
        }
        let count = |sign| line.matches(sign).count() as i64;
        depth += count('{') - count('}');
    }
    functions
}

/// The name of the function whose definition begins in this line.
fn heading(line: &str) -> Option<&str> {
    let (head, rest) = line.split_once('(')?;
    let mut words = head.split_whitespace();
    let (_, name) = (words.next()?, words.next_back()?);
    let is_name = |word: &str| word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_heading = head.split_whitespace().all(is_name) && !rest.trim_end().ends_with(';');
    is_heading.then_some(name)
}

/// Functions whose names occur only in their definitions.
fn unused(lines: &[String], functions: &[String]) -> Vec<String> {
    let mut unused: Vec<String> = Vec::new();
    for name in functions.iter().filter(|name| *name != "main") {
        let definitions = functions.iter().filter(|other| *other == name).count();
        let is_word = |word: &&str| *word == name.as_str();
        let words = lines.iter().flat_map(|line| words(line));
        if words.filter(is_word).count() <= definitions && !unused.contains(name) {
            unused.push(name.clone());
        }
    }
    unused
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the table of features: functions of shapes and operators are distinguished from other functions.
    #[test]
    fn functions_are_told_by_their_names() {
        let of = [
            ("sdRoomDirected", Some("Room")),
            ("gdUser3", Some("Field")),
            ("opSmoothUnion", Some("SmoothUnion")),
            ("sdRepeatCap", Some("Repeat")),
            ("hitListener", None),
            ("directedGradient", None),
            ("hit3", None),
            ("turn", None),
        ];
        for (function, expected) in of {
            assert_eq!(feature(function), expected, "{function}");
        }
    }

    /// Protects the count of functions, and the detection of unused functions.
    #[test]
    fn definitions_are_counted_and_dead_ones_found() {
        let text = "float a(vec3 p) { return p.x; }\nfloat b(\n vec3 p) {\n float c = a(p);\n \
                    if (c > 0.0) { return c; }\n return 1.0;\n}\nvoid main() {\n}";
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let functions = defined(&lines);
        assert_eq!(functions, ["a", "b", "main"]);
        assert_eq!(unused(&lines, &functions), ["b"]);
    }
}
