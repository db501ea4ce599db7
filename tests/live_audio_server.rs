//! Live output through a real sound system: a PulseAudio server with a null sink, whose monitor is
//! recorded. The player is this program itself, started once more with the server in its
//! environment.

mod sound_server;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use echomarch::audio::live::{Live, LiveError, LiveOptions, list_devices};
use echomarch::audio::{NOISE_AMPLITUDE, SAMPLE_RATE, SINE_AMPLITUDE, Sound};
use sound_server::levels::{Heard, Log, error_db, gains, rms};
use sound_server::{Process, SINK, Server, now_s, wait_for};
use tempfile::TempDir;

/// Says which part of the player below is wanted.
const PART: &str = "ECHOMARCH_TEST_PART";
/// Says which file it shall record to.
const FILE: &str = "ECHOMARCH_TEST_FILE";

/// Seconds that the sound stays at each place, and places from left to right.
const STEP_S: f64 = 0.4;
const PLACES: u32 = 9;
const SWEEP_S: f64 = 3.0;

/// Times that the device is closed and opened again.
const CLOSINGS: u64 = 5;

/// The player's half of each test; nothing when it is not started by one.
#[test]
fn player() {
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

fn pause(seconds: f64) {
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
        log += &format!(" {:.4}:{along:.6}", now_s());
        live.set_panning(1.0 - along, along);
    };
    // Back to the first at the end, where the sweep begins.
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
    // A pan is taken by the next callback: two buffers are more than that takes.
    let buffers_ms = 2000.0 * f64::from(status.buffer_frames) / 48_000.0;
    let waited_ms = status.pan_waited_ms.unwrap();
    assert!(waited_ms <= buffers_ms, "{waited_ms} ms above {buffers_ms}");
    assert!(matches!(
        live.stop_recording(),
        Err(LiveError::NotRecording)
    ));
    assert_eq!(status.restarts, 0);
    assert_eq!(status.sample_rate, 48_000);
}

/// A sine that is closed and opened again at several places of its period. The buffer is long,
/// so that a machine that is busy leaves no gap.
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
            status.device.is_some() && status.restarts == restarts
        });
        wait_for_sound(&live);
        pause(0.4 + 0.0133 * restarts as f64);
        live.set_device(None);
    }
    wait_for("the last device", || live.status().restarts == CLOSINGS);
    wait_for_sound(&live);
    pause(0.4);
    println!("late callbacks {}", live.status().late_callbacks);
}

/// Plays until its input ends, and tells each change of its status.
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
            "state: device {:?}, restarts {}, heard {}, error {:?}",
            status.device,
            status.restarts,
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
    assert_eq!(status.restarts, 1);
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
    assert_eq!(live.status().restarts, 2);
}

/// Records from before the first device, which then has another rate than is assumed; over a
/// change of the rate, which ends it; and once more.
fn play_recordings() {
    let live = start(Some("other"));
    live.start_recording(&file()).unwrap();
    wait_for_sound(&live);
    pause(0.3);
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
    // It was told: it stands in the way of nothing.
    let again = file().with_file_name("again.wav");
    live.start_recording(&again).unwrap();
    let status = live.status();
    assert!(status.is_recording && status.notice.is_none(), "{status:?}");
    pause(2.0);
    // What a program leaves that is broken off now.
    let part = part_of("again");
    let left = hound::WavReader::open(&part).unwrap().duration();
    assert!(left > 24_000, "{left} frames in {}", part.display());
    assert!(live.stop_recording().unwrap() > 48_000);
    assert!(again.exists() && !part.exists());

    live.set_sound("no-such-file.wav".parse().unwrap());
    wait_for("the file's error", || live.status().notice.is_some());
    let status = live.status();
    assert!(status.notice.unwrap().contains("no-such-file.wav") && status.has_sound);
    live.set_sound("speech".parse().unwrap());
    wait_for("the sound", || live.status().notice.is_none());
}

