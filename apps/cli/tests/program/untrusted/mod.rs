//! Untrusted files: their contents are read within limits and shown only as text. The files are never overwritten.
#![cfg(unix)]

mod fields;
mod limits;
mod meshes;
mod names;
mod overwriting;
mod scenes;

use crate::answers::{answer_file, trial};
use crate::common::cli::{refused, stderr};
use std::path::Path;
use tempfile::TempDir;

/// A scene with this shape.
fn scene(shape: &str) -> String {
    format!(
        "Scene(surfaces: [Surface(shape: {shape})], source: Source(position: (-3, 5, 1)), \
         listener: Listener(position: (3, 5, 1), radius: 1))"
    )
}

/// A working folder that contains `scene.ron`.
fn folder_with(shape: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.ron"), scene(shape)).unwrap();
    folder
}

/// Runs the program in `folder`. The program must refuse with one sentence, which is returned, and leave the folder
/// unchanged.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let said = stderr(&output);
    let lines = said.lines().filter(|line| line.starts_with("echomarch: "));
    let [line] = lines.collect::<Vec<_>>()[..] else {
        panic!("{arguments:?}: expected one sentence: {said}");
    };
    line.to_owned()
}

/// Answers to one trial.
fn answers(scene: &str, participant: &str) -> String {
    let mut file = answer_file("aa", &[1], [trial(1, -48.4, 45.0)]);
    file["participant"] = participant.into();
    file["trials"][0]["stimulus"]["scene"] = scene.into();
    file.to_string()
}
