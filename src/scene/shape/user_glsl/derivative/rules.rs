//! The differentiation rules of GLSL's operators and functions.
//!
//! A rule is text. In it, `A`, `B` and `C` are the values of the arguments, `dA`, `dB` and `dC` are their derivatives
//! along one direction, `V` is the value of the result and `T` is its type. The derivative of the result is the sum of
//! one term for each argument that depends on the point. Every term is linear in the derivative of its argument.
//!
//! Where `abs`, `min`, `max` and `clamp` have a kink, the derivative is that of one side. If a constant limit equals
//! the value, the derivative is that of a slightly smaller value. With this choice, `length(max(q, 0.0)) + min(x, 0.0)`
//! counts the derivative at a face only once. The derivative of a length at 0 is the limit along a fixed direction.
//! Other poles are limited to large numbers.

use super::types::{Base, Type};
use super::{Obstacle, obstacle};

/// The differentiation rule of an operator or a function.
#[derive(Clone, Debug)]
pub struct Rule {
    /// The type of the result.
    pub returns: Type,
    /// Whether scalar arguments are converted to vectors of the result's type.
    pub promotes: bool,
    /// Statements before the value.
    pub before: String,
    /// Statements between the value and the terms.
    pub after: String,
    pub value: String,
    /// The term of each argument.
    pub terms: Vec<String>,
    /// A shorter form of the sum of all terms, used if all arguments depend on the point.
    pub sum: Option<&'static str>,
}

impl Rule {
    fn new(returns: &Type, value: &str, terms: &[&str]) -> Rule {
        Rule {
            returns: returns.clone(),
            promotes: true,
            before: String::new(),
            after: String::new(),
            value: value.to_owned(),
            terms: terms.iter().map(|term| (*term).to_owned()).collect(),
            sum: None,
        }
    }

    fn summed(self, sum: &'static str) -> Rule {
        Rule {
            sum: Some(sum),
            ..self
        }
    }

    fn before(self, before: String) -> Rule {
        Rule { before, ..self }
    }

    fn after(self, after: &str) -> Rule {
        Rule {
            after: after.to_owned(),
            ..self
        }
    }

    fn unpromoted(self) -> Rule {
        Rule {
            promotes: false,
            ..self
        }
    }
}

/// A rule, or `None` for a function whose value is piecewise constant and whose derivative is 0.
pub type Found = Result<Option<Rule>, Obstacle>;

/// Minimum divisor in a derivative, which keeps the derivative finite.
const TINY: &str = "1e-18";

/// Minimum radicand in the derivatives of `asin`, `acos` and `acosh`. It limits the derivative to a million, and its
/// square is then finite. No stated Lipschitz constant is larger than a million.
const TINY_UNDER_ROOT: &str = "1e-12";

/// Writes a comparison of scalars, or of vectors by component.
fn compared(of: &Type, left: &str, operator: &str, right: &str) -> String {
    if of.is_scalar() {
        return format!("({left} {operator} {right})");
    }
    let name = match operator {
        "<" => "lessThan",
        "<=" => "lessThanEqual",
        ">" => "greaterThan",
        ">=" => "greaterThanEqual",
        _ => "equal",
    };
    format!("{name}({left}, {right})")
}

/// Writes a value in which 0 is replaced by 1.
fn not_zero(of: &Type, name: &str) -> String {
    format!("({name} + T({}))", compared(of, name, "==", "T(0.0)"))
}

/// The direction in which the derivative of a length at 0 is taken: a unit vector that is unlikely to coincide with a
/// special direction of the text.
fn off_axis(of: &Type) -> &'static str {
    match of.rows {
        2 => "vec2(0.6, -0.8)",
        3 => "vec3(0.48, -0.64, 0.6)",
        _ => "vec4(0.1, -0.7, 0.5, 0.5)",
    }
}

/// The type with the most components, with floats unless all arguments are integers.
fn widest(given: &[Type]) -> Option<Type> {
    let widest = given.iter().max_by_key(|of| of.rows)?.clone();
    let is_whole = |of: &Type| matches!(of.base, Base::Int | Base::Uint);
    match given.iter().all(is_whole) {
        true => Some(widest),
        false => Some(widest.of(Base::Float)),
    }
}

