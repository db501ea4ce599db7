//! Compares derivatives of texts on the renderer with differences of the same functions, written in Rust and computed
//! in `f64`.

use super::*;
use crate::gl::ContextOptions;
use glam::{DVec2, DVec3};

type Function = fn(DVec3) -> f64;

/// A call in GLSL of a function of one number, and the same function in Rust.
type OfOne = (&'static str, fn(f64) -> f64);

/// Number of points at which each text is compared.
const POINTS: usize = 4096;

/// Half the step of the differences, in metres. For values of 1 the rounding error is then 1e-11, and the next term of
/// the series 1e-10.
const STEP: f64 = 1e-5;

/// Offset of the points from halves and whole numbers, at which a function may jump.
const OFF_GRID: f64 = 0.0123;

/// Points are left out if the slopes on both sides differ by more than this, because they are within a step of an edge.
const EDGE: f64 = 1e-3;

/// Tolerated error of a component, as a share of the component or of 1, due to rounding in the text's single precision.
const TOLERANCE: f64 = 2e-5;

/// The largest error of the derivative, and the number of components compared.
fn compared(context: &Context, text: &str, function: Function, half: f64) -> (f64, usize) {
    compared_with(context, text, &function, half)
}

fn compared_with(
    context: &Context,
    text: &str,
    function: &dyn Fn(DVec3) -> f64,
    half: f64,
) -> (f64, usize) {
    let size = Vec3::splat(2.0 * half as f32);
    let field = UserField::new("tried.glsl", text.to_owned(), size, 10.0);
    assert!(field.is_differentiated(), "{text}");
    let text = shader::join(&shader::user_sources(&field, CheckedGradient::Derived));
    let program = Program::fragment(context, "a derivative", &text).unwrap();
    let probe = Probe {
        context,
        program,
        field: &field,
        waves: WaveDomain::BothSides,
    };
    let points: Vec<Vec3> = (1..=POINTS)
        .map(|index| (half * (OFF_GRID + 1.96 * halton(index) - 1.0)).as_vec3())
        .collect();
    let found = probe.gradients(&points).unwrap();
    let (mut worst, mut count) = (0.0, 0);
    for (point, found) in points.iter().zip(found) {
        let p = point.as_dvec3();
        let middle = function(p);
        for (axis, found) in DVec3::AXES.into_iter().zip(found.to_array()) {
            let [less, more] = [-STEP, STEP].map(|step| function(p + step * axis));
            if ((more - middle) - (middle - less)).abs() > EDGE * STEP {
                continue;
            }
            let expected = (more - less) / (2.0 * STEP);
            let error = (f64::from(found) - expected).abs() / expected.abs().max(1.0);
            assert!(error < TOLERANCE, "at {p}: {found}, not {expected}: {text}");
            worst = f64::max(worst, error);
            count += 1;
        }
    }
    (worst, count)
}

fn gyroid(p: DVec3) -> f64 {
    let q = 1.3 * p;
    let (s, c) = (q.map(f64::sin), q.map(f64::cos));
    (s.dot(DVec3::new(c.y, c.z, c.x)).abs() - 0.35) / 1.3
}

fn hash(i: DVec2) -> f64 {
    let part = |x: f64, by: u32| ((x as i32 + 4096) as u32).wrapping_mul(by);
    let h = part(i.x, 747_796_405).wrapping_add(part(i.y, 2_891_336_453));
    let h = ((h >> 15) ^ h).wrapping_mul(277_803_737);
    f64::from((h >> 13) & 1023) / 1024.0
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

fn noise(p: DVec2) -> f64 {
    let i = p.floor();
    let f = (p - i).map(|f| f * f * f * (f * (f * 6.0 - 15.0) + 10.0));
    let row = |y: f64| {
        let corner = |x: f64| hash(i + DVec2::new(x, y));
        mix(corner(0.0), corner(1.0), f.x)
    };
    mix(row(0.0), row(1.0), f.y)
}

fn terrain(p: DVec3) -> f64 {
    let (mut h, mut a, mut q) = (0.0, 1.5, 0.25 * DVec2::new(p.x, p.z));
    for octave in 0..5 {
        h += a * noise(q + 17.0 * f64::from(octave));
        a *= 0.45;
        q *= 2.0;
    }
    p.y + 2.5 - h
}

fn bulb(p: DVec3) -> f64 {
    let (mut z, mut dr, mut r) = (p, 1.0, 0.0);
    for _ in 0..3 {
        r = z.length();
        if r > 2.0 {
            break;
        }
        let s = z.x * z.x + z.y * z.y;
        let k = 1.0 - z.z * z.z / s;
        dr = 2.0 * r * dr + 1.0;
        let square = [
            k * (z.x * z.x - z.y * z.y),
            2.0 * k * z.x * z.y,
            2.0 * z.z * s.sqrt(),
        ];
        z = DVec3::from(square) + p;
    }
    0.5 * r.ln() * r / dr
}

fn sponge(p: DVec3) -> f64 {
    let cross = |q: DVec3| {
        let [a, b, c] = [q.x.max(q.y), q.y.max(q.z), q.z.max(q.x)];
        1.0 - a.min(b.min(c))
    };
    let (q, mut scale) = (p / 1.5, 1.0);
    let mut value = (q.abs() - 1.0).max_element();
    for _ in 0..2 {
        let cube = (q * scale + 1.0).map(|x| x - 2.0 * (x / 2.0).floor()) - 1.0;
        scale *= 3.0;
        value = value.max(cross((3.0 * cube).abs()) / scale);
    }
    1.5 * value
}

fn repeated(p: DVec3) -> f64 {
    let turned = DVec2::from_angle(-0.3).rotate(DVec2::new(p.x, p.z));
    let p = DVec3::new(turned.x, p.y, turned.y);
    let c = DVec3::new(1.3, 1.7, 1.1);
    let q = p + 0.5 * c;
    let q = q - c * (q / c).floor() - 0.5 * c;
    let e = q.abs() - 0.2;
    let cube = e.max(DVec3::ZERO).length() + e.max_element().min(0.0);
    let (a, b, k) = (cube, p.length() - 0.7, 0.3);
    let h = (0.5 + 0.5 * (b - a) / k).clamp(0.0, 1.0);
    mix(b, a, h) - k * h * (1.0 - h)
}

/// Protects the gradients of users' texts that state none. For typical texts, the derivative on the renderer equals
/// that of the function, which Rust computes in double precision.
#[test]
fn derivatives_of_texts_are_those_of_their_functions() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    let texts: [(&str, &str, Function, f64); 6] = [
        (
            "gyroid",
            "float field(vec3 p) { vec3 q = 1.3 * p; return (abs(dot(sin(q), cos(q.yzx))) - 0.35) / 1.3; }",
            gyroid,
            4.0,
        ),
        (
            "terrain with a hash of whole numbers",
            "float hash(vec2 i) { uint h = uint(int(i.x) + 4096) * 747796405u
                 + uint(int(i.y) + 4096) * 2891336453u;
                 h = ((h >> 15u) ^ h) * 277803737u; return float((h >> 13u) & 1023u) / 1024.0; }
             float noise(vec2 p) { vec2 i = floor(p), f = p - i;
                 f = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
                 return mix(mix(hash(i), hash(i + vec2(1.0, 0.0)), f.x),
                     mix(hash(i + vec2(0.0, 1.0)), hash(i + vec2(1.0, 1.0)), f.x), f.y); }
             float field(vec3 p) { float h = 0.0, a = 1.5; vec2 q = 0.25 * p.xz;
                 for (int i = 0; i < 5; ++i) { h += a * noise(q + 17.0 * float(i)); a *= 0.45; q *= 2.0; }
                 return p.y + 2.5 - h; }",
            terrain,
            8.0,
        ),
        (
            "bulb with a loop that ends early",
            "#define TURNS 3
             float field(vec3 p) { vec3 z = p; float dr = 1.0, r = 0.0;
                 for (int i = 0; i < TURNS; i++) { r = length(z); if (r > 2.0) break;
                     float s = dot(z.xy, z.xy), k = 1.0 - z.z * z.z / s;
                     dr = 2.0 * r * dr + 1.0;
                     z = vec3(k * (z.x * z.x - z.y * z.y), 2.0 * k * z.x * z.y, 2.0 * z.z * sqrt(s)) + p; }
                 return 0.5 * log(r) * r / dr; }",
            bulb,
            1.0,
        ),
        (
            "sponge",
            "float in_cross(vec3 q) { return 1.0 - min(max(q.x, q.y), min(max(q.y, q.z), max(q.z, q.x))); }
             const int LEVELS = 2;
             float field(vec3 p) { vec3 q = p / 1.5; vec3 e = abs(q) - 1.0;
                 float value = max(e.x, max(e.y, e.z)), scale = 1.0;
                 for (int level = 0; level < LEVELS; level++) { vec3 cube = mod(q * scale + 1.0, 2.0) - 1.0;
                     scale *= 3.0; value = max(value, in_cross(abs(3.0 * cube)) / scale); }
                 return value * 1.5; }",
            sponge,
            2.0,
        ),
        (
            "turned by reference, repeated, blended",
            "float smin(float a, float b, float k) { float h = clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0);
                 return mix(b, a, h) - k * h * (1.0 - h); }
             float cube(vec3 p, vec3 b) { vec3 q = abs(p) - b;
                 return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0); }
             void turn(inout vec2 p, float a) { p = cos(a) * p + sin(a) * vec2(p.y, -p.x); }
             float field(vec3 p) { turn(p.xz, 0.3); vec3 c = vec3(1.3, 1.7, 1.1), q = mod(p + 0.5 * c, c) - 0.5 * c;
                 return smin(cube(q, vec3(0.2)), length(p) - 0.7, 0.3); }",
            repeated,
            2.0,
        ),
        (
            "structures, arrays, globals, overloads, macros and every statement",
            "#define SQUARE(x) ((x) * (x))
             struct Part { float d; vec3 at; int id; };
             float least;
             float f(float x) { return x * x; }
             vec2 f(vec2 x) { return 0.5 * x.yx; }
             Part made(vec3 p, float r) { Part h; h.d = length(p) - r; h.at = p; h.id = 1; return h; }
             Part nearer(Part a, Part b) { if (a.d < b.d) return a; return b; }
             void doubled(in float x, out float y, inout float z) { y = 2.0 * x; z += y; }
             float field(vec3 p) { least = 1e9; float w[3] = float[3](0.0, 0.5, 2.0); w[0] = SQUARE(p.x);
                 Part h = nearer(made(p, 0.5), made(p - 1.0, 0.3));
                 for (int i = 0; i < 3; i++) { if (i == 1) continue; least = min(least, w[i] + p.y); }
                 mat2 m = mat2(p.x, 0.5, p.y, 1.0); m[1].x += p.z; vec2 v = m * p.xy; v.yx *= 0.5;
                 float y, z = p.z; doubled(p.y, y, z); int n = 0;
                 do { z *= 0.9; ++n; } while (n < 2);
                 switch (h.id) { case 0: z = 0.0; break; default: z += 0.1 * p.x; }
                 float t = p.x; t++; t -= 2.0; float u = t-- + f(p.y) + f(p.xy).x;
                 return h.d + h.at.z + 0.1 * least + v.x + v.y + y + z + t + u; }",
            |p| {
                let [one, other] = [(p, 0.5), (p - 1.0, 0.3)].map(|(q, r)| (q.length() - r, q.z));
                let (d, at) = if one.0 < other.0 { one } else { other };
                let least = (p.x * p.x + p.y).min(2.0 + p.y);
                let (x, y) = (p.x * p.x + (p.y + p.z) * p.y, 0.5 * p.x + p.y);
                let z = 0.81 * (p.z + 2.0 * p.y) + 0.1 * p.x;
                let u = p.x - 1.0 + p.y * p.y + 0.5 * p.y;
                d + at + 0.1 * least + 0.5 * (x + y) + 2.0 * p.y + z + p.x - 2.0 + u
            },
            2.0,
        ),
    ];
    for (name, text, function, half) in texts {
        let (worst, count) = compared(&context, text, function, half);
        println!("{name}: at most {worst:.1e} at {count} components");
        assert!(count > 2 * POINTS, "{name}: {count}");
    }
}

