//! Live output through a real sound system: a PulseAudio server with a null sink whose monitor is recorded. The player
//! is this test program, started again with the address of the server in its environment.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::live_player::{CLOSINGS, PLACES, Player, pause, play};
use crate::measures::rms;
use crate::sound_server::levels::{Heard, error_db, gains};
use crate::sound_server::{SINK, Server, wait_for};
use echomarch::audio::Sound;
use tempfile::TempDir;

/// The player's part of each test; does nothing unless a test starts it.
#[test]
fn player() {
    play();
}

fn this_program() -> PathBuf {
    std::env::current_exe().unwrap()
}

static NOISE: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let mut samples = vec![0.0; 40 * Sound::SAMPLE_RATE as usize];
    Sound::parse("noise", Sound::SAMPLE_RATE)
        .unwrap()
        .fill(&mut samples);
    samples
});

/// Protects the panning up to the sound system's output: the positions and the sweep are heard in order, with the set
/// levels on both sides, and the recording equals the monitor.
#[test]
fn the_levels_follow_the_panning_from_left_to_right() {
    const ATTEMPTS: u32 = 5;
    for attempt in 1..=ATTEMPTS {
        println!("attempt {attempt}");
        if sweep_is_heard() {
            return;
        }
    }
    panic!("the machine is too busy: most of the sound had gaps, {ATTEMPTS} times");
}

/// Plays and records once. Returns false if gaps left too few windows to compare.
fn sweep_is_heard() -> bool {
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "sweep", &file);
    let places = player.wait_for(&["places "]);
    let line = player.wait_for(&["recorded ", "dropped "]);
    player.finish();
    let heard = recorder.stop();
    let places = places
        .split_whitespace()
        .filter_map(|word| word.parse().ok());
    // The sound is in the centre until the first position is set.
    let places: Vec<f64> = [0.5].into_iter().chain(places).collect();
    assert!(places.len() > PLACES as usize);
    // Intervals of 50 ms, over which the noise's level is known to 0.1 dB.
    let compared = Heard::new(&heard, 50).follow(&places);
    println!("{compared:?}");
    assert_eq!(compared.wrong, 0, "{compared:?}");
    // Outside the sweep, the gains are constant most of the time.
    assert!(3 * compared.moving < 2 * compared.windows, "{compared:?}");
    let is_enough = compared.windows > 60 && compared.left_out < compared.windows;
    let is_whole = line.contains("dropped 0");
    is_enough && is_whole && recording_is_what_was_heard(&file, &heard, &line)
}

/// Checks that the file equals the monitor bit for bit, in consecutive pieces of 10 ms, except for pieces in gaps of a
/// busy machine. Returns false if less than half of the file was heard.
fn recording_is_what_was_heard(file: &Path, heard: &[f32], line: &str) -> bool {
    const PIECE: usize = 960;
    let mut reader = hound::WavReader::open(file).unwrap();
    assert_eq!(reader.spec().sample_rate, 48_000);
    let written: Vec<f32> = reader.samples().map(Result::unwrap).collect();
    assert!(line.contains(&format!("recorded {},", written.len() / 2)));
    let (mut place, mut found) = (0, 0);
    let pieces = written.chunks_exact(PIECE);
    let count = pieces.len();
    for piece in pieces {
        let is_there = |&at: &usize| heard[at] == piece[0] && heard[at..][..PIECE] == *piece;
        let last = heard.len() - PIECE;
        if let Some(at) = (place..last).step_by(2).find(is_there) {
            found += 1;
            place = at + PIECE;
        }
    }
    println!("{found} of {count} pieces equal bit for bit, in order");
    2 * found > count
}

/// Protects the end of a stream: audible sound fades out, so that neither a change of device nor the end clicks. On a
/// busy machine the server or the recorder may sometimes lose samples, which cannot be distinguished from a click. A
/// click of the program itself occurs in every run.
#[test]
fn a_stream_that_is_closed_does_not_click() {
    const RUNS: usize = 4;
    let mut found = Vec::new();
    while found.len() < RUNS {
        match closed_streams() {
            Ok(()) => return,
            Err(what) => found.push(what),
        }
    }
    panic!("in each of {RUNS} runs: {found:#?}");
}

/// Opens and closes streams, and records the server's output. Returns a description of the largest step if it is a
/// click.
fn closed_streams() -> Result<(), String> {
    let server = Server::start();
    let recorder = server.record(SINK, 48_000, 2);
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "close", &file);
    // A busy machine may leave gaps; the check below distinguishes them from clicks.
    player.wait_for(&["late callbacks "]);
    player.finish();
    let left: Vec<f32> = recorder.stop().iter().step_by(2).copied().collect();
    // The sine's own step, and the step that a 20 ms glide adds.
    let own = Sound::SINE_AMPLITUDE * 100.0 * std::f32::consts::TAU / 48_000.0;
    let allowed = own + Sound::SINE_AMPLITUDE / 960.0;
    let (mut rises, mut is_silent, mut largest) = (0, true, 0.0f32);
    for piece in left.chunks(480) {
        let is_now_silent = piece.iter().all(|s| s.abs() < 1e-6);
        rises += u64::from(is_silent && !is_now_silent);
        is_silent = is_now_silent;
    }
    let step = |at: usize| (left[at + 1] - left[at]).abs();
    let (mut at, mut gaps) = (0, 0);
    while at + 1 < left.len() {
        if let Some(end) = end_of_gap(&left, at, allowed) {
            gaps += 1;
            at += end;
        } else {
            largest = largest.max(step(at));
        }
        at += 1;
    }
    let told =
        format!("largest step {largest:.5}, allowed {allowed:.5}, {rises} rises, {gaps} gaps");
    println!("{told}");
    // Between two streams there may be less than 10 ms of silence.
    let is_right = largest <= allowed + 1e-5 && (2..=CLOSINGS + 1 + gaps).contains(&rises);
    is_right.then_some(()).ok_or(told)
}

