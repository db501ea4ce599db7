//! Texts of users' fields: the checks before a graphics driver compiles the text.

use super::Target;
use echomarch::scene::UserField;
use glam::Vec3;

const TOKENS: &[&str] = &[
    "float field(vec3 p) {",
    "return",
    "uniform",
    "discard",
    "precision highp float;",
    "const int N[3] = int[3](1, 2, 3);",
    "struct S { float a; };",
    "gl_FragCoord",
    "float dot(vec3 a, vec3 b);",
    "float dot = dot(p, p);",
    "half",
    "a__b",
    "_a",
    "float s(float x) { return x; }",
    "const float p = 1.0, s = p;",
    "struct st { float s; st p[s]; };",
    ".s",
    "#define GL_ES",
    "#undef __LINE__",
    "in",
    "out",
    "for (int i = 0; i < 9; ++i)",
    "#define A(x, y) x y A",
    "#define A A A",
    "#define B() B(",
    "#undef A",
    "#if defined(A) && (1 << 70) / -1 % 3",
    "#ifdef A",
    "#elif -9223372036854775807 - 1",
    "#else",
    "#endif",
    "#version 330",
    "#extension",
    "#error",
    "A(",
    "A(B(), A(1, 2))",
    "__VERSION__",
    "##",
    "\\\n",
    "\r\n",
    "/*",
    "*/",
    "//",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "[99999999999999999999]",
    "1e+5",
    "0x",
    "08",
    "1.5.e-",
    ",",
    ";",
    "\u{feff}",
    "caf\u{e9}",
    "\u{0}",
];

/// Returns the target for texts of users' fields.
pub fn target() -> Target {
    let texts = [
        include_str!("../../examples/scenes/menger.glsl"),
        "#version 330\nprecision highp float; // all\nfloat field(vec3 p) { return length(p) - 1.0; }\n",
        "#define SCALE 2.0\n#define MAX(a, b) ((a) > (b) ? (a) : (b))\n#ifdef GL_ES\nprecision mediump float;\n\
         #elif __VERSION__ >= 300 && defined SCALE\nconst float R = 1.0, S[2] = float[2](1., .5);\n#endif\n\
         struct Ball { vec3 centre; float radius; };\nmat2 turn(in float a, out float b) { b = a; return mat2(cos(a)); }\n\
         float field(const in vec3 p) { Ball ball = Ball(p.zyx, R); return MAX(SCALE, MAX(1e-3, ball.radius)); }\n",
        "#define A0 +p.x\n#define A1 A0 A0\n#define A2 A1 A1\n#define D(x) x + x\n\
         float field(vec3 p) { return D(D(D(1.0))) \\\n A2; /* the\n end */ }",
    ];
    Target {
        name: "field_text",
        corpus: texts.map(|text| text.as_bytes().to_vec()).to_vec(),
        tokens: TOKENS,
        one,
    }
}

/// Checks a text. If the text is accepted, the shader text made from it must be accepted too.
pub fn one(data: &[u8]) {
    let text = String::from_utf8_lossy(data).into_owned();
    let lines = 2 * text.len() as u32 + 1;
    let read = |text: String| UserField::new("fuzz.glsl", text, Vec3::ONE, 1.0);
    let field = read(text);
    match field.check_text() {
        Err((line, why)) => {
            assert!(line.is_none_or(|line| (1..=lines).contains(&line)), "{why}");
            assert!(!why.contains('\n') && why.len() < 1500, "{why}");
            assert!(field.shader_text().is_empty() && field.names().is_empty());
        }
        Ok(()) => {
            let again = read(field.shader_text());
            assert_eq!(again.check_text(), Ok(()));
            assert_eq!(again.names(), field.names());
            // This call also differentiates the text.
            assert_eq!(again.has_loops(), field.has_loops());
            assert!(field.names().iter().any(|name| name == "field"));
        }
    }
}
