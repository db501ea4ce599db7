//! The values that an error message recommends are accepted.

use super::{refusal, scene, settings};
use crate::common::for_each_api;
use echomarch::gl::Context;
use echomarch::scene::UserField;
use echomarch::{Profile, Tracer};
use glam::Vec3;
use std::sync::Arc;

const BULB: &str = "float field(vec3 p) {
    vec3 z = p;
    float grown = 1.0, r = length(z);
    for (int turn = 0; turn < TURNS && r < 2.0; ++turn) {
        float tilt = 8.0 * acos(z.z / r), round = 8.0 * atan(z.y, z.x);
        grown = 8.0 * pow(r, 7.0) * grown + 1.0;
        z = pow(r, 8.0) * vec3(sin(tilt) * cos(round), sin(tilt) * sin(round), cos(tilt)) + p;
        r = length(z);
    }
    return 0.5 * log(r) * r / grown;
}";

const COLUMNS: &str = "float field(vec3 p) {
    vec2 q = mod(p.xz + 0.5, 1.0) - 0.5;
    vec2 out_ = normalize(q);
    return 1.7 * (dot(q, out_) - 0.12 - 0.02 * cos(8.0 * atan(out_.y, out_.x)));
}";

const GROUND: &str = "float hash(vec2 i) { return fract(sin(dot(i, vec2(41.3, 289.1))) * 1234.5); }
float noise(vec2 p) {
    vec2 i = floor(p), f = p - i;
    f = f * f * (3.0 - 2.0 * f);
    vec2 e = vec2(1.0, 0.0);
    return mix(mix(hash(i), hash(i + e.xy), f.x), mix(hash(i + e.yx), hash(i + e.xx), f.x), f.y);
}
float field(vec3 p) {
    float h = 0.0, a = 0.6;
    vec2 q = p.xz;
    for (int i = 0; i < 5; ++i) { h += a * noise(q); a *= 0.45; q = 2.0 * q + 3.0; }
    return p.y - h;
}";

const GYROID: &str = "float field(vec3 p) {
    vec3 q = 2.0 * p;
    return abs(dot(sin(q), cos(q.yzx))) - 0.4;
}";

const HEART: &str = "float field(vec3 p) {
    vec3 q = p * p;
    float a = q.x + 2.25 * q.z + q.y - 1.0;
    return 0.2 * (a * a * a - (q.x + 0.1125 * q.z) * p.y * q.y);
}";

const JULIA: &str = "float field(vec3 p) {
    vec4 z = vec4(p, 0.0), c = vec4(-0.2, 0.6, 0.2, 0.2);
    float grown = 1.0;
    for (int i = 0; i < 8; ++i) {
        grown *= 2.0 * length(z);
        z = vec4(z.x * z.x - dot(z.yzw, z.yzw), 2.0 * z.x * z.yzw) + c;
        if (dot(z, z) > 16.0) break;
    }
    float r = length(z);
    return 0.5 * r * log(r) / grown;
}";

fn texts() -> Vec<(String, f32)> {
    let bulb = |turns: &str| (format!("#define TURNS {turns}\n{BULB}"), 2.4);
    let mut all = vec![bulb("4"), bulb("6"), bulb("8")];
    let others = [
        (COLUMNS, 4.0),
        (GROUND, 8.0),
        (GYROID, 5.0),
        (HEART, 3.0),
        (JULIA, 3.0),
    ];
    all.extend(others.map(|(text, size)| (text.to_owned(), size)));
    if let Ok(menger) = std::fs::read_to_string("examples/scenes/menger.glsl") {
        // A field that is twice as steep.
        let menger = menger.replace("float field(", "float single(");
        let twice = format!("{menger}\nfloat field(vec3 p) {{ return 2.0 * single(p); }}\n");
        all.push((twice, 4.2));
    }
    all
}

fn field(text: &str, size: f32, lipschitz: f32, bend: Option<f32>) -> UserField {
    let mut field = UserField::new("my.glsl", text.to_owned(), Vec3::splat(size), lipschitz);
    field.bend = bend;
    field
}

