//! Runs that a signal ends leave no files.
#![cfg(unix)]

use crate::common::cli::{command, contents};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Starts the program, waits for a non-empty temporary file, and sends the signal.
fn interrupt(signal: &str, number: i32, arguments: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = command();
    let program = program.args(arguments).current_dir(folder.path());
    let mut program = program
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let has_begun = || {
        let files = std::fs::read_dir(folder.path()).unwrap().flatten();
        let mut sizes = files.filter_map(|file| file.metadata().ok());
        sizes.any(|about| about.len() > 0)
    };
    while !has_begun() {
        assert!(
            program.try_wait().unwrap().is_none(),
            "{arguments:?} ended too soon"
        );
        sleep(Duration::from_millis(5));
    }
    let id = program.id().to_string();
    let sent = Command::new("kill").args(["-s", signal, &id]).status();
    assert!(sent.unwrap().success());
    let ended = program.wait().unwrap();
    assert_eq!(ended.code(), Some(128 + number), "{signal}: {arguments:?}");
    let left = contents(folder.path());
    assert!(left.is_empty(), "{signal}: {:?}", left.keys());
}

/// Protects folders from leftovers of runs that are interrupted by the terminal, by another program, or by closing the
/// terminal.
#[test]
fn an_interrupted_run_leaves_nothing() {
    let render = ["render", "corner", "-o", "o.wav", "--seconds", "9000"];
    let dump = [
        "trace",
        "open-field",
        "--waves",
        "8388608",
        "--iterations",
        "1",
        "--dump-waves",
        "w.csv",
    ];
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        interrupt(signal, number, &render);
    }
    interrupt("TERM", 15, &dump);
    // With `nohup`, this test process ignores SIGHUP, and the program must then continue.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    if ignored.unwrap_or(0) & 1 == 0 {
        interrupt("HUP", 1, &render);
    }
}

/// Protects the window's files: an interrupted window closes normally.
#[cfg(feature = "demo")]
#[test]
fn an_interrupted_window_is_closed() {
    use std::io::{BufRead, BufReader};
    let display = crate::common::window::Display::new();
    let folder = tempfile::tempdir().unwrap();
    let mut program = command();
    let program = program
        .args([
            "demo",
            "--waves",
            "64",
            "--scale",
            "0.1",
            "--screenshot",
            "last.png",
        ])
        .arg("--log-frames")
        .current_dir(folder.path())
        .env("DISPLAY", &display.name);
    let mut program = program
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(program.stderr.take().unwrap()).lines();
    let frame = lines.find(|line| {
        line.as_ref()
            .is_ok_and(|line| line.starts_with("{\"frame\""))
    });
    assert!(frame.is_some(), "no frame was drawn");
    let read_on = std::thread::spawn(move || lines.count());
    let id = program.id().to_string();
    let sent = Command::new("kill").args(["-s", "TERM", &id]).status();
    assert!(sent.unwrap().success());
    assert_eq!(program.wait().unwrap().code(), Some(128 + 15));
    read_on.join().unwrap();
    let left: Vec<_> = contents(folder.path()).into_keys().collect();
    assert_eq!(left, [folder.path().join("last.png")]);
}
