//! Malicious or faulty users' GLSL: it is either refused in one sentence or traced. Users' GLSL never crashes the
//! program, hangs it or exhausts its memory.

use crate::common::cli::{argument, command, stderr};
use crate::common::{builtin, context};
use echomarch::gl::Api;
use echomarch::scene::shape::{Room, User};
use echomarch::scene::{Node, UserField};
use echomarch::tracer::{FieldTrial, Reloading, TraceError, TrialCommand};
use echomarch::{Error, Listener, Profile, Scene, Settings, Source, Surface, Tracer};
use glam::{DVec3, Vec3};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::Arc;

const SCENE: &str = "Scene(
    surfaces: [
        Surface(shape: Room(size: (9, 9, 9))),
        Surface(shape: Field(file: \"f.glsl\", lipschitz: 1, size: (3, 3, 3))),
    ],
    source: Source(position: (-3, 1, 1)),
    listener: Listener(position: (3, 1, 1), radius: 1),
)";

const BALL: &str = "float field(vec3 p) { return length(p) - 1.0; }\n";

/// Protects fields beside surfaces whose shaders read the scene's data, such as `Rooms` and meshes with several materials:
/// on desktop OpenGL their trial failed, because samplers of two types read from one texture unit.
#[test]
fn a_field_in_rooms_of_several_materials_is_traced() {
    let rooms = "Rooms(of: [(name: \"a\", from: (-4.5, -4.5, -4.5), to: (4.5, 4.5, 4.5))]), material: \"plasterboard\", faces: {\"a/floor\": \"wood-floor\"}";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("f.glsl"), BALL).unwrap();
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, SCENE.replace("Room(size: (9, 9, 9))", rooms)).unwrap();
    let traced = command()
        .args(["trace", "--levels", "--waves", "256", argument(&scene)])
        .output()
        .unwrap();
    assert!(traced.status.success(), "{}", stderr(&traced));
}

/// A division that compilers fold into a constant, and that causes a processor fault.
const DIVISION: &str =
    "float field(vec3 p) { p.x += float((-2147483647 - 1) / -1); return length(p) - 1.0; }\n";

/// Maximum data size of a process and of each of its child processes, in kibibytes.
const MEMORY: &str = "2000000";

/// The field of a ball of one metre, preceded by these statements.
fn before(statements: &str) -> String {
    format!("float field(vec3 p) {{ {statements} return length(p) - 1.0; }}\n")
}

fn doubling(levels: usize) -> String {
    let mut text = "#define A1 +p.x +p.x\n".to_owned();
    for level in 2..=levels {
        let of = level - 1;
        text += &format!("#define A{level} A{of} A{of}\n");
    }
    text + &format!("float field(vec3 p) {{ return 1.0 A{levels}; }}\n")
}

/// A chain of functions that each call the previous one twice. Compilers need seconds to inline them.
fn doubling_calls(start: &str) -> String {
    let call = |n: usize| {
        format!(
            "float f{}(float x) {{ return f{n}(x) + f{n}(x + 1.0); }}",
            n + 1
        )
    };
    let first = format!("float f0(float x) {{ return sin(x + {start}); }}\n");
    format!(
        "{first}{}\n{}",
        joined(24, call, "\n"),
        before("p.x += 1e-9 * f24(p.x);")
    )
}

fn joined(count: usize, one: impl Fn(usize) -> String, between: &str) -> String {
    let all: Vec<String> = (0..count).map(one).collect();
    all.join(between)
}

/// Traces a scene with this field, with limited memory.
fn trace(text: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("f.glsl"), text).unwrap();
    std::fs::write(folder.path().join("s.ron"), SCENE).unwrap();
    let limited = format!("ulimit -d {MEMORY} && exec \"$0\" \"$@\"");
    Command::new("sh")
        .args(["-c", &limited, env!("CARGO_BIN_EXE_echomarch")])
        .args(["trace", "s.ron", "--waves", "64", "--quiet"])
        .current_dir(folder.path())
        .output()
        .unwrap()
}

fn refuses(text: &str, told: &str) {
    let output = trace(text);
    let said = stderr(&output);
    let start = &text[..text.len().min(120)];
    assert_eq!(output.status.code(), Some(2), "{start}: {said}");
    assert!(
        said.contains(told) && said.contains("f.glsl"),
        "{start}: {said}"
    );
    assert_eq!(said.trim_end().lines().count(), 1, "{start}: {said}");
    assert!(said.len() < 500, "{start}: {said}");
}

