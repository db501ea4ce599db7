//! Helpers that control the window as a user does, with a virtual display, real key presses and screenshots.
//!
//! The helpers need Xvfb and xdotool, which are Debian packages of the same names. Without them the tests fail.

use super::cli::command;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};
use tempfile::TempDir;

/// Allows only one window at a time. Several windows would react too slowly to keys.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Maximum wait before a test fails. The limit exceeds the time that any machine needs.
const TIMEOUT: Duration = Duration::from_secs(300);

/// A virtual display, closed on drop.
pub struct Display {
    server: Child,
    pub name: String,
    _alone: MutexGuard<'static, ()>,
}

impl Display {
    pub fn new() -> Display {
        let alone = ONE_AT_A_TIME.lock().unwrap_or_else(|e| e.into_inner());
        let mut server = Command::new("Xvfb")
            // Without -noreset, the server restarts and refuses clients when the last window closes.
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

    /// Opens the window with these arguments, in a new folder.
    pub fn demo(&self, arguments: &[&str]) -> Demo<'_> {
        self.start(command(), arguments)
    }

    /// Opens the window as [`demo`](Display::demo) does, with a custom command that starts the program.
    pub fn start(&self, mut command: Command, arguments: &[&str]) -> Demo<'_> {
        command
            .args(["demo", "--json", "--waves", "4096", "--scale", "0.25"])
            .args(["--screenshot", "last.png", "--no-help"])
            .args(arguments);
        self.open(command)
    }

    /// Opens the window with a complete command, in a new folder.
    pub fn open(&self, mut command: Command) -> Demo<'_> {
        let folder = tempfile::tempdir().unwrap();
        let mut child = command
            .arg("--log-frames")
            .current_dir(folder.path())
            .env("DISPLAY", &self.name)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let errors = BufReader::new(child.stderr.take().unwrap());
        let (sender, told) = mpsc::channel();
        let (to_frames, frames) = mpsc::channel();
        std::thread::spawn(move || {
            for line in errors.lines().map_while(Result::ok) {
                // The receiver may have been dropped.
                let _ = match line.starts_with(r#"{"frame":"#) {
                    true => to_frames.send(line).is_ok(),
                    false => sender.send(line).is_ok(),
                };
            }
        });
        let demo = Demo {
            display: self,
            child: Some(child),
            told,
            frames,
            folder,
        };
        demo.focus();
        demo
    }

    /// Kills the display server, to simulate a crash.
    pub fn end(&self) {
        let pid = self.server.id().to_string();
        let ended = Command::new("kill").args(["-9", &pid]).status().unwrap();
        assert!(ended.success());
    }

    pub fn xdotool(&self, arguments: &[&str]) -> String {
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
pub struct Demo<'a> {
    pub display: &'a Display,
    child: Option<Child>,
    told: Receiver<String>,
    frames: Receiver<String>,
    folder: TempDir,
}

