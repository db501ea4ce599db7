//! Users' GLSL fields: what is refused, and how it is told; what is known of them once the
//! renderer has checked them; and scenes that follow their files.

use crate::common::{context, for_each_api};
use echomarch::gpu::{Api, Context};
use echomarch::scene::shape::{Cuboid, Room, Sphere, Twist, User};
use echomarch::scene::{Node, UserField, Warning};
use echomarch::trace::{Reload, Reloading};
use echomarch::{Listener, Profile, Scene, Settings, Shape, Source, Surface, Tracer};
use glam::{DVec3, Vec3};
use std::path::Path;
use std::sync::Arc;

const BALL: &str = "float field(vec3 p) {\n    return length(p) - 1.0;\n}\n";

fn user(text: &str, lipschitz: f32) -> Arc<UserField> {
    let size = Vec3::new(3.0, 4.0, 5.0);
    Arc::new(UserField::new("my.glsl", text.to_owned(), size, lipschitz))
}

/// A room with users' fields in a row along x.
fn scene(fields: &[Arc<UserField>]) -> Scene {
    let room = Node::Room(Room {
        size: Vec3::splat(20.0),
    });
    let mut surfaces = vec![Surface::new(room)];
    for (index, field) in fields.iter().enumerate() {
        let node = Node::User(User {
            field: Arc::clone(field),
        });
        let along = 5.0 * index as f32 - 2.5;
        surfaces.push(Surface::new(node).at(Vec3::new(along, 0.0, -5.0)));
    }
    Scene::new(
        "fields",
        surfaces,
        Source::at(Vec3::new(4.0, 2.0, 3.0)),
        Listener::at(Vec3::new(-4.0, -2.0, 4.0), 1.0),
    )
}

fn settings(profile: Profile) -> Settings {
    Settings::new(profile).with_waves(4096).with_iterations(6)
}

fn refusal(context: &Context, text: &str, lipschitz: f32) -> String {
    let scene = scene(&[user(text, lipschitz)]);
    let mut tracer = Tracer::new(context).unwrap();
    let error = tracer
        .frame(&scene, &settings(Profile::Hybrid))
        .unwrap_err();
    assert!(error.is_bad_input(), "{error}");
    let sentence = error.to_string();
    assert!(
        !sentence.contains('\n') && !sentence.contains("user0_"),
        "{sentence}"
    );
    sentence
}

