//! Tests of accepted and rejected texts.

use super::*;

const FIELD: &str = "float field(vec3 p) { return p.x; }";

fn refusal(text: &str) -> (Option<u32>, String) {
    read(text).expect_err(&text[..text.len().min(200)])
}

/// Protects the counts of `echomarch cost`: comments and excluded lines are not code, names are renamed, and the limits
/// of users' texts do not apply.
#[test]
fn a_shader_is_reduced_to_its_code() {
    let text = "// 1: a\n#line 1 1\n#define ON 1\n#define OFF 0\n#define field user0_field\n\
                float field(vec3 p) { /* one\ntwo */ return p.x; } // end\n#undef field\n\
                #if OFF\nfloat off;\n#else\nfloat field;\n#endif\n#if !ON\nfloat off;\n#endif\n\
                #ifdef ON\nfloat on;\n#endif";
    let expected = [
        "float user0_field ( vec3 p ) {",
        "return p . x ; }",
        "float field ;",
        "float on ;",
    ];
    assert_eq!(code_lines(text).unwrap(), expected);
    let long = "float a;\n".repeat(MOST_TOKENS);
    assert_eq!(code_lines(&long).unwrap().len(), MOST_TOKENS);
    assert!(code_lines("#if 1\nfloat a;").is_err());
}

/// Protects the renaming: every name that can clash with a name of the program is found.
#[test]
fn the_names_of_a_text_are_found() {
    let text = "// float not(vec3 p)\n#define PI 3.14\nconst float A = PI, B[2];\n\
        struct Ray { vec3 o; float far; };\nmat2 rot(float a) { float c2 = cos(a); return mat2(c2); }\n\
        /* vec3\n no(); */ float field(vec3 p) { return length(p.xyz) - A - out_of; }\n";
    let names = read(text).unwrap().names;
    assert_eq!(
        names,
        ["A", "B", "Ray", "o", "far", "rot", "c2", "field", "out_of"]
    );
}

/// Protects line numbers, and shaders from duplicates of their own statements.
#[test]
fn a_text_is_made_fit_for_a_shader_line_by_line() {
    let text = "\u{feff}#version 450\r\n  precision highp float; // all\n// caf\u{e9}\n\
        #define TWICE(x) \\\n  (2.0 * (x)) // two\nfloat field(vec3 p) {\n  return TWICE(p.x)-A;\n}";
    assert_eq!(
        read(text).unwrap().code,
        "\n\n\n // two\n\nfloat field(vec3 p) {\n  return ( 2.0 * ( p . x ) ) -A;\n}\n"
    );
    let tight =
        "#define A -1\nint a=1-A+A;int precision lowp int;b;float field(vec3 p){return p.x;}";
    let expected = "\nint a0=1- - 1 + - 1 ;int b0;float field(vec3 p){return p.x;}\n";
    assert_eq!(read(tight).unwrap().code, expected);
    let plain = "float field(vec3 p) {\n\n    return p.x; /* a\n */ }\n";
    assert_eq!(read(plain).unwrap().code, plain);
}

/// Protects the detection of a gradient function: a function with another signature is not one.
#[test]
fn a_stated_gradient_is_found() {
    for (text, is_stated) in [
        ("vec3 fieldGradient(vec3 p) { return p; }", true),
        (
            "vec3 fieldGradient(const in highp vec3 at) { return at; }",
            true,
        ),
        (
            "#define G vec3 fieldGradient\nG(vec3 p) { return p; }",
            true,
        ),
        ("", false),
        ("// vec3 fieldGradient(vec3 p)", false),
        ("vec3 gradient(vec3 p) { return p; }", false),
        (
            "#if 0\nvec3 fieldGradient(vec3 p) { return p; }\n#endif",
            false,
        ),
    ] {
        let text = format!("{text}\n{FIELD}");
        assert_eq!(read(&text).unwrap().states_gradient, is_stated, "{text}");
    }
}

/// Protects users from a gradient that is silently ignored: a gradient of another type is rejected.
#[test]
fn a_gradient_of_another_type_is_refused() {
    for text in [
        "vec4 fieldGradient(vec3 p) { return vec4(p, 0.0); }",
        "vec2 fieldGradient(vec3 p) { return p.xy; }",
        "vec3 fieldGradient(vec2 p) { return p.xyx; }",
        "const vec3 fieldGradient = vec3(1.0);",
    ] {
        let (line, why) = read(&format!("{text}\n{FIELD}")).err().unwrap();
        assert_eq!(line, Some(1), "{text}");
        assert!(why.contains("vec3 fieldGradient(vec3 p)"), "{why}");
    }
}

