//! Tests of what is differentiated and what is rejected, and of the safety of arbitrary texts. Tests of the renderer
//! (`crate::tracer`) compare the derivatives with differences.

use super::super::read;
use super::*;

fn derived(text: &str) -> Result<String, Obstacle> {
    let read = read(text).unwrap_or_else(|why| panic!("{text}: {why:?}"));
    written(&read.code, Along::Axes, 0)
}

/// Texts with most features that a field can use.
const TEXTS: [&str; 4] = [
    include_str!("../../../../../examples/scenes/menger.glsl"),
    "struct Hit { float d; vec3 q; int id; };\n float best = 0.0;\n const float W[2] = float[2](1.0, 0.5);\n\
     Hit make(vec3 p, float r) { Hit h; h.d = length(p) - r; h.q = p; h.id = 1; return h; }\n\
     void turn(inout vec2 p, float a) { p = cos(a) * p + sin(a) * vec2(p.y, -p.x); }\n\
     float field(vec3 p) { turn(p.xz, 0.3); p.y++; best = p.x; float w[3]; w[1] = p.z; w[2] = W[1];\n\
     Hit h = p.x > 0.0 ? make(p, 0.5) : make(p.zyx, 1.0); mat3 m = mat3(p, p.yzx, vec3(1.0)); m[1].x += 1.0;\n\
     for (int i = 0; i < 3; ++i) { if (i == 2) continue; w[i] = w[1] * 0.5; }\n\
     switch (h.id) { case 0: h.d = 0.0; break; default: h.d += w[1]; }\n\
     do { h.d *= 0.5; } while (h.d > 10.0); return h.d + best + (m * p).x + w[0]; }",
    "float hash(vec2 i) { uint h = uint(int(i.x)) * 747796405u; return float((h >> 13u) & 1023u) / 1024.0; }\n\
     float noise(vec2 p) { vec2 i = floor(p), f = p - i; return mix(hash(i), hash(i + vec2(1.0, 0.0)), f.x); }\n\
     float field(vec3 p) { float h = 0.0, a = 1.5; for (int i = 0; i < 5; ++i) { h += a * noise(p.xz); a *= 0.5; }\n\
     return p.y - h; }",
    "#define R(p, a) p = cos(a) * p + sin(a) * vec2(p.y, -p.x)\nfloat f(float x) { return x; }\n\
     vec2 f(vec2 x) { return x * f(x.y); }\nfloat field(vec3 p) { R(p.xy, 0.5); return f(f(p.xy)).x + f(p.z); }",
];

/// Protects the cost of a gradient: parts that do not depend on the point are computed once, by the text's own
/// functions. A function is written once for each set of arguments that depend on the point.
#[test]
fn what_does_not_depend_on_the_point_stays() {
    let text = derived(TEXTS[2]).unwrap();
    for kept in [
        "user0_hash(user0_i)",
        "float a = 1.5;",
        "(a *= 0.5);",
        "vec2 user0_i = floor(p.v);",
    ] {
        assert!(text.contains(kept), "{kept}: {text}");
    }
    assert!(!text.contains("hash(dual0_"), "{text}");
    assert_eq!(text.matches("noise(dual0_vec2 p)").count(), 1, "{text}");
}

/// Protects texts that contain unused functions or structures that cannot be parsed: the field still has a derivative.
#[test]
fn what_is_not_used_is_no_obstacle() {
    let other =
        "struct { float a; } s; float f() { struct L { float a; }; L b; b.a = 9.0; return b.a; }";
    let uses = |value: &str| format!("{other} float field(vec3 p) {{ return {value}; }}");
    assert!(derived(&uses("length(p) - 1.0")).is_ok());
    assert!(derived(&uses("length(p) - f()")).is_ok());
}

/// Protects the names in the derivative. They differ between fields and between the two kinds of derivatives. Names
/// that begin with an underscore produce no double underscore, which GLSL reserves.
#[test]
fn names_are_those_of_the_field() {
    let text = read(
        "float _a(float x) { return x; } float field(vec3 p) { float _b_ = _a(p.x); return _b_; }",
    );
    let code = text.unwrap().code;
    for (along, prefix) in [(Along::Axes, "dual7_"), (Along::Line, "slope7_")] {
        let text = written(&code, along, 7).unwrap();
        assert!(
            text.contains(&format!("float {prefix}field(vec3 p, ")),
            "{text}"
        );
        assert!(text.contains("users7_b_"), "{text}");
        assert!(!text.contains("__") && !text.contains("user0"), "{text}");
    }
}

