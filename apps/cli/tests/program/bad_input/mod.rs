//! Unusable input: one sentence that states the mistake and its place, exit code 2, and no file
//! changed. Input that is only odd: a warning, and a result.

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

/// The one line that the program prints for arguments that it refuses itself.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = refused(folder, arguments);
    let lines: Vec<&str> = stderr(&output).lines().collect();
    let [line] = lines[..] else {
        panic!("{arguments:?}: expected one line: {lines:?}");
    };
    let sentence = line.strip_prefix("echomarch: ");
    let sentence = sentence.unwrap_or_else(|| panic!("{arguments:?}: {line}"));
    // A cause that the sentence contains must not follow it again.
    if let Some((_, cause)) = sentence.rsplit_once(": ") {
        assert_eq!(sentence.matches(cause).count(), 1, "{sentence}");
    }
    sentence.to_owned()
}