/// Requires either one sentence or a frame, depending on the renderer.
fn refuses_or_traces(text: &str) {
    let output = trace(text);
    let said = stderr(&output);
    let start = &text[..text.len().min(120)];
    match output.status.code() {
        Some(0) => (),
        Some(2) => assert_eq!(said.trim_end().lines().count(), 1, "{start}: {said}"),
        other => panic!("{start}: {other:?}, {said}"),
    }
}

/// Protects the program from invalid texts that are recognised before compilation.
#[test]
fn what_a_field_cannot_be_is_refused_by_name() {
    refuses(&before("discard;"), "'discard'");
    refuses(&before("gl_FragDepth = 0.5;"), "'gl_FragDepth'");
    refuses(&before("p.x += gl_FragCoord.x;"), "'gl_FragCoord'");
    refuses(&before("outOrigin = vec4(1.0);"), "outOrigin");
    refuses(&before("p.x += uMinDistance;"), "uMinDistance");
    refuses(&before("p.x += waveIndex();"), "waveIndex");
    // Earlier, each of these declarations changed the waves of other surfaces, or ended with a driver's log.
    for declared in [
        "float dot(vec3 a, vec3 b) { return 0.0; }",
        "float step(float a, float b);",
        "uint floatBitsToUint(float f) { return 0u; }",
        "float min(float a, float b) { return 0.0; }",
        "struct normalize { float a; };",
        "float length;",
        "float half = 1.0;",
        "float a__b = 1.0;",
    ] {
        refuses(&format!("\n{declared}\n{BALL}"), "f.glsl:2: '");
    }
    refuses(
        &format!("#define U uniform\nU float t;\n{BALL}"),
        "f.glsl:2: ",
    );
    refuses(
        &format!("#extension GL_ARB_gpu_shader5 : enable\n{BALL}"),
        "#extension",
    );
    refuses(&doubling(16), "32768");
    refuses(&doubling(30), "32768");
    refuses(
        &before("float a[1000000000]; a[int(p.x)] = 1.0; p.x += a[3];"),
        "1000000000",
    );
    let ones = joined(50_000, |_| "1.0".into(), ",");
    let array = format!("const float T[50000] = float[50000]({ones});\n");
    refuses(&(array + &before("p.x += T[int(p.x)];")), "32768");
    let sum = joined(20_000, |_| "p.x".into(), "+");
    refuses(&before(&format!("p.y += 1e-5 * ({sum});")), "32768");
    let sum = joined(100_000, |_| "p.x".into(), "+");
    refuses(&before(&format!("p.y += 1e-5 * ({sum});")), "262144");
    let globals = joined(80_000, |n| format!("int a{n};"), "\n");
    refuses(&(globals + BALL), "");
}

/// Protects the program from endless loops, and from drivers' compilers that crash, hang or exhaust the memory.
#[test]
fn what_dies_or_does_not_end_is_refused() {
    refuses(DIVISION, "SIGFPE");
    refuses(
        &before("int a = -2147483647 - 1; p.x += float(a % -1);"),
        "SIGFPE",
    );
    for loops in [
        "for (int i = 0; i < 60000; ++i) for (int j = 0; j < 60000; ++j) p.x += sin(p.y) * 1e-9;",
        "for (int i = 0; i < 1000000000; ++i) p.x += sin(p.y + p.x) * 1e-9;",
        "while (p.x < 1e9) p.y += sin(p.x) * 1e-9;",
        // This loop is long only at positions where waves hit the surface.
        "if (abs(length(p) - 1.0) < 0.001) for (int i = 0; i < 1000000000; ++i) p.x += sin(p.y + p.x) * 1e-12;",
    ] {
        refuses(&before(loops), "f.glsl: ");
    }
    refuses(&doubling_calls("1.0"), "f.glsl: ");
    refuses(&before("p.x = 0.0 / (p.x - p.x);"), "finite");
    let stated = |statements: &str| {
        format!("{BALL}vec3 fieldGradient(vec3 p) {{ {statements} return normalize(p); }}\n")
    };
    refuses(
        &stated("int a = -2147483647 - 1; p.x += float(a % -1);"),
        "SIGFPE",
    );
    let at_surface = "if (abs(length(p) - 1.0) < 0.001) for (int i = 0; i < 1000000000; ++i) p.x += sin(p.y + p.x) * 1e-12;";
    refuses(&stated(at_surface), "f.glsl: ");
    refuses(
        &format!(
            "float f(float x) {{ return f(x); }}\n{}",
            before("p.x = f(p.x);")
        ),
        "f.glsl",
    );
}