/// Protects people who write a field from having to read a driver's log.
#[test]
fn what_is_wrong_is_told_with_file_and_line() {
    let broken = [
        (
            "float field(vec3 p) {\n    return length(p) - foo;\n}\n",
            "my.glsl:2: ",
            "foo",
        ),
        // Lines stay where they are although these two are taken out.
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

/// Protects the waves from values that break the march.
#[test]
fn values_that_are_none_or_grow_too_fast_are_told_with_the_place() {
    let odd = [
        (
            "float field(vec3 p) { return 1.0 / p.x; }",
            "the value at (0.000, ",
        ),
        (
            "float field(vec3 p) { float x = p.x - p.x; return x / x; }",
            "finite everywhere",
        ),
        (
            "float field(vec3 p) { return 2.0 * (length(p) - 1.0); }",
            "more than the stated lipschitz of 1: state at least 2.0",
        ),
        (
            "float field(vec3 p) { return 1.2 * dot(p, vec3(0.36, 0.48, 0.8)) - 0.5; }",
            "state at least 1.2",
        ),
        // Only between the samples: a ripple of 2 cm.
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

/// Protects fields that keep their promise to the full from being refused.
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

/// Protects what the CPU knows of a field: whether the source is buried.
#[test]
fn a_checked_field_has_its_distance_on_the_cpu() {
    for_each_api(|context| {
        let field = user(BALL, 1.0);
        let mut scene = scene(&[field.clone(), user(BALL, 1.0)]);
        let mut tracer = Tracer::new(context).unwrap();
        tracer.check(&scene, &settings(Profile::Hybrid)).unwrap();
        let samples = field.samples().unwrap();
        assert_eq!(samples.values.len(), samples.side.pow(3));
        let centre = scene.surfaces[1].position;
        for offset in [Vec3::ZERO, Vec3::X * 0.7, Vec3::new(0.3, -1.2, 0.4)] {
            let distance = scene.surface_distance(centre + offset).distance;
            assert!(
                (distance - (offset.length() - 1.0)).abs() < 0.03,
                "{distance}"
            );
        }
        // The second, which is the same, has its samples from the first.
        let second = scene.surfaces[2].position;
        assert!(scene.surface_distance(second).distance < -0.9);
        scene.source.position = second;
        let frame = tracer.frame(&scene, &settings(Profile::Hybrid)).unwrap();
        assert_eq!((frame.counts.dead, frame.counts.listener_hits), (4096, 0));
    });
}

/// Protects the value that a field has in every profile: a ball is a ball.
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

/// Protects two fields in one scene whose helpers, constants, macros and types have one name.
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
        // The same text again, which promises less.
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

/// Protects people from a field whose sign is the wrong way round, or whose box misses it.
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

/// Protects every frame from paying for what is checked once, and once it is checked.
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

const SCENE: &str = "Scene(
    surfaces: [
        Surface(shape: Room(size: (20, 20, 20))),
        Surface(shape: Field(file: \"my.glsl\", lipschitz: 1, size: (4, 4, 4)), position: (0, 0, -5)),
    ],
    source: Source(position: (4, 2, 3)),
    listener: Listener(position: (-4, -2, 4), radius: 1),
)";

fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("my.glsl"), text).unwrap();
}

/// What the next looks at the files bring.
fn settle(reloading: &mut Reloading, tracer: &mut Tracer, settings: &Settings) -> Reload {
    for _ in 0..3 {
        match reloading.poll(tracer, settings) {
            Reload::Unchanged => (),
            change => return change,
        }
    }
    Reload::Unchanged
}

/// Protects a running program from every broken state of the files: the last good scene stays
/// until the next good one.
#[test]
fn a_scene_follows_its_files() {
    for_each_api(|context| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.ron");
        std::fs::write(&file, SCENE).unwrap();
        write(folder.path(), BALL);
        let settings = settings(Profile::Hybrid);
        let mut tracer = Tracer::new(context).unwrap();
        let mut reloading =
            Reloading::open(file.to_str().unwrap(), &mut tracer, &settings).unwrap();
        assert_eq!(reloading.files().count(), 2);
        let first = reloading.scene().clone();
        let broken = [
            ("float field(vec3 p) { return foo; }", "my.glsl:1: "),
            (
                "float field(vec3 p) { return 3.0 * length(p) - 1.0; }",
                "state at least 3.0",
            ),
            (
                "float field(vec3 p) { return sqrt(-1.0 - abs(p.x)); }",
                "finite",
            ),
            ("", "there is no `float field(vec3 p)`"),
        ];
        for (text, what) in broken {
            write(folder.path(), text);
            let change = settle(&mut reloading, &mut tracer, &settings);
            let Reload::Kept(error) = change else {
                panic!("{text}: {change:?}");
            };
            assert!(error.to_string().contains(what), "{error}");
            assert!(error.to_string().contains("my.glsl"), "{error}");
            let again = settle(&mut reloading, &mut tracer, &settings);
            assert!(matches!(again, Reload::Unchanged), "{again:?}");
            assert_eq!(*reloading.scene(), first);
            tracer.frame(reloading.scene(), &settings).unwrap();
        }
        std::fs::remove_file(folder.path().join("my.glsl")).unwrap();
        let change = settle(&mut reloading, &mut tracer, &settings);
        assert!(matches!(change, Reload::Kept(_)), "{change:?}");
        write(
            folder.path(),
            "float field(vec3 p) { return length(p) - 0.5; }",
        );
        let compiled = tracer.programs_compiled();
        let change = settle(&mut reloading, &mut tracer, &settings);
        assert!(matches!(change, Reload::Taken), "{change:?}");
        assert!(*reloading.scene() != first);
        // The program is there before the first frame needs it.
        assert_eq!(tracer.programs_compiled(), compiled + 1);
        tracer.frame(reloading.scene(), &settings).unwrap();
        assert_eq!(tracer.programs_compiled(), compiled + 1);
    });
}

#[cfg(feature = "cli")]
mod program {
    use super::*;
    use crate::common::cli::{command, json, stdout, succeed};
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    /// Protects the loop of writing a field and listening: what is wrong is told, the next
    /// good state is traced.
    #[test]
    fn a_watched_scene_is_traced_with_every_change() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.ron"), SCENE).unwrap();
        write(folder.path(), BALL);
        let mut running = command()
            .args(["trace", "scene.ron", "--waves", "1000", "--watch"])
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut printed = BufReader::new(running.stdout.take().unwrap()).lines();
        let mut told = BufReader::new(running.stderr.take().unwrap()).lines();
        // Each waits for what the change before it came to, however long that takes.
        let mut wait_for = |part: &str| printed.find(|line| line.as_ref().unwrap().contains(part));
        assert!(wait_for("scene: 1000 waves").is_some());
        write(folder.path(), "float field(vec3 p) {\n    return foo;\n}");
        let wrong = told.find(|line| line.as_ref().unwrap().contains("my.glsl:2: "));
        assert!(wrong.is_some());
        write(
            folder.path(),
            "float field(vec3 p) { return length(p) - 0.5; }",
        );
        assert!(wait_for("scene: 1000 waves").is_some());
        running.kill().unwrap();
        running.wait().unwrap();
        // Nothing was told or traced more often than it changed.
        assert_eq!(
            printed
                .filter(|line| line.as_ref().unwrap().contains("waves,"))
                .count(),
            0
        );
        assert_eq!(
            told.filter(|line| line.as_ref().unwrap().contains("my.glsl:2: "))
                .count(),
            0
        );
    }

    /// Protects what `shader` prints: the text that is compiled, user's text included.
    #[test]
    fn the_shader_is_printed() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.ron");
        std::fs::write(&scene, SCENE).unwrap();
        write(folder.path(), BALL);
        let scene = scene.to_str().unwrap();
        for pass in ["march", "view", "slice"] {
            let text = succeed(&["shader", scene, "--pass", pass]);
            let text = stdout(&text);
            assert!(text.starts_with("#version 330 core\n"), "{text}");
            assert!(text.contains(BALL.trim_end()) && text.contains("my.glsl\n#line 1 "));
        }
        let text = json(&["shader", scene, "--gl", "gles", "--pass", "pan"]);
        assert!(
            text["text"]
                .as_str()
                .unwrap()
                .starts_with("#version 300 es\n")
        );
    }
}