/// The file beside [`FILE`] that is being written.
fn part_of(stem: &str) -> PathBuf {
    let files = std::fs::read_dir(file().parent().unwrap()).unwrap();
    let names = files.map(|entry| entry.unwrap().path());
    let is_part = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.starts_with(&format!("{stem}-")) && name.ends_with(".part.wav")
    };
    names.into_iter().find(is_part).unwrap()
}

/// Many sounds are chosen while there is no device: the last is heard.
fn play_changes_in_silence() {
    let live = start(Some("no such device"));
    wait_for("an error", || live.status().last_error.is_some());
    live.start_recording(&file()).unwrap();
    for sound in ["sine:200", "sine:300", "sine:400", "sine:500", "noise"] {
        live.set_sound(sound.parse().unwrap());
        // Attempts to open it lie in between.
        live.set_device(Some("no such device".to_owned()));
        pause(0.1);
    }
    live.set_device(None);
    wait_for_sound(&live);
    pause(0.3);
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
    let start = Instant::now();
    drop(live);
    assert!(start.elapsed() < Duration::from_secs(1));
}

/// The player as a process, and what it prints.
struct Player {
    process: Process,
    lines: Receiver<String>,
    input: Option<ChildStdin>,
}

impl Player {
    fn start(mut command: Command, part: &str, file: &Path) -> Self {
        let mut child: Child = command
            .args(["--exact", "player", "--nocapture", "--test-threads=1"])
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

    /// Waits for a line that holds all of these.
    fn wait_for(&self, parts: &[&str]) -> String {
        let end = Instant::now() + Duration::from_secs(30);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line = self.lines.recv_timeout(left);
            let line = line.unwrap_or_else(|_| panic!("the player did not say {parts:?}"));
            if parts.iter().all(|part| line.contains(part)) {
                return line;
            }
        }
    }

    /// How many threads it has now.
    fn threads(&self) -> usize {
        let tasks = std::fs::read_dir(format!("/proc/{}/task", self.process.0.id()));
        tasks.unwrap().count()
    }

    /// Lets it end, and fails if it does not end well.
    fn finish(mut self) {
        self.input = None;
        assert!(self.process.0.wait().unwrap().success());
    }
}

fn this_program() -> PathBuf {
    std::env::current_exe().unwrap()
}

static NOISE: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let mut samples = vec![0.0; 40 * SAMPLE_RATE as usize];
    Sound::parse("noise", SAMPLE_RATE)
        .unwrap()
        .fill(&mut samples);
    samples
});

#[test]
fn the_levels_follow_the_panning_from_left_to_right() {
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "sweep", &file);
    let places = player.wait_for(&["places "]);
    let line = player.wait_for(&["recorded ", "dropped 0"]);
    player.finish();
    let begin_s = recorder.began_s;
    let heard = recorder.stop();
    let log = places.split_whitespace().filter_map(|word| {
        let (seconds, along) = word.split_once(':')?;
        Some((seconds.parse().ok()?, along.parse().ok()?))
    });
    let log = Log(log.collect());
    assert!(log.0.len() > 100 + PLACES as usize);
    // Windows of 50 ms, over which the noise's level is known to 0.1 dB.
    let compared = log.compare(&Heard::new(&heard, 50), begin_s, 1024.0 / 48_000.0);
    println!("{compared:?}");
    let seconds = f64::from(PLACES + 2) * STEP_S + SWEEP_S;
    let all = compared.windows + compared.gaps;
    assert!(all as f64 > 20.0 * seconds - 15.0, "{all} windows");
    // A busy machine may leave a gap; whatever was played is right.
    assert!(compared.gaps * 20 <= all, "{compared:?}");
    assert!(compared.worst_db <= 0.5, "{compared:?}");
    recording_is_what_was_heard(&file, &heard, &line);
}