/// Protects the program from texts that strain a compiler: a driver may accept or reject them.
#[test]
fn what_strains_a_compiler_ends_in_a_sentence_or_a_frame() {
    let minus = "- ".repeat(20_000);
    let not = "! ".repeat(20_000);
    let swizzles = ".xyz".repeat(8_000);
    let ternaries = "p.x > 9.0 ? 1.0 : ".repeat(3_000);
    let constants = joined(2_000, |n| format!("{}.0", n % 7), ",");
    let structs = joined(
        25,
        |n| format!("struct S{} {{ S{n} a; S{n} b; }};", n + 1),
        "\n",
    );
    let long = "a".repeat(1_000);
    for text in [
        before(&format!("p.x += 0.0 * ({minus}p.x);")),
        before(&format!("bool b = {not}true;")),
        before(&format!("p.x += 0.0 * p{swizzles}.x;")),
        before(&format!("p.x = {ternaries}p.x;")),
        before(&format!(
            "p.x += {}p.x{};",
            "(".repeat(120),
            ")".repeat(120)
        )),
        before(&format!("float {long} = p.x; p.x = {long};")),
        before("const int N = 1000 * 1000 * 1000; float a[N]; a[int(p.x)] = 1.0; p.x += a[3];"),
        before("float a[16000]; a[int(p.x * 1e9)] = 1.0; p.x += 0.0 * a[int(p.y)];"),
        before("mat4 m = inverse(mat4(0.0)); p.x += 0.0 * m[int(p.x * 1e9)][2];"),
        before(
            "p.x += 1e-30 * float(1 << 40) + 1e-30 * float(1 >> -1) + float(7 % 0) + float(1 / 0);",
        ),
        before("int zero = int(p.x * 0.0); p.x += 1e-30 * float(5 / zero + 5 % zero);"),
        format!(
            "const float T[2000] = float[2000]({constants});\n{}",
            before("p.x += 1e-9 * T[int(p.x * 100.0) & 1023];")
        ),
        format!("struct S0 {{ float a; }};\n{structs}\n{}", before("S25 s;")),
        before("if (p.x > 1.49999) for (int i = 0; i < 1000000000; ++i) p.x += sin(p.y) * 1e-9;"),
    ] {
        refuses_or_traces(&text);
    }
}

/// Protects harmless texts: they are not refused.
#[test]
fn what_is_harmless_is_traced() {
    for text in [
        format!("precision highp float; // fp\n{BALL}"),
        format!("#version 330 core\n#ifdef GL_ES\nprecision mediump float;\n#endif\n{BALL}"),
        "#define SQUARE(x) ((x) * \\\n  (x))\nstruct Ball { vec3 xz; float far; };\n\
         const Ball ball = Ball(vec3(0.0), 1.0);\nfloat size_ = ball.far;\n\
         float field(vec3 p) { return sqrt(SQUARE(p.x) + SQUARE(p.y) + SQUARE(p.z)) - size_; }\n"
            .to_owned(),
    ] {
        let output = trace(&text);
        assert!(output.status.success(), "{text}: {}", stderr(&output));
    }
}