/// A smooth surface about `centre`, as a user states it.
struct Smooth {
    name: &'static str,
    value: String,
    gradient: String,
    box_size: f32,
    centre: Vec3,
    /// A length by which the source stands off.
    size: f32,
    /// At a point from the centre.
    normal: fn(DVec3) -> DVec3,
    /// What a mirrored direction may be off by, by differences and by the stated gradient.
    most: [f64; 2],
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
        // Where a wave lands is known to 5e-7 m in each coordinate, and the tube has 0.4 m.
        most: [4e-5, 4e-6],
    };
    let away = Vec3::new(10.0, -4.0, 8.0);
    vec![
        ball("ball", 1.0, 4.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("ball, large box", 1.0, 100.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("small ball", 0.1, 10.0, Vec3::ZERO, [1e-5, 1e-6]),
        ball("large ball", 50.0, 120.0, Vec3::ZERO, [1e-5, 1e-6]),
        // A place is known to 1e-6 there, and so is the direction from the centre.
        ball("ball away", 1.0, 40.0, away, [1e-5, 4e-6]),
        torus("torus", 4.0),
        torus("torus, large box", 100.0),
    ]
}

/// Protects normals of users' fields: whatever the box of the field, the unit that its text is
/// written in, and the scale of the surface, and those of a text that states its gradient from
/// being any worse than a ball's.
#[test]
fn normals_do_not_depend_on_the_box() {
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for surface in smooth_surfaces() {
        let (value, gradient) = (&surface.value, &surface.gradient);
        let values = format!("float field(vec3 p) {{ return {value}; }}\n");
        let stated = format!("{values}vec3 fieldGradient(vec3 p) {{ return {gradient}; }}\n");
        for (text, most) in [values, stated].into_iter().zip(surface.most) {
            let worst = worst_direction(&mut tracer, &surface, &text);
            println!("{}, at most {most:e}: {worst:.2e}", surface.name);
            assert!(worst < most, "{}: {worst:e}, not {most:e}", surface.name);
        }
    }
}

/// By how much mirrored directions are off at the most, in both profiles.
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
        assert!(met.len() > 100, "{profile}: {} waves met it", met.len());
        for wave in met {
            let normal = (surface.normal)(wave.position.as_dvec3());
            let d = wave.start_direction.as_dvec3();
            let mirrored = d - 2.0 * d.dot(normal) * normal;
            worst = worst.max(mirrored.distance(wave.direction.as_dvec3()));
        }
    }
    worst
}