/// The whole file stands in the monitor bit for bit, one piece of 50 ms after the other. Where a
/// busy machine leaves a gap the pieces after it are found further on, and one in the gap is lost.
fn recording_is_what_was_heard(file: &Path, heard: &[f32], line: &str) {
    const PIECE: usize = 4800;
    let mut reader = hound::WavReader::open(file).unwrap();
    assert_eq!(reader.spec().sample_rate, 48_000);
    let written: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    assert!(line.contains(&format!("recorded {},", written.len() / 2)));
    assert!(written.len() as f64 / 96_000.0 > f64::from(PLACES) * STEP_S + SWEEP_S - 0.2);
    let (mut place, mut gaps, mut lost) = (0, 0, 0);
    let pieces = written.chunks_exact(PIECE);
    let count = pieces.len();
    for piece in pieces {
        let is_there = |&at: &usize| heard[at] == piece[0] && heard[at..][..PIECE] == *piece;
        let last = heard.len() - PIECE;
        let Some(at) = (place..last).step_by(2).find(is_there) else {
            lost += 1;
            continue;
        };
        gaps += usize::from(at != place);
        place = at + PIECE;
    }
    println!("{count} pieces bit for bit, but for {lost}; {gaps} gaps, the beginning's included");
    assert!(lost * 20 <= count && gaps * 20 <= count);
}

/// Protects the end of a stream: what is under way is heard until it has faded, so that neither
/// another device nor the end clicks.
#[test]
fn a_stream_that_is_closed_does_not_click() {
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "close", &file);
    player.wait_for(&["late callbacks 0"]);
    player.finish();
    let left: Vec<f32> = recorder.stop().iter().step_by(2).copied().collect();
    // The sine's own step, and what a glide of 20 ms adds to it.
    let own = SINE_AMPLITUDE * 100.0 * std::f32::consts::TAU / 48_000.0;
    let allowed = own + SINE_AMPLITUDE / 960.0;
    let (mut rises, mut is_silent, mut largest) = (0, true, 0.0f32);
    for piece in left.chunks(480) {
        let is_now_silent = piece.iter().all(|s| s.abs() < 1e-6);
        rises += u64::from(is_silent && !is_now_silent);
        is_silent = is_now_silent;
    }
    for pair in left.windows(2) {
        largest = largest.max((pair[1] - pair[0]).abs());
    }
    println!("largest step {largest:.5}, allowed {allowed:.5}, {rises} rises");
    assert!(largest <= allowed + 1e-5, "{largest} above {allowed}");
    assert_eq!(rises, CLOSINGS + 1);
}

#[test]
fn a_server_that_dies_is_waited_for_and_the_sound_goes_on_where_it_was() {
    let mut server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "endure", &file);
    player.wait_for(&["device Some", "restarts 0", "heard true"]);
    pause(0.5);
    server.kill();
    player.wait_for(&["device None", "heard false", "is lost"]);
    pause(1.0);
    let start = Instant::now();
    server.restart();
    let recorder = server.record(SINK, 48_000, 2);
    player.wait_for(&["device Some", "restarts 1", "heard true"]);
    println!("heard again {:?} after the restart began", start.elapsed());
    pause(0.5);
    player.finish();
    let loud = gains(&recorder.stop(), 960);
    let loud = loud.iter().filter(|g| error_db(**g, [0.5, 0.5]) < 0.5);
    assert!(loud.count() > 15, "too little is heard after the restart");

    // In the file, sample n is the noise's sample n + shift, before and after the gap.
    let mut reader = hound::WavReader::open(&file).unwrap();
    let left: Vec<f32> = reader.samples().step_by(2).map(Result::unwrap).collect();
    let shift = shift_of(&left[2400..2500], 2400).expect("noise before the gap");
    let end = left.len() - 9600;
    assert_eq!(shift_of(&left[end..end + 100], end), Some(shift));
}

/// How many samples the noise at `at` in the file lies further on in the sound.
fn shift_of(piece: &[f32], at: usize) -> Option<usize> {
    let fits = |start: &usize| {
        let noise = &NOISE[*start..*start + piece.len()];
        noise
            .iter()
            .zip(piece)
            .all(|(n, p)| (0.5 * n - p).abs() < 1e-6)
    };
    (at..NOISE.len() - piece.len())
        .find(fits)
        .map(|start| start - at)
}

