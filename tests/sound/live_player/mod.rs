//! The player of the tests that use a sound server: this test program, started again with the address of the server in
//! its environment. This module defines what the player plays, and how a test starts and observes it.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

use echomarch::audio::PanningLaw;
use echomarch::audio::live::{Live, LiveError, LiveOptions, list_devices};

use crate::sound_server::{Process, SINK, TIMEOUT, wait_for};

/// Names the part of the player to run.
const PART: &str = "ECHOMARCH_TEST_PART";
/// Names the file to record to.
const FILE: &str = "ECHOMARCH_TEST_FILE";

/// Seconds that the sound stays at each position, and the number of positions from left to right.
pub const STEP_S: f64 = 0.4;
pub const PLACES: u32 = 9;
pub const SWEEP_S: f64 = 3.0;

/// Number of times that the device is closed and opened again.
pub const CLOSINGS: u64 = 5;

/// The player's part of each test; does nothing unless a test starts it.
pub fn play() {
    match std::env::var(PART).as_deref() {
        Ok("sweep") => play_sweep(),
        Ok("close") => play_and_close(),
        Ok("endure") => play_on(),
        Ok("devices") => play_devices(),
        Ok("recordings") => play_recordings(),
        Ok("changes") => play_changes_in_silence(),
        Ok("nothing") => play_without_device(),
        _ => {}
    }
}

fn start(device: Option<&str>) -> Live {
    let options = LiveOptions {
        device: device.map(str::to_owned),
        // In the centre each side has half of the sound.
        law: PanningLaw::Linear,
        ..LiveOptions::default()
    };
    Live::start("noise".parse().unwrap(), options)
}

fn file() -> PathBuf {
    std::env::var_os(FILE).unwrap().into()
}

fn wait_for_sound(live: &Live) {
    wait_for("sound", || live.levels() != [0.0, 0.0]);
}

pub fn pause(seconds: f64) {
    std::thread::sleep(Duration::from_secs_f64(seconds));
}

fn place(step: u32) -> f64 {
    f64::from(step) / f64::from(PLACES - 1)
}

fn play_sweep() {
    let live = start(None);
    live.set_panning(1.0, 0.0);
    wait_for_sound(&live);
    live.start_recording(&file()).unwrap();
    assert!(matches!(
        live.start_recording(&file()),
        Err(LiveError::AlreadyRecording)
    ));
    let mut log = String::new();
    let mut set = |along: f64| {
        log += &format!(" {along:.6}");
        live.set_panning(1.0 - along, along);
    };
    // At the end, returns to the first position, where the sweep begins.
    for step in (0..PLACES).chain([0]) {
        set(place(step));
        pause(STEP_S);
    }
    let start = Instant::now();
    while start.elapsed().as_secs_f64() < SWEEP_S {
        set(start.elapsed().as_secs_f64() / SWEEP_S);
        pause(0.01);
    }
    set(1.0);
    pause(STEP_S);
    set(1.0);
    let status = live.status();
    let frames = live.stop_recording().unwrap();
    println!("{status:?}");
    println!("places{log}");
    println!("recorded {frames}, dropped {}", status.dropped_frames);
    assert!(status.pan_waited_ms.is_some());
    assert!(matches!(
        live.stop_recording(),
        Err(LiveError::NotRecording)
    ));
    assert_eq!(status.sample_rate, 48_000);
}

/// Plays a sine, and closes and opens the device at several points of the sine's period. The buffer is long, so that a
/// busy machine leaves no gap.
fn play_and_close() {
    let options = LiveOptions {
        buffer_frames: 4096,
        ..LiveOptions::default()
    };
    let live = Live::start("sine:100".parse().unwrap(), options);
    live.set_panning(1.0, 0.0);
    for restarts in 0..CLOSINGS {
        wait_for("the device", || {
            let status = live.status();
            // A busy machine may have lost the device in the meantime.
            status.device.is_some() && status.restarts - status.losses == restarts
        });
        wait_for_sound(&live);
        pause(0.4 + 0.0133 * restarts as f64);
        live.set_device(None);
    }
    wait_for("the last device", || {
        let status = live.status();
        status.device.is_some() && status.restarts - status.losses == CLOSINGS
    });
    wait_for_sound(&live);
    pause(0.4);
    println!("late callbacks {}", live.status().late_callbacks);
}