/// Protects the waves from a gradient that is not the value's: it is refused with the place and
/// both gradients.
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
        // Right but for one side, and but for one place.
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

/// Protects gradients that are right from being refused where differences cannot tell: at edges
/// and ridges, where values are rounded much, and where there is no gradient.
#[test]
fn a_right_gradient_is_taken() {
    let honest = [
        // Edges of a cube, within and without.
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
        // A cone, with no gradient along its axis.
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
        // In units of a third of a millimetre.
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
        // Two of them in one scene, and one that states none.
        let fields = honest.map(|(text, lipschitz)| user(text, lipschitz));
        let both = scene(&[fields[0].clone(), fields[1].clone(), user(BALL, 1.0)]);
        for profile in Profile::ALL {
            tracer.frame(&both, &settings(profile)).unwrap();
        }
    });
}

/// Protects a wave that is aimed at a tip, where the stated gradient divides 0 by 0.
#[test]
fn a_wave_that_meets_a_tip_is_mirrored() {
    let text = "float field(vec3 p) { return 0.8 * length(p.xz) + 0.6 * (p.y - 1.0); }
        vec3 fieldGradient(vec3 p) {
            return vec3(0.8 * p.x / length(p.xz), 0.6, 0.8 * p.z / length(p.xz));
        }";
    let mut scene = scene(&[user(text, 1.0)]);
    scene.surfaces[1].position = Vec3::ZERO;
    scene.source = Source::at(Vec3::new(0.0, 4.0, 0.0));
    let mut tracer = Tracer::new(&context(Api::Gl)).unwrap();
    for profile in [Profile::Hybrid, Profile::March] {
        let settings = Settings::new(profile).with_iterations(1);
        let states = tracer
            .trace_directions(&scene, &settings, &[Vec3::NEG_Y])
            .unwrap();
        let end = &states[1][0];
        assert_eq!(end.status, 2.0, "{profile}: {end:?}");
        assert!(end.position.distance(Vec3::Y) < 1e-5, "{profile}: {end:?}");
        // One of the sides mirrors it, and no wave goes on as it came.
        let expected = -1.0 + 2.0 * 0.6 * 0.6;
        assert!(
            (end.direction.y - expected).abs() < 1e-4,
            "{profile}: {end:?}"
        );
    }
}
