//! The window as a person uses it: a display without a screen, real key presses, pictures.
//!
//! Needs Xvfb and xdotool (Debian packages of these names); a machine without them fails.
#![cfg(feature = "demo")]

mod common;

use common::cli::{argument, command, echomarch, stderr, succeed};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Windows one after the other: together they would be too slow for their own keys.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Longer than any window takes to open, on any machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A display without a screen; it goes when dropped.
struct Display {
    server: Child,
    name: String,
    _alone: MutexGuard<'static, ()>,
}

impl Display {
    fn new() -> Display {
        let alone = ONE_AT_A_TIME.lock().unwrap_or_else(|e| e.into_inner());
        let mut server = Command::new("Xvfb")
            // Without -noreset it starts over, and refuses clients, when the last window goes.
            .args(["-noreset", "-displayfd", "1", "-screen", "0", "1280x800x24"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb is missing: install the Debian package xvfb");
        let mut number = String::new();
        let out = server.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut number).unwrap();
        Display {
            server,
            name: format!(":{}", number.trim()),
            _alone: alone,
        }
    }

    /// Opens the window with these arguments, in a folder of its own.
    fn demo(&self, arguments: &[&str]) -> Demo<'_> {
        let folder = tempfile::tempdir().unwrap();
        let child = command()
            .current_dir(folder.path())
            .env("DISPLAY", &self.name)
            .args(["demo", "--json", "--waves", "4096", "--scale", "0.25"])
            .args(["--screenshot", "last.png", "--no-help"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let demo = Demo {
            display: self,
            child: Some(child),
            folder,
        };
        demo.focus();
        demo
    }

    fn xdotool(&self, arguments: &[&str]) -> String {
        let output = Command::new("xdotool")
            .env("DISPLAY", &self.name)
            .args(arguments)
            .output()
            .expect("xdotool is missing: install the Debian package xdotool");
        String::from_utf8(output.stdout).unwrap()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program with its window open.
struct Demo<'a> {
    display: &'a Display,
    child: Option<Child>,
    folder: TempDir,
}

impl Demo<'_> {
    /// Gives the window the keyboard, once it is there and has drawn.
    fn focus(&self) {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            let found = self.display.xdotool(&["search", "--name", "^Echomarch$"]);
            if let Some(window) = found.lines().next() {
                self.display.xdotool(&["windowfocus", "--sync", window]);
                sleep(Duration::from_millis(500));
                return;
            }
            sleep(Duration::from_millis(50));
        }
        panic!("no window opened");
    }

    fn key(&self, key: &str) -> &Self {
        self.display.xdotool(&["key", key]);
        sleep(Duration::from_millis(250));
        self
    }

    fn hold(&self, key: &str, seconds: f64) -> &Self {
        self.display.xdotool(&["keydown", key]);
        sleep(Duration::from_secs_f64(seconds));
        self.display.xdotool(&["keyup", key]);
        sleep(Duration::from_millis(250));
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Closes the window by its key; the report and the last picture.
    fn quit(mut self) -> (Value, Image, TempDir) {
        self.key("ctrl+q");
        let report = self.report();
        let picture = Image::open(&self.path("last.png"));
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir().unwrap());
        (report, picture, folder)
    }

    fn report(&mut self) -> Value {
        let output = self.child.take().unwrap().wait_with_output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["gl_errors"], 0, "{report}");
        report
    }
}

impl Drop for Demo<'_> {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// A picture of the window.
struct Image {
    width: u32,
    pixels: Vec<u8>,
}

impl Image {
    fn open(path: &Path) -> Image {
        let picture = image::open(path).unwrap().to_rgba8();
        Image {
            width: picture.width(),
            pixels: picture.into_raw(),
        }
    }

    /// The share of pixels that differ by more than a shade, in columns that panels do not cover.
    fn difference(&self, other: &Image, columns: std::ops::Range<u32>) -> f64 {
        assert_eq!(self.pixels.len(), other.pixels.len());
        let pairs = self.pixels.chunks(4).zip(other.pixels.chunks(4));
        let (mut all, mut different) = (0u32, 0u32);
        for (index, (a, b)) in pairs.enumerate() {
            if columns.contains(&(index as u32 % self.width)) {
                all += 1;
                let apart = a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 12);
                different += u32::from(apart);
            }
        }
        f64::from(different) / f64::from(all)
    }
}

/// The middle of the window, where the picture is seen.
const MIDDLE: std::ops::Range<u32> = 270..700;

fn place(value: &Value) -> [f64; 3] {
    std::array::from_fn(|axis| value[axis].as_f64().unwrap())
}

/// Protects walking: keys held move the listener along its gaze, walls stop it, what is seen follows, and the
/// picture of one who stands still stays.
#[test]
fn keys_walk_and_walls_stop() {
    let display = Display::new();
    let (still, before, _) = display.demo(&["corner"]).quit();
    assert_eq!(place(&still["listener"]["position"]), [10.0, 0.0, 8.0]);
    let (_, again, _) = display.demo(&["corner"]).quit();
    assert!(before.difference(&again, MIDDLE) < 0.005);

    let demo = display.demo(&["corner"]);
    demo.hold("s", 1.0);
    let (walked, after, _) = demo.quit();
    let [x, _, z] = place(&walked["listener"]["position"]);
    assert!((x - 10.0).abs() < 1e-3 && z > 8.2, "{x} {z}");
    assert!(before.difference(&after, MIDDLE) > 0.05);

    // The block's face is at z = 0; straight on lies nothing else.
    let demo = display.demo(&["corner"]);
    demo.display.xdotool(&["keydown", "shift"]);
    demo.hold("w", 6.0);
    demo.display.xdotool(&["keyup", "shift"]);
    let (stopped, _, _) = demo.quit();
    let [_, _, z] = place(&stopped["listener"]["position"]);
    assert!((0.3..0.4).contains(&z), "stopped at {z}");
}