fn sentence(context: &Context, field: UserField) -> Option<String> {
    let scene = scene(&[Arc::new(field)]);
    let mut tracer = Tracer::new(context).unwrap();
    let checked = tracer.check(&scene, &settings(Profile::Hybrid));
    checked.err().map(|error| error.to_string())
}

/// The number after `state at least` in a message.
fn advised(sentence: &str) -> Option<f32> {
    sentence.split("state at least ").nth(1)?.parse().ok()
}

/// Protects users from trial and error: the recommended constant is accepted, and nine tenths of it are rejected. An
/// earlier version recommended at least 95 for a Mandelbulb for which 3 is sufficient.
#[test]
fn the_advised_growth_is_accepted() {
    for_each_api(|context| {
        for (text, size) in texts() {
            let refused = sentence(context, field(&text, size, 1.0, None));
            let refused = refused.unwrap_or_else(|| panic!("accepted with 1: {text}"));
            let advice = advised(&refused).unwrap_or_else(|| panic!("{refused}: {text}"));
            let less = sentence(context, field(&text, size, 0.9 * advice, None));
            println!("{refused}");
            assert!(less.is_some(), "more than needed: {refused}");
            let checked = sentence(context, field(&text, size, advice, None));
            assert_eq!(checked, None, "{text}");
        }
    });
}

/// Protects marches that use second derivatives from a stated bend that is too small. The error is found, and the
/// recommended bend is accepted and close to the true value.
#[test]
fn the_advised_bend_is_accepted() {
    // The maximum of -f'' where waves can be: 0 for the sphere, 1.2 for the sine waves, 1 for the hollow sphere.
    let known = [
        ("float field(vec3 p) { return length(p) - 1.0; }", 1.0, 0.0),
        (
            "float field(vec3 p) { return p.y - 0.3 * sin(2.0 * p.x); }",
            1.2,
            1.2,
        ),
        (
            "float field(vec3 p) { return 1.2 - 0.5 * dot(p, p); }",
            4.0,
            1.0,
        ),
    ];
    for_each_api(|context| {
        for (text, lipschitz, truth) in known {
            let of = |bend| field(text, 4.0, lipschitz, Some(bend));
            assert_eq!(sentence(context, of(1.02 * truth)), None, "{text}");
            if truth == 0.0 {
                continue;
            }
            let refused = sentence(context, of(0.9 * truth)).unwrap();
            assert!(
                refused.contains("more than the stated bend of"),
                "{refused}"
            );
            let advice = advised(&refused).unwrap();
            assert!((0.98 * truth..1.15 * truth).contains(&advice), "{refused}");
            assert_eq!(sentence(context, of(advice)), None, "{text}");
        }
        let refused = sentence(context, field(GYROID, 5.0, 4.0, Some(0.0))).unwrap();
        let advice = advised(&refused).unwrap();
        assert_eq!(
            sentence(context, field(GYROID, 5.0, 4.0, Some(advice))),
            None
        );
    });
}

/// Protects waves in the air between two solids, where the value of a union has an edge and has no finite bend. An edge
/// in the solid does not affect waves.
#[test]
fn an_edge_in_the_air_has_no_bend() {
    let two = "float field(vec3 p) { return length(vec3(abs(p.x) - 0.8, p.yz)) - 0.4; }";
    let hollow = "float field(vec3 p) { return max(length(p) - 1.0, abs(p.y) - 0.5); }";
    for_each_api(|context| {
        for bend in [0.0, 50.0] {
            let refused = sentence(context, field(two, 4.0, 1.0, Some(bend))).unwrap();
            assert!(refused.contains("leave bend out"), "{refused}");
        }
        assert_eq!(sentence(context, field(hollow, 4.0, 1.0, Some(0.0))), None);
        let text = "float field(vec3 p) { return 2.0 * (length(p) - 1.0); }";
        assert!(refusal(context, text, 1.0).contains("state at least 2.0"));
    });
}
