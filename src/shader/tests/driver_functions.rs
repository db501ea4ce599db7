//! Tests that results do not depend on parts of GLSL whose precision the driver chooses.

use crate::gl::{Context, Program, RenderTarget, Texture, full_screen_pass};
use crate::shader::text::{library, link};
use crate::shader::{Source, StartOrderText, first_sum_text, join, pan_text};
use crate::test_common::for_each_api;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

/// Functions whose error GLSL does not bound, or bounds loosely (GLSL 4.60, section 4.7.1).
const INEXACT: [&str; 13] = [
    "sin(", "cos(", "tan(", "asin(", "acos(", "atan(", "sinh(", "cosh(", "pow(", "exp(", "log(",
    "exp2(", "log2(",
];

fn each_file(folder: &Path, visit: &mut dyn FnMut(&Path, &str)) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => each_file(&path, visit),
            false => visit(&path, &fs::read_to_string(&path).unwrap()),
        }
    }
}

/// Protects waves from the driver's inexact functions such as sine, whose errors reach 2e-4 on some drivers. Pictures
/// may use these functions.
#[test]
fn no_wave_rests_on_an_inexact_function() {
    let glsl = Path::new(env!("CARGO_MANIFEST_DIR")).join("glsl");
    let mut files = 0;
    each_file(&glsl, &mut |path, text| {
        if path.starts_with(glsl.join("view")) {
            return;
        }
        files += 1;
        let code = text.lines().map(|line| line.split("//").next().unwrap());
        for (number, line) in code.enumerate() {
            let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let calls = |name: &&&str| {
                let mut places = line.match_indices(**name);
                places.any(|(at, _)| !line[..at].ends_with(is_name))
            };
            let called = INEXACT.iter().find(calls);
            assert_eq!(called, None, "{}:{}", path.display(), number + 1);
        }
    });
    assert!(files > 50, "{files}");
}

/// Evaluates `expression`, which contains `float value`, for each value. Each result is one texel.
fn asked(context: &Context, expression: &str, values: &[f32]) -> Vec<[f32; 4]> {
    let root = format!(
        "uniform highp sampler2D uValues;\nlayout(location = 0) out vec4 outAnswer;\n\
         void main() {{\n    \
         float value = texelFetch(uValues, ivec2(gl_FragCoord.xy), 0).x;\n    \
         outAnswer = vec4({expression}, 0.0, 0.0);\n}}\n"
    );
    let text = join(&link(vec![Source::new("ask", root)], library()));
    let program = Program::fragment(context, "ask", &text).unwrap();
    let width = values.len() as u32;
    let [given, answers] = [(); 2].map(|()| Texture::new(context, width, 1).unwrap());
    let texels: Vec<f32> = values.iter().flat_map(|&v| [v, 0.0, 0.0, 0.0]).collect();
    given.upload(&texels).unwrap();
    program.set_texture("uValues", 0, &given);
    let target = RenderTarget::new(context, &[&answers]).unwrap();
    full_screen_pass(context, &program, &target, width, 1).unwrap();
    target.read(0).unwrap().as_chunks::<4>().0.to_vec()
}