/// Protects hearing what changes: 1, 2 and 3 switch the algorithm while the window runs, and each is heard.
#[test]
fn keys_switch_the_profile() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    for key in ["1", "2", "3", "1"] {
        demo.key(key);
        sleep(Duration::from_millis(900));
    }
    let (report, _, _) = demo.quit();
    assert_eq!(report["profile"], "thesis");
    let mut heard: Vec<&str> = report["pans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pan| pan["profile"].as_str().unwrap())
        .collect();
    heard.dedup();
    assert_eq!(heard, ["hybrid", "thesis", "march", "hybrid", "thesis"]);
    let call = report["trace_call"].as_str().unwrap();
    assert!(call.contains("--profile thesis --waves 4096"), "{call}");
}

/// Protects whoever has never seen it: F1 opens the list of keys, and closes it.
#[test]
fn f1_opens_and_closes_the_help() {
    let display = Display::new();
    let (closed, without, _) = display.demo(&["corner"]).quit();
    assert_eq!(closed["help"], false);
    let demo = display.demo(&["corner"]);
    demo.key("F1");
    let (open, with, _) = demo.quit();
    assert_eq!(open["help"], true);
    assert!(without.difference(&with, 340..620) > 0.3);
    let demo = display.demo(&["corner"]);
    demo.key("F1").key("h");
    let (closed, again, _) = demo.quit();
    assert_eq!(closed["help"], false);
    assert!(without.difference(&again, MIDDLE) < 0.005);
}

/// Protects what was set up by hand: a source that was picked up comes along and is heard elsewhere; the file
/// saved is a scene that traces to the very pan that was heard last.
#[test]
fn a_source_carried_and_saved_is_heard_alike_from_the_file() {
    let display = Display::new();
    let demo = display.demo(&["corner"]);
    demo.key("f").hold("Left", 0.5).hold("s", 0.5).key("f");
    demo.key("F5");
    let (report, _, folder) = demo.quit();
    let source = place(&report["source"]);
    assert!((source[0] + 8.0).abs() > 1.0, "{source:?}");
    assert_eq!(report["saved"][0], "corner-1.ron");
    assert_eq!(report["trace_call_is_exact"], true);

    let scene = folder.path().join("corner-1.ron");
    let traced = succeed(&["trace", argument(&scene), "--waves", "4096", "--json"]);
    let traced: Value = serde_json::from_slice(&traced.stdout).unwrap();
    let pans = report["pans"].as_array().unwrap();
    let heard = pans.last().unwrap()["pan"].as_f64().unwrap();
    assert!((traced["pan"].as_f64().unwrap() - heard).abs() < 0.02);
    assert_eq!(traced["waves"], 4096);
    assert_eq!(
        Value::from(&report["trace_call"].as_str().unwrap()[..29]),
        "echomarch trace corner-1.ron "
    );
}

/// Protects moving scenes: the source passes by itself and is heard from left to right, until P holds it.
#[test]
fn a_moving_source_is_heard_to_move_until_it_is_held() {
    let display = Display::new();
    let demo = display.demo(&["open-field"]);
    sleep(Duration::from_millis(3200));
    demo.key("p");
    sleep(Duration::from_millis(700));
    let (report, _, _) = demo.quit();
    let pans: Vec<f64> = report["pans"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pan| pan["pan"].as_f64().unwrap())
        .collect();
    assert!(pans[0] < -0.3, "{}", pans[0]);
    let greatest = pans.iter().copied().fold(f64::MIN, f64::max);
    assert!(greatest > 0.2, "{greatest}");
    let held = &pans[pans.len() - 3..];
    assert!(held.iter().all(|pan| *pan == held[0]), "{held:?}");
}

/// Protects runs that end by themselves, and windows of any size: exactly so many frames.
#[test]
fn a_run_ends_after_its_frames() {
    let display = Display::new();
    let mut demo = display.demo(&[
        "shoebox", "--frames", "40", "--width", "640", "--height", "360",
    ]);
    let report = demo.report();
    assert_eq!(report["frames"], 40);
    assert_eq!(report["window"], serde_json::json!([640, 360]));
    assert!(report["fps_median"].as_f64().unwrap() > 0.0);
    assert_eq!(Image::open(&demo.path("last.png")).width, 640);
}

/// Protects machines without a display: one sentence, exit code 1, and what there is instead.
#[test]
fn a_missing_display_is_told_in_one_sentence() {
    for (name, reason) in [("", "DISPLAY is not set"), (":4711", "DISPLAY is :4711")] {
        let output = command().arg("demo").env("DISPLAY", name).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let told = stderr(&output);
        assert!(told.starts_with("echomarch: no display: "), "{told}");
        assert!(told.contains(reason) && told.contains("trace, view, render"));
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

/// Protects against a window that opens on what was mistyped: exit code 2 before any display is asked for.
#[test]
fn bad_input_opens_no_window() {
    for arguments in [
        ["demo", "nowhere"].as_slice(),
        &["demo", "corner", "--volume", "2"],
        &["demo", "corner", "--sound", "trumpet"],
        &["demo", "corner", "--screenshot", "picture.jpg"],
        &["demo", "corner", "--trace-every", "0"],
        &["demo", "corner", "--fps", "0"],
        &["demo", "corner", "--gl", "osmesa"],
    ] {
        let output = echomarch(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let told = stderr(&output);
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}
