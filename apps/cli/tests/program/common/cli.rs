//! Runs the program on the command line.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Returns a command that runs the program without arguments.
pub fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_echomarch"))
}

/// Runs the program with standard output and standard error redirected.
pub fn echomarch(arguments: &[&str]) -> Output {
    command().args(arguments).output().unwrap()
}

/// Runs the program and requires exit code 0.
pub fn succeed(arguments: &[&str]) -> Output {
    let output = echomarch(arguments);
    let errors = stderr(&output);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    output
}

/// Runs the program with `--json`, requires exit code 0, and parses its output.
pub fn json(arguments: &[&str]) -> serde_json::Value {
    let output = succeed(&[arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs the program and requires that it refuses the input with one sentence that contains `told`.
pub fn refuse(arguments: &[&str], told: &str) {
    let output = echomarch(arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(told), "{arguments:?}: {said}");
    assert_eq!(said.trim_end().lines().count(), 1, "one sentence: {said}");
    assert!(output.stdout.is_empty());
}

/// Runs the program in a folder.
pub fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    let mut program = command();
    let program = program.args(arguments).current_dir(folder);
    program.output().unwrap()
}

/// Runs the program in `folder`. The program must refuse the input and leave the folder unchanged.
pub fn refused(folder: &Path, arguments: &[&str]) -> Output {
    let before = contents(folder);
    let output = run_in(folder, arguments);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert_eq!(stdout(&output), "", "{arguments:?}");
    assert!(contents(folder) == before, "{arguments:?}: {said}");
    output
}

/// Returns the entries of a folder, with the contents of regular files smaller than one mebibyte.
pub fn contents(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .map(|path| {
            let is_read = path.is_file() && path.metadata().unwrap().len() < 1 << 20;
            let bytes = is_read.then(|| std::fs::read(&path).unwrap());
            (path, bytes)
        })
        .collect()
}

pub fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

pub fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// Returns a path as an argument.
pub fn argument(path: &Path) -> &str {
    path.to_str().unwrap()
}
