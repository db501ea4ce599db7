//! Scenes that follow the files of their fields, in the library and on the command line.

use super::{BALL, settings};
use crate::common::for_each_api;
use echomarch::trace::{Reload, Reloading};
use echomarch::{Profile, Settings, Tracer};
use std::path::Path;

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

/// The first change that the next polls of the files return.
fn settle(reloading: &mut Reloading, tracer: &mut Tracer, settings: &Settings) -> Reload {
    for _ in 0..3 {
        match reloading.poll(tracer, settings) {
            Reload::Unchanged => (),
            change => return change,
        }
    }
    Reload::Unchanged
}

/// Protects a running program from every broken state of the files: the last good scene stays until
/// the next good one.
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
        // The program is compiled before the first frame needs it.
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

    /// Protects the loop of writing a field and listening: errors are reported, and the next good
    /// state is traced.
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
        // Each waits for the result of the previous change, however long that takes.
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
        // Each change is reported or traced only once.
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

    /// Protects the output of `shader`: the compiled text, including the user's text.
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