/// Protects the message about a text that does not define a field.
#[test]
fn what_is_no_field_is_told() {
    for good in [
        "float field(const in vec3 p) { return p.x; }",
        "float\nfield ( vec3 p ) { return p.x; }",
        "#define main float field(vec3 p)\nmain { return p.x; }",
        "float helper(in float a, out float b, inout vec3 c);float field(highp vec3 p){return 1.;}",
    ] {
        assert!(read(good).is_ok(), "{good}");
    }
    for none in [
        "",
        "float f(vec3 p) { return 1.0; }",
        "// float field(vec3 p)",
        "float field(vec2 p);",
        "#ifdef GL_ES\nfloat field(vec3 p) { return 1.0; }\n#endif",
        "void f() { float field(vec3 p); }",
    ] {
        let (line, why) = refusal(none);
        assert!(
            line.is_none() && why.contains("float field(vec3 p)"),
            "{none}: {why}"
        );
    }
}

/// Protects the shader around a field from forbidden content. The content is reported by name and line, also within
/// macros and continued lines.
#[test]
fn what_a_field_cannot_have_is_refused_by_name() {
    let bad = [
        ("uniform float iTime;", "'uniform'"),
        ("#define U uniform\nU float iTime;", "'uniform'"),
        ("#define U(x) x\nU(uniform) float iTime;", "'uniform'"),
        ("uni\\\nform float iTime;", "'uniform'"),
        ("in vec3 at;", "'in'"),
        ("float a; out vec4 colour;", "'out'"),
        ("varying vec3 at;", "'varying'"),
        ("attribute vec3 at;", "'attribute'"),
        ("layout(location = 0) out vec4 o;", "'layout'"),
        ("void f() { discard; }", "'discard'"),
        ("#define D discard\nvoid f() { D; }", "'discard'"),
        ("void f() { gl_FragDepth = 1.0; }", "'gl_FragDepth'"),
        ("float f() { return gl_FragCoord.x; }", "'gl_FragCoord'"),
        ("float f() { return dFdx(1.0); }", "'dFdx'"),
        ("float f(sampler2D s) { return 1.0; }", "'sampler2D'"),
        ("float f() { return texture(s, p.xy).x; }", "'texture'"),
        ("#extension GL_ARB_gpu_shader5 : enable", "#extension"),
        ("#pragma optimize(off)", "#pragma"),
        ("#line 7 1", "#line"),
        ("#include <stdio.h>", "#include"),
        ("# define A a ## b", "##"),
        ("float a[1000000000];", "1000000000"),
        ("float a = \"1\";", "'\"'"),
        ("float GL_a;", "'GL_a'"),
    ];
    for (text, name) in bad {
        for (before, lines) in [("", 0), ("\n/* a\n b */\n", 3)] {
            let whole = format!("{before}{text}\n{FIELD}");
            let (line, why) = refusal(&whole);
            assert!(why.contains(name), "{whole}: {why}");
            let own = 1 + u32::from(text.starts_with("#define") && text.contains('\n'));
            assert_eq!(line, Some(own + lines), "{whole}: {why}");
        }
    }
}