/// Protects pictures, which have shader programs of their own.
#[test]
fn pictures_are_refused_as_frames_are() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.ron");
    std::fs::write(&scene, SCENE).unwrap();
    std::fs::write(folder.path().join("f.glsl"), DIVISION).unwrap();
    for picture in ["view", "slice"] {
        let output = command()
            .args([picture, argument(&scene), "-o", "p.png", "--quiet"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{picture}: {said}");
        assert!(said.contains("SIGFPE"), "{picture}: {said}");
    }
}

/// A room with a user's field.
fn scene(text: &str) -> Scene {
    let field = UserField::new("f.glsl", text.to_owned(), Vec3::splat(3.0), 1.0);
    let room = Node::Room(Room {
        size: Vec3::splat(9.0),
    });
    let node = Node::User(User {
        field: Arc::new(field),
    });
    Scene::new(
        "strange",
        vec![Surface::new(room), Surface::new(node)],
        Source::at(Vec3::new(-3.0, 1.0, 1.0)),
        Listener::at(Vec3::new(3.0, 1.0, 1.0), 1.0),
    )
}

/// A command that logs each start in the file `log`, and continues once the file `go` exists.
fn noting(folder: &Path) -> TrialCommand {
    let script = format!(
        "echo >> log; until [ -e go ]; do sleep 0.05; done; exec {} field-trial",
        env!("CARGO_BIN_EXE_echomarch")
    );
    let script = format!("cd '{}'; {script}", folder.display());
    TrialCommand {
        program: "sh".into(),
        arguments: vec!["-c".into(), script.into()],
    }
}

fn starts(folder: &Path) -> usize {
    let log = std::fs::read_to_string(folder.join("log"));
    log.map_or(0, |log| log.lines().count())
}

/// Returns the next change of the files, after the child process has answered.
fn settle(
    reloading: &mut Reloading,
    tracer: &mut Tracer,
    settings: &Settings,
) -> Result<bool, Error> {
    loop {
        match reloading.poll(tracer, settings) {
            Ok(false) => std::thread::sleep(std::time::Duration::from_millis(10)),
            change => return change,
        }
    }
}

/// Protects programs that use the library. Users' fields are refused until the program chooses how they are tried;
/// built-in scenes are not refused. A child process gives the same results as this process. No field is tried twice,
/// and watching files never blocks. All of this is one test, because the choice applies to the whole process.
#[test]
fn a_library_chooses_how_fields_are_tried() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let context = context(Api::Gl);
    let settings = Settings::new(Profile::Hybrid).with_waves(64);
    let mut tracer = Tracer::new(&context).unwrap();
    let own = scene(BALL);
    FieldTrial::default().set();
    let error = tracer.check(&own, &settings).unwrap_err();
    let refused = matches!(&error, Error::Trace(TraceError::FieldRefused { .. }));
    assert!(refused && error.is_bad_input(), "{error}");
    let message = error.to_string();
    for part in ["InThisProcess", "InChild", ".glsl"] {
        assert!(message.contains(part), "{message}");
    }
    let error = echomarch::picture::slice(&mut tracer, &own, &Default::default()).unwrap_err();
    assert_eq!(error.to_string(), message);
    for name in Scene::BUILTIN_NAMES {
        tracer.check(&builtin(name), &settings).unwrap();
    }
    FieldTrial::InThisProcess.set();
    tracer.check(&own, &settings).unwrap();

    FieldTrial::InChild(noting(folder)).set();
    std::fs::write(folder.join("go"), "").unwrap();
    let mut tracer = Tracer::new(&context).unwrap();
    let tried = scene(BALL);
    // The CPU values of the field come from its samples.
    let values = |scene: &Scene| {
        let field = scene.user_fields().next().unwrap();
        let diagonal = (-10..=10).map(|step| DVec3::splat(0.1 * f64::from(step)));
        diagonal.map(|p| field.value(p)).collect::<Vec<f64>>()
    };
    tracer.check(&tried, &settings).unwrap();
    assert_eq!(values(&tried), values(&own));
    assert_ne!(values(&tried), [0.0; 21]);
    for _ in 0..2 {
        tracer.frame(&tried, &settings).unwrap();
        Tracer::new(&context)
            .unwrap()
            .frame(&scene(BALL), &settings)
            .unwrap();
    }
    assert_eq!(starts(folder), 1);
    for _ in 0..2 {
        let error = tracer.check(&scene(DIVISION), &settings).unwrap_err();
        let dies = matches!(&error, Error::Trace(TraceError::FieldDies { .. }));
        assert!(dies && error.is_bad_input(), "{error}");
    }
    assert_eq!(starts(folder), 2);
    let error = tracer.check(&scene(&BALL.replace("1.0", "one")), &settings);
    let error = error.unwrap_err().to_string();
    assert!(
        error.starts_with("f.glsl:1: ") && error.contains("one"),
        "{error}"
    );
    // Built-in shapes need no trial in a child process.
    tracer
        .check(&Scene::builtin("menger").unwrap(), &settings)
        .unwrap();
    assert_eq!(starts(folder), 3);

    let file = folder.join("s.ron");
    let write = |text: &str| std::fs::write(folder.join("f.glsl"), text).unwrap();
    std::fs::write(&file, SCENE).unwrap();
    write(BALL);
    let mut reloading = Reloading::open(argument(&file), &mut tracer, &settings).unwrap();
    let first = reloading.scene().clone();
    std::fs::remove_file(folder.join("go")).unwrap();
    write(DIVISION);
    let before = starts(folder);
    while starts(folder) == before {
        let change = reloading.poll(&mut tracer, &settings);
        assert!(matches!(change, Ok(false)), "{change:?}");
        tracer.frame(reloading.scene(), &settings).unwrap();
    }
    std::fs::write(folder.join("go"), "").unwrap();
    let change = settle(&mut reloading, &mut tracer, &settings);
    let error = change.unwrap_err();
    assert!(error.to_string().contains("SIGFPE"), "{error}");
    assert_eq!(*reloading.scene(), first);
    write(&BALL.replace("1.0", "0.75"));
    let change = settle(&mut reloading, &mut tracer, &settings);
    assert!(matches!(change, Ok(true)), "{change:?}");

    FieldTrial::InChild(TrialCommand {
        program: folder.join("none"),
        arguments: Vec::new(),
    })
    .set();
    for program in ["none", "/bin/true"] {
        FieldTrial::InChild(TrialCommand {
            program: folder.join(program),
            arguments: Vec::new(),
        })
        .set();
        let error = tracer
            .check(&scene(&BALL.replace("1.0", "0.5")), &settings)
            .unwrap_err();
        let none = matches!(&error, Error::Trace(TraceError::NoFieldTrial { .. }));
        assert!(none && !error.is_bad_input(), "{error}");
    }
    FieldTrial::InThisProcess.set();
    tracer
        .check(&scene(&BALL.replace("1.0", "0.5")), &settings)
        .unwrap();
}

