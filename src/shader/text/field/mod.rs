//! A field as shader text: its value, its gradient, and its intersection with a line.
//!
//! Each tree becomes straight-line code, one statement per node, in functions named after the
//! surface's number: `field3(p)`; `gradient3(p)` (the gradient, and the value as the last
//! component); for a closed form `hit3(p, d, errorBound)`, or for copies `hit3(p, d, errorBound,
//! limit)`; and for the march `free3(p, d, errorBound)`. Value and gradient are the same text over
//! two types: `float`, and `vec4` for a value with its gradient, which the operators propagate
//! (forward differentiation).
//!
//! Numbers are literals. If something moves a node, all numbers of the node are uniforms instead,
//! because several of them follow from one parameter (a rotation's nine).

mod along;
mod chords;
mod copies;
mod function_kind;
mod hit;
mod rooms;
mod value;

pub(in crate::shader) use along::{free_text, is_bounded, leaps};
pub(in crate::shader) use chords::{chords_text, has_chords, has_parts_of_air};
pub(super) use function_kind::has_differences;
pub(in crate::shader) use hit::{has_closed_form, hit_text, takes_limit};
pub(in crate::shader) use rooms::projection as rooms_projection;
pub(super) use value::{
    gradient_text, is_known_on_lines, is_smooth_on_lines, line_text, normal_text, value_text,
};

use super::link::{Part, Source, no_comment, parts, source};
use crate::scene::shape::Repeat;
use crate::scene::{Copies, Node, Shape, UserField};
use crate::shader::origin_rebasing::divides;
use crate::shader::structure::Assets;
use std::fmt::Write as _;

/// A function that writes a function of a field.
pub(in crate::shader) type Write = fn(&Shape, &Place, &Assets) -> String;

/// The surface, or the kind of surfaces, that has a field.
pub(in crate::shader) struct Place<'a> {
    /// The suffix of its functions' names.
    pub tag: &'a str,
    /// The parameter of its functions in addition to the point, with a comma before it.
    pub parameter: &'a str,
    /// The argument for this parameter.
    pub argument: &'a str,
    /// Nodes whose numbers move, in the order of [`Shape::nodes`].
    pub moving: &'a [bool],
    /// The n-th vector of the moving numbers.
    pub value: &'a dyn Fn(usize) -> String,
}

/// Writes the text of one field.
pub(super) struct Writer<'a> {
    numbers: Numbers<'a>,
    place: &'a Place<'a>,
    /// The indices of height images and users' fields of the scene.
    assets: &'a Assets,
    /// The start of the names of all functions being written.
    stem: &'static str,
    /// The direction of the line in the axes of the node being written.
    direction: String,
    next_name: usize,
    /// Other functions that the function being written calls.
    functions: String,
    body: String,
}

/// The numbers of a tree, node by node in the order of [`Shape::nodes`].
pub(super) struct Numbers<'a> {
    place: &'a Place<'a>,
    /// Number of moving numbers already taken.
    taken: usize,
    node: usize,
}

impl<'a> Numbers<'a> {
    pub fn new(place: &'a Place<'a>) -> Numbers<'a> {
        Numbers {
            place,
            taken: 0,
            node: 0,
        }
    }

    /// The next node's numbers as expressions.
    pub fn next(&mut self, field: &Shape) -> Vec<String> {
        let moves = self.place.moving.get(self.node).copied().unwrap_or(false);
        self.node += 1;
        let numbers = field.shader_numbers();
        if !moves {
            return numbers.into_iter().map(literal).collect();
        }
        let taken = numbers.iter().map(|_| self.take());
        taken.collect()
    }

    /// Skips the numbers of the next field.
    pub fn skip(&mut self, field: &Shape) {
        for node in field.nodes() {
            self.next(node);
        }
    }

    /// The position in the tree, for callers that write a part of it more than once.
    pub fn mark(&self) -> (usize, usize) {
        (self.taken, self.node)
    }

    /// Goes back to a [`Numbers::mark`].
    pub fn back_to(&mut self, (taken, node): (usize, usize)) {
        (self.taken, self.node) = (taken, node);
    }

    /// The factor of the whole value, or `None` if it is 1.
    pub fn lipschitz(&mut self, field: &Shape) -> Option<String> {
        let lipschitz = field.properties().lipschitz;
        if self.place.moving.contains(&true) && divides(field) {
            return Some(self.take());
        }
        (lipschitz > 1.0).then(|| literal(1.0 / lipschitz))
    }

    fn take(&mut self) -> String {
        let (vector, component) = (self.taken / 4, self.taken % 4);
        self.taken += 1;
        let vector = (self.place.value)(vector);
        format!("{vector}.{}", ["x", "y", "z", "w"][component])
    }
}