#[test]
fn a_sink_that_goes_away_and_comes_back_is_opened_again() {
    let server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "endure", &file);
    player.wait_for(&["device Some", "restarts 0", "heard true"]);
    server.pactl(&["unload-module", "module-null-sink"]);
    player.wait_for(&["device None", "heard false", "is lost"]);
    let sink = format!("sink_name={SINK}");
    server.pactl(&[
        "load-module",
        "module-null-sink",
        &sink,
        "rate=48000",
        "norewinds=1",
    ]);
    player.wait_for(&["device Some", "heard true"]);
    player.finish();
}

#[test]
fn a_server_that_hangs_is_given_up_and_found_again() {
    let server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "endure", &file);
    player.wait_for(&["device Some", "restarts 0", "heard true"]);
    server.signal("STOP");
    player.wait_for(&["device None", "heard false", "has taken no sound for 1.0 s"]);
    // However often it is asked, no more threads wait for it, nor connections.
    player.wait_for(&["device None", "has not answered for 5 s"]);
    let threads = player.threads();
    pause(8.0);
    assert_eq!(player.threads(), threads);
    server.signal("CONT");
    player.wait_for(&["device Some", "restarts 1", "heard true"]);
    let clients = server.pactl(&["list", "short", "clients"]);
    // The player's, and perhaps the one that asks.
    assert!(clients.lines().count() <= 2, "{clients}");
    player.finish();
}

#[test]
fn devices_are_listed_and_changed() {
    let server = Server::start();
    server.load_other();
    let recorder = server.record("other", 44_100, 1);
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "devices", &file);
    player.finish();
    // The server mixes left and right to the one channel: half of what is on the left.
    let full = f64::from(NOISE_AMPLITUDE) / 3f64.sqrt();
    let loudest = recorder
        .stop()
        .chunks_exact(4410)
        .map(|piece| rms(piece.iter().copied()) / full)
        .fold(0.0, f64::max);
    assert!((loudest - 0.5).abs() < 0.05, "{loudest}");
}

/// Protects recordings from the rate of a device that comes later, and from one that ended by
/// itself: each says what it holds, and makes room for the next.
#[test]
fn a_recording_follows_the_first_device_and_one_that_ended_is_followed_by_another() {
    let server = Server::start();
    server.load_other();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "recordings", &file);
    player.finish();
    for (name, rate_hz, at_least) in [("heard.wav", 44_100, 4410), ("again.wav", 48_000, 48_000)] {
        let mut reader = hound::WavReader::open(file.with_file_name(name)).unwrap();
        assert_eq!(reader.spec().sample_rate, rate_hz, "{name}");
        assert!(reader.duration() > at_least, "{name}");
        let loudest = reader.samples::<f32>().map(|s| s.unwrap().abs());
        assert!(loudest.fold(0.0, f32::max) > 0.2, "{name}");
    }
}

/// Protects from sounds that pile up while there is no device: of all that were chosen the last
/// is heard, from its start.
#[test]
fn of_sounds_that_were_chosen_without_a_device_the_last_is_heard() {
    let server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "changes", &file);
    player.finish();
    let mut reader = hound::WavReader::open(&file).unwrap();
    let left: Vec<f32> = reader.samples().step_by(2).map(Result::unwrap).collect();
    // 20 ms after the beginning the gains have risen: from then on it is noise.
    let shift = shift_of(&left[960..1060], 960).expect("noise");
    assert!(shift < SAMPLE_RATE as usize / 2, "{shift} samples in");
}

#[test]
fn without_any_device_it_runs_on_in_silence_and_says_so() {
    let folder = TempDir::new().unwrap();
    let nowhere = folder.path().join("nowhere");
    let mut command = Command::new(this_program());
    command
        .env("XDG_RUNTIME_DIR", folder.path())
        .env("HOME", folder.path())
        .env("PULSE_SERVER", format!("unix:{}", nowhere.display()))
        .env("PULSE_RUNTIME_PATH", &nowhere)
        .env("ALSA_CONFIG_PATH", nowhere.join("alsa.conf"));
    let player = Player::start(command, "nothing", &folder.path().join("heard.wav"));
    let line = player.wait_for(&["LiveStatus", "device: None"]);
    assert!(line.contains("last_error: Some"), "{line}");
    player.finish();
}