/// The type of the result of a GLSL function.
pub fn type_of_call(name: &str, given: &[Type]) -> Option<Type> {
    let first = given.first()?;
    if given.iter().any(|of| of.is_array() || of.is_struct()) {
        return None;
    }
    let float = Type::scalar(Base::Float);
    Some(match name {
        "abs" | "sign" | "min" | "max" | "clamp" => widest(given)?,
        "isnan" | "isinf" | "lessThan" | "lessThanEqual" | "greaterThan" | "greaterThanEqual"
        | "equal" | "notEqual" | "not" => first.of(Base::Bool),
        "any" | "all" => Type::scalar(Base::Bool),
        "floatBitsToInt" => first.of(Base::Int),
        "floatBitsToUint" => first.of(Base::Uint),
        "intBitsToFloat" | "uintBitsToFloat" => first.of(Base::Float),
        "length" | "distance" | "dot" | "determinant" => float,
        "cross" | "normalize" | "reflect" | "refract" | "faceforward" | "modf" => {
            first.of(Base::Float)
        }
        "inverse" | "matrixCompMult" => first.clone(),
        "transpose" => Type::new(Base::Float, first.rows, first.columns),
        "outerProduct" => Type::new(Base::Float, given.get(1)?.rows, first.rows),
        _ => widest(given)?.of(Base::Float),
    })
}

/// The rule of a GLSL function with these arguments; `varies` states which depend on the point.
pub fn of_call(name: &str, given: &[Type], varies: &[bool]) -> Found {
    let Some(t) = type_of_call(name, given) else {
        return obstacle("a call of a function of GLSL with other arguments");
    };
    if given.iter().any(Type::is_matrix) || name == "outerProduct" {
        return of_matrices(name, given, &t).map(Some);
    }
    if let Some(rule) = of_one(name, &t).filter(|_| given.len() == 1) {
        return Ok(Some(rule));
    }
    if let Some(rule) = of_geometry(name, given, &t) {
        return Ok(Some(rule));
    }
    let zero = "T(0.0)";
    let is_plain = |at: usize| !varies.get(at).copied().unwrap_or(false);
    Ok(Some(match (name, given.len()) {
        ("atan", 2) => Rule::new(&t, "atan(A, B)", &["(B / Q) * dA", "-(A / Q) * dB"])
            .before(format!("T S = A * A + B * B; T Q = {};", not_zero(&t, "S"))),
        ("pow", 2) => {
            let log = format!("(V * log(max(A, T({TINY})))) * dB");
            Rule::new(&t, "pow(A, B)", &["F * dA", log.as_str()])
                .after(&format!("T F = B * V / {};", not_zero(&t, "A")))
        }
        ("mod", 2) => Rule::new(&t, "mod(A, B)", &["dA", "-floor(A / B) * dB"]),
        ("min" | "max", 2) => {
            let operator = match (name, is_plain(0), is_plain(1)) {
                ("min", true, _) => "<=",
                ("min", ..) => "<",
                (_, _, true) => ">=",
                _ => ">",
            };
            let (b, is_b) = (bools(&t), compared(&t, "B", operator, "A"));
            let value = format!("{name}(A, B)");
            Rule::new(&t, &value, &["mix(dA, T(0.0), L)", "mix(T(0.0), dB, L)"])
                .summed("mix(dA, dB, L)")
                .before(format!("{b} L = {is_b};"))
        }
        ("clamp", 3) => {
            let b = bools(&t);
            let low = compared(&t, "A", if is_plain(1) { "<=" } else { "<" }, "B");
            let high = compared(&t, "A", ">", "C");
            Rule::new(
                &t,
                "clamp(A, B, C)",
                &[
                    "mix(mix(dA, T(0.0), L), T(0.0), H)",
                    "mix(mix(T(0.0), dB, L), T(0.0), H)",
                    "mix(T(0.0), dC, H)",
                ],
            )
            .before(format!("{b} L = {low}; {b} H = {high};"))
        }
        ("mix", 3) if given[2].base == Base::Bool => Rule::new(
            &t,
            "mix(A, B, C)",
            &["mix(dA, T(0.0), C)", "mix(T(0.0), dB, C)"],
        )
        .summed("mix(dA, dB, C)")
        .unpromoted(),
        ("mix", 3) => Rule::new(
            &t,
            "mix(A, B, C)",
            &["(1.0 - C) * dA", "C * dB", "(B - A) * dC"],
        )
        .summed("mix(dA, dB, C) + (B - A) * dC"),
        ("smoothstep", 3) => Rule::new(
            &t,
            "smoothstep(A, B, C)",
            &["-(S * (1.0 - Q)) * dA", "-(S * Q) * dB", "S * dC"],
        )
        .before(format!(
            "T Q = clamp((C - A) / (B - A), {zero}, T(1.0)); T S = 6.0 * Q * (1.0 - Q) / (B - A);"
        )),
        (
            "sign" | "floor" | "ceil" | "trunc" | "round" | "roundEven" | "step" | "isnan"
            | "isinf" | "lessThan" | "lessThanEqual" | "greaterThan" | "greaterThanEqual" | "equal"
            | "notEqual" | "floatBitsToInt" | "floatBitsToUint",
            _,
        ) => return Ok(None),
        _ => return obstacle("a function of GLSL without a rule"),
    }))
}