/// A number as a literal that GLSL reads back to the same bits.
pub(in crate::shader) fn literal(number: f64) -> String {
    let number = number as f32;
    // An infinite size is limited to a number that GLSL can write.
    let held = number.clamp(-1e30, 1e30);
    format!("{held:?}")
}

/// Maximum cells of a repetition that a line may cross without a step limit.
const MOST_CELLS: u64 = 1024;

/// Whether each copy keeps to its own cell, so that a line hits the copies in the order of the cells.
pub(super) fn keep_to_cells(field: &Shape) -> bool {
    let within = |copies: &Copies| !matches!(copies, Copies::Around(_));
    field.copies().is_ok_and(|c| c.iter().all(within))
}

/// Maximum cells that a line crosses on its way past all copies; `None` if the number is so large
/// that a traversal has a step limit.
pub(in crate::shader) fn cells_crossed(field: &Shape) -> Option<u64> {
    let Node::Repeat(Repeat { period, count }) = &field.node else {
        return Some(0);
    };
    let along = |axis: usize| match (period[axis] > 0.0, count[axis]) {
        (false, _) => Some(1),
        (true, 0) => None,
        (true, count) => Some(u64::from(count)),
    };
    let cells: Option<u64> = (0..3).map(along).sum();
    cells.filter(|cells| *cells <= MOST_CELLS)
}

/// Whether a traversal of the field's copies has a step limit.
pub(in crate::shader) fn has_step_limit(field: &Shape) -> bool {
    let unlimited = |node: &&Shape| cells_crossed(node).is_none();
    field.nodes().iter().any(unlimited)
}

/// A repetition in the form that the traversal takes: vectors of expressions.
pub(super) struct CopyAxes {
    /// From the origin to the middle of copy number 0.
    pub shift: String,
    /// From one copy to the next; 1 along an axis without repetition.
    pub period: String,
    /// The box around a copy's middle.
    least: String,
    most: String,
    /// Numbers of the copies.
    first: String,
    last: String,
}

impl CopyAxes {
    /// The axes of a `Repeat` with these numbers as expressions.
    pub fn new(field: &Shape, numbers: &[String]) -> Option<CopyAxes> {
        let Node::Repeat(Repeat { period, count }) = &field.node else {
            return None;
        };
        let axes = [0, 1, 2].map(|axis| {
            let count = (period[axis] > 0.0).then_some(count[axis]);
            Along::new(count, &numbers[axis])
        });
        let vector = |[x, y, z]: [&str; 3]| format!("vec3({x}, {y}, {z})");
        let each = |of: fn(&Along) -> &str| vector([0, 1, 2].map(|axis| of(&axes[axis])));
        let three = |from: usize| vector([0, 1, 2].map(|axis| numbers[from + axis].as_str()));
        Some(CopyAxes {
            shift: each(|along| &along.shift),
            period: each(|along| &along.period),
            least: three(3),
            most: three(6),
            first: each(|along| &along.first),
            last: each(|along| &along.last),
        })
    }

    /// The traversal of a line whose start is relative to copy 0.
    pub fn traversal(&self, q: &str, d: &str, error_bound: &str) -> String {
        let CopyAxes {
            period,
            least,
            most,
            first,
            last,
            ..
        } = self;
        format!(
            "traverseCopies({q}, {d}, {error_bound}, {period}, {least}, {most}, {first}, {last})"
        )
    }
}

/// One axis of a repetition.
struct Along {
    shift: String,
    period: String,
    first: String,
    last: String,
}

impl Along {
    /// With `count` copies (0: without end), or without repetition.
    fn new(count: Option<u32>, period: &str) -> Along {
        /// Greater than the number of every copy that a float can represent.
        const NO_LAST: f64 = 1e30;
        let (first, last) = match count {
            None => (0.0, 0.0),
            Some(0) => (-NO_LAST, NO_LAST),
            Some(count) => {
                let first = -f64::from(count / 2);
                (first, first + f64::from(count - 1))
            }
        };
        // An even number of copies is centred on the origin, with none at the origin itself.
        let even = count.is_some_and(|count| count > 0 && count.is_multiple_of(2));
        Along {
            shift: if even {
                format!("0.5 * {period}")
            } else {
                literal(0.0)
            },
            period: if count.is_some() {
                period.to_owned()
            } else {
                literal(1.0)
            },
            first: literal(first),
            last: literal(last),
        }
    }
}

/// The users' own texts, and the functions that call them.
pub(in crate::shader) fn user_parts(assets: &Assets) -> Vec<Part> {
    let mut all = Vec::new();
    for (index, user) in assets.users.iter().enumerate() {
        all.push(Part {
            sources: Vec::from(user_text(user, index)),
            defines: ["field", "fieldGradient"]
                .map(|name| format!("user{index}_{name}("))
                .to_vec(),
            // The user's text uses only its own definitions.
            uses: Vec::new(),
        });
        if user.is_differentiated() {
            all.extend(derivative_parts(user, index));
        }
        all.extend(user_functions(user, index).into_iter().flat_map(parts));
    }
    all
}