/// Functions of GLSL of one number, which are smooth between −1 and 1.
const OF_ONE: [OfOne; 30] = [
    ("radians(90.0 * x)", |x| (90.0 * x).to_radians()),
    ("degrees(0.02 * x)", |x| (0.02 * x).to_degrees()),
    ("sin(x)", f64::sin),
    ("cos(x)", f64::cos),
    ("tan(x)", f64::tan),
    ("asin(0.9 * x)", |x| (0.9 * x).asin()),
    ("acos(0.9 * x)", |x| (0.9 * x).acos()),
    ("atan(x)", f64::atan),
    ("atan(x, 2.0 - x)", |x| x.atan2(2.0 - x)),
    ("atan(1.5, x - 2.0)", |x| 1.5f64.atan2(x - 2.0)),
    ("sinh(x)", f64::sinh),
    ("cosh(x)", f64::cosh),
    ("tanh(x)", f64::tanh),
    ("asinh(x)", f64::asinh),
    ("acosh(2.5 + x)", |x| (2.5 + x).acosh()),
    ("atanh(0.9 * x)", |x| (0.9 * x).atanh()),
    ("pow(2.0 + x, 1.5)", |x| (2.0 + x).powf(1.5)),
    ("pow(1.5, x)", |x| 1.5f64.powf(x)),
    ("pow(2.0 + x, x)", |x| (2.0 + x).powf(x)),
    ("exp(x)", f64::exp),
    ("exp2(x)", f64::exp2),
    ("log(2.0 + x)", |x| (2.0 + x).ln()),
    ("log2(2.0 + x)", |x| (2.0 + x).log2()),
    ("sqrt(2.0 + x)", |x| (2.0 + x).sqrt()),
    ("inversesqrt(2.0 + x)", |x| 1.0 / (2.0 + x).sqrt()),
    ("abs(x) + sign(x) + floor(x) + ceil(x)", |x| {
        x.abs() + x.signum() + x.floor() + x.ceil()
    }),
    ("fract(1.7 * x) + trunc(x) + round(x) + roundEven(x)", |x| {
        1.7 * x - (1.7 * x).floor() + x.trunc() + x.round() + x.round_ties_even()
    }),
    ("mod(3.0 * x, 1.3 + 0.1 * x)", |x| {
        (3.0 * x).rem_euclid(1.3 + 0.1 * x)
    }),
    ("smoothstep(-0.8, 0.9, x)", |x| {
        let t = ((x + 0.8) / 1.7).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }),
    ("smoothstep(0.2 * x - 1.0, 1.0 + x * x, 0.3)", |x| {
        let (least, most) = (0.2 * x - 1.0, 1.0 + x * x);
        let t = ((0.3 - least) / (most - least)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }),
];

/// Functions of GLSL of vectors and matrices, evaluated within 1 m of the origin.
const OF_MORE: [(&str, Function); 26] = [
    ("min(p.x, 0.3) + min(p.y, p.z) + min(0.1, p.z)", |p| {
        p.x.min(0.3) + p.y.min(p.z) + p.z.min(0.1)
    }),
    ("max(p.x, 0.3) + max(p, 0.2).y + max(p, p.zxy).x", |p| {
        p.x.max(0.3) + p.y.max(0.2) + p.x.max(p.z)
    }),
    (
        "clamp(p.x, -0.5, 0.5) + clamp(p.y, 0.2 * p.z - 1.5, 1.5)",
        |p| p.x.clamp(-0.5, 0.5) + p.y.clamp(0.2 * p.z - 1.5, 1.5),
    ),
    ("mix(p.x, p.y, p.z) + mix(p, p.yzx, 0.3).z", |p| {
        mix(p.x, p.y, p.z) + mix(p.z, p.x, 0.3)
    }),
    (
        "mix(p, p.yzx, lessThan(p, vec3(0.1))).x + step(0.3, p.x)",
        |p| (if p.x < 0.1 { p.y } else { p.x }) + f64::from(u8::from(p.x >= 0.3)),
    ),
    ("length(p) + length(p.xz) + length(p.y - 3.0)", |p| {
        p.length() + p.x.hypot(p.z) + (p.y - 3.0).abs()
    }),
    ("distance(p, p.zyx * 0.5) + distance(p.x, 4.0 + p.y)", |p| {
        p.distance(0.5 * DVec3::new(p.z, p.y, p.x)) + (p.x - 4.0 - p.y).abs()
    }),
    ("dot(p, p.yzx)", |p| p.dot(DVec3::new(p.y, p.z, p.x))),
    ("cross(p, p.zyx + 1.0).y", |p| {
        p.cross(DVec3::new(p.z, p.y, p.x) + 1.0).y
    }),
    ("normalize(p + 2.0).x + normalize(vec4(p, 1.5)).w", |p| {
        (p + 2.0).normalize().x + 1.5 / (p.length_squared() + 2.25).sqrt()
    }),
    ("reflect(p, normalize(p.yzx + 2.0)).z", |p| {
        let n = (DVec3::new(p.y, p.z, p.x) + 2.0).normalize();
        (p - 2.0 * n.dot(p) * n).z
    }),
    (
        "refract(normalize(p + 3.0), normalize(-p.yzx - 2.0), 0.8 + 0.1 * p.x).y",
        |p| {
            let (i, eta) = ((p + 3.0).normalize(), 0.8 + 0.1 * p.x);
            let n = (-DVec3::new(p.y, p.z, p.x) - 2.0).normalize();
            let k = 1.0 - eta * eta * (1.0 - n.dot(i).powi(2));
            (eta * i - (eta * n.dot(i) + k.sqrt()) * n).y
        },
    ),
    (
        "faceforward(p, vec3(1.0), vec3(-1.0)).x + faceforward(p, p, vec3(2.0, 0.0, 0.0)).y",
        |p| p.x + if p.x < 0.0 { p.y } else { -p.y },
    ),
    ("determinant(mat2(p.x, 1.0, p.y, p.z))", |p| p.x * p.z - p.y),
    (
        "determinant(mat3(p, p.yzx + 1.0, vec3(1.0, p.y, 2.0)))",
        |p| {
            p.cross(DVec3::new(p.y, p.z, p.x) + 1.0)
                .dot(DVec3::new(1.0, p.y, 2.0))
        },
    ),
    (
        "determinant(mat4(p.x, 0, 0, 1, 0, 2, 0, p.y, 0, 0, 3, 0, p.z, 0, 0, 1))",
        |p| 6.0 * (p.x - p.z),
    ),
    ("inverse(mat2(3.0 + p.x, p.y, p.z, 2.0))[0].y", |p| {
        -p.y / (2.0 * (3.0 + p.x) - p.y * p.z)
    }),
    ("(transpose(mat2x3(p, p.zxy)) * p).y", |p| {
        DVec3::new(p.z, p.x, p.y).dot(p)
    }),
    ("outerProduct(p.xy, p)[2].x", |p| p.x * p.z),
    (
        "matrixCompMult(mat2(p.xy, p.yz), mat2(p.yz, p.zx))[1].x",
        |p| p.y * p.z,
    ),
    (
        "(mat2(p.x, p.y, p.z, 1.0) * mat2(1.0, p.y, 2.0, p.z))[1].y",
        |p| 2.0 * p.y + p.z,
    ),
    (
        "(p.xy * mat2(p.x, p.y, p.z, 1.0)).x + (mat2(p.x) * p.yz).y",
        |p| p.x * p.x + p.y * p.y + p.x * p.z,
    ),
    (
        "(1.0 / (p + 3.0)).x + (p / 2.0).y + (p / (p.yzx + 3.0)).z",
        |p| 1.0 / (p.x + 3.0) + p.y / 2.0 + p.z / (p.x + 3.0),
    ),
    (
        "(2.0 - p.xyz).x - (p.y - p).z + (-p).y + (mat2(p.x) - 1.0)[0].x",
        |p| 2.0 - p.x - (p.y - p.z) - p.y + p.x - 1.0,
    ),
    (
        "vec4(p.xy, vec2(0.5)).y * mat3(2.0)[1].y + vec3(p.x).z + float(p)",
        |p| 2.0 * p.y + 2.0 * p.x,
    ),
    (
        "any(lessThan(p, vec3(-0.5))) || isnan(p.x) || all(equal(p, p.yzx)) ? p.y : float(int(p.z * 3.0)) + p.z",
        |p| match p.min_element() < -0.5 {
            true => p.y,
            false => (p.z * 3.0).trunc() + p.z,
        },
    ),
];

/// Protects the differentiation rule of every function and operator of GLSL that a text can use: the derivative agrees
/// with that of the function.
#[test]
fn every_function_of_glsl_has_its_derivative() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    let field = |body: &str| format!("float field(vec3 p) {{ {body} }}");
    for (call, function) in OF_ONE {
        let text = field(&format!("float x = p.x; return {call};"));
        let along = |p: DVec3| p.x;
        let (worst, count) = compared_with(&context, &text, &|p| function(along(p)), 1.0);
        println!("{call}: at most {worst:.1e} at {count}");
        assert!(count > 2 * POINTS, "{call}: {count}");
        // The same function of a vector, compared in one component, if all arguments are vectors.
        let vector = call.replace('x', "v").replace("evp", "exp");
        if !vector.contains(',') {
            let text = field(&format!("vec3 v = p.zxy; return ({vector}).y;"));
            compared_with(&context, &text, &|p| function(along(p)), 1.0);
        }
    }
    for (call, function) in OF_MORE {
        let text = field(&format!("return {call};"));
        let (worst, count) = compared(&context, &text, function, 1.0);
        println!("{call}: at most {worst:.1e} at {count}");
        assert!(count > 2 * POINTS, "{call}: {count}");
    }
}

