//! Makes a user's field of Echomarch from an expression tree of fidget.
//!
//! fidget has the axes of its caller. The value at (x, y, z) becomes the value at the same point of the surface's own
//! axes, in metres.

use echomarch::glam::{DVec3, Vec3};
use echomarch::scene::UserField;
use fidget_core::Context;
use fidget_core::context::{BinaryOpcode, Node, Op, Tree, UnaryOpcode};
use fidget_core::var::Var;
use std::collections::HashMap;
use std::fmt::Write;

/// The reason why a tree cannot become a field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// An operation without a counterpart in a field: a comparison, a logical operation, a mix of bits, rounding to the
    /// nearest number, or a random number.
    #[error("the operation {name} is not supported in a field")]
    Operation {
        /// Name of the operation in fidget.
        name: String,
    },
    /// A number that is not finite.
    #[error("the tree contains {number}: only finite numbers are possible in a field")]
    Number {
        /// The number.
        number: f32,
    },
    /// A variable other than x, y and z.
    #[error("the tree has a variable besides x, y and z: replace it with a number")]
    Variable,
}

/// One value of an expression. Indices are those of earlier steps.
#[derive(Clone, Copy, Debug)]
enum Step {
    Axis(usize),
    Number(f32),
    One(UnaryOpcode, usize),
    Two(BinaryOpcode, usize, usize),
}

/// Makes a field from a tree whose value is positive in the air and in metres. `size` is the full size in metres of the
/// box around the shape, which is centred on the origin, and `lipschitz` the greatest change of the value per metre.
///
/// # Errors
/// [`TreeError`] for an operation or a variable that a field cannot have.
pub fn user_field(
    name: &str,
    tree: &Tree,
    size: Vec3,
    lipschitz: f32,
) -> Result<UserField, TreeError> {
    let steps = steps(tree)?;
    let field = UserField::new(name, glsl(&steps), size, lipschitz);
    Ok(field.with_cpu(move |p| value(&steps, p)))
}

/// The steps of a tree, each shared expression once. The last step is the result.
fn steps(tree: &Tree) -> Result<Vec<Step>, TreeError> {
    let mut context = Context::new();
    let root = context.import(tree);
    let mut steps = Vec::new();
    let mut known: HashMap<Node, usize> = HashMap::new();
    // Trees can be deep, so that the open nodes are on a stack of their own.
    let mut open = vec![root];
    while let Some(node) = open.pop() {
        let Some(op) = context.get_op(node).filter(|_| !known.contains_key(&node)) else {
            continue;
        };
        let operands = match *op {
            Op::Input(_) | Op::Const(_) => vec![],
            Op::Unary(_, a) => vec![a],
            Op::Binary(_, a, b) => vec![a, b],
        };
        let missing = operands
            .iter()
            .filter(|operand| !known.contains_key(operand));
        let missing: Vec<Node> = missing.copied().collect();
        if !missing.is_empty() {
            open.push(node);
            open.extend(missing);
            continue;
        }
        let of = |operand: &Node| known[operand];
        steps.push(match *op {
            Op::Input(Var::X) => Step::Axis(0),
            Op::Input(Var::Y) => Step::Axis(1),
            Op::Input(Var::Z) => Step::Axis(2),
            Op::Input(Var::V(_)) => return Err(TreeError::Variable),
            Op::Const(number) => Step::Number(*number),
            Op::Unary(op, a) => Step::One(op, of(&a)),
            Op::Binary(op, a, b) => Step::Two(op, of(&a), of(&b)),
        });
        known.insert(node, steps.len() - 1);
    }
    for step in &steps {
        text(step)?;
    }
    Ok(steps)
}