/// The type of the result of a comparison by component.
fn bools(of: &Type) -> String {
    of.of(Base::Bool).name()
}

/// The rule of a function of one argument, by component.
fn of_one(name: &str, t: &Type) -> Option<Rule> {
    let call = format!("{name}(A)");
    let safe = |text: String| format!("max({text}, T({TINY_UNDER_ROOT}))");
    let rate = match name {
        "radians" | "degrees" => format!("{name}(T(1.0))"),
        "sin" => "cos(A)".into(),
        "cos" => "(-sin(A))".into(),
        "tan" => "(1.0 + V * V)".into(),
        "asin" => format!("inversesqrt({})", safe("1.0 - A * A".into())),
        "acos" => format!("(-inversesqrt({}))", safe("1.0 - A * A".into())),
        "atan" => "(1.0 / (1.0 + A * A))".into(),
        "sinh" => "cosh(A)".into(),
        "cosh" => "sinh(A)".into(),
        "tanh" => "(1.0 - V * V)".into(),
        "asinh" => "inversesqrt(A * A + 1.0)".into(),
        "acosh" => format!("inversesqrt({})", safe("A * A - 1.0".into())),
        "atanh" => "(1.0 / (1.0 - A * A))".into(),
        "exp" => "V".into(),
        "exp2" => "(0.69314718056 * V)".into(),
        "log" => "(1.0 / A)".into(),
        "log2" => "(1.44269504089 / A)".into(),
        "sqrt" => format!("(0.5 / max(V, T({TINY})))"),
        "inversesqrt" => "(-0.5 * V / A)".into(),
        "abs" => "(1.0 - 2.0 * step(A, T(0.0)))".into(),
        "fract" => "T(1.0)".into(),
        _ => return None,
    };
    let term = match name {
        "fract" => "dA".to_owned(),
        _ => "F * dA".to_owned(),
    };
    let rule = Rule::new(t, &call, &[term.as_str()]);
    Some(match name {
        "fract" => rule,
        _ => rule.after(&format!("T F = {rate};")),
    })
}

/// The rule of a geometric function of whole vectors.
fn of_geometry(name: &str, given: &[Type], t: &Type) -> Option<Rule> {
    let first = given.first()?;
    let g = first.name();
    let is_scalar = first.is_scalar();
    let dot = |a: &str, b: &str| format!("dot({a}, {b})");
    let rule = match name {
        "length" | "normalize" if is_scalar => {
            let rate = "(1.0 - 2.0 * step(A, 0.0)) * dA";
            match name {
                "length" => Rule::new(t, "abs(A)", &[rate]),
                _ => Rule::new(t, "sign(A)", &["0.0 * dA"]),
            }
        }
        "distance" if is_scalar => {
            let sign = "(1.0 - 2.0 * step(A - B, 0.0))";
            let terms = [format!("{sign} * dA"), format!("-{sign} * dB")];
            Rule::new(t, "abs(A - B)", &[&terms[0], &terms[1]])
        }
        "length" => {
            let off = off_axis(first);
            Rule::new(t, "length(A)", &[&dot("N", "dA")])
                .after(&format!("{g} N = V > 0.0 ? A / V : {off};"))
        }
        "distance" => {
            let off = off_axis(first);
            let terms = [dot("N", "dA"), format!("-{}", dot("N", "dB"))];
            Rule::new(t, "distance(A, B)", &[&terms[0], &terms[1]])
                .after(&format!("{g} N = V > 0.0 ? (A - B) / V : {off};"))
        }
        "dot" => Rule::new(t, "dot(A, B)", &["dot(dA, B)", "dot(A, dB)"]),
        "cross" => Rule::new(t, "cross(A, B)", &["cross(dA, B)", "cross(A, dB)"]),
        "normalize" => Rule::new(t, "normalize(A)", &["(dA - dot(N, dA) * N) * R"])
            .after("float S = length(A); float R = S > 0.0 ? 1.0 / S : 0.0; T N = A * R;"),
        "reflect" => Rule::new(
            t,
            "reflect(A, B)",
            &[
                "(dA - 2.0 * dot(B, dA) * B)",
                "-2.0 * (dot(dB, A) * B + dot(B, A) * dB)",
            ],
        ),
        "faceforward" => Rule::new(
            t,
            "faceforward(A, B, C)",
            &["S * dA", "0.0 * dB", "0.0 * dC"],
        )
        .after("float S = dot(C, B) < 0.0 ? 1.0 : -1.0;"),
        // A is the incident vector, B the normal, C the ratio of refractive indices. The result is 0 where K < 0.
        "refract" => Rule::new(
            t,
            "refract(A, B, C)",
            &[
                "S * (C * dA - (C + C * C * P / R) * dot(B, dA) * B)",
                "S * (-(C + C * C * P / R) * dot(dB, A) * B - (C * P + R) * dB)",
                "S * (A - (P - C * (1.0 - P * P) / R) * B) * dC",
            ],
        )
        .after(&format!(
            "float P = dot(B, A); float K = 1.0 - C * C * (1.0 - P * P); \
             float S = K < 0.0 ? 0.0 : 1.0; float R = sqrt(max(K, {TINY_UNDER_ROOT}));"
        )),
        _ => return None,
    };
    Some(rule.unpromoted())
}