/// Protects compilers: texts with unbounded growth or nesting are rejected quickly.
#[test]
fn what_would_overwhelm_a_compiler_is_refused() {
    let doubling = |levels: usize| {
        let mut text = "#define A0 +p.x +p.x\n".to_owned();
        for level in 1..levels {
            let of = level - 1;
            text += &format!("#define A{level} A{of} A{of}\n");
        }
        text + &format!("float field(vec3 p) {{ return 1.0 A{}; }}", levels - 1)
    };
    let calls = |levels: usize| {
        let open = "D(".repeat(levels) + "p.x" + &")".repeat(levels);
        format!("#define D(x) x + x\nfloat field(vec3 p) {{ return {open}; }}")
    };
    assert!(read(&doubling(5)).is_ok() && read(&calls(5)).is_ok());
    let sum = "p.x + ".repeat(20_000);
    let globals: String = (0..80_000).map(|n| format!("int a{n};")).collect();
    let nested = |open: &str, close: &str| {
        let (open, close) = (open.repeat(5_000), close.repeat(5_000));
        format!("float field(vec3 p) {{ return {open}p.x{close}; }}")
    };
    let chain: String = (0..30_000)
        .map(|n| format!("#define B{n} B{}\n", n + 1))
        .collect();
    for text in [
        doubling(16),
        doubling(30),
        calls(30),
        calls(5_000),
        format!("float field(vec3 p) {{ return {sum}1.0; }}"),
        format!("{globals}{FIELD}"),
        nested("(", ")"),
        nested("{", "}"),
        nested("p[", "]"),
        format!("float {}; {FIELD}", "a".repeat(5_000)),
        format!(
            "#if {}1{}\n#endif\n{FIELD}",
            "(".repeat(9_000),
            ")".repeat(9_000)
        ),
        format!("#if {}1\n#endif\n{FIELD}", "!".repeat(9_000)),
        format!("{}\n{FIELD}", "#if 1\n".repeat(9_000)),
        format!("// {}\n{FIELD}", "a".repeat(LARGEST_TEXT)),
        chain + FIELD,
    ] {
        let (_, why) = refusal(&text);
        assert!(why.len() < 200, "{why}");
    }
    let spaced = format!("{}{FIELD}", "#define A B\n#undef A\n".repeat(9_000));
    assert!(read(&spaced).is_ok());
}

/// Protects the meaning of texts: macros and conditions have the same result as in GLSL.
#[test]
fn macros_and_conditions_do_as_in_glsl() {
    let same = [
        ("#define A -1\nx = 1-A;", "x = 1- -1;"),
        (
            "#define A(x, y) x * y\nx = A(f(1, 2), (3, 4));",
            "x = f(1,2)*(3,4);",
        ),
        (
            "#define f(x) g(x)\n#define g(x) f(x)\nx = f(1);",
            "x = f(1);",
        ),
        ("#define f(x) (x + 1)\nx = f(f(1));", "x = ((1 + 1) + 1);"),
        ("#define f() 1\n#define g f\nx = g() + f;", "x = 1 + f;"),
        ("#define A B\n#define B A\nx = A + B;", "x = A + B;"),
        ("#define A 1\n#undef A\nx = A;", "x = A;"),
        (
            "#if defined(A) || !defined B && 2 * 3 == 6\nx\n#else\ny\n#endif\n",
            "x",
        ),
        (
            "#if 0\n#if 1\nx\n#endif\n#elif 1\ny\n#elif 1\nz\n#else\nw\n#endif",
            "y",
        ),
        ("#define A\n#ifdef A\nx\n#endif\n#ifndef A\ny\n#endif", "x"),
        ("#if (1 << 3) - 8 | 0x10 & ~0xf ^ 16 % 7\nx\n#endif", "x"),
        ("#if __VERSION__ >= 300\nx\n#endif", "x"),
        ("#define A(x) x\nx = A\n(1);", "x = 1;"),
        ("#\nx /**/y // z\n", "x y"),
        ("#if 0\n#extension all : enable\n#error no\n#endif\nx", "x"),
    ];
    let plain = |text: &str| {
        let text = tokens::clean(text);
        let (tokens, _) = tokens::tokens(&text).unwrap();
        let tokens = preprocess::preprocess(&tokens, MOST_TOKENS).unwrap();
        tokens
            .iter()
            .map(|token| token.text)
            .collect::<Vec<_>>()
            .join(" ")
    };
    for (text, expected) in same {
        assert_eq!(plain(text), plain(expected), "{text}");
    }
    for (text, what) in [
        ("#if 1\n", "#endif"),
        ("#endif\n", "#endif"),
        ("#else\n", "#else"),
        ("#if 1 / 0\n#endif\n", "0"),
        ("#if 1 +\n#endif\n", "#if"),
        ("#if 1.5\n#endif\n", "1.5"),
        ("#define A(x) x\nx = A(1;\n", "A"),
        ("#define A(x) x\nx = A(1, 2);\n", "A"),
        ("#define A 1\n#define A 2\n", "A"),
        ("#define 1\n", "#define"),
        ("#define A(x\n", "A"),
        ("#error not this\n", "not this"),
        ("#other\n", "#other"),
        ("/* \n", "/*"),
        ("void f() { (1]; }\n", "']'"),
        ("}\n", "'}'"),
        ("float field(vec3 p) {\n", "'{'"),
    ] {
        let (_, why) = refusal(&format!("{text}{FIELD}"));
        assert!(why.contains(what), "{text}: {why}");
    }
}

