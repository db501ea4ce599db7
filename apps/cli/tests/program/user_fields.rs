//! Users' fields on the command line: watched files, and the printed shader.

use crate::common::cli::{command, json, stdout, succeed};
use crate::common::field_files::{BALL, SCENE, write};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// Protects the cycle of editing a field and tracing it: errors are reported, and the next valid state is traced.
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
    // Each change waits for the result of the previous change, however long it takes.
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

/// Protects the output of `shader`: it is the complete shader text, including the user's text.
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