/// The derivatives of a user's text, which call functions of the text.
fn derivative_parts(user: &UserField, index: usize) -> [Part; 2] {
    let shown = shown_name(user);
    let part = |name: &str, what: &str, text: String| Part {
        sources: vec![Source::new(
            format!("{what} of {shown}, field {index}"),
            text,
        )],
        defines: vec![format!("{name}{index}_field(")],
        uses: vec![format!("user{index}_field(")],
    };
    [
        part("dual", "gradient", user.gradient_text(index)),
        part("slope", "slope", user.slope_text(index)),
    ]
}

/// A user's text between the text that renames its names and the text that restores them: its
/// `field` becomes `user<index>_field`. The text itself is the second of the three.
pub(in crate::shader) fn user_text(user: &UserField, index: usize) -> [Source; 3] {
    let mut before = String::new();
    let mut after = String::new();
    for name in user.names() {
        let _ = writeln!(before, "#define {name} {}", name_in_shader(index, &name));
        let _ = writeln!(after, "#undef {name}");
    }
    let shown = shown_name(user);
    [
        Source::new(format!("names of {shown}, field {index}"), before),
        Source::new(shown.clone(), user.shader_text()),
        Source::new(format!("end of {shown}, field {index}"), after),
    ]
}

/// The name in the shader of a name in a user's text. GLSL reserves two underscores in a row.
fn name_in_shader(index: usize, name: &str) -> String {
    match name.starts_with('_') {
        true => format!("users{index}{name}"),
        false => format!("user{index}_{name}"),
    }
}

/// The file's name in the form allowed in a comment.
pub(crate) fn shown_name(user: &UserField) -> String {
    user.file.display().to_string().replace(no_comment, "?")
}

/// The functions that call the text of a user's field; in the files their names contain `User0`.
fn user_functions(user: &UserField, index: usize) -> Vec<Source> {
    let gradient = if user.states_gradient() {
        source!("user/gradient.glsl")
    } else if user.is_differentiated() {
        source!("user/derivative.glsl")
    } else {
        source!("user/differences.glsl")
    };
    let numbered = |source: Source| {
        let text = source.text.replace("User0", &format!("User{index}"));
        let own = |text: String, prefix: &str| {
            text.replace(&format!("{prefix}0_"), &format!("{prefix}{index}_"))
        };
        let text = ["user", "dual", "slope"].into_iter().fold(text, own);
        let name = format!("{}, field {index}", source.name);
        Source::new(name, text)
    };
    let mut sources = vec![source!("user/value.glsl"), gradient];
    if has_slope(user) {
        sources.push(source!("user/on_line.glsl"));
    }
    sources.into_iter().map(numbered).collect()
}

/// Whether value and slope on a line are one evaluation of the text.
fn has_slope(user: &UserField) -> bool {
    user.states_gradient() || user.is_differentiated()
}

/// The number by which a driver's messages name the user's own text in [`user_sources`].
pub(crate) const USER_FILE: u32 = 2;

/// The gradient in a field's own program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CheckedGradient {
    /// The stated one, or 0.
    Stated,
    /// The derivative of the text; not a number where the value beside it differs from the field's.
    Derived,
}

/// A fragment shader with only the field: it evaluates the values and the gradients at the points in
/// `uPoints`.
pub(crate) fn user_sources(user: &UserField, gradient: CheckedGradient) -> Vec<Source> {
    /// Tolerated difference between the two values, as a share of the largest value that the box allows: a compiler
    /// may round them differently.
    const VALUE_TOLERANCE: f32 = 1e-5;
    let mut sources = Vec::from(user_text(user, 0));
    let body = match gradient {
        CheckedGradient::Stated if user.states_gradient() => {
            "    return user0_fieldGradient(p);\n".to_owned()
        }
        CheckedGradient::Stated => "    return vec3(0.0);\n".to_owned(),
        CheckedGradient::Derived => {
            sources.push(Source::new("the derivative", user.gradient_text(0)));
            let most = VALUE_TOLERANCE * user.lipschitz * user.size.max_element();
            let most = literal(f64::from(most));
            format!(
                "    vec3 gradient;\n    float off = dual0_field(p, gradient) - user0_field(p);\n    \
                 return abs(off) <= {most} ? gradient : sqrt(vec3(-1.0) - abs(p));\n"
            )
        }
    };
    let function = format!("vec3 checkedGradient(vec3 p) {{\n{body}}}\n");
    sources.push(Source::new("the gradient", function));
    sources.push(source!("user/check.frag"));
    sources
}