/// Protects tips and edges. Where a text has no derivative, the computed derivative is finite and is that of one side.
#[test]
fn poles_have_the_derivative_of_a_side() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    let origin = [Vec3::ZERO];
    for (value, least, most) in [
        ("length(p)", 0.99, 1.01),
        ("distance(p, vec3(0.0))", 0.99, 1.01),
        ("0.8 * length(p.xz) + 0.6 * p.y", 0.99, 1.01),
        ("abs(p.x)", 1.0, 1.0),
        ("max(p.x, 0.0) + min(p.x, 0.0)", 1.0, 1.0),
        // On a face of a cube the derivative counts once, and not for the outside and the inside together.
        (
            "length(max(vec3(p.x, -1.0, -1.0), 0.0)) + min(p.x, 0.0)",
            1.0,
            1.0,
        ),
        ("sqrt(max(p.x - 1.0, 0.0)) + p.y", 1.0, 1.0),
        ("pow(max(p.x, 0.0), 0.5) + p.y", 1.0, 1.0),
        ("atan(p.y, p.x) * 0.0 + p.z", 1.0, 1.0),
        ("dot(normalize(p), vec3(0.0)) + p.z", 1.0, 1.0),
        ("acos(clamp(1.0 + p.x, -1.0, 1.0)) * 0.0 + p.z", 1.0, 1.0),
    ] {
        let text = format!("float field(vec3 p) {{ return {value}; }}");
        let field = UserField::new("pole.glsl", text, Vec3::splat(2.0), 1.0);
        let text = shader::join(&shader::user_sources(&field, CheckedGradient::Derived));
        // The comparison of the values is removed, because the value of normalize(0) is not a number.
        let text = text.replace("abs(off) <= ", "true || abs(off) <= ");
        let program = Program::fragment(&context, "a pole", &text).unwrap();
        let probe = Probe {
            context: &context,
            program,
            field: &field,
            waves: WaveDomain::BothSides,
        };
        let found = probe.gradients(&origin).unwrap()[0].length();
        assert!((least..=most).contains(&found), "{value}: {found}");
    }
}

/// Protects waves from a wrong gradient. A text whose values grow in steps has a derivative of 0. The comparison with
/// differences finds this, and gradients are then computed from differences.
#[test]
fn a_derivative_that_is_none_is_not_used() {
    let context = Context::headless(&ContextOptions::default()).unwrap();
    for (value, agrees) in [
        ("length(p) - 1.0", Some(true)),
        ("float(int(65536.0 * p.x)) / 65536.0", Some(false)),
        ("length(round(p * 16384.0) / 16384.0) - 1.0", Some(false)),
        ("uintBitsToFloat(floatBitsToUint(p.x))", None),
    ] {
        let text = format!("float field(vec3 p) {{ return {value}; }}");
        let field = UserField::new("steps.glsl", text, Vec3::splat(3.0), 2.0);
        assert_eq!(field.is_differentiated(), agrees.is_some(), "{value}");
        check(&context, &field, WaveDomain::Air).unwrap();
        assert_eq!(field.derivative_agrees(), agrees, "{value}");
        assert_eq!(field.is_differentiated(), agrees == Some(true), "{value}");
    }
}