/// Protects start directions, twists and bends: the error of cosine and sine is at most three roundings of 1 (of the
/// angle, the polynomial, and its last sum), plus the rounding of the angle beyond one turn.
#[test]
fn cosine_and_sine_are_right_on_every_driver() {
    const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
    let shares: Vec<f32> = (0..4096)
        .map(|i| ((i * 4099) % 16_777_216) as f32 / 16_777_216.0)
        .chain([0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875])
        .chain([1.0 - f32::EPSILON / 2.0])
        .collect();
    let angles: Vec<f32> = (-2048..2048)
        .map(|i| i as f32 * 0.37 + 1e-3 * (i as f32).powi(2) * (i as f32).signum())
        .collect();
    assert!(angles.iter().all(|angle| angle.abs() < 16_384.0 * 1.57));
    for_each_api(|context| {
        let off = |[cosine, sine, ..]: [f32; 4], angle: f64| {
            let cosine = (f64::from(cosine) - angle.cos()).abs();
            cosine.max((f64::from(sine) - angle.sin()).abs())
        };
        let answers = asked(context, "cosineSineOfTurn(value)", &shares);
        for (&share, answer) in shares.iter().zip(answers) {
            let off = off(answer, TAU * f64::from(share));
            assert!(off <= 3.0 * ROUNDING, "{share}: {off:e}");
        }
        let answers = asked(context, "cosineSine(value)", &angles);
        for (&angle, answer) in angles.iter().zip(answers) {
            let off = off(answer, f64::from(angle));
            let bound = 3.0 + f64::from(angle.abs()) * 0.01;
            assert!(off <= bound * ROUNDING, "{angle}: {off:e}");
        }
    });
}

/// Protects reports from invalid waves, which a faulty driver may cause: they are counted, and contribute to neither
/// ear, on the GPU and on the CPU.
#[test]
fn waves_that_are_not_finite_are_counted() {
    let nan = f32::NAN;
    // Each wave has its origin and status, and its direction and counters. The waves are heard, dead, travelling, and
    // five invalid ones.
    let waves = [
        ([0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 1.0, 3.0]),
        ([0.0, 0.0, 0.0, -1.0], [0.0, 0.0, 0.0, 0.0]),
        ([5.0, 0.0, 0.0, 2.0], [1.0, 0.0, 0.0, 0.0]),
        ([nan, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        ([0.0, 0.0, 1.0, nan], [1.0, 0.0, 0.0, 0.0]),
        ([0.0, 0.0, 1.0, 0.0], [1.0, nan, 0.0, 0.0]),
        ([0.0, f32::INFINITY, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        ([0.0, 0.0, 1.0, 3.0], [f32::NEG_INFINITY, 0.0, 0.0, 0.0]),
    ];
    for_each_api(|context| {
        let count = waves.len() as u32;
        let texture = || Texture::new(context, count, 1).unwrap();
        let [origins, directions, contributions, heard, passes] = [(); 5].map(|()| texture());
        origins.upload(&waves.map(|wave| wave.0).concat()).unwrap();
        directions
            .upload(&waves.map(|wave| wave.1).concat())
            .unwrap();
        let pan = Program::fragment(context, "pan", &pan_text(StartOrderText::ByNumber)).unwrap();
        pan.set_texture("uOrigins", 0, &origins);
        pan.set_texture("uDirections", 1, &directions);
        pan.set_vec4("uListener", glam::Vec4::new(0.0, 0.0, 0.0, 1.0));
        pan.set_vec3("uListenerRight", glam::Vec3::X);
        let target = RenderTarget::new(context, &[&contributions]).unwrap();
        full_screen_pass(context, &pan, &target, count, 1).unwrap();
        let statuses: Vec<f32> = target
            .read(0)
            .unwrap()
            .as_chunks::<4>()
            .0
            .iter()
            .map(|t| t[2])
            .collect();
        assert_eq!(statuses, [0.0, -1.0, 2.0, -2.0, -2.0, -2.0, -2.0, -2.0]);

        let sum = Program::fragment(context, "sum", &first_sum_text()).unwrap();
        sum.set_texture("uContributions", 0, &contributions);
        sum.set_u32("uWaveCount", count);
        sum.set_u32("uGridWidth", count);
        sum.set_i32("uBlock", 8);
        let target = RenderTarget::new(context, &[&heard, &passes]).unwrap();
        full_screen_pass(context, &sum, &target, 1, 1).unwrap();
        assert_eq!(target.read(0).unwrap()[..4], [0.5, 0.5, 1.0, 1.0]);
        assert_eq!(target.read(1).unwrap()[..4], [3.0, 0.0, 3.0, 5.0]);
    });
}
