//! Normals of users' fields: by differences, by differentiation of the text, and by a stated gradient.

use super::{BALL, refusal, scene, settings, user};
use crate::common::{context, for_each_api};
use echomarch::gl::Api;
use echomarch::scene::shape::User;
use echomarch::scene::{Node, UserField};
use echomarch::{Listener, Profile, Scene, Settings, Source, Surface, Tracer};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A smooth surface about `centre`, as a user's field.
struct Smooth {
    name: &'static str,
    value: String,
    gradient: String,
    box_size: f32,
    centre: Vec3,
    /// Length in metres that determines the distance of the source.
    size: f32,
    /// Normal at a point relative to `centre`.
    normal: fn(DVec3) -> DVec3,
    /// Maximum error of a reflected direction: with differences, and with a derived or stated gradient.
    most: [f64; 2],
}

/// Converts the point of a field's text to bits and back. The text then has no derivative, and its gradients are
/// computed by differences.
fn opaque(text: &str) -> String {
    let start = text.find('{').unwrap() + 1;
    let (head, rest) = text.split_at(start);
    format!("{head} p = uintBitsToFloat(floatBitsToUint(p));{rest}")
}

fn smooth_surfaces() -> Vec<Smooth> {
    let ball = |name, radius: f32, box_size: f32, centre: Vec3, most| {
        let [x, y, z] = centre.to_array();
        let from = format!("(p - vec3({x:?}, {y:?}, {z:?}))");
        Smooth {
            name,
            value: format!("length({from}) - {radius:?}"),
            gradient: format!("normalize({from})"),
            box_size,
            centre,
            size: radius,
            normal: |p| p.normalize(),
            most,
        }
    };
    let torus = |name, box_size| Smooth {
        name,
        value: "length(vec2(length(p.xz) - 1.2, p.y)) - 0.4".into(),
        gradient:
            "normalize(vec3(p.x - 1.2 * p.x / length(p.xz), p.y, p.z - 1.2 * p.z / length(p.xz)))"
                .into(),
        box_size,
        centre: Vec3::ZERO,
        size: 1.6,
        normal: |p| {
            let ring = DVec3::new(p.x, 0.0, p.z).normalize() * 1.2;
            (p - ring).normalize()
        },
        // The hit of a wave has an error of 5e-7 m in each coordinate, and the radius of the tube is 0.4 m.
        most: [4e-5, 4e-6],
    };
    let away = Vec3::new(10.0, -4.0, 8.0);
    vec![
        ball("ball", 1.0, 4.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("ball, large box", 1.0, 100.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("small ball", 0.1, 10.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("large ball", 50.0, 120.0, Vec3::ZERO, [1e-5, 1e-6]),
        // A position there has an error of 1e-6 m, and so has the direction from the centre.
        ball("ball away", 1.0, 40.0, away, [1e-5, 4e-6]),
        torus("torus", 4.0),
        torus("torus, large box", 100.0),
    ]
}

/// Protects normals of users' fields from depending on the size of the box, the unit of the value or the scale of the
/// surface. With a stated gradient, they are as accurate as those of a built-in sphere.
#[test]
fn normals_do_not_depend_on_the_box() {
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for surface in smooth_surfaces() {
        let (value, gradient) = (&surface.value, &surface.gradient);
        let values = format!("float field(vec3 p) {{ return {value}; }}\n");
        let stated = format!("{values}vec3 fieldGradient(vec3 p) {{ return {gradient}; }}\n");
        let [differences, exact] = surface.most;
        let texts = [
            (opaque(&values), differences),
            (values, exact),
            (stated, exact),
        ];
        for (text, most) in texts {
            let worst = worst_direction(&mut tracer, &surface, &text);
            println!("{}, at most {most:e}: {worst:.2e}", surface.name);
            assert!(worst < most, "{}: {worst:e}, not {most:e}", surface.name);
        }
    }
}

/// Returns the maximum error of the reflected directions in both profiles.
fn worst_direction(tracer: &mut Tracer, surface: &Smooth, text: &str) -> f64 {
    let box_size = Vec3::splat(surface.box_size);
    let field = UserField::new("smooth.glsl", text.to_owned(), box_size, 1.0);
    let node = Node::User(User {
        field: Arc::new(field),
    });
    let size = surface.size;
    let scene = Scene::new(
        surface.name,
        vec![Surface::new(node).at(-surface.centre)],
        Source::at(Vec3::new(-4.0, 1.0, 0.5) * size),
        Listener::at(Vec3::new(6.0, 3.0, 0.0) * size, size),
    );
    let mut worst: f64 = 0.0;
    for profile in [Profile::Hybrid, Profile::March] {
        let settings = Settings::new(profile).with_waves(16_384).with_iterations(1);
        let (_, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
        let met: Vec<_> = waves.iter().filter(|wave| wave.status == 1.0).collect();
        assert!(met.len() > 100, "{profile}: {} waves hit it", met.len());
        for wave in met {
            let normal = (surface.normal)(wave.position.as_dvec3());
            let d = wave.start_direction.as_dvec3();
            let mirrored = d - 2.0 * d.dot(normal) * normal;
            worst = worst.max(mirrored.distance(wave.direction.as_dvec3()));
        }
    }
    worst
}

/// Protects waves from a stated gradient that is not that of the value. The gradient is rejected, and the message
/// contains the position and both gradients.
#[test]
fn a_stated_gradient_that_is_none_is_refused() {
    let ball = |gradient: &str| {
        format!("{BALL}vec3 fieldGradient(vec3 p) {{\n    return {gradient};\n}}\n")
    };
    let context = context(Api::Gl);
    for gradient in [
        "-normalize(p)",
        "2.0 * normalize(p)",
        "normalize(p.yxz)",
        "normalize(p * vec3(1.0, 1.1, 1.0))",
        "p",
        "vec3(0.0)",
        // A gradient that is wrong on one side only, and a gradient that is wrong near one point only.
        "p.x > 0.0 ? normalize(p) : vec3(-1.0, 0.0, 0.0)",
        "normalize(p) * (distance(p, vec3(0.6, 0.0, 0.8)) < 0.3 ? 0.9 : 1.0)",
        "normalize(p) / 0.0",
        "sqrt(-1.0 - abs(p))",
    ] {
        let sentence = refusal(&context, &ball(gradient), 1.0);
        assert!(
            sentence.starts_with("my.glsl: fieldGradient is (")
                && sentence.contains("where the value grows by ("),
            "{gradient}: {sentence}"
        );
    }
    let sentence = refusal(&context, &ball("foo"), 1.0);
    assert!(sentence.starts_with("my.glsl:5: "), "{sentence}");
    let sentence = refusal(&context, &ball("gl_FragCoord.xyz"), 1.0);
    assert!(sentence.contains("'gl_FragCoord'"), "{sentence}");
}

/// Protects correct gradients from being rejected where differences cannot decide: at edges and ridges, for values with
/// large rounding errors, and where the gradient is undefined.
#[test]
fn a_right_gradient_is_taken() {
    let honest = [
        // Edges of a cube, seen from the inside and the outside.
        (
            "float field(vec3 p) { vec3 q = abs(p); return max(q.x, max(q.y, q.z)) - 1.0; }
            vec3 fieldGradient(vec3 p) {
                vec3 q = abs(p);
                float most = max(q.x, max(q.y, q.z));
                return q.x == most ? vec3(sign(p.x), 0, 0)
                    : q.y == most ? vec3(0, sign(p.y), 0) : vec3(0, 0, sign(p.z));
            }",
            1.0,
        ),
        // A cone, whose gradient is undefined on the axis.
        (
            "float field(vec3 p) { return 0.8 * length(p.xz) + 0.6 * (p.y - 1.0); }
            vec3 fieldGradient(vec3 p) {
                return vec3(0.8 * p.x / length(p.xz), 0.6, 0.8 * p.z / length(p.xz));
            }",
            1.0,
        ),
        // A ripple of 6 cm.
        (
            "float field(vec3 p) { return 0.8 * p.y + 0.005 * sin(100.0 * p.x); }
            vec3 fieldGradient(vec3 p) { return vec3(0.5 * cos(100.0 * p.x), 0.8, 0); }",
            1.0,
        ),
        // Values that are rounded to a micrometre.
        (
            "float field(vec3 p) { return (length(p) + 10.0) - 11.0; }
            vec3 fieldGradient(vec3 p) { return normalize(p); }",
            1.01,
        ),
        // Values in units of a third of a millimetre.
        (
            "float field(vec3 p) { return 3000.0 * (length(p) - 1.0); }
            vec3 fieldGradient(vec3 p) { return 3000.0 * normalize(p); }",
            3000.0,
        ),
    ];
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for (text, lipschitz) in honest {
            let scene = scene(&[user(text, lipschitz)]);
            let checked = tracer.check(&scene, &settings(Profile::Hybrid));
            assert!(checked.is_ok(), "{text}: {checked:?}");
        }
        // Two of these fields in one scene, together with a field without a stated gradient.
        let fields = honest.map(|(text, lipschitz)| user(text, lipschitz));
        let both = scene(&[fields[0].clone(), fields[1].clone(), user(BALL, 1.0)]);
        for profile in Profile::ALL {
            tracer.frame(&both, &settings(profile)).unwrap();
        }
    });
}

/// Protects a wave that is aimed at the tip of a cone, where the stated gradient is 0 divided by 0.
#[test]
fn a_wave_that_meets_a_tip_is_mirrored() {
    let text = "float field(vec3 p) { return 0.8 * length(p.xz) + 0.6 * (p.y - 1.0); }
        vec3 fieldGradient(vec3 p) {
            return vec3(0.8 * p.x / length(p.xz), 0.6, 0.8 * p.z / length(p.xz));
        }";
    let mut scene = scene(&[user(text, 1.0)]);
    scene.surfaces[1].position = Vec3::ZERO;
    scene.sources[0] = Source::at(Vec3::new(0.0, 4.0, 0.0));
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for profile in [Profile::Hybrid, Profile::March] {
        let settings = Settings::new(profile).with_iterations(1);
        let states = tracer
            .trace_directions(&scene, &settings, &[Vec3::NEG_Y])
            .unwrap();
        let end = &states[1][0];
        assert_eq!(end.status, 2.0, "{profile}: {end:?}");
        assert!(end.position.distance(Vec3::Y) < 1e-5, "{profile}: {end:?}");
        // One of the cone's sides reflects the wave, so its direction changes.
        let expected = -1.0 + 2.0 * 0.6 * 0.6;
        assert!(
            (end.direction.y - expected).abs() < 1e-4,
            "{profile}: {end:?}"
        );
    }
}

/// Maximum error of a direction reflected by the sheets of a gyroid, with normals by differences. It is the rounding
/// error of the text's numbers over the narrowest step, near the faces of the box.
const GYROID_MOST: f64 = 4e-4;

/// The same error with normals from the derivative. It is the rounding error of the hit on the curved surface.
const GYROID_DERIVED_MOST: f64 = 1e-5;

/// Protects normals by differences from steps that agree by accident. Near a face of the box, one-sided differences
/// alone would cause an error of 2e-3 rad.
#[test]
fn no_face_of_the_box_spoils_a_normal() {
    let text = "float field(vec3 p) {
        vec3 q = 1.3 * p;
        return (abs(dot(sin(q), cos(q.yzx))) - 0.35) / 1.3;
    }";
    for (text, most) in [
        (opaque(text), GYROID_MOST),
        (text.to_owned(), GYROID_DERIVED_MOST),
    ] {
        no_normal_is_off(text, most);
    }
}

/// Compares the reflections by the sheets of a gyroid with reflections by the exact normals.
fn no_normal_is_off(text: String, most: f64) {
    const TIMES: f64 = 1.3;
    let size = Vec3::new(12.0, 7.0, 12.0);
    let normal = |p: DVec3| {
        let q = TIMES * p;
        let (s, c) = (q.map(f64::sin), q.map(f64::cos));
        let value = s.dot(DVec3::new(c.y, c.z, c.x));
        let by = DVec3::new(
            c.x * c.y - s.z * s.x,
            c.y * c.z - s.x * s.y,
            c.z * c.x - s.y * s.z,
        );
        value.signum() * by.normalize()
    };
    let field = UserField::new("gyroid.glsl", text, size, 1.75);
    let node = Node::User(User {
        field: Arc::new(field),
    });
    let scene = Scene::new(
        "gyroid",
        vec![Surface::new(node)],
        Source::at(Vec3::new(1.2, 0.0, 0.0)),
        // The listener is at the origin, so that the coordinates of the waves are those of the field.
        Listener::at(Vec3::ZERO, 0.01),
    );
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    let settings = Settings::new(Profile::Hybrid)
        .with_waves(300_000)
        .with_seed(99_173)
        .with_iterations(1);
    let (_, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
    let half = 0.5 * size.as_dvec3();
    let (mut near_faces, mut off, mut worst) = (0, 0, 0.0_f64);
    for wave in waves.iter().filter(|wave| wave.status == 1.0) {
        let p = wave.position.as_dvec3();
        let to_face = (half - p.abs()).min_element();
        if to_face < 1e-5 {
            // The hit is on a face of the box itself.
            continue;
        }
        near_faces += usize::from(to_face < 0.05);
        let normal = normal(p);
        let d = wave.start_direction.as_dvec3();
        let mirrored = d - 2.0 * d.dot(normal) * normal;
        let error = mirrored.distance(wave.direction.as_dvec3());
        off += usize::from(error > 2e-5);
        worst = worst.max(error);
    }
    println!("{near_faces} near faces, {off} off by more than 2e-5, at most {worst:.1e}");
    assert!(near_faces > 200, "{near_faces}");
    assert!(worst < most, "{worst:e}, not {most:e}");
}

/// Protects normals near the edge between two almost parallel planes. At 16/9 of a step from the edge, the slopes can
/// agree by accident. This would give a normal between those of the planes, up to half a metre from the edge.
#[test]
fn no_edge_that_is_far_spoils_a_normal() {
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for (slope, is_opaque) in [(0.1, true), (0.01, true), (0.1, false), (0.01, false)] {
        let half: f64 = 0.5 * slope;
        let plane = |side: f64| DVec3::new(side * half.sin(), half.cos(), 0.0);
        let glsl = |n: DVec3| format!("dot(p, vec3({:?}, {:?}, 0.0))", n.x as f32, n.y as f32);
        let text = format!(
            "float field(vec3 p) {{ return min({}, {}); }}",
            glsl(plane(1.0)),
            glsl(plane(-1.0))
        );
        let text = if is_opaque { opaque(&text) } else { text };
        let field = UserField::new("roof.glsl", text, Vec3::splat(8.0), 1.001);
        let node = Node::User(User {
            field: Arc::new(field),
        });
        let scene = Scene::new(
            "valley",
            vec![Surface::new(node).at(Vec3::new(1.3, 0.4, -0.7))],
            Source::at(Vec3::new(1.3, 1.4, -0.7)),
            Listener::at(Vec3::new(1.3, 3.4, -0.7), 0.1),
        );
        let settings = Settings::new(Profile::Hybrid)
            .with_waves(100_000)
            .with_iterations(1);
        let (_, waves) = tracer.frame_with_waves(&scene, &settings).unwrap();
        let (mut met, mut worst) = (0, 0.0_f64);
        for wave in waves.iter().filter(|wave| wave.status == 1.0) {
            let p = wave.position.as_dvec3() - DVec3::new(1.3, 0.4, -0.7);
            // Steps are at least a thousandth of the largest coordinate.
            if p.x.abs() < 0.01 || p.abs().max_element() > 3.9 {
                continue;
            }
            met += 1;
            // The solid is the union of both half spaces, so the lower value belongs to the plane that is hit.
            let normal = plane(-p.x.signum());
            let d = wave.start_direction.as_dvec3();
            let mirrored = d - 2.0 * d.dot(normal) * normal;
            worst = worst.max(mirrored.distance(wave.direction.as_dvec3()));
        }
        println!("{slope}: {met} hits, at most {worst:.1e}");
        assert!(met > 10_000);
        assert!(worst < 2e-4, "{slope}: {worst:e}");
    }
}
