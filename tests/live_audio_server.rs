//! Live output through a real sound system: a PulseAudio server with a null sink, whose monitor is
//! recorded. The player is this program itself, started once more with the server in its
//! environment.

mod live_player;
mod sound_server;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::Instant;

use echomarch::audio::{NOISE_AMPLITUDE, SAMPLE_RATE, SINE_AMPLITUDE, Sound};
use live_player::{CLOSINGS, PLACES, Player, STEP_S, SWEEP_S, pause, play};
use sound_server::levels::{Heard, Log, error_db, gains, rms};
use sound_server::{SINK, Server};
use tempfile::TempDir;

/// The player's half of each test; nothing when it is not started by one.
#[test]
fn player() {
    play();
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
    let step = |at: usize| (left[at + 1] - left[at]).abs();
    let (mut at, mut gaps) = (0, 0);
    while at + 1 < left.len() {
        if let Some(end) = end_of_gap(&left[at..], allowed) {
            gaps += 1;
            at += end;
        } else {
            largest = largest.max(step(at));
        }
        at += 1;
    }
    println!("largest step {largest:.5}, allowed {allowed:.5}, {rises} rises, {gaps} gaps");
    assert!(largest <= allowed + 1e-5, "{largest} above {allowed}");
    assert!(gaps <= 1);
    assert!((CLOSINGS + 1..=CLOSINGS + 1 + gaps).contains(&rises));
}

/// Where a gap of a busy machine ends that begins after the first sample: the sound breaks off and
/// goes on at once at its full level, where a stream that is opened rises from silence.
fn end_of_gap(samples: &[f32], allowed: f32) -> Option<usize> {
    if samples[0].abs() <= allowed || samples[1] != 0.0 {
        return None;
    }
    let silent = samples[1..].iter().take_while(|&&s| s == 0.0).count();
    let next = samples.get(silent + 1)?;
    (next.abs() > allowed).then_some(silent)
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