/// The rule of a function of matrices.
fn of_matrices(name: &str, given: &[Type], t: &Type) -> Result<Rule, Obstacle> {
    let rule = match (name, given.first().map_or(0, |of| of.columns)) {
        ("transpose", _) => Rule::new(t, "transpose(A)", &["transpose(dA)"]),
        ("matrixCompMult", _) => Rule::new(
            t,
            "matrixCompMult(A, B)",
            &["matrixCompMult(dA, B)", "matrixCompMult(A, dB)"],
        ),
        ("outerProduct", _) => Rule::new(
            t,
            "outerProduct(A, B)",
            &["outerProduct(dA, B)", "outerProduct(A, dB)"],
        ),
        ("inverse", _) => Rule::new(t, "inverse(A)", &["(-(V * dA * V))"]),
        ("determinant", columns) => {
            // The sum of the determinants in which one column is replaced by its derivative.
            let replaced = |one: usize| {
                let column = |at| format!("{}[{at}]", if at == one { "dA" } else { "A" });
                let columns: Vec<String> = (0..columns).map(column).collect();
                format!("determinant(mat{}({}))", columns.len(), columns.join(", "))
            };
            let terms: Vec<String> = (0..columns).map(replaced).collect();
            let term = format!("({})", terms.join(" + "));
            Rule::new(t, "determinant(A)", &[term.as_str()])
        }
        _ => return obstacle("a function of matrices without a rule"),
    };
    Ok(rule.unpromoted())
}

/// The type of the result of a binary operator on floats.
pub fn type_of_operation(operator: &str, left: &Type, right: &Type) -> Option<Type> {
    if [left, right]
        .iter()
        .any(|of| of.is_array() || of.is_struct())
    {
        return None;
    }
    let base = match (left.base, right.base) {
        (one, other) if one == other => one,
        (Base::Float, Base::Int | Base::Uint) | (Base::Int | Base::Uint, Base::Float) => {
            Base::Float
        }
        // Int and uint are converted implicitly. A shift keeps the type of its left operand.
        (one, other) if matches!(operator, "<<" | ">>") || other == Base::Int => one,
        (_, other) => other,
    };
    let of = |t: &Type| Some(t.of(base));
    if operator == "*" {
        match (left.is_matrix(), right.is_matrix()) {
            (true, true) => return Some(Type::new(base, right.columns, left.rows)),
            (true, false) if right.is_vector() => return Some(Type::vector(base, left.rows)),
            (false, true) if left.is_vector() => return Some(Type::vector(base, right.columns)),
            _ => (),
        }
    }
    if left.is_scalar() {
        return of(right);
    }
    of(left)
}

/// The rule of a binary operator.
pub fn of_operation(operator: &str, left: &Type, right: &Type) -> Result<Rule, Obstacle> {
    let Some(t) = type_of_operation(operator, left, right) else {
        return obstacle("an operator on other types");
    };
    // A scalar is added to every component, including the components of a matrix.
    let wide = |of: &Type, rate: &'static str| match (of.is_scalar() && !t.is_scalar(), rate) {
        (false, _) => rate,
        (true, "dA") => "T(0.0) + dA",
        (true, _) => "T(0.0) + dB",
    };
    let rule = match operator {
        "+" => Rule::new(&t, "A + B", &[wide(left, "dA"), wide(right, "dB")]),
        "-" => Rule::new(
            &t,
            "A - B",
            &[wide(left, "dA"), &format!("-({})", wide(right, "dB"))],
        )
        .summed("dA - dB"),
        "*" => Rule::new(&t, "A * B", &["dA * B", "A * dB"]),
        "/" if right.is_matrix() => return obstacle("a division by a matrix"),
        "/" => Rule::new(&t, "A / B", &["dA / B", "-(V * dB) / B"]),
        _ => return obstacle("an operator without a rule"),
    };
    Ok(rule.unpromoted())
}

/// The rule of the negation.
pub fn of_negation(of: &Type) -> Rule {
    Rule::new(of, "-A", &["-dA"])
}
