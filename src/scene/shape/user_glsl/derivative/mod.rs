//! Derivatives of users' fields, by forward-mode differentiation of the source text.
//!
//! For a text with `float field(vec3 p)`, this module writes the text of a function that computes the same value and
//! its derivatives. A float, vector or matrix that depends on the point becomes a structure. It contains the value and,
//! for each direction, a derivative of the same type. An operator becomes a call of a function that implements the rule
//! of the operator ([`rules`]). Everything that does not depend on the point is unchanged: numbers, counters,
//! conditions, and calls of the user's own functions (the hash of a cell, for example). A function is written once for
//! each set of arguments that depend on the point. An assignment makes the whole variable depend on the point. A
//! function is therefore written repeatedly, until no more variables become dependent on the point.
//!
//! This module rejects a text that cannot be parsed, and a text that computes floats from the bits of floats that
//! depend on the point. Gradients are then computed by differences. The renderer tests whether the derivative agrees
//! with the value (`crate::tracer`), because a text may, for example, compute steps from integers.
//!
//! The parser is part of this crate. A text has already been preprocessed, so it has no directives, and a field uses
//! only a small part of the language. The crates `glsl-lang` and `naga` contain their own preprocessor and validator.
//! Their limits and language versions differ from those of the drivers that compile the text.

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
mod turns;
mod types;
mod values;

use super::tokens;
use functions::Writer;

/// The reason why a text has no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obstacle(pub &'static str);

/// Returns an obstacle as an error.
fn obstacle<T>(why: &'static str) -> Result<T, Obstacle> {
    Err(Obstacle(why))
}

/// The directions along which the derivatives are taken.
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

    /// The prefix of the names of a field's functions and structures.
    fn prefix(self, index: usize) -> String {
        match self {
            Along::Axes => format!("dual{index}_"),
            Along::Line => format!("slope{index}_"),
        }
    }
}

/// Writes the derivative of a preprocessed text. The result follows the text of the field with this index, in which
/// every name `a` has been renamed to `user<index>_a`.
///
/// # Errors
/// The reason why the text has no derivative.
pub fn written(code: &str, along: Along, index: usize) -> Result<String, Obstacle> {
    let Ok((tokens, _)) = tokens::tokens(code) else {
        return obstacle("it cannot be split into tokens");
    };
    let program = statements::program(&tokens)?;
    let makes_floats = uses_floats_of_bits(&tokens);
    Writer::new(&program, (along, index), makes_floats).whole()
}

/// The most turns that all loops in one evaluation of a preprocessed text take together; `None` if it is unknown.
pub fn loop_turns(code: &str) -> Option<u64> {
    let (tokens, _) = tokens::tokens(code).ok()?;
    turns::turns(&statements::program(&tokens).ok()?)
}

/// Whether a text computes floats from bits.
fn uses_floats_of_bits(tokens: &[tokens::Token]) -> bool {
    let makes = |token: &tokens::Token| matches!(token.text, "intBitsToFloat" | "uintBitsToFloat");
    tokens.iter().any(makes)
}
