//! Derivatives of users' texts, by forward differentiation of their source.
//!
//! From a text with `float field(vec3 p)` this writes the text of a function with the same value and its derivatives.
//! A float, vector or matrix that depends on the point becomes a structure of its value and its derivative along each
//! direction, which has the same type as the value; an operator becomes a call of a function with the operator's rule
//! ([`rules`]). Everything else stays as it is: numbers, counters, conditions, and calls whose arguments do not depend on
//! the point are calls of the user's own functions (the hash of a cell, for example). A function is written once for each
//! set of arguments that depend on the point. An assignment makes the whole variable depend on the point, so a function
//! is written again until no more variables change.
//!
//! A text that cannot be parsed, or that computes floats from the bits of floats that vary, has no derivative here; its
//! gradient is then computed by differences. Whether the derivative is that of the value is tested on the renderer
//! (`crate::tracer`), since a text may compute steps from whole numbers, for example.
//!
//! The parser is this module's own. A text has been preprocessed, so it has no directives; of the rest of the language,
//! the part that a field may use is small. The crates `glsl-lang` and `naga` bring a preprocessor and a validator of
//! their own, whose limits and languages differ from those of the drivers that compile the text.

mod blocks;
mod calls;
mod expressions;
mod functions;
mod helpers;
mod parse;
mod rules;
mod statements;
mod syntax;
#[cfg(test)]
mod tests;
mod types;
mod values;

use super::tokens;
use functions::Writer;

/// Why a text has no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle(pub &'static str);

/// An obstacle as a result.
fn obstacle<T>(why: &'static str) -> Result<T, Obstacle> {
    Err(Obstacle(why))
}

/// The directions of the derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Along x, y and z: `float dual0_field(vec3 p, out vec3 gradient)`.
    Axes,
    /// Along one direction: `float slope0_field(vec3 p, vec3 direction, out float slope)`.
    Line,
}

impl Along {
    /// The names of the derivatives in a structure.
    fn lanes(self) -> &'static [&'static str] {
        match self {
            Along::Axes => &["x", "y", "z"],
            Along::Line => &["s"],
        }
    }

    /// The beginning of the names of functions and structures of a field.
    fn prefix(self, index: usize) -> String {
        match self {
            Along::Axes => format!("dual{index}_"),
            Along::Line => format!("slope{index}_"),
        }
    }
}

/// The derivative of a preprocessed text, as text that follows the text of the field with this index, in which every
/// name `a` has become `user<index>_a`.
///
/// # Errors
/// The reason why the text has no derivative.
pub fn written(code: &str, along: Along, index: usize) -> Result<String, Obstacle> {
    let Ok((tokens, _)) = tokens::tokens(code) else {
        return obstacle("it has no tokens");
    };
    let program = statements::program(&tokens)?;
    let makes_floats = uses_floats_of_bits(&tokens);
    Writer::new(&program, (along, index), makes_floats).whole()
}

/// Whether a text makes floats of bits.
fn uses_floats_of_bits(tokens: &[tokens::Token]) -> bool {
    let makes = |token: &tokens::Token| matches!(token.text, "intBitsToFloat" | "uintBitsToFloat");
    tokens.iter().any(makes)
}