fn with_body(body: &str) -> String {
    format!("float field(vec3 p) {{\n float a = 0.0; int i = 0;\n{body}\n return p.x; }}")
}

/// An infinite loop is rejected, because a renderer would silently end it after an arbitrary number of iterations.
#[test]
fn a_loop_without_an_end_is_refused_with_its_line() {
    for body in [
        "while (true) { a += 1.0; }",
        "while ((true)) a += 1.0;",
        "while (true);",
        "for (;;) { a += 1.0; if (a > 3.0) { a = 0.0; } }",
        "for (int k = 0; ; k++) a += 1.0;",
        "for (; true; ) { }",
        "do { a += 1.0; } while (true);",
        "while (a < 1.0) { }",
        "while (a < 1.0) { i++; float b = a; }",
        "while (sin(p.x) < 2.0 * p[0]) { a += p.y; }",
        "for (int k = 0; k < 4; ) { a += float(k); }",
        "for (int k = 0; k < 4; i++) { a = max(a, p.x); }",
        "do { a += 1.0; } while (p.x <= 1.0);",
    ] {
        let (line, why) = read(&with_body(body)).expect_err(body);
        assert_eq!(line, Some(3), "{body}");
        assert!(why.contains("never ends"), "{body}: {why}");
    }
}

/// Protects loops that end by a `break`, a `return` or a condition.
#[test]
fn a_loop_that_can_be_left_is_taken() {
    for body in [
        "while (true) { if (i++ > 5) break; }",
        "while (true) { if (i++ > 5) { return 1.0; } }",
        "while (true) if (i++ > 5) { break; }",
        "for (;;) { if (i++ > 5) break; }",
        "for (int k = 0; k < 4; k++) { a += 1.0; }",
        "do { a += 1.0; } while (a < 3.0);",
        "do { if (i++ > 5) break; } while (true);",
        "do { if (i++ > 5) { break; } } while (true);",
        "{ a = 1.0; } while (a < 3.0) a += 1.0;",
        "bool t = true; while (i < 3) { i++; }",
        "while (a < 3.0) --a;",
        "do { a += 1.0; } while (false);",
        "do { a += 1.0; } while (1 > 2);",
        "vec3 q = p; while (q.x < 3.0) { q *= 2.0; }",
        "vec3 q = p; while (q.x < 3.0) { q.xy += 2.0; }",
        "vec3 q = p; while (q.x < 3.0) { q[i] = 2.0; }",
        "while (a < 3.0) { (a) += 2.0; }",
        "while (i++ < 3) { }",
        "do i++; while (i < 3);",
        "while (i < 3) if (a > 0.0) a = 0.0; else i++;",
        "while (a < p.x) for (int k = 0; k < 4; k++) a += 1.0;",
        "float distance = 0.0; while (distance < p.x) { distance += 0.1; }",
        "while (i < 3) { ++(i); }",
        "const bool AGAIN = false; do { a += 1.0; } while (AGAIN);",
        "while (a < 3.0) { float b = modf(p.x, a); }",
        "while (a < 3.0) if (i > 2) { a += 2.0; }",
        // Invalid GLSL that the driver reports.
        "while; for a; do {} while 1; while",
    ] {
        assert!(
            read(&with_body(body)).is_ok(),
            "{body}: {:?}",
            read(&with_body(body))
        );
    }
}

/// Protects the only exception to renaming: the program's own shaders contain no name that looks like a selection of
/// components.
#[test]
fn selections_and_names_are_told_apart() {
    for word in ["x", "xyz", "rgba", "stp", "p", "aaaa"] {
        assert!(is_selection(word), "{word}");
    }
    for word in ["xr", "xyzwx", "origin", "outOrigin", "d"] {
        assert!(!is_selection(word), "{word}");
    }
    for word in [
        "isampler2D",
        "samplerCube",
        "samplerBuffer",
        "uimage3D",
        "image2D",
        "gl_x",
        "defined",
        "half",
        "a__b",
        "user0_a",
        "users12_a",
    ] {
        assert!(words::refusal(word).is_some(), "{word}");
    }
    assert!(words::refusal("sampler").is_none() && words::refusal("imaged").is_none());
}
