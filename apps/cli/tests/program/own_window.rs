//! The example of a game that traces waves on the context of its own window.

use super::common::window::Display;
use std::path::PathBuf;
use std::process::Command;

/// Protects `apps/window/examples/own_window.rs`: a window of winit and glutin draws pictures, and traces frames of
/// waves between the pictures.
#[test]
fn a_game_traces_waves_on_its_own_context() {
    let display = Display::new();
    let game = Command::new(built())
        .arg("200")
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&game.stderr);
    assert!(game.status.success(), "{errors}");
    let out = String::from_utf8(game.stdout).unwrap();
    assert!(out.contains("renderer: "), "{out}");
    let last = out.lines().last().unwrap_or_default();
    let frames = last
        .strip_prefix("200 pictures, ")
        .and_then(|rest| rest.strip_suffix(" frames of waves"))
        .and_then(|frames| frames.parse::<u32>().ok());
    assert!(frames.is_some_and(|frames| frames > 0), "{out}");
}

/// Builds the example and returns its path. The features are those of the whole workspace, as in `scripts/test.sh`, so
/// that no package is compiled again for the example.
fn built() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let profile = test.ancestors().nth(2).unwrap();
    let build = Command::new(env!("CARGO"))
        .args([
            "build",
            "--locked",
            "--quiet",
            "--workspace",
            "--all-features",
        ])
        .args(["--example", "own_window", "--target-dir"])
        .arg(profile.parent().unwrap())
        .args(profile.ends_with("release").then_some("--release"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&build.stderr);
    assert!(build.status.success(), "{errors}");
    profile.join("examples/own_window")
}