impl Demo<'_> {
    /// Waits until the window is open and has drawn, then gives it the keyboard focus.
    fn focus(&self) {
        let window = self.window();
        self.wait_frames();
        self.display.xdotool(&["windowfocus", "--sync", &window]);
        self.wait_frames();
    }

    /// Waits until the window has drawn the effects of all earlier actions. The first frame that begins after this call
    /// may have polled its events before the call. The next two frames poll their events later, and panels follow one
    /// frame later. Returns at once if the window has closed.
    pub fn wait_frames(&self) {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let now = since_1970.unwrap().as_secs_f64();
        let mut fresh = 0;
        while fresh < 3 {
            match self.frames.recv_timeout(TIMEOUT) {
                Ok(line) => {
                    let frame: Value = serde_json::from_str(&line).unwrap();
                    fresh += u32::from(frame["began"].as_f64() > Some(now));
                }
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => panic!("no frame was drawn in time"),
            }
        }
    }

    /// Waits until the program prints a frame for which `is_so` returns true, and returns that frame.
    pub fn wait_until(&self, what: &str, mut is_so: impl FnMut(&Value) -> bool) -> Value {
        let end = Instant::now() + TIMEOUT;
        let mut last = Value::Null;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let Ok(line) = self.frames.recv_timeout(left) else {
                let told: Vec<String> = self.told.try_iter().collect();
                panic!("waited for: {what}; last frame {last}; {told:?}");
            };
            last = serde_json::from_str(&line).unwrap();
            if is_so(&last) {
                return last;
            }
        }
    }

    /// Waits until `more` further frames of waves have been played.
    pub fn wait_traced(&self, more: u64) {
        self.wait_frames();
        let mut first = None;
        self.wait_until("frames of waves", |frame| {
            let traced = frame["traced"].as_u64().unwrap();
            traced >= *first.get_or_insert(traced) + more
        });
    }

    /// Waits until the window is open, and returns its identifier on the display.
    pub fn window(&self) -> String {
        let began = Instant::now();
        while began.elapsed() < TIMEOUT {
            let found = self.display.xdotool(&["search", "--name", "^Echomarch$"]);
            if let Some(window) = found.lines().next() {
                return window.to_owned();
            }
            sleep(Duration::from_millis(50));
        }
        panic!(
            "no window opened: {:?}",
            self.told.try_iter().collect::<Vec<_>>()
        );
    }

    /// Waits until the program prints a line that contains `part`.
    pub fn wait_for(&self, part: &str) -> String {
        let end = Instant::now() + TIMEOUT;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line = self.told.recv_timeout(left);
            let line = line.unwrap_or_else(|_| panic!("the program did not print {part:?}"));
            if line.contains(part) {
                return line;
            }
        }
    }

    pub fn key(&self, key: &str) -> &Self {
        self.display.xdotool(&["key", key]);
        self.wait_frames();
        self
    }

    /// Holds a key down for `seconds` of the window's own clock, and for at least twenty frames. The minimum is needed
    /// because the walking time of one frame is limited, so that a slow window moves less than its frame time.
    pub fn hold(&self, key: &str, seconds: f64) -> &Self {
        let mut begin = None;
        self.hold_until(key, "time to pass", |frame| {
            let at = |name: &str| frame[name].as_f64().unwrap();
            let now = [at("seconds"), at("frame")];
            let from = *begin.get_or_insert(now);
            now[0] >= from[0] + seconds && now[1] >= from[1] + 20.0
        })
    }

    /// Holds a key down until `is_so` returns true for a frame.
    pub fn hold_until(&self, key: &str, what: &str, is_so: impl FnMut(&Value) -> bool) -> &Self {
        self.display.xdotool(&["keydown", key]);
        self.wait_frames();
        self.wait_until(what, is_so);
        self.display.xdotool(&["keyup", key]);
        self.wait_frames();
        self
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Closes the window with its key. Returns the report and the last screenshot.
    pub fn quit(mut self) -> (Value, Image, TempDir) {
        // This function does not wait for a frame: the report may exceed the buffer of a pipe, and the program ends
        // only after the report has been read.
        self.display.xdotool(&["key", "ctrl+q"]);
        let report = self.report();
        let picture = Image::open(&self.path("last.png"));
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir().unwrap());
        (report, picture, folder)
    }

    /// Waits until the program has ended by itself. Returns its exit code, its output and its messages.
    pub fn ended(mut self) -> (Option<i32>, String, Vec<String>) {
        let output = self.child.take().unwrap().wait_with_output().unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        (output.status.code(), printed, self.told.iter().collect())
    }

    pub fn report(&mut self) -> Value {
        let output = self.child.take().unwrap().wait_with_output().unwrap();
        let told = || self.told.iter().collect::<Vec<_>>().join("\n");
        assert!(output.status.success(), "{}", told());
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

/// A screenshot of the window.
pub struct Image {
    pub width: u32,
    pixels: Vec<u8>,
}

impl Image {
    pub fn open(path: &Path) -> Image {
        let picture = image::open(path).unwrap().to_rgba8();
        Image {
            width: picture.width(),
            pixels: picture.into_raw(),
        }
    }

    /// Returns the share of pixels in these columns that have more red than blue.
    pub fn warm(&self, columns: Range<u32>) -> f64 {
        let pixels = self.pixels.chunks(4).enumerate();
        let within = pixels.filter(|(index, _)| columns.contains(&(*index as u32 % self.width)));
        let (mut all, mut warm) = (0u32, 0u32);
        for (_, pixel) in within {
            all += 1;
            warm += u32::from(pixel[0] > pixel[2]);
        }
        f64::from(warm) / f64::from(all)
    }

    /// Returns the share of pixels whose colour differs visibly, in columns that panels do not cover.
    pub fn difference(&self, other: &Image, columns: Range<u32>) -> f64 {
        self.difference_in(other, columns, 0..u32::MAX)
    }

    /// Returns the share of pixels whose colour differs visibly, in these columns and rows.
    pub fn difference_in(&self, other: &Image, columns: Range<u32>, rows: Range<u32>) -> f64 {
        assert_eq!(self.pixels.len(), other.pixels.len());
        let pairs = self.pixels.chunks(4).zip(other.pixels.chunks(4));
        let (mut all, mut different) = (0u32, 0u32);
        for (index, (a, b)) in pairs.enumerate() {
            let (row, column) = (index as u32 / self.width, index as u32 % self.width);
            if columns.contains(&column) && rows.contains(&row) {
                all += 1;
                let apart = a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 12);
                different += u32::from(apart);
            }
        }
        f64::from(different) / f64::from(all)
    }
}