/// Protects from wrong gradients: a text that cannot be differentiated is rejected.
#[test]
fn what_cannot_be_differentiated_is_told() {
    let field = |body: &str| format!("float field(vec3 p) {{ {body} }}");
    for (text, why) in [
        (
            field("return uintBitsToFloat(floatBitsToUint(p.x));"),
            "floats are made of the bits of floats that depend on the point",
        ),
        (
            field("float w[2]; w[0] = p.x; int i = 0; return w[i++] * w[i++];"),
            "an index with effects",
        ),
        (
            "float f(float x); float g(float x) { return f(x); } float f(float x) { return g(x); }\n\
             float field(vec3 p) { return f(p.x); }"
                .to_owned(),
            "a function calls itself",
        ),
        (
            field("return determinant(mat3(mat2(p.x)));"),
            "a matrix of a smaller one",
        ),
        (field("return no(p);"), "a function without a definition"),
        (field("return no;"), "a name without a declaration"),
        (
            field("const int N = 2; float w[N] = float[N](1.0, 2.0); w[0] = p.x; return w[1];"),
            "an array that depends on the point is assigned as a whole",
        ),
    ] {
        assert_eq!(derived(&text), Err(Obstacle(why)), "{text}");
    }
}

/// Protects passes from more turns than a driver allows, and marches from a step limit that waves reach: loops that
/// count to constant ends are counted, with those in calls and in other loops.
#[test]
fn turns_of_loops_are_counted() {
    let body = |body: &str| format!("float field(vec3 p) {{ float s = 0.0; {body} return s; }}");
    let called = "const int N = 4; float f(float x) { for (int i = N; i > 0; --i) { x *= 0.5; } return x; }\n\
                  float field(vec3 p) { for (int i = 0; i <= 2; i += 2) { p.x = f(p.x); } return f(p.x); }";
    for (text, turns) in [
        (body(""), Some(0)),
        (
            body("for (int i = 0; i < 5; i++) { if (s > 1.0) break; s += p.x; }"),
            Some(5),
        ),
        (
            body("for (int i = 0; s < 9.0 && 7 >= i; ++i) s += p.x;"),
            Some(8),
        ),
        (
            body("for (float i = 0.0; i < 1.0; i += 0.25) s += pow(0.5, i);"),
            Some(5),
        ),
        (
            body("for (int i = 0; i < 3; ++i) for (int j = 9; j > i; --j) s += p.x;"),
            None,
        ),
        (
            body("for (int i = 0; i < 3; ++i) for (int j = 9; j > 7; --j) s += p.x;"),
            Some(9),
        ),
        (called.to_owned(), Some(2 * 5 + 4)),
        (body("for (int i = 0; i < 3; ++i) { i = 0; }"), None),
        (body("for (int i = 0; i < 3; --i) s += p.x;"), None),
        (body("for (int i = 0; i < int(p.x); ++i) s += p.x;"), None),
        (body("while (s < p.x) s += 1.0;"), None),
        // A gradient is called beside the value.
        (
            body("for (int i = 0; i < 3; ++i) s += p.x;")
                + " vec3 fieldGradient(vec3 p) { for (int i = 0; i < 7; ++i) p *= 0.5; return p; }",
            Some(3 + 7),
        ),
        // A guard far away counts as few turns, if the loop may end before it.
        (
            body("for (int i = 0; i < 1000; ++i) { if (s > p.x) break; s += 1.0; }"),
            Some(60),
        ),
        (
            body(
                "for (int i = 0; i < 900000000; ++i) for (int j = 0; j < 900000000; ++j) s += p.x;",
            ),
            Some(1 << 20),
        ),
        // Counts that would be wrong: another variable of the name, a changed counter, numbers that wrap or stop growing,
        // octal digits.
        (
            "const int N = 4; ".to_owned()
                + &body("int N = 4000; for (int i = 0; i < N; ++i) s += p.x;"),
            None,
        ),
        (
            body("for (int i = 0; i < 3 && --i > -9000; ++i) s += p.x;"),
            None,
        ),
        (body("for (uint i = 5u; i >= 0u; --i) s += p.x;"), None),
        (body("for (uint i = 0u; i < -1u; ++i) s += p.x;"), None),
        (
            body("for (float i = 16777216.0; i < 16777220.0; i += 1.0) s += p.x;"),
            None,
        ),
        (body("for (int i = 010; i < 20; ++i) s += p.x;"), None),
        (
            "void back(inout int i) { i = 0; } ".to_owned()
                + &body("for (int i = 0; i < 3; ++i) back(i);"),
            None,
        ),
    ] {
        assert_eq!(loop_turns(&read(&text).unwrap().code), turns, "{text}");
    }
}

