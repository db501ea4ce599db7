//! The example of a game that traces waves on the context of its own window.

use super::common::window::Display;
use std::process::Command;

/// Protects `examples/own_window.rs`: a window of winit and glutin draws pictures, and traces frames of waves between
/// them.
#[test]
fn a_game_traces_waves_on_its_own_context() {
    let display = Display::new();
    let game = Command::new(env!("CARGO"))
        .args([
            "run",
            "--locked",
            "--quiet",
            "-p",
            "echomarch-window",
            "--example",
            "own_window",
        ])
        .args(["--", "200"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
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