#[cfg(feature = "demo")]
mod window {
    use super::*;
    use crate::common::drop::drop_file;
    use crate::common::window::Display;
    use std::path::PathBuf;

    /// Protects users in a scene whose field changes into one that crashes: the window reports it, and continues with
    /// the last valid scene.
    #[test]
    fn the_window_outlives_every_field() {
        let folder = tempfile::tempdir().unwrap();
        let (scene, field) = (folder.path().join("s.ron"), folder.path().join("f.glsl"));
        std::fs::write(&scene, SCENE).unwrap();
        std::fs::write(&field, BALL).unwrap();
        let display = Display::new();
        let demo = display.demo(&[argument(&scene)]);
        let kills = [
            (DIVISION.to_owned(), "SIGFPE"),
            (
                before("for (int i = 0; i < 1000000000; ++i) p.x += sin(p.y + p.x);"),
                "f.glsl",
            ),
            (doubling(30), "32768"),
        ];
        for (text, told) in &kills {
            std::fs::write(&field, text).unwrap();
            let line = demo.wait_for("the last scene stays");
            assert!(line.contains(told), "{line}");
            demo.wait_frames();
        }
        std::fs::write(&field, BALL.replace("1.0", "0.5")).unwrap();
        demo.wait_for("is read again");
        demo.wait_frames();
        let (report, _, _) = demo.quit();
        assert_eq!(report["reread"].as_array().unwrap().len(), kills.len() + 1);
    }

    /// Writes a scene with this field to a new folder within `folder`.
    fn scene_with(folder: &Path, name: &str, text: &str) -> PathBuf {
        let folder = folder.join(name);
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("f.glsl"), text).unwrap();
        let scene = folder.join("s.ron");
        std::fs::write(&scene, SCENE).unwrap();
        scene
    }

    /// Protects users from waiting for the trial of a chosen scene: the window continues with the last valid scene and
    /// shows a message. After the trial the window shows the new scene, unless the scene is refused or another scene is
    /// chosen meanwhile.
    #[test]
    fn a_scene_that_is_chosen_is_tried_aside() {
        let folder = tempfile::tempdir().unwrap();
        let slow =
            |name: &str, start: &str| scene_with(folder.path(), name, &doubling_calls(start));
        let (first, second) = (slow("first", "1.0"), slow("second", "2.0"));
        let good = scene_with(folder.path(), "good", BALL);
        let display = Display::new();
        let demo = display.demo(&["corner"]);
        let window = demo.window();
        let choose = |scene: &Path| {
            drop_file(&display.name, &window, scene);
            demo.wait_for(&format!("{} is being tried", scene.display()));
        };
        // The trial takes seconds, in which the window draws many frames.
        let wait_tried = |scene: &Path| {
            let mut frames = 0;
            demo.wait_until("frames during the trial", |frame| {
                let is_tried = frame["trying"] == argument(scene);
                assert!(!is_tried || frame["scene"] == "corner", "{frame}");
                frames += u32::from(is_tried);
                frames >= 3
            });
        };
        choose(&first);
        wait_tried(&first);
        demo.wait_for("f.glsl: ");
        let after = demo.wait_until("the end of the trial", |frame| frame["trying"].is_null());
        assert_eq!(after["scene"], "corner");

        // The scene is the last in the list. The next scene is the first in the list.
        choose(&second);
        wait_tried(&second);
        display.xdotool(&["key", "n"]);
        demo.wait_for("scene corner");
        choose(&good);
        demo.wait_until("the good scene", |frame| frame["scene"] == argument(&good));
        let (report, _, _) = demo.quit();
        assert_eq!(report["reread"].as_array().unwrap().len(), 0);
    }
}