/// Returns the length in samples of the gap that begins after `at`, if the step is a gap of a busy machine. At a gap
/// the sound stops and continues at its full level. A closed stream, in contrast, fades out to silence, and an opened
/// stream rises from silence.
fn end_of_gap(samples: &[f32], at: usize, allowed: f32) -> Option<usize> {
    // Half a period of the sine contains its peak. In the last half period of a fade of 20 ms, the sine has at most a
    // quarter of its peak.
    const HALF_A_PERIOD: usize = 240;
    let is_full = |samples: &[f32]| {
        samples
            .iter()
            .any(|s| s.abs() > Sound::SINE_AMPLITUDE / 2.0)
    };
    let before = &samples[at.saturating_sub(HALF_A_PERIOD)..=at];
    if !is_full(before) || samples[at + 1] != 0.0 {
        return None;
    }
    let silent = samples[at + 1..].iter().take_while(|&&s| s == 0.0).count();
    let after = &samples[at + silent + 1..];
    // The sound may continue near a zero of the sine, or with a fade.
    let goes_on = after.first().is_some_and(|next| next.abs() > allowed)
        || is_full(&after[..after.len().min(HALF_A_PERIOD)]);
    goes_on.then_some(silent)
}

#[test]
fn a_server_that_dies_is_waited_for_and_the_sound_goes_on_where_it_was() {
    let mut server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "endure", &file);
    player.wait_for_sound_after(0);
    pause(0.5);
    server.kill();
    player.wait_for(&["device None", "heard false", "is lost"]);
    pause(1.0);
    server.restart();
    let recorder = server.record(SINK, 48_000, 2);
    player.wait_for_sound_after(1);
    wait_for("sound after the restart", || {
        let loud = gains(&recorder.samples(), 960);
        let loud = loud.iter().filter(|g| error_db(**g, [0.5, 0.5]) < 0.5);
        loud.count() > 15
    });
    player.finish();

    // Sample n of the file is sample n + shift of the noise, before and after the gap.
    let mut reader = hound::WavReader::open(&file).unwrap();
    let left: Vec<f32> = reader.samples().step_by(2).map(Result::unwrap).collect();
    let shift = shift_of(&left[2400..2500], 2400).expect("noise before the gap");
    let end = left.len() - 9600;
    assert_eq!(shift_of(&left[end..end + 100], end), Some(shift));
}

/// Returns the number of samples by which the noise at `at` in the file is ahead of the position in the file.
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
    player.wait_for_sound_after(0);
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
    player.wait_for_sound_after(1);
    player.finish();
}

#[test]
fn a_server_that_hangs_is_given_up_and_found_again() {
    let server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "endure", &file);
    player.wait_for_sound_after(0);
    server.signal("STOP");
    player.wait_for(&["device None", "heard false", "has taken no sound for 1.0 s"]);
    // Repeated queries start no further threads or connections.
    player.wait_for(&["device None", "has not answered for 5 s"]);
    let threads = player.threads();
    pause(8.0);
    assert_eq!(player.threads(), threads);
    server.signal("CONT");
    player.wait_for_sound_after(1);
    let clients = server.pactl(&["list", "short", "clients"]);
    // One client is the player, and another may be the query.
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
    // The server mixes left and right to one channel: half of the left signal.
    let full = f64::from(Sound::NOISE_AMPLITUDE) / 3f64.sqrt();
    let loudest = recorder
        .stop()
        .chunks_exact(4410)
        .map(|piece| rms(piece) / full)
        .fold(0.0, f64::max);
    assert!((loudest - 0.5).abs() < 0.05, "{loudest}");
}

/// Protects recordings from a device that opens later with another rate, and from a recording that ended by itself: the
/// status reports each event, and the next recording can start.
#[test]
fn a_recording_follows_the_first_device_and_one_that_ended_is_followed_by_another() {
    let server = Server::start();
    server.load_other();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "recordings", &file);
    player.finish();
    for (name, rate_hz, at_least) in [("heard.wav", 44_100, 4410), ("again.wav", 48_000, 24_000)] {
        let mut reader = hound::WavReader::open(file.with_file_name(name)).unwrap();
        assert_eq!(reader.spec().sample_rate, rate_hz, "{name}");
        assert!(reader.duration() > at_least, "{name}");
        let loudest = reader.samples::<f32>().map(|s| s.unwrap().abs());
        assert!(loudest.fold(0.0, f32::max) > 0.2, "{name}");
    }
}

/// Protects from sounds that accumulate without a device: only the most recently chosen sound is heard, from its start.
#[test]
fn of_sounds_that_were_chosen_without_a_device_the_last_is_heard() {
    let server = Server::start();
    let file = server.folder.path().join("heard.wav");
    let player = Player::start(server.command(this_program()), "changes", &file);
    player.finish();
    let mut reader = hound::WavReader::open(&file).unwrap();
    let left: Vec<f32> = reader.samples().step_by(2).map(Result::unwrap).collect();
    // The gains have risen 20 ms after the beginning, or later if a busy machine lost the device at once. From then on
    // the file contains the noise.
    let places = (960..left.len() - 100).step_by(480);
    let mut shifts = places.filter_map(|at| shift_of(&left[at..at + 100], at));
    let shift = shifts.next().expect("noise");
    assert!(
        shift < Sound::SAMPLE_RATE as usize / 2,
        "{shift} samples in"
    );
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