/// Plays until its input ends, and prints each change of its status.
fn play_on() {
    let is_over = Arc::new(AtomicBool::new(false));
    let theirs = Arc::clone(&is_over);
    std::thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        theirs.store(true, Relaxed);
    });
    let live = start(None);
    wait_for_sound(&live);
    live.start_recording(&file()).unwrap();
    let mut told = String::new();
    while !is_over.load(Relaxed) {
        let status = live.status();
        let line = format!(
            "state: device {:?}, restarts {}, losses {}, heard {}, error {:?}",
            status.device,
            status.restarts,
            status.losses,
            live.levels() != [0.0, 0.0],
            status.last_error,
        );
        if line != told {
            println!("{line}");
            told = line;
        }
        pause(0.02);
    }
    println!("recorded {}", live.stop_recording().unwrap());
}

fn play_devices() {
    let devices = list_devices();
    println!("{devices:?}");
    let default = devices.iter().find(|device| device.default).unwrap();
    assert_eq!(default.id, SINK);
    assert_eq!(default.channels, 2);
    let other = devices.iter().find(|device| device.id == "other").unwrap();
    assert_eq!(other.channels, 1);

    let live = start(None);
    live.set_panning(1.0, 0.0);
    wait_for_sound(&live);
    live.start_recording(&file()).unwrap();
    live.set_device(Some(other.name.clone()));
    wait_for("the other device", || live.status().sample_rate == 44_100);
    wait_for_sound(&live);
    let status = live.status();
    println!("{status:?}");
    assert_eq!(status.device.as_deref(), Some(other.name.as_str()));
    assert!(status.restarts >= 1);
    assert!(!status.is_recording);
    assert!(status.last_error.unwrap().contains("44100 Hz"));
    assert!(live.stop_recording().unwrap() > 0);
    pause(0.5);

    live.set_device(Some("no such device".to_owned()));
    wait_for("an error", || {
        let error = live.status().last_error.unwrap_or_default();
        error.contains("`no such device`") && error.contains(&other.name)
    });
    assert_eq!(live.status().device, None);
    live.set_device(None);
    wait_for("the first device", || live.status().sample_rate == 48_000);
    wait_for_sound(&live);
    assert!(live.status().restarts >= 2);
}

/// Starts a recording before the first device opens. The rate of this device differs from the assumed rate. Later a
/// change of the rate ends the recording. Then a second recording is made.
fn play_recordings() {
    let live = start(Some("other"));
    live.start_recording(&file()).unwrap();
    wait_for_sound(&live);
    wait_recorded("heard", 4410);
    let status = live.status();
    assert!(status.is_recording, "{status:?}");
    assert_eq!((status.sample_rate, status.notice), (44_100, None));
    live.set_device(None);
    wait_for("the end of the recording", || !live.status().is_recording);
    wait_for_sound(&live);
    let status = live.status();
    let told = status.notice.unwrap();
    assert!(told.contains("48000 Hz"), "{told}");
    assert!(status.device.is_some() && status.has_sound);
    // The notice has been read and does not block a new recording.
    let again = file().with_file_name("again.wav");
    live.start_recording(&again).unwrap();
    let status = live.status();
    assert!(status.is_recording && status.notice.is_none(), "{status:?}");
    // A program interrupted now leaves a readable file.
    wait_recorded("again", 24_000);
    let part = part_of("again");
    assert!(live.stop_recording().unwrap() > 24_000);
    assert!(again.exists() && !part.exists());

    live.set_sound("no-such-file.wav".parse().unwrap());
    wait_for("the file's error", || live.status().notice.is_some());
    let status = live.status();
    assert!(status.notice.unwrap().contains("no-such-file.wav") && status.has_sound);
    live.set_sound("speech".parse().unwrap());
    wait_for("the sound", || live.status().notice.is_none());
}

/// Waits until an interruption would leave a file of at least `frames` frames.
fn wait_recorded(stem: &str, frames: u32) {
    let part = part_of(stem);
    wait_for("the recording", || {
        hound::WavReader::open(&part).is_ok_and(|reader| reader.duration() > frames)
    });
}