/// The expression of a step in GLSL.
fn text(step: &Step) -> Result<String, TreeError> {
    let refused = |name: String| Err(TreeError::Operation { name });
    Ok(match *step {
        Step::Axis(axis) => format!("p[{axis}]"),
        // The exponent form is a float in GLSL for every number.
        Step::Number(number) if number.is_finite() => format!("{number:e}"),
        Step::Number(number) => return Err(TreeError::Number { number }),
        Step::One(op, a) => match op {
            UnaryOpcode::Neg => format!("-v{a}"),
            UnaryOpcode::Recip => format!("1.0 / v{a}"),
            UnaryOpcode::Square => format!("v{a} * v{a}"),
            UnaryOpcode::Abs => format!("abs(v{a})"),
            UnaryOpcode::Sqrt => format!("sqrt(v{a})"),
            UnaryOpcode::Floor => format!("floor(v{a})"),
            UnaryOpcode::Ceil => format!("ceil(v{a})"),
            UnaryOpcode::Sin => format!("sin(v{a})"),
            UnaryOpcode::Cos => format!("cos(v{a})"),
            UnaryOpcode::Tan => format!("tan(v{a})"),
            UnaryOpcode::Asin => format!("asin(v{a})"),
            UnaryOpcode::Acos => format!("acos(v{a})"),
            UnaryOpcode::Atan => format!("atan(v{a})"),
            UnaryOpcode::Exp => format!("exp(v{a})"),
            UnaryOpcode::Ln => format!("log(v{a})"),
            UnaryOpcode::Round | UnaryOpcode::Not | UnaryOpcode::Rand => {
                return refused(format!("{op:?}"));
            }
        },
        Step::Two(op, a, b) => match op {
            BinaryOpcode::Add => format!("v{a} + v{b}"),
            BinaryOpcode::Sub => format!("v{a} - v{b}"),
            BinaryOpcode::Mul => format!("v{a} * v{b}"),
            BinaryOpcode::Div => format!("v{a} / v{b}"),
            BinaryOpcode::Atan => format!("atan(v{a}, v{b})"),
            BinaryOpcode::Min => format!("min(v{a}, v{b})"),
            BinaryOpcode::Max => format!("max(v{a}, v{b})"),
            BinaryOpcode::Mod => format!("v{a} - abs(v{b}) * floor(v{a} / abs(v{b}))"),
            BinaryOpcode::Compare | BinaryOpcode::And | BinaryOpcode::Or | BinaryOpcode::Mix => {
                return refused(format!("{op:?}"));
            }
        },
    })
}

/// The function `field` with one variable for each step.
fn glsl(steps: &[Step]) -> String {
    let mut body = String::from("float field(vec3 p) {\n");
    for (index, step) in steps.iter().enumerate() {
        // Each step has a text: see `steps`. Writing to a String cannot fail.
        let text = text(step).unwrap_or_default();
        let _ = writeln!(body, "    float v{index} = {text};");
    }
    let _ = writeln!(body, "    return v{};\n}}", steps.len().saturating_sub(1));
    body
}

/// The value at a point in metres.
fn value(steps: &[Step], p: DVec3) -> f64 {
    let mut values: Vec<f64> = Vec::with_capacity(steps.len());
    for step in steps {
        let value = match *step {
            Step::Axis(axis) => p[axis],
            Step::Number(number) => number.into(),
            Step::One(op, a) => one(op, values[a]),
            Step::Two(op, a, b) => two(op, values[a], values[b]),
        };
        values.push(value);
    }
    values.last().copied().unwrap_or(f64::NAN)
}

fn one(op: UnaryOpcode, a: f64) -> f64 {
    match op {
        UnaryOpcode::Neg => -a,
        UnaryOpcode::Recip => 1.0 / a,
        UnaryOpcode::Square => a * a,
        UnaryOpcode::Abs => a.abs(),
        UnaryOpcode::Sqrt => a.sqrt(),
        UnaryOpcode::Floor => a.floor(),
        UnaryOpcode::Ceil => a.ceil(),
        UnaryOpcode::Sin => a.sin(),
        UnaryOpcode::Cos => a.cos(),
        UnaryOpcode::Tan => a.tan(),
        UnaryOpcode::Asin => a.asin(),
        UnaryOpcode::Acos => a.acos(),
        UnaryOpcode::Atan => a.atan(),
        UnaryOpcode::Exp => a.exp(),
        UnaryOpcode::Ln => a.ln(),
        UnaryOpcode::Round | UnaryOpcode::Not | UnaryOpcode::Rand => f64::NAN,
    }
}

fn two(op: BinaryOpcode, a: f64, b: f64) -> f64 {
    match op {
        BinaryOpcode::Add => a + b,
        BinaryOpcode::Sub => a - b,
        BinaryOpcode::Mul => a * b,
        BinaryOpcode::Div => a / b,
        BinaryOpcode::Atan => a.atan2(b),
        BinaryOpcode::Min => a.min(b),
        BinaryOpcode::Max => a.max(b),
        BinaryOpcode::Mod => a.rem_euclid(b),
        BinaryOpcode::Compare | BinaryOpcode::And | BinaryOpcode::Or | BinaryOpcode::Mix => {
            f64::NAN
        }
    }
}
