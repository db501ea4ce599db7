//! The renderer's checks of a user's field before it accepts a scene, and the results of these checks.

use super::{BALL, refusal, scene, settings, user};
use crate::common::{context, for_each_api};
use echomarch::gl::Api;
use echomarch::scene::shape::{Cuboid, Sphere, Twist};
use echomarch::scene::{Node, Warning};
use echomarch::{Profile, Shape, Surface, Tracer};
use glam::{DVec3, Vec3};

/// Protects authors of fields from having to read the log of a driver.
#[test]
fn what_is_wrong_is_told_with_file_and_line() {
    let broken = [
        (
            "float field(vec3 p) {\n    return length(p) - foo;\n}\n",
            "my.glsl:2: ",
            "foo",
        ),
        // Line numbers are correct although these two lines are removed.
        (
            "#version 450\nprecision mediump float;\n// caf\u{e9}\nfloat field(vec3 p) { return lenth(p); }",
            "my.glsl:4: ",
            "lenth",
        ),
        (
            "float help(float x) { return x; }\nfloat field(vec3 p) {\n return help(p);\n}",
            "my.glsl:3: ",
            "help",
        ),
        (
            "float f(vec3 p) { return p.x; }",
            "my.glsl: ",
            "there is no `float field(vec3 p)`",
        ),
        (
            "\nuniform float iTime;\nfloat field(vec3 p) { return iTime; }",
            "my.glsl:2: ",
            "'uniform'",
        ),
        (
            "float field(vec3 p) {\n    return 1.0;\n",
            "my.glsl: after its end: ",
            "",
        ),
        (
            "#if 1\nfloat field(vec3 p) { return 1.0; }\n",
            "my.glsl",
            "",
        ),
    ];
    for_each_api(|context| {
        for (text, place, what) in broken {
            let sentence = refusal(context, text, 1.0);
            assert!(
                sentence.starts_with(place) && sentence.contains(what),
                "{sentence}"
            );
        }
    });
}

/// Protects waves from values that break the march.
#[test]
fn values_that_are_none_or_grow_too_fast_are_told_with_the_place() {
    let odd = [
        (
            "float field(vec3 p) { return 1.0 / p.x; }",
            "the value at (0.000, ",
        ),
        (
            "float field(vec3 p) { float x = p.x - p.x; return x / x; }",
            "finite wherever waves can be",
        ),
        (
            "float field(vec3 p) { return 2.0 * (length(p) - 1.0); }",
            "more than the stated lipschitz of 1: state at least 2.0",
        ),
        (
            "float field(vec3 p) { return 1.2 * dot(p, vec3(0.36, 0.48, 0.8)) - 0.5; }",
            "state at least 1.2",
        ),
        // A ripple of 2 cm, which is visible only between the samples.
        (
            "float field(vec3 p) { return 0.01 * sin(300.0 * p.y); }",
            "more than the stated",
        ),
        (
            "float field(vec3 p) { return p.z > 0.1 ? 1.0 : -1.0; }",
            "seems to jump",
        ),
    ];
    for_each_api(|context| {
        for (text, what) in odd {
            let sentence = refusal(context, text, 1.0);
            assert!(
                sentence.starts_with("my.glsl: ") && sentence.contains(what),
                "{sentence}"
            );
        }
    });
}

/// Protects fields whose Lipschitz constant equals the stated constant: they are accepted.
#[test]
fn fields_that_grow_just_as_fast_as_they_say_are_taken() {
    let menger = std::fs::read_to_string("examples/scenes/menger.glsl").ok();
    let honest = [
        (BALL.to_owned(), 1.0),
        (
            "float field(vec3 p) { vec3 q = abs(p); return max(q.x, max(q.y, q.z)) - 1.0; }".into(),
            1.0,
        ),
        (
            "float field(vec3 p) { vec3 q = abs(p); return q.x + q.y + q.z - 1.0; }".into(),
            1.7321,
        ),
        (
            "float field(vec3 p) { return 1e-2 * (length(p.xz) - 1.0); }".into(),
            0.01,
        ),
        (
            "float field(vec3 p) { return 300.0 * (length(fract(p) - 0.5) - 0.3); }".into(),
            300.0,
        ),
    ];
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for (text, lipschitz) in honest
            .iter()
            .cloned()
            .chain(menger.clone().map(|m| (m, 1.0)))
        {
            let scene = scene(&[user(&text, lipschitz)]);
            let checked = tracer.check(&scene, &settings(Profile::Hybrid));
            assert!(checked.is_ok(), "{text}: {checked:?}");
        }
    });
}

