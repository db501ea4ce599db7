//! The region in which a field is checked: the air and the solid near the surface, but not deep in the solid.

use super::{refusal, scene, settings, user};
use crate::common::for_each_api;
use echomarch::scene::Node;
use echomarch::scene::shape::{Complement, Difference, Sphere, User};
use echomarch::{Profile, Shape, Surface, Tracer};
use glam::DVec3;

/// A sphere with a radius of 1 m, whose value deeper than `depth` metres is `inner`, an expression of the radius `r`.
fn ball_with(depth: f32, inner: &str) -> String {
    format!(
        "float field(vec3 p) {{ float r = length(p), zero = r - r; \
         return r < 1.0 - {depth:?} ? {inner} : r - 1.0; }}"
    )
}

/// Values that are not numbers, a jump, and a steep region.
const FAULTS: [&str; 4] = [
    "zero / zero",
    "-1.0 / zero",
    "r - 9.0",
    "-0.01 * sin(900.0 * r) - 0.2",
];

/// Protects published fields whose solids have singular points at their centres or axes. No wave reaches these points.
#[test]
fn faults_deep_in_the_solid_refuse_nothing() {
    let at_origin =
        "float field(vec3 p) { return 0.5 * length(p) + 0.5 * dot(normalize(p), p) - 1.0; }";
    let at_axes = "float field(vec3 p) { vec2 q = mod(p.xz + 0.5, 1.0) - 0.5; \
                   return dot(q, normalize(q)) - 0.1; }";
    let deep = FAULTS.map(|inner| ball_with(0.2, inner));
    let all = [at_origin, at_axes].map(str::to_owned);
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for text in all.iter().chain(&deep) {
            let field = user(text, 1.0);
            let scene = scene(std::slice::from_ref(&field));
            let checked = tracer.check(&scene, &settings(Profile::Hybrid));
            assert!(checked.is_ok(), "{text}: {checked:?}");
            assert!(field.value(DVec3::ZERO) < 0.0, "{text}");
        }
    });
}

/// Protects waves and normals from the same faults where they have an effect: in the solid within a hundredth of a
/// metre of the surface, which differences reach, and in thin layers and small spheres in the air.
#[test]
fn faults_in_the_air_and_next_to_the_surface_are_found() {
    let mut faulty: Vec<String> = FAULTS.map(|inner| ball_with(0.005, inner)).into();
    let in_air = [
        // A steep layer with a thickness of 1 cm.
        "length(p) - 1.0 + 0.05 * smoothstep(1.30, 1.31, length(p))",
        // A jump downwards by 3 cm.
        "length(p) - 1.0 - (length(p) > 1.4 ? 0.03 : 0.0)",
        // Values that are not numbers, in a sphere with a radius of 10 cm.
        "(length(p - vec3(1.2, 1.0, 0.3)) < 0.1 ? (p.x - p.x) / (p.x - p.x) : length(p) - 1.0)",
        // Values that are not numbers, on a plane in the air.
        "length(p) - 1.0 + 1e-3 * (p.y - 1.25) * normalize(vec3(p.y - 1.25, 0.0, 0.0)).x",
    ];
    faulty.extend(in_air.map(|value| format!("float field(vec3 p) {{ return {value}; }}")));
    for_each_api(|context| {
        for text in &faulty {
            println!("{text}");
            let sentence = refusal(context, text, 1.0);
            let is_told = ["finite wherever", "more than the stated lipschitz"];
            assert!(
                is_told.iter().any(|told| sentence.contains(told)),
                "{text}: {sentence}"
            );
        }
    });
}

/// Protects scenes in which the solid of a field becomes air. The whole box of the field is then checked, even if the
/// same field has passed the checks in another scene.
#[test]
fn a_field_turned_inside_out_is_judged_on_both_sides() {
    let text = ball_with(0.2, FAULTS[0]);
    let field = || {
        let field = user(&text, 1.0);
        Shape::from(Node::User(User { field }))
    };
    let ball = Shape::from(Node::Sphere(Sphere { radius: 0.2 }));
    let turned = Shape {
        node: Node::Complement(Complement {}),
        children: vec![field()],
    };
    let cut = Shape {
        node: Node::Difference(Difference {}),
        children: vec![ball.clone(), field()],
    };
    let kept = Shape {
        node: Node::Difference(Difference {}),
        children: vec![field(), ball],
    };
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        let mut checked = |shape: &Shape| {
            let mut scene = scene(&[]);
            scene.surfaces.push(Surface::new(shape.clone()));
            tracer.check(&scene, &settings(Profile::Hybrid))
        };
        assert!(checked(&kept).is_ok());
        for shape in [&turned, &cut] {
            let error = checked(shape).unwrap_err().to_string();
            assert!(error.contains("finite wherever"), "{error}");
        }
        assert!(checked(&field()).is_ok());
    });
}

/// Protects marches whose relaxed steps end deep in the solid, where the value is not a number. Such a point counts as
/// solid, and the results are equal to those of a sphere whose values are all numbers.
#[test]
fn a_value_that_is_none_counts_as_solid() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for profile in [Profile::Hybrid, Profile::March] {
            let mut counts = |inner: &str| {
                let scene = scene(&[user(&ball_with(0.05, inner), 1.0)]);
                let frame = tracer.frame(&scene, &settings(profile)).unwrap();
                frame.counts
            };
            let known = counts("r - 1.0");
            for inner in ["zero / zero", "-1.0 / zero"] {
                assert_eq!(counts(inner), known, "{profile}: {inner}");
            }
        }
    });
}