/// Protects stack and memory from deeply nested and long texts: they have no derivative.
#[test]
fn large_texts_are_left_alone() {
    let nested = |open: &str, close: &str, count: usize| {
        format!(
            "float field(vec3 p) {{ return {}p.x{}; }}",
            open.repeat(count),
            close.repeat(count)
        )
    };
    let mut functions = "float f0(float x) { return x; }\n".to_owned();
    for index in 1..500 {
        let below = index - 1;
        functions += &format!("float f{index}(float x) {{ return f{below}(x); }}\n");
    }
    let chain = functions + "float field(vec3 p) { return f499(p.x); }";
    let branches = format!(
        "float field(vec3 p) {{ {} return p.x; }}",
        "if (p.x > 0.0) p.x *= 0.5; else ".repeat(1000)
    );
    for text in [
        nested("-", "", 5000),
        nested("(", ")", 120),
        nested("p.x + ", "", 5000),
        nested("p.x > 0.0 ? 1.0 : ", "", 2000),
        nested("abs(", ")", 120),
        chain,
        branches,
    ] {
        assert!(derived(&text).is_err(), "{}", &text[..60]);
    }
    // A function with four parameters, called with every combination of arguments that depend on the point.
    let mut text =
        "float f(float a, float b, float c, float d) { return a * b + c * d; }\n".to_owned();
    text += "float field(vec3 p) { float s = 0.0;";
    for mask in 0..16 {
        let argument = |bit: usize| if mask >> bit & 1 == 1 { "p.x" } else { "2.0" };
        let [a, b, c, d] = [0, 1, 2, 3].map(argument);
        text += &format!(" s += f({a}, {b}, {c}, {d});");
    }
    assert!(derived(&(text + " return s; }")).is_ok());
}

/// Protects the program from arbitrary texts. If tokens are removed, doubled, exchanged or mixed, the program does not
/// panic, and the written text stays within its limit.
#[test]
fn no_mutated_text_panics() {
    /// Number of changed versions of each text, and number of changes in each version.
    const ROUNDS: usize = 500;
    const CHANGES: usize = 3;
    let mut state = 1u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below.max(1)
    };
    let codes = TEXTS.map(|text| read(text).unwrap().code);
    let words: Vec<Vec<&str>> = codes
        .iter()
        .map(|code| {
            let (tokens, _) = tokens::tokens(code).unwrap();
            tokens.iter().map(|token| token.text).collect()
        })
        .collect();
    let all: Vec<&str> = words.concat();
    let mut differentiated = 0;
    for round in 0..ROUNDS * words.len() {
        let mut changed = words[round % words.len()].clone();
        for _ in 0..=random(CHANGES) {
            let place = random(changed.len());
            match random(4) {
                0 => drop(changed.remove(place)),
                1 => changed.insert(place, all[random(all.len())]),
                2 => changed[place] = all[random(all.len())],
                _ => {
                    let other = random(changed.len());
                    changed.swap(place, other);
                }
            }
        }
        for along in [Along::Axes, Along::Line] {
            let text = written(&changed.join(" "), along, 0);
            differentiated += usize::from(text.is_ok());
            assert!(text.map_or(0, |text| text.len()) < 1 << 18);
        }
    }
    assert!(differentiated > 50, "{differentiated}");
}