/// The partial file next to [`FILE`] that is being written.
fn part_of(stem: &str) -> PathBuf {
    let files = std::fs::read_dir(file().parent().unwrap()).unwrap();
    let names = files.map(|entry| entry.unwrap().path());
    let is_part = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.starts_with(&format!("{stem}-")) && name.ends_with(".part.wav")
    };
    names.into_iter().find(is_part).unwrap()
}

/// Chooses many sounds without a device; only the most recent sound is heard.
fn play_changes_in_silence() {
    let live = start(Some("no such device"));
    wait_for("an error", || live.status().last_error.is_some());
    live.start_recording(&file()).unwrap();
    for sound in ["sine:200", "sine:300", "sine:400", "sine:500", "noise"] {
        live.set_sound(sound.parse().unwrap());
        // The player tries to open the device in between.
        live.set_device(Some("no such device".to_owned()));
        pause(0.1);
    }
    live.set_device(None);
    wait_for_sound(&live);
    wait_recorded("heard", 4410);
    assert!(live.stop_recording().unwrap() > 0);
}

fn play_without_device() {
    assert_eq!(list_devices(), []);
    let live = start(None);
    wait_for("an error", || live.status().last_error.is_some());
    live.set_panning(0.0, 1.0);
    live.set_sound("speech".parse().unwrap());
    live.start_recording(&file()).unwrap();
    pause(1.0);
    live.set_sound("no-such-file.wav".parse().unwrap());
    wait_for("the file's error", || {
        let error = live.status().last_error.unwrap_or_default();
        error.contains("no-such-file.wav")
    });
    live.set_device(Some("no such device".to_owned()));
    pause(0.5);
    let status = live.status();
    println!("{status:?}");
    assert_eq!(status.device, None);
    assert_eq!(status.restarts, 0);
    assert_eq!(live.levels(), [0.0, 0.0]);
    assert_eq!(live.stop_recording().unwrap(), 0);
}

/// The player as a process, and the lines that it prints.
pub struct Player {
    process: Process,
    lines: Receiver<String>,
    input: Option<ChildStdin>,
}

impl Player {
    pub fn start(mut command: Command, part: &str, file: &Path) -> Self {
        let mut child: Child = command
            .args([
                "--exact",
                "live_audio_server::player",
                "--nocapture",
                "--test-threads=1",
            ])
            .env(PART, part)
            .env(FILE, file)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                println!("player: {line}");
                let _ = sender.send(line);
            }
        });
        Self {
            input: child.stdin.take(),
            process: Process(child),
            lines,
        }
    }

    /// Waits for a line that contains all of `parts`.
    pub fn wait_for(&self, parts: &[&str]) -> String {
        self.wait_until(&format!("{parts:?}"), |line| {
            parts.iter().all(|part| line.contains(part))
        })
    }

    /// Waits until the sound is heard after at least `losses` losses of the device (a busy machine may cause more
    /// losses). The device was then reopened exactly once for each loss.
    pub fn wait_for_sound_after(&self, losses: u64) -> String {
        self.wait_until(&format!("sound after {losses} losses"), |line| {
            let [restarts, lost] = ["restarts", "losses"].map(|name| number_after(line, name));
            let is_heard = line.contains("device Some") && line.contains("heard true");
            is_heard && restarts == lost && lost >= Some(losses)
        })
    }

    fn wait_until(&self, what: &str, is_so: impl Fn(&str) -> bool) -> String {
        let end = Instant::now() + TIMEOUT;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line = self.lines.recv_timeout(left);
            let line = line.unwrap_or_else(|_| panic!("the player did not print {what}"));
            if is_so(&line) {
                return line;
            }
        }
    }

    /// Returns its current number of threads.
    pub fn threads(&self) -> usize {
        let tasks = std::fs::read_dir(format!("/proc/{}/task", self.process.0.id()));
        tasks.unwrap().count()
    }

    /// Closes the input of the player, and requires a successful exit.
    pub fn finish(mut self) {
        self.input = None;
        assert!(self.process.0.wait().unwrap().success());
    }
}

/// Returns the number after a word in the player's line.
fn number_after(line: &str, word: &str) -> Option<u64> {
    let (_, rest) = line.split_once(&format!("{word} "))?;
    rest.split(',').next()?.parse().ok()
}
