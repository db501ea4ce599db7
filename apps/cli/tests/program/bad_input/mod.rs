//! Invalid input causes one sentence that states the mistake and its position, and exit code 2. Invalid input changes
//! no file. Unusual but valid input causes a warning and a result.

mod arguments;
mod scene_files;
mod warnings;

use crate::common::cli::{refused, stderr};
use std::path::Path;
use tempfile::TempDir;

const SCENE: &str = "\
Scene(
    surfaces: [
        Surface(shape: Sphere(radius: 1), position: (0, 0, -9)),
    ],
    source: Source(position: (0, 5, 0)),
    listener: Listener(position: (4, 0, 0), radius: 1),
)
";

/// A working folder that contains `scene.ron`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.ron"), SCENE).unwrap();
    folder
}

/// Runs the program, which must refuse the arguments itself. Returns the one line that it prints.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let lines: Vec<&str> = stderr(&output).lines().collect();
    let [line] = lines[..] else {
        panic!("{arguments:?}: expected one line: {lines:?}");
    };
    let sentence = line.strip_prefix("echomarch: ");
    let sentence = sentence.unwrap_or_else(|| panic!("{arguments:?}: {line}"));
    // The sentence must not state its cause twice.
    if let Some((_, cause)) = sentence.rsplit_once(": ") {
        assert_eq!(sentence.matches(cause).count(), 1, "{sentence}");
    }
    sentence.to_owned()
}