/// Protects tests on the CPU that use a field, such as whether the source is in a solid.
#[test]
fn a_checked_field_has_its_distance_on_the_cpu() {
    for_each_api(|context| {
        let field = user(BALL, 1.0);
        let mut scene = scene(&[field.clone(), user(BALL, 1.0)]);
        let mut tracer = Tracer::new(context).unwrap();
        tracer.check(&scene, &settings(Profile::Hybrid)).unwrap();
        assert!((field.value(DVec3::ZERO) + 1.0).abs() < 0.03);
        let centre = scene.surfaces[1].position;
        for offset in [Vec3::ZERO, Vec3::X * 0.7, Vec3::new(0.3, -1.2, 0.4)] {
            let distance = scene.surface_distance(centre + offset).distance;
            assert!(
                (distance - (offset.length() - 1.0)).abs() < 0.03,
                "{distance}"
            );
        }
        // The second field is identical, and uses the samples of the first.
        let second = scene.surfaces[2].position;
        assert!(scene.surface_distance(second).distance < -0.9);
        scene.sources[0].position = second;
        let frame = tracer.frame(&scene, &settings(Profile::Hybrid)).unwrap();
        assert_eq!((frame.counts.dead, frame.counts.listener_hits), (4096, 0));
    });
}

/// Protects the value of a field in every profile: a sphere as a user's field has the same result as the built-in
/// sphere.
#[test]
fn a_ball_of_ones_own_sounds_like_a_ball() {
    for_each_api(|context| {
        let mut tracer = Tracer::new(context).unwrap();
        for profile in Profile::ALL {
            let own = scene(&[user(BALL, 1.0)]);
            let mut known = own.clone();
            known.surfaces[1].shape = Node::Sphere(Sphere { radius: 1.0 }).into();
            let [own, known] = [own, known].map(|scene| {
                let frame = tracer.frame(&scene, &settings(profile)).unwrap();
                frame.counts.listener_hits as f64
            });
            assert!(
                (own - known).abs() < 0.02 * known + 4.0,
                "{profile}: {own}, {known}"
            );
        }
    });
}

/// Protects two fields of one scene whose helper functions, constants, macros and types have the same names.
#[test]
fn fields_may_use_the_same_names() {
    let text = |radius: &str| {
        format!(
            "#define SCALE 2.0\nstruct Ball {{ float radius; }};\n\
             const Ball ball = Ball({radius} * SCALE);\n\
             float sdBox(vec3 p) {{ return length(p) - ball.radius; }}\n\
             float help(vec3 p) {{ return sdBox(p); }}\n\
             float field(vec3 p) {{ return help(p); }}\n"
        )
    };
    for_each_api(|context| {
        let (small, large) = (user(&text("0.25"), 1.0), user(&text("0.6"), 1.0));
        // The same text, with a larger stated constant.
        let again = user(&text("0.6"), 2.0);
        let scene = scene(&[small, large, again]);
        let mut tracer = Tracer::new(context).unwrap();
        for profile in Profile::ALL {
            tracer.frame(&scene, &settings(profile)).unwrap();
        }
        for (index, radius) in [(1, 0.5), (2, 1.2), (3, 0.6)] {
            let value = scene.surfaces[index].distance(scene.surfaces[index].position);
            assert!((value + radius).abs() < 0.03, "{value}");
        }
    });
}

/// Protects users from a field with an inverted sign, or with a box that does not contain its surface.
#[test]
fn a_field_without_a_surface_is_warned_of() {
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for (text, all) in [
        ("float field(vec3 p) { return length(p) + 0.1; }", "air"),
        ("float field(vec3 p) { return length(p) - 9.0; }", "solid"),
    ] {
        let scene = scene(&[user(text, 1.0)]);
        assert_eq!(scene.warnings(), []);
        tracer.check(&scene, &settings(Profile::Hybrid)).unwrap();
        let warnings = scene.warnings();
        assert!(
            matches!(&warnings[..], [Warning::OneSided { .. }]),
            "{warnings:?}"
        );
        assert!(
            warnings[0]
                .to_string()
                .contains(&format!("my.glsl is all {all}"))
        );
    }
}

/// Protects frames from the cost of a check that needs to run only once, and tests that it runs.
#[test]
fn a_stated_growth_is_tried_once() {
    let twisted = Shape {
        node: Node::Twist(Twist {
            rate: 2.0,
            lipschitz: 1.01,
        }),
        children: vec![Shape::from(Node::Cuboid(Cuboid {
            size: Vec3::new(2.0, 3.0, 2.0),
        }))],
    };
    let mut scene = scene(&[]);
    scene.surfaces.push(Surface::new(twisted));
    scene.validate().unwrap();
    let refused = scene.check().unwrap_err().to_string();
    assert!(
        refused.contains("more than the stated lipschitz of 1.01"),
        "{refused}"
    );
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    let error = tracer
        .frame(&scene, &settings(Profile::Hybrid))
        .unwrap_err();
    assert_eq!(error.to_string(), refused);
}
